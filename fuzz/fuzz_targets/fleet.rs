//! Files of the grammar that the bytes choose are checked, drawn, formatted and written out.

#![no_main]

use saoms_components as _;

#[path = "../../tests/robustness/targets/mod.rs"]
#[allow(dead_code, reason = "each fuzzer runs one of them")]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::fleet(bytes));
