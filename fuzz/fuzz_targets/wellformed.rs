//! Compares the well-formedness and the content of a file with another XML parser.

#![no_main]

#[path = "../../saoms-lang/tests/suite/load/oracle.rs"]
mod oracle;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| oracle::judge(&String::from_utf8_lossy(bytes)));
