//! The line below the others on a terminal, which says how far a run is.

use std::io::{self, IsTerminal, Stderr, Write};
use std::sync::{Mutex, PoisonError};
use std::{env, mem};

/// Signs shown one after the other while the run continues.
const TURNS: [char; 4] = ['|', '/', '-', '\\'];
/// Control sequences (ECMA-48, 8.3.41, and DECAWM): to the start of the line and erase it; do not wrap; wrap again.
const ERASE: &str = "\r\x1b[K";
const CUT: &str = "\x1b[?7l";
const WRAP: &str = "\x1b[?7h";

/// A status line on a terminal. Other lines go above it; what is wider than the terminal is cut.
pub(super) struct StatusLine<W = Stderr>(Mutex<Status<W>>);

struct Status<W> {
    to: W,
    text: String,
    turn: usize,
}

impl StatusLine {
    /// The line on standard error; `None` where an output is no terminal, or one that cannot erase a line.
    pub(super) fn on_terminal() -> Option<Self> {
        let is_dumb = || env::var_os("TERM").is_none_or(|term| term == "dumb");
        let is_shown =
            crate::output::own().is_ok_and(|output| output.is_terminal()) && io::stderr().is_terminal() && !is_dumb();
        is_shown.then(|| Self::new(io::stderr()))
    }
}

impl<W: Write> StatusLine<W> {
    fn new(to: W) -> Self {
        Self(Mutex::new(Status { to, text: String::new(), turn: 0 }))
    }

    /// Shows another text.
    pub(super) fn set(&self, text: String) {
        self.change(|status| {
            status.turn = (status.turn + 1) % TURNS.len();
            status.text = text;
        });
    }

    /// Writes lines above the status line.
    pub(super) fn above(&self, write: impl FnOnce()) {
        self.change(|status| {
            status.write(ERASE);
            write();
        });
    }

    /// Takes the line away.
    pub(super) fn clear(&self) {
        self.change(|status| {
            mem::take(&mut status.text);
            status.write(ERASE);
        });
    }

    fn change(&self, change: impl FnOnce(&mut Status<W>)) {
        // A panic elsewhere leaves a text that can be shown.
        let mut status = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut status);
        if !status.text.is_empty() {
            let line = format!("{ERASE}{CUT}{} {}{WRAP}", TURNS[status.turn], status.text);
            status.write(&line);
        }
    }
}

impl<W: Write> Status<W> {
    fn write(&mut self, text: &str) {
        // A terminal that went away needs no status.
        let _ = self.to.write_all(text.as_bytes()).and_then(|()| self.to.flush());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_go_above_the_status() {
        let line = StatusLine::new(Vec::new());
        line.above(|| {});
        line.set("1s".to_owned());
        line.above(|| {});
        line.clear();
        line.above(|| {});
        let written = String::from_utf8(line.0.into_inner().unwrap().to).unwrap();
        let shown = written.replace(ERASE, "<erase>").replace(CUT, "<cut>").replace(WRAP, "<wrap>");
        let status = "<erase><cut>/ 1s<wrap>";
        assert_eq!(shown, format!("<erase>{status}<erase>{status}<erase><erase>"));
    }
}
