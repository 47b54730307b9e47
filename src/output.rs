//! Writing to standard output and standard error, where a closed pipe is no reason to fail.

use std::fmt::Display;
use std::io::{self, BufWriter, Write};

use serde::Serialize;

/// Writes a value to standard output, piece by piece.
pub(crate) fn print(shown: &(impl Display + ?Sized)) {
    let _ = try_print(shown);
}

/// [`print()`] with the result of writing. A reader that went away (`saoms components | head`) is not an error.
pub(crate) fn try_print(shown: &(impl Display + ?Sized)) -> io::Result<()> {
    let mut output = BufWriter::new(io::stdout().lock());
    unless_closed(write!(output, "{shown}").and_then(|()| output.flush()))
}

/// Writes data to standard output as JSON, piece by piece.
pub(crate) fn print_json(value: &impl Serialize) {
    write_json(io::stdout().lock(), value);
}

/// Writes data to standard error as JSON, piece by piece.
pub(crate) fn eprint_json(value: &impl Serialize) {
    write_json(io::stderr().lock(), value);
}

fn write_json(to: impl Write, value: &impl Serialize) {
    let mut output = BufWriter::new(to);
    // Nothing fails but writing, and nobody is left to be told of that.
    let written = serde_json::to_writer_pretty(&mut output, value).map_err(io::Error::from);
    let _ = written.and_then(|()| output.write_all(b"\n")).and_then(|()| output.flush());
}

/// The result of writing, where a reader that went away is no error.
pub(crate) fn unless_closed(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// Writes a value to standard error, piece by piece.
pub(crate) fn eprint(shown: &(impl Display + ?Sized)) {
    let mut output = BufWriter::new(io::stderr().lock());
    let _ = write!(output, "{shown}").and_then(|()| output.flush());
}

/// `1 error`, `2 errors`.
pub(crate) fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
