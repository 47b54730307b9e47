//! Writing to standard output and standard error, where a closed pipe is no reason to fail.

use std::io::{self, Write};

/// Writes text to standard output.
pub(crate) fn print(text: &str) {
    let _ = try_print(text);
}

/// Writes text to standard output. A reader that went away (`saoms components | head`) is not an error.
pub(crate) fn try_print(text: &str) -> io::Result<()> {
    let mut output = io::stdout().lock();
    unless_closed(output.write_all(text.as_bytes()).and_then(|()| output.flush()))
}

/// What came of writing, where it is no fault that nobody reads on.
pub(crate) fn unless_closed(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// Writes text to standard error.
pub(crate) fn eprint(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// `1 error`, `2 errors`.
pub(crate) fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
