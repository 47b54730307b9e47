//! Elements that are put together and written.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::{Element, XML_NAMESPACE, escaped};

/// An element to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    name: Cow<'static, str>,
    attributes: Vec<(Cow<'static, str>, String)>,
    content: Vec<Content>,
}

#[derive(Clone, Debug, PartialEq)]
enum Content {
    Node(Node),
    /// As it is written in a file.
    Written(String),
}

impl Node {
    /// One of this name, with nothing in it.
    pub fn new(name: impl Into<Cow<'static, str>>) -> Self {
        Self { name: name.into(), attributes: Vec::new(), content: Vec::new() }
    }

    /// With an attribute.
    pub fn with(mut self, name: impl Into<Cow<'static, str>>, value: impl Into<String>) -> Self {
        self.attributes.push((name.into(), value.into()));
        self
    }

    /// With an attribute where there is a value.
    pub fn maybe(self, name: &'static str, value: Option<impl Into<String>>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// With an attribute directly behind another one.
    pub fn behind(mut self, other: &str, (name, value): (&'static str, &str)) -> Self {
        let place = self.attributes.iter().position(|(known, _)| known == other);
        let place = place.map_or(self.attributes.len(), |place| place + 1);
        self.attributes.insert(place, (name.into(), value.to_owned()));
        self
    }

    /// With something inside.
    pub fn child(mut self, child: Node) -> Self {
        self.content.push(Content::Node(child));
        self
    }

    /// With all of these inside.
    pub fn children(mut self, children: impl IntoIterator<Item = Node>) -> Self {
        self.content.extend(children.into_iter().map(Content::Node));
        self
    }

    /// With these before all that is inside.
    pub fn first(mut self, children: Vec<Node>) -> Self {
        self.content.splice(0..0, children.into_iter().map(Content::Node));
        self
    }

    /// With a text inside.
    pub fn text(mut self, text: &str) -> Self {
        // Between tags these can stand as they are, and are read best so.
        const PLAIN: [(&str, &str); 4] = [("&#10;", "\n"), ("&#9;", "\t"), ("&quot;", "\""), ("&apos;", "'")];
        let plain = PLAIN.iter().fold(escaped(text), |text, (escape, plain)| text.replace(escape, plain));
        self.content.push(Content::Written(plain));
        self
    }

    /// With the namespace that a prefix stands for, unless it says that already.
    pub fn declare(mut self, prefix: &str, namespace: &str) -> Self {
        let name = if prefix.is_empty() { "xmlns".to_owned() } else { format!("xmlns:{prefix}") };
        if !self.attributes.iter().any(|(known, _)| *known == name) {
            self.attributes.insert(0, (name.into(), namespace.to_owned()));
        }
        self
    }

    /// An element as it is written in a file, with all prefixes declared that are used in it. What `is_around` is true of is a namespace
    /// that is the default one where it is written. `text` changes what is written.
    pub fn copied(
        element: Element<'_>,
        is_around: impl Fn(&str) -> bool,
        text: impl Fn(&str) -> Option<String>,
    ) -> Self {
        let whole = element.document().text();
        let content = element.content_span();
        let content = &whole[content.start as usize..content.end as usize];
        let mut node = Self::start(element, is_around, &text);
        if !content.trim().is_empty() {
            node.content.push(Content::Written(text(content).unwrap_or_else(|| content.to_owned())));
        }
        node
    }

    /// The start of an element as it is written in a file; with the namespaces of all that is used in it.
    fn start(
        element: Element<'_>,
        is_around: impl Fn(&str) -> bool,
        text: &impl Fn(&str) -> Option<String>,
    ) -> Self {
        let outer = element.resolve_prefix("").unwrap_or_default();
        let needs_outer = needs_default(element);
        let own = element.namespace();
        let name = || element.name().to_owned();
        let mut node = match element.prefix() {
            _ if is_around(own) && (!needs_outer || is_around(&outer)) => {
                Self::new(element.local_name().to_owned())
            }
            Some(_) if needs_outer && !is_around(&outer) => Self::new(name()).with("xmlns", outer),
            Some(_) => Self::new(name()),
            None => Self::new(name()).with("xmlns", own),
        };
        for attribute in element.attributes() {
            node = node.with(attribute.name().to_owned(), rendered(attribute.value(), text));
        }
        let is_prefixed = node.name.contains(':');
        node.with_prefixes_of(element, is_prefixed)
    }

    /// An element that starts as one of a file does, with the attributes that stay, by name and namespace; with nothing inside.
    pub fn started(
        element: Element<'_>,
        stays: impl Fn(&str, &str) -> bool,
        text: impl Fn(&str) -> Option<String>,
    ) -> Self {
        let mut node = Self::new(element.local_name().to_owned());
        let mut prefixes: Vec<String> = Vec::new();
        for attribute in element.attributes().filter(|one| stays(one.name(), one.namespace())) {
            prefixes.extend(attribute.prefix().map(str::to_owned));
            let value = rendered(attribute.value(), &text);
            prefixes.extend(prefixes_in(&value).map(str::to_owned));
            node = node.with(attribute.name().to_owned(), value);
        }
        node.with_prefixes(element, prefixes)
    }

    /// With the declarations of the prefixes in a text of an element.
    pub fn with_prefixes_in(self, element: Element<'_>, text: &str) -> Self {
        let prefixes = prefixes_in(text).map(str::to_owned).collect();
        self.with_prefixes(element, prefixes)
    }

    /// With the declarations of the prefixes that are used in an element, its own where it is written with it.
    fn with_prefixes_of(self, element: Element<'_>, is_prefixed: bool) -> Self {
        let mut prefixes: Vec<String> = Vec::new();
        for (place, one) in element.descendants().enumerate() {
            prefixes.extend(one.prefix().filter(|_| is_prefixed || place > 0).map(str::to_owned));
            for attribute in one.attributes() {
                prefixes.extend(attribute.prefix().map(str::to_owned));
                prefixes.extend(prefixes_in(&attribute.value()).map(str::to_owned));
            }
            if one.has_text() {
                prefixes.extend(prefixes_in(&one.text()).map(str::to_owned));
            }
        }
        self.with_prefixes(element, prefixes)
    }

    fn with_prefixes(mut self, element: Element<'_>, mut prefixes: Vec<String>) -> Self {
        prefixes.sort_unstable();
        prefixes.dedup();
        for prefix in prefixes {
            if let Some(namespace) = element.resolve_prefix(&prefix).filter(|one| *one != XML_NAMESPACE) {
                self = self.declare(&prefix, &namespace);
            }
        }
        self
    }

    /// An attribute, as it is written so far.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Gives an attribute a value, in the place that it has.
    pub fn set(&mut self, name: &'static str, value: impl Into<String>) {
        match self.attributes.iter_mut().find(|(known, _)| known == name) {
            Some((_, known)) => *known = value.into(),
            None => self.attributes.push((name.into(), value.into())),
        }
    }

    /// Adds a QName to an attribute that is a list of them; under another prefix where its own means something else here.
    pub fn add_name(&mut self, name: &'static str, (prefix, namespace): (&str, &str), local: &str) {
        let mut word = local.to_owned();
        if !prefix.is_empty() && !namespace.is_empty() {
            let bound = |prefix: &str| self.attribute(&format!("xmlns:{prefix}"));
            let mut free = prefix.to_owned();
            while bound(&free).is_some_and(|known| known != namespace) {
                free.push('_');
            }
            word = format!("{free}:{local}");
            *self = std::mem::replace(self, Self::new("")).declare(&free, namespace);
        } else if !prefix.is_empty() {
            word = format!("{prefix}:{local}");
        }
        let value = match self.attribute(name) {
            Some(known) if !known.is_empty() => format!("{known} {word}"),
            _ => word,
        };
        self.set(name, value);
    }

    /// Whether it has other attributes than one.
    pub fn has_more_than(&self, name: &str) -> bool {
        self.attributes.iter().any(|(known, _)| known != name)
    }

    /// Whether an element inside that is no `binding.sca` has a `uri`.
    pub fn has_address(&self) -> bool {
        let mut inside = self.nodes();
        inside.any(|one| {
            one.name.contains("binding.") && one.name != "binding.sca" && one.attribute("uri").is_some()
        })
    }

    /// Takes the `uri` of all elements of a name away that are directly inside.
    pub fn take_addresses_of(&mut self, name: &str) -> Vec<String> {
        let mut all = Vec::new();
        for one in &mut self.content {
            if let Content::Node(node) = one
                && node.name == name
                && let Some(place) = node.attributes.iter().position(|(known, _)| known == "uri")
            {
                all.push(node.attributes.remove(place).1);
            }
        }
        all
    }

    /// Takes all away that is inside.
    pub fn clear(&mut self) {
        self.content.clear();
    }

    fn nodes(&self) -> impl Iterator<Item = &Self> {
        self.content.iter().filter_map(|one| match one {
            Content::Node(node) => Some(node),
            Content::Written(_) => None,
        })
    }

    /// Declares prefixes as far outside as they mean the same.
    pub fn hoist(&mut self) {
        let Self { attributes, content, .. } = self;
        for child in content {
            let Content::Node(child) = child else { continue };
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
                (
                    !name.starts_with("xmlns"),
                    if name.starts_with("xmlns") { name.to_owned() } else { String::new() },
                )
            };
            key(one).cmp(&key(other))
        });
    }

