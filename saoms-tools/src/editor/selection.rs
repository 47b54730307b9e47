//! Ranges that belong together: what is selected when a selection grows, and the two tags of an element.

use std::ops::Range;

use super::scene::file::File;
use super::syntax::{Cursor, trimmed, words};

/// The ranges around a byte, the smallest first: a word, a value, an attribute, a tag, what an element holds, the element, and so on.
pub fn selections(file: &File, at: usize) -> Vec<Range<usize>> {
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
            all.extend([trimmed(text, inside.clone()), inside]);
        }
        for attribute in &one.attributes {
            let value = attribute.value.clone();
            let end = value
                .as_ref()
                .map_or(attribute.name.end, |value| value.end + usize::from(attribute.is_closed));
            all.extend([attribute.name.clone(), attribute.name.start..end]);
            all.extend(
                value
                    .into_iter()
                    .flat_map(|value| words(text, value.clone()).chain([value]).collect::<Vec<_>>()),
            );
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

/// The name in the start tag and the name in the end tag of the element whose name a byte touches: they are typed as one.
pub fn linked_tags(file: &File, at: usize) -> Option<[Range<usize>; 2]> {
    let element = match file.tree.cursor(&file.text, at) {
        Cursor::ElementName { element, .. } | Cursor::EndTag { element: Some(element), .. } => element,
        _ => return None,
    };
    let one = &file.tree.elements[element];
    let tag = one.end_tag.as_ref()?;
    Some([one.name.clone(), tag.start + 2..tag.start + 2 + one.name.len()])
}
