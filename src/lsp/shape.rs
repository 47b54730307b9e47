//! What belongs together in a text: what can be folded, and what is selected when a selection grows.

use std::ops::Range;

use lsp_types::{FoldingRange, FoldingRangeKind};

use super::file::File;

/// Elements and comments of several lines. Of an element the line of its end tag stays; of several that begin in one line the outermost is folded.
pub(super) fn folds(file: &File) -> Vec<FoldingRange> {
    let (text, tree) = (&*file.text, &file.tree);
    let line = |byte: usize| file.lines.position(text, byte).line;
    let elements = tree.elements.iter().filter_map(|one| {
        let start = line(one.tag.start);
        let end = match &one.end_tag {
            Some(tag) => line(tag.start).saturating_sub(1),
            None => line(one.end.max(one.tag.end).saturating_sub(1)),
        };
        // A start tag alone may have several lines, too.
        let end = end.max(line(one.tag.end.saturating_sub(1)));
        (start < end).then_some((start, end, None))
    });
    let opaque = tree.opaque.iter().filter_map(|part| {
        let (start, end) = (line(part.start), line(part.end.saturating_sub(1)));
        let kind = text[part.clone()].starts_with("<!--").then_some(FoldingRangeKind::Comment);
        (start < end).then_some((start, end, kind))
    });
    let mut all: Vec<_> = elements.chain(opaque).collect();
    all.sort_by_key(|(start, end, _)| (*start, std::cmp::Reverse(*end)));
    all.dedup_by_key(|(start, ..)| *start);
    let fold =
        |(start_line, end_line, kind)| FoldingRange { start_line, end_line, kind, ..FoldingRange::default() };
    all.into_iter().map(fold).collect()
}

/// What is around a byte, the smallest first: a word, a value, an attribute, a tag, what an element holds, the element, and so on.
pub(super) fn around(file: &File, at: usize) -> Vec<Range<usize>> {
    let (text, tree) = (&*file.text, &file.tree);
    let opaque = tree.opaque.iter().filter(|part| part.start < at && at < part.end).cloned();
    let mut all: Vec<Range<usize>> = opaque.collect();
    all.push(0..text.len());
    let mut here = tree.innermost(at);
    while let Some(element) = here {
        let one = &tree.elements[element];
        let end = one.end.max(one.tag.end);
        let inside_end = one.end_tag.as_ref().map_or(end, |tag| tag.start);
        all.extend([one.tag.start..end, one.tag.clone(), one.name.clone()]);
        all.extend(one.end_tag.clone());
        if one.is_complete && !one.is_empty {
            let inside = one.tag.end..inside_end.max(one.tag.end);
            all.extend([super::syntax::trimmed(text, inside.clone()), inside]);
        }
        for attribute in &one.attributes {
            let value = attribute.value.clone();
            let end = value
                .as_ref()
                .map_or(attribute.name.end, |value| value.end + usize::from(attribute.is_closed));
            all.extend([attribute.name.clone(), attribute.name.start..end]);
            all.extend(value.into_iter().flat_map(|value| {
                super::syntax::words(text, value.clone()).chain([value]).collect::<Vec<_>>()
            }));
        }
        here = one.parent;
    }
    all.retain(|range| range.start <= at && at <= range.end && !range.is_empty());
    all.sort_by_key(|range| (range.len(), range.start));
    // Each holds the one before: of two that touch at the byte the one behind it counts.
    let mut nested: Vec<Range<usize>> = Vec::new();
    for range in all {
        let is_wider = nested.last().is_none_or(|last| {
            range.start <= last.start && last.end <= range.end && range.len() > last.len()
        });
        if is_wider {
            nested.push(range);
        }
    }
    nested
}
