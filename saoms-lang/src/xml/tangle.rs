//! End tags that do not fit.

use super::arena::Node;
use super::fault::Fault;
use super::parse::{Parser, Tangle};
use super::tree::ElementId;
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::source::Span;

/// How far back the element is looked for that an end tag could be of.
const NEAR: usize = 1000;

impl Parser<'_> {
    /// An end tag with another name than the element has that is open.
    pub(super) fn mismatch(&mut self, found: &str, start: u32, end: u32) -> Fault {
        let names = || {
            let open = self.open.iter().rev().map(|open| &self.arena.kept[open.kept]);
            open.map(|node| (self.name(node), node.start))
        };
        let (expected, at) = names().next().unwrap_or_default();
        let file = self.input.file;
        let message = format!(
            "{} found where {} is expected",
            quoted(&format!("</{found}>")),
            quoted(&format!("</{expected}>"))
        );
        let tag = Span::new(at + 1, at + 1 + expected.len() as u32).in_file(file);
        let one = self.input.fault(&codes::XML_TAG_MISMATCH, start, end, message);
        let one = one.label(tag, format!("{} is open", quoted(expected)));
        let close = format!("</{expected}>");
        let is_near = nearest(found, [expected]).is_some();
        if names().skip(1).any(|(name, _)| name == found) && !is_near {
            self.tangle = Some(Tangle::LeftOpen);
            return self.unclosed(one, start).into();
        }
        if !is_near && let Some(same) = self.closed(found) {
            let node = self.arena.get(same, self.arena.place(same));
            let name = self.name_at(node.start(), node.shape()).in_file(file);
            let (is_empty, closed) = (node.tag_end() == node.end(), node.end());
            if is_empty && !self.input.slice(closed, start).trim().is_empty() {
                self.tangle = Some(Tangle::ClosedEarly(ElementId(same)));
                let slash = Span::new(closed - 2, closed - 1).in_file(file);
                let one = one.label(name, format!("this {} ends with `/>`", quoted(found)));
                return one.suggest("remove its `/`", slash, "").into();
            }
            let one = one.label(name, format!("this {} is closed", quoted(found)));
            return one.suggest("remove it", Span::new(start, end).in_file(file), "").into();
        }
        let description = format!("replace it with {}", quoted(&close));
        one.suggest(description, Span::new(start, end).in_file(file), close).into()
    }

    /// With what closes the element that is open, before the end tag at `end` of one around it.
    fn unclosed(&self, one: Diagnostic, end: u32) -> Diagnostic {
        let Some(open) = self.open.last() else { return one };
        let node @ Node { tag_end, has_text, .. } = &self.arena.kept[open.kept];
        let (name, file) = (self.name(node), self.input.file);
        if open.element + 1 == self.arena.len() && !has_text {
            let slash = Span::empty(tag_end - 1).in_file(file);
            return one.suggest(format!("end {} with `/>`", quoted(name)), slash, "/");
        }
        let place = Span::empty(end).in_file(file);
        one.suggest(format!("close {} first", quoted(name)), place, format!("</{name}>"))
    }

    /// The last element of this name that is directly inside the one that is open, and closed.
    fn closed(&mut self, name: &str) -> Option<u32> {
        // This fault is the last of all: there come no more elements.
        self.arena.finish();
        let open = self.open.last()?;
        let mut inside = (0..self.arena.len()).rev().take(NEAR);
        inside.find(|element| {
            let node = self.arena.get(*element, self.arena.place(*element));
            let found = self.name_at(node.start(), node.shape());
            node.parent() == open.element && self.input.slice(found.start, found.end) == name
        })
    }
}
