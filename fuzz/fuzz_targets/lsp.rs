//! Whatever an editor holds, every question about it has an answer.

#![no_main]

use saoms_components as _;

#[path = "../../src/lsp"]
#[allow(dead_code, unused_imports, reason = "the server itself is left out")]
mod lsp {
    mod complete;
    mod contracts;
    mod describe;
    mod diagnostics;
    mod expressions;
    mod file;
    mod hover;
    mod laws;
    mod links;
    mod loops;
    mod navigate;
    mod occurrences;
    mod outline;
    mod position;
    mod rename;
    mod scene;
    mod shape;
    mod symbol;
    mod symbols;
    mod syntax;
    pub(crate) mod testing;
    mod topics;
    mod uri;
    mod workspace;
}

// The last two bytes say where the question is asked.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((text, [high, low])) = bytes.split_last_chunk() else { return };
    let text = String::from_utf8_lossy(text);
    let at = usize::from(u16::from_be_bytes([*high, *low])) % (text.len() + 1);
    let at = text.floor_char_boundary(at);
    lsp::testing::ask_everything(&text, at, &[]);
    lsp::testing::hold_laws(&text, at, &[]);
});
