//! Parts of a text that an editor can fold.

use saoms_lang::syntax::TokenKind;

use super::scene::file::File;
use super::syntax::is_opaque;

/// Lines that can be folded into the first of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// The first line, from 0.
    pub start: usize,
    /// The last line.
    pub end: usize,
    /// True for a comment.
    pub is_comment: bool,
}

/// Elements and comments of several lines. The line of an end tag stays; of several that begin in one line the
/// outermost is folded.
pub fn folds(file: &File) -> Vec<Fold> {
    let line = |byte: u32| file.lines.line(byte as usize) - 1;
    let elements = file.document.elements().filter_map(|one| {
        let (whole, tag) = (one.span(), one.start_tag_span());
        let start = line(tag.start);
        let end = match one.end_tag_span() {
            Some(tag) => line(tag.start).saturating_sub(1),
            None => line(whole.end.saturating_sub(1)),
        };
        // A start tag alone may have several lines, too.
        let end = end.max(line(tag.end.saturating_sub(1)));
        (start < end).then_some(Fold { start, end, is_comment: false })
    });
    let opaque = file.document.tokens().filter(|(kind, _)| is_opaque(*kind)).filter_map(|(kind, span)| {
        let (start, end) = (line(span.start), line(span.end.saturating_sub(1)));
        (start < end).then_some(Fold { start, end, is_comment: kind == TokenKind::Comment })
    });
    let mut all: Vec<Fold> = elements.chain(opaque).collect();
    all.sort_by_key(|fold| (fold.start, std::cmp::Reverse(fold.end)));
    all.dedup_by_key(|fold| fold.start);
    all
}
