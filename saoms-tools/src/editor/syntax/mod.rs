//! Composites as they are while somebody types: elements and attributes of any text, however broken.
//!
//! The loader reads well-formed XML and says what is wrong with the rest; an editor has to know what is meant before that. What is read here is
//! never wrong, only incomplete: quotes and tags that are not closed end where the next one begins, end tags that are missing are
//! supplied where the vocabulary asks for them.

mod cursor;
mod namespaces;
mod scan;
mod tag;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub(crate) use cursor::Cursor;
pub(crate) use namespaces::prefix;
pub(crate) use scan::scan;

/// The elements of a text in document order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    pub(crate) elements: Vec<Element>,
    /// Comments, instructions and CDATA sections, in order: nothing is completed in them.
    pub(crate) opaque: Vec<Range<usize>>,
}

/// An element.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    /// Its name as written; empty while it has none.
    pub(crate) name: Range<usize>,
    /// From the `<` to behind the `>` of the start tag, or to where it breaks off.
    pub(crate) tag: Range<usize>,
    /// Whether the start tag has its `>`.
    pub(crate) is_complete: bool,
    /// Whether the start tag ends with `/>`.
    pub(crate) is_empty: bool,
    /// Behind the end tag, or where the element ends without one.
    pub(crate) end: usize,
    /// The end tag with its `</`.
    pub(crate) end_tag: Option<Range<usize>>,
    pub(crate) parent: Option<usize>,
    pub(crate) attributes: Vec<Attribute>,
}

/// An attribute.
#[derive(Clone, Debug)]
pub(crate) struct Attribute {
    pub(crate) name: Range<usize>,
    /// The value without its quotes; `None` while there is no `=`.
    pub(crate) value: Option<Range<usize>>,
    /// Whether the value has both quotes.
    pub(crate) is_closed: bool,
}

impl Tree {
    /// The innermost element that a byte is in, its tags included.
    pub(crate) fn innermost(&self, at: usize) -> Option<usize> {
        let started = self.elements.partition_point(|element| element.tag.start < at);
        let mut here = started.checked_sub(1);
        while let Some(index) = here
            && at >= self.elements[index].end.max(self.elements[index].tag.end)
        {
            let one = &self.elements[index];
            // Right behind what is not closed yet is still in it.
            let is_open = if one.is_complete { !one.is_empty && one.end_tag.is_none() } else { true };
            if is_open && at == one.end.max(one.tag.end) {
                break;
            }
            here = one.parent;
        }
        here
    }

    /// The elements directly in one, in order.
    pub(crate) fn children(&self, parent: usize) -> impl Iterator<Item = usize> {
        let end = self.elements[parent].end;
        let inside =
            (parent + 1..self.elements.len()).take_while(move |&at| self.elements[at].tag.start < end);
        inside.filter(move |&at| self.elements[at].parent == Some(parent))
    }

    /// The name of an element without its prefix.
    pub(crate) fn local<'t>(&self, text: &'t str, element: usize) -> &'t str {
        local(&text[self.elements[element].name.clone()])
    }

    /// The attribute of this name.
    pub(crate) fn attribute(&self, text: &str, element: usize, name: &str) -> Option<&Attribute> {
        self.elements[element].attributes.iter().find(|one| &text[one.name.clone()] == name)
    }

    /// The value of an attribute, white space at its ends left out.
    pub(crate) fn value(&self, text: &str, element: usize, name: &str) -> Option<Range<usize>> {
        Some(trimmed(text, self.attribute(text, element, name)?.value.clone()?))
    }

    /// The text directly inside an element that holds no others, white space at its ends left out.
    pub(crate) fn text(&self, text: &str, element: usize) -> Option<Range<usize>> {
        let one = &self.elements[element];
        if one.is_empty || !one.is_complete || self.children(element).next().is_some() {
            return None;
        }
        let end = one.end_tag.as_ref().map_or(one.end, |tag| tag.start);
        let inside = trimmed(text, one.tag.end..end.max(one.tag.end));
        let is_plain = !self.opaque.iter().any(|part| part.start < inside.end && inside.start < part.end);
        (!inside.is_empty() && is_plain).then_some(inside)
    }
}

/// A name without its prefix.
pub(crate) fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// A range without the white space at its ends.
pub(crate) fn trimmed(text: &str, range: Range<usize>) -> Range<usize> {
    let part = &text[range.clone()];
    let start = range.start + part.len() - part.trim_start().len();
    start..start + part.trim().len()
}

/// The words of a range, each with its place.
pub(crate) fn words(text: &str, range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let part = &text[range.clone()];
    part.split_whitespace().map(move |word| {
        let start = range.start + (word.as_ptr() as usize - part.as_ptr() as usize);
        start..start + word.len()
    })
}
