//! Whatever an editor holds, every question about it has an answer.

#![no_main]

use saoms_components as _;
use saoms_tools::editor::testing::{ask_everything, hold_laws};

// The last two bytes say where the question is asked.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((text, [high, low])) = bytes.split_last_chunk() else { return };
    let text = String::from_utf8_lossy(text);
    let at = usize::from(u16::from_be_bytes([*high, *low])) % (text.len() + 1);
    let at = text.floor_char_boundary(at);
    ask_everything(&text, at, &[]);
    hold_laws(&text, at, &[]);
});
