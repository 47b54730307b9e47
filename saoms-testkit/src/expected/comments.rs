//! Expectations in the comments of a composite.

use std::ops::Range;

/// Start of an expectation.
const OPEN: &str = "<!--~";
const CLOSE: &str = "-->";

/// The expectation of a comment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Expectation {
    /// Line of the diagnostic, from 1.
    pub(super) line: u32,
    /// `error` or `warning`; `None` for any.
    pub(super) severity: Option<String>,
    /// Code of the diagnostic; empty if the comment has none, which no diagnostic matches.
    pub(super) code: String,
    /// Part of its message.
    pub(super) text: String,
}

/// An expectation and the place of its comment.
#[derive(Clone, Debug)]
pub(super) struct Comment {
    pub(super) at: Range<usize>,
    pub(super) expectation: Expectation,
}

/// The expectations of a text, which need not be XML.
pub(super) fn comments(text: &str) -> Vec<Comment> {
    let mut found = Vec::new();
    let (mut at, mut line) = (0, 1);
    while let Some(start) = text[at..].find(OPEN).map(|start| at + start) {
        line += lines(&text[at..start]);
        let inside = start + OPEN.len();
        let Some(length) = text[inside..].find(CLOSE) else { break };
        let end = inside + length + CLOSE.len();
        let expectation = expectation(&text[inside..inside + length], line);
        found.push(Comment { at: start..end, expectation });
        line += lines(&text[start..end]);
        at = end;
    }
    found
}

pub(super) fn lines(text: &str) -> u32 {
    text.bytes().filter(|byte| *byte == b'\n').count() as u32
}

/// Parses the text between `<!--~` and `-->` of a comment that begins in this line.
fn expectation(inside: &str, line: u32) -> Expectation {
    let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    // One line, if no number is given.
    let moved = |text: &str| text[..digits(text)].parse().unwrap_or(1);
    let (line, rest) = match inside.as_bytes().first() {
        Some(b'^') => (line.saturating_sub(moved(&inside[1..])), &inside[1 + digits(&inside[1..])..]),
        Some(b'v') => (line.saturating_add(moved(&inside[1..])), &inside[1 + digits(&inside[1..])..]),
        _ => (line, inside),
    };
    let mut words = rest.split_whitespace().peekable();
    let severity = words.next_if(|word| matches!(*word, "error" | "warning")).map(str::to_owned);
    let code = words.next().unwrap_or_default().to_owned();
    Expectation { line, severity, code, text: words.collect::<Vec<_>>().join(" ") }
}

/// A message in the form that is compared: its words, as far as a comment can contain them.
pub(super) fn plain(message: &str) -> String {
    let words = message.split_whitespace().collect::<Vec<_>>().join(" ");
    let end = words.find("--").unwrap_or(words.len());
    words[..end].trim_end().to_owned()
}
