//! XML elements that are written: schemas and expanded composites.

use std::borrow::Cow;
use std::fmt::Write as _;

use saoms_api::host::escaped;

/// An element to be written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NewElement {
    name: Cow<'static, str>,
    attributes: Vec<(Cow<'static, str>, String)>,
    content: Vec<Content>,
}

#[derive(Clone, Debug, PartialEq)]
enum Content {
    Element(NewElement),
    /// As it is written in a file.
    Written(String),
}

impl NewElement {
    /// One of this name, with nothing in it.
    pub(crate) fn new(name: impl Into<Cow<'static, str>>) -> Self {
        Self { name: name.into(), attributes: Vec::new(), content: Vec::new() }
    }

    /// With an attribute.
    pub(crate) fn with(mut self, name: impl Into<Cow<'static, str>>, value: impl Into<String>) -> Self {
        self.attributes.push((name.into(), value.into()));
        self
    }

    /// With an attribute where there is a value.
    pub(crate) fn maybe(self, name: &'static str, value: Option<impl Into<String>>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// With something inside.
    pub(crate) fn child(mut self, child: NewElement) -> Self {
        self.content.push(Content::Element(child));
        self
    }

    /// With all of these inside.
    pub(crate) fn children(mut self, children: impl IntoIterator<Item = NewElement>) -> Self {
        self.content.extend(children.into_iter().map(Content::Element));
        self
    }

    /// With a text inside.
    pub(crate) fn text(mut self, text: &str) -> Self {
        // Between tags these can stand as they are, and are read best so.
        const PLAIN: [(&str, &str); 4] = [("&#10;", "\n"), ("&#9;", "\t"), ("&quot;", "\""), ("&apos;", "'")];
        let plain = PLAIN.iter().fold(escaped(text), |text, (escape, plain)| text.replace(escape, plain));
        self.content.push(Content::Written(plain));
        self
    }

    /// Declares the namespace of a prefix, unless it is declared already.
    pub(crate) fn declare(mut self, prefix: &str, namespace: &str) -> Self {
        let name = if prefix.is_empty() { "xmlns".to_owned() } else { format!("xmlns:{prefix}") };
        if !self.attributes.iter().any(|(known, _)| *known == name) {
            self.attributes.insert(0, (name.into(), namespace.to_owned()));
        }
        self
    }

    /// Declares prefixes as far outside as they mean the same.
    pub(crate) fn hoist(&mut self) {
        let Self { attributes, content, .. } = self;
        for child in content {
            let Content::Element(child) = child else { continue };
            child.hoist();
            let mut stay = Vec::with_capacity(child.attributes.len());
            for (name, value) in std::mem::take(&mut child.attributes) {
                let is_prefix = name.starts_with("xmlns:");
                match attributes.iter().find(|(known, _)| is_prefix && *known == name) {
                    Some((_, known)) if *known == value => {}
                    None if is_prefix => attributes.push((name, value)),
                    _ => stay.push((name, value)),
                }
            }
            child.attributes = stay;
        }
        // What is declared stands first, in order.
        attributes.sort_by(|(one, _), (other, _)| {
            let key = |name: &str| {
                (!name.starts_with("xmlns"), if name.starts_with("xmlns") { name.to_owned() } else { String::new() })
            };
            key(one).cmp(&key(other))
        });
    }

    /// As a text, indented.
    pub(crate) fn write(&self, depth: usize, out: &mut String) {
        let _ = write!(out, "{:1$}", "", 2 * depth);
        self.inline(depth, out);
        out.push('\n');
    }

    fn inline(&self, depth: usize, out: &mut String) {
        let _ = write!(out, "<{}", self.name);
        for (name, value) in &self.attributes {
            let _ = write!(out, " {name}=\"{}\"", escaped(value));
        }
        if self.content.is_empty() {
            return out.push_str("/>");
        }
        out.push('>');
        let is_written = self.content.iter().any(|one| matches!(one, Content::Written(_)));
        if !is_written {
            out.push('\n');
        }
        for one in &self.content {
            match one {
                Content::Written(text) => out.push_str(text),
                Content::Element(node) if is_written => node.inline(depth + 1, out),
                Content::Element(node) => node.write(depth + 1, out),
            }
        }
        if !is_written {
            let _ = write!(out, "{:1$}", "", 2 * depth);
        }
        let _ = write!(out, "</{}>", self.name);
    }
}
