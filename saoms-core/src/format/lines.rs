//! The lines that are written.

/// Columns of each level; all columns are a multiple of it.
const INDENT: usize = 2;

/// Elements that are deeper than this are indented no further, so that the output grows with the input alone.
const DEEPEST: usize = 40;

/// Text that is being written; its lines end as the first line of the source does.
pub(super) struct Lines {
    out: String,
    line_end: &'static str,
    /// Length of the mark at the start.
    mark: usize,
}

impl Lines {
    /// Nothing but `mark` yet.
    pub(super) fn new(source: &str, mark: &str) -> Self {
        let first = source.find(['\r', '\n']).map_or("", |at| &source[at..]);
        let line_end = if first.starts_with("\r\n") { "\r\n" } else { "\n" };
        let mut out = String::with_capacity(source.len() + source.len() / 8 + 16);
        out.push_str(mark);
        Self { out, line_end, mark: mark.len() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.out.len() == self.mark
    }

    /// The columns that a level takes.
    pub(super) fn columns(depth: usize) -> usize {
        depth.min(DEEPEST) * INDENT
    }

    /// Starts a line, after a blank one if asked.
    pub(super) fn next(&mut self, depth: usize, blank: bool) {
        if blank {
            self.out.push_str(self.line_end);
        }
        self.next_at(Self::columns(depth));
    }

    /// Starts a line with so many blanks.
    pub(super) fn next_at(&mut self, columns: usize) {
        self.out.push_str(self.line_end);
        for _ in 0..columns / INDENT {
            self.out.push_str("  ");
        }
    }

    /// Writes text without line ends.
    pub(super) fn push(&mut self, text: &str) {
        self.out.push_str(text);
    }

    /// Writes text of the source; each line end in it becomes one of this text, which XML does not tell apart (XML 1.0, 2.11).
    pub(super) fn verbatim(&mut self, mut text: &str) {
        while let Some(at) = text.find(['\r', '\n']) {
            self.out.push_str(&text[..at]);
            self.out.push_str(self.line_end);
            let length = if text[at..].starts_with("\r\n") { 2 } else { 1 };
            text = &text[at + length..];
        }
        self.out.push_str(text);
    }

    /// Ends the last line.
    pub(super) fn finish(mut self) -> String {
        self.out.push_str(self.line_end);
        self.out
    }
}