    /// As a text, indented.
    pub fn write(&self, depth: usize, out: &mut String) {
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
                Content::Node(node) if is_written => node.inline(depth + 1, out),
                Content::Node(node) => node.write(depth + 1, out),
            }
        }
        if !is_written {
            let _ = write!(out, "{:1$}", "", 2 * depth);
        }
        let _ = write!(out, "</{}>", self.name);
    }
}

/// Whether something inside has no prefix, and the default namespace of what is around it.
fn needs_default(element: Element<'_>) -> bool {
    let mut covered = 0;
    element.descendants().skip(1).any(|one| {
        if one.span().start < covered {
            return false;
        }
        if one.namespace_declarations().any(|declared| declared.name() == "xmlns") {
            covered = one.span().end;
            return false;
        }
        one.prefix().is_none()
    })
}

fn rendered(value: Cow<'_, str>, text: &impl Fn(&str) -> Option<String>) -> String {
    text(&value).unwrap_or_else(|| value.into_owned())
}

/// What could be prefixes of QNames in a text.
fn prefixes_in(text: &str) -> impl Iterator<Item = &str> {
    let is_name = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.');
    let before =
        text.match_indices(':').map(move |(at, _)| text[..at].rsplit(|letter| !is_name(letter)).next());
    before.flatten().filter(|prefix| !prefix.is_empty())
}
