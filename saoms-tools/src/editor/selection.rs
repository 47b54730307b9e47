//! Ranges that belong together: what is selected when a selection grows, and the two tags of an element.

use std::ops::Range;

use super::scene::file::File;
use super::syntax::{Cursor, Places, bytes, is_opaque, trimmed, value_of, words};

/// The most elements around a byte that are selected one after another: an answer of the protocol nests as deeply.
const MOST_ELEMENTS: usize = 20;

/// The ranges around a byte, the smallest first: a word, a value, an attribute, a tag, what an element holds, the
/// element, and so on; the last is the whole text.
pub fn selections(file: &File, at: usize) -> Vec<Range<usize>> {
    let text = file.text.as_str();
    let opaque = file.document.token_at(at as u32).filter(|(kind, _)| is_opaque(*kind));
    let mut all: Vec<Range<usize>> = opaque.into_iter().map(|(_, span)| bytes(span)).collect();
    all.push(0..text.len());
    let around = std::iter::successors(file.document.innermost(at as u32), |element| element.parent());
    for element in around.take(MOST_ELEMENTS) {
        all.extend([element.whole(), element.tag(), bytes(element.name_span())]);
        all.extend(element.end_tag_span().map(bytes));
        if element.has_whole_start_tag() && !element.is_empty() {
            let inside = bytes(element.content_span());
            all.extend([trimmed(text, inside.clone()), inside]);
        }
        for attribute in element.written_attributes() {
            all.extend([bytes(attribute.name_span()), bytes(attribute.span())]);
            if let Some(value) = value_of(attribute) {
                all.extend(words(text, value.clone()));
                all.push(value);
            }
        }
    }
    all.retain(|range| range.start <= at && at <= range.end && !range.is_empty());
    all.sort_by_key(|range| (range.len(), range.start));
    // Each holds the one before: of two that touch at the byte the one behind it counts.
    let mut nested: Vec<Range<usize>> = Vec::new();
    for range in all {
        let is_wider = nested
            .last()
            .is_none_or(|last| range.start <= last.start && last.end <= range.end && range.len() > last.len());
        if is_wider {
            nested.push(range);
        }
    }
    nested
}

/// The name in the start tag and the name in the end tag of the element whose name a byte touches: they are typed as
/// one.
pub fn linked_tags(file: &File, at: usize) -> Option<[Range<usize>; 2]> {
    let (Cursor::ElementName { element, .. } | Cursor::EndTag { element, .. }) = file.cursor(at) else {
        return None;
    };
    let (start, end) = (element?.name_span(), element?.end_name_span()?);
    let is_one = file.text[bytes(start)] == file.text[bytes(end)];
    is_one.then(|| [bytes(start), bytes(end)])
}
