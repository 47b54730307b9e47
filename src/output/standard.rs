//! Standard output and standard error. A reader that went away (`saoms components | head`) is no failure; a full disk
//! is one.

use std::fmt::Display;
use std::io::{self, BufWriter, ErrorKind, StdoutLock, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;

/// True once something could not be written to standard output.
static HAS_FAILED: AtomicBool = AtomicBool::new(false);

/// True if something could not be written to standard output, which was told.
pub(crate) fn has_failed() -> bool {
    HAS_FAILED.load(Ordering::SeqCst)
}

/// Writes a value to standard output, piece by piece.
pub(crate) fn print(shown: &(impl Display + ?Sized)) {
    printed(|output| write!(output, "{shown}"));
}

/// Writes data to standard output as JSON, piece by piece.
pub(crate) fn print_json(value: &impl Serialize) {
    printed(|output| json(output, value));
}

/// Writes to standard output. The first failure is told; from then on [`has_failed`].
pub(crate) fn printed(write: impl FnOnce(&mut BufWriter<StdoutLock<'static>>) -> io::Result<()>) {
    let mut output = BufWriter::new(io::stdout().lock());
    let Err(error) = write(&mut output).and_then(|()| output.flush()) else { return };
    if error.kind() == ErrorKind::BrokenPipe || HAS_FAILED.swap(true, Ordering::SeqCst) {
        return;
    }
    let help = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "\n  = help: it is not whole: make room, and run the command again"
        }
        _ => "",
    };
    eprint(&format!("error: standard output cannot be written: {error}{help}\n"));
}

/// Writes a value to standard error, piece by piece.
pub(crate) fn eprint(shown: &(impl Display + ?Sized)) {
    let mut output = BufWriter::new(io::stderr().lock());
    // Nobody is left to be told.
    let _ = write!(output, "{shown}").and_then(|()| output.flush());
}

/// Writes data to standard error as JSON, piece by piece.
pub(crate) fn eprint_json(value: &impl Serialize) {
    let mut output = BufWriter::new(io::stderr().lock());
    let _ = json(&mut output, value).and_then(|()| output.flush());
}

fn json(output: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *output, value)?;
    output.write_all(b"\n")
}
