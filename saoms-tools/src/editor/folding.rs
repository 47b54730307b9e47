//! Parts of a text that an editor can fold.

use super::scene::file::File;

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

/// Elements and comments of several lines. The line of an end tag stays; of several that begin in one line the outermost is folded.
pub fn folds(file: &File) -> Vec<Fold> {
    let (text, tree) = (&*file.text, &file.tree);
    let line = |byte: usize| file.lines.line(byte);
    let elements = tree.elements.iter().filter_map(|one| {
        let start = line(one.tag.start);
        let end = match &one.end_tag {
            Some(tag) => line(tag.start).saturating_sub(1),
            None => line(one.end.max(one.tag.end).saturating_sub(1)),
        };
        // A start tag alone may have several lines, too.
        let end = end.max(line(one.tag.end.saturating_sub(1)));
        (start < end).then_some(Fold { start, end, is_comment: false })
    });
    let opaque = tree.opaque.iter().filter_map(|part| {
        let (start, end) = (line(part.start), line(part.end.saturating_sub(1)));
        let is_comment = text[part.clone()].starts_with("<!--");
        (start < end).then_some(Fold { start, end, is_comment })
    });
    let mut all: Vec<Fold> = elements.chain(opaque).collect();
    all.sort_by_key(|fold| (fold.start, std::cmp::Reverse(fold.end)));
    all.dedup_by_key(|fold| fold.start);
    all
}
