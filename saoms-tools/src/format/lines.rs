//! The lines that are written.

use std::fmt::{Result, Write};

/// Columns of each level; all columns are a multiple of it.
const INDENT: usize = 2;

/// Elements that are deeper than this are indented no further, so that the output grows with the input alone.
const DEEPEST: usize = 40;

/// Text that is being written; its lines end as the first line of the source does.
pub(super) struct Lines<'w> {
    out: &'w mut dyn Write,
    line_end: &'static str,
    /// True if nothing but the mark at the start is written yet.
    pub(super) is_empty: bool,
    /// The result of writing; after a failure nothing more is written.
    result: Result,
}

impl<'w> Lines<'w> {
    /// Nothing but `mark` yet.
    pub(super) fn new(source: &str, mark: &str, out: &'w mut dyn Write) -> Self {
        let first = source.find(['\r', '\n']).map_or("", |at| &source[at..]);
        let line_end = if first.starts_with("\r\n") { "\r\n" } else { "\n" };
        let result = out.write_str(mark);
        Self { out, line_end, is_empty: true, result }
    }

    /// The columns that a level takes.
    pub(super) fn columns(depth: usize) -> usize {
        depth.min(DEEPEST) * INDENT
    }

    /// Starts a line, after a blank one if asked.
    pub(super) fn next(&mut self, depth: usize, blank: bool) {
        if blank {
            self.push(self.line_end);
        }
        self.next_at(Self::columns(depth));
    }

    /// Starts a line with so many blanks.
    pub(super) fn next_at(&mut self, columns: usize) {
        const BLANKS: &str = "                ";
        self.push(self.line_end);
        let mut left = columns / INDENT * INDENT;
        while left > 0 {
            let some = left.min(BLANKS.len());
            self.push(&BLANKS[..some]);
            left -= some;
        }
    }

    /// Writes text without line ends.
    pub(super) fn push(&mut self, text: &str) {
        self.is_empty = false;
        if self.result.is_ok() {
            self.result = self.out.write_str(text);
        }
    }

    /// Writes text of the source; each line end in it becomes one of this text, which XML does not tell apart (XML 1.0,
    /// 2.11).
    pub(super) fn verbatim(&mut self, mut text: &str) {
        while let Some(at) = text.find(['\r', '\n']) {
            self.push(&text[..at]);
            self.push(self.line_end);
            let length = if text[at..].starts_with("\r\n") { 2 } else { 1 };
            text = &text[at + length..];
        }
        self.push(text);
    }

    /// Ends the last line, and says what came of writing all of it.
    pub(super) fn finish(mut self) -> Result {
        self.push(self.line_end);
        self.result
    }
}
