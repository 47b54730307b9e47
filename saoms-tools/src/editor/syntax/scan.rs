//! From text to a tree.

use super::{Element, Tree, local, tag};

/// Which elements hold those that are part of SCA or SAOMS; used where tags do not match.
const HOLDERS: &[(&str, &[&str])] = &[
    ("component", &["composite"]),
    ("include", &["composite"]),
    ("wire", &["composite"]),
    ("property", &["component", "composite", "loop"]),
    ("service", &["component", "composite"]),
    ("reference", &["component", "composite"]),
    ("loop", &["component"]),
    ("implementation.", &["component"]),
    ("interface.", &["service", "reference"]),
    ("binding.", &["service", "reference", "callback"]),
    ("callback", &["service", "reference"]),
];

/// Reads a text. Where its tags do not match, elements end where the vocabulary says that they must have.
pub(crate) fn scan(text: &str) -> Tree {
    let (tree, matches) = Scanner::new(text, false).run();
    if matches { tree } else { Scanner::new(text, true).run().0 }
}

struct Scanner<'t> {
    text: &'t str,
    tree: Tree,
    open: Vec<usize>,
    recovers: bool,
    /// Whether each tag has its counterpart.
    matches: bool,
}

impl<'t> Scanner<'t> {
    fn new(text: &'t str, recovers: bool) -> Self {
        Self { text, tree: Tree::default(), open: Vec::new(), recovers, matches: true }
    }

    fn run(mut self) -> (Tree, bool) {
        let mut at = 0;
        while let Some(found) = self.text[at..].find('<') {
            let start = at + found;
            let rest = &self.text[start..];
            at = if let Some(end) = opaque(rest) {
                self.tree.opaque.push(start..start + end);
                start + end
            } else if rest.starts_with("</") {
                self.end_tag(start)
            } else {
                self.start_tag(start)
            };
        }
        let end = self.text.len();
        self.matches &= self.open.is_empty();
        self.close_to(0, end);
        (self.tree, self.matches)
    }

    fn start_tag(&mut self, start: usize) -> usize {
        let tag = tag::read(self.text, start);
        let name = local(&self.text[tag.name.clone()]);
        if self.recovers
            && let Some(holders) = holders(name)
        {
            let elements = &self.tree.elements;
            let holds = |&one: &usize| holders.contains(&local(&self.text[elements[one].name.clone()]));
            if let Some(depth) = self.open.iter().rposition(holds) {
                self.close_to(depth + 1, start);
            }
        }
        self.matches &= tag.is_complete;
        // Most elements that are being typed stand alone; those that hold others show it by what follows.
        let stays_open = match tag.is_complete {
            true => !tag.is_empty,
            false => HOLDERS.iter().any(|(_, holders)| holders.contains(&name)),
        };
        let place = self.tree.elements.len();
        self.tree.elements.push(Element {
            name: tag.name,
            tag: start..tag.end,
            is_complete: tag.is_complete,
            is_empty: tag.is_empty,
            end: tag.end,
            end_tag: None,
            parent: self.open.last().copied(),
            attributes: tag.attributes,
        });
        if stays_open {
            self.open.push(place);
        }
        tag.end.max(start + 1)
    }

    fn end_tag(&mut self, start: usize) -> usize {
        let bytes = self.text.as_bytes();
        let name = tag::name(bytes, start + 2);
        let behind = bytes[name.end..].iter().position(|byte| b"<>".contains(byte));
        let end = match behind.map(|at| name.end + at) {
            Some(at) if bytes[at] == b'>' => at + 1,
            _ => name.end,
        };
        let wanted = &self.text[name];
        let is_meant = |&one: &usize| &self.text[self.tree.elements[one].name.clone()] == wanted;
        let Some(depth) = self.open.iter().rposition(is_meant) else {
            self.matches = false;
            return end;
        };
        self.matches &= depth + 1 == self.open.len();
        self.close_to(depth + 1, start);
        if let Some(one) = self.open.pop() {
            self.tree.elements[one].end_tag = Some(start..end);
            self.tree.elements[one].end = end;
        }
        end
    }

    /// Ends all elements but so many outer ones.
    fn close_to(&mut self, depth: usize, at: usize) {
        for one in self.open.drain(depth..) {
            self.tree.elements[one].end = at;
        }
    }
}

/// The elements that can hold one of this name.
fn holders(name: &str) -> Option<&'static [&'static str]> {
    let is_meant = |known: &str| name == known || (known.ends_with('.') && name.starts_with(known));
    HOLDERS.iter().find(|(known, _)| is_meant(known)).map(|(_, holders)| *holders)
}

/// The length of a comment, a CDATA section, an instruction or a declaration.
fn opaque(rest: &str) -> Option<usize> {
    const KINDS: [(&str, &str); 4] = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">")];
    let (open, close) = KINDS.into_iter().find(|(open, _)| rest.starts_with(open))?;
    Some(rest[open.len()..].find(close).map_or(rest.len(), |at| open.len() + at + close.len()))
}
