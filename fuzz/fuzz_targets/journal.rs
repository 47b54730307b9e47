//! Whatever is read as a journal can be asked why.

#![no_main]

use saoms_components as _;

#[path = "../../tests/robustness/targets/mod.rs"]
#[allow(dead_code, reason = "each fuzzer runs one of them")]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::journal(bytes));
