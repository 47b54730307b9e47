//! Fleets out of bytes: the elements and attributes of the vocabulary, the classes and properties of the registry, and
//! values that fit them, put together as the bytes decide. Most of it is right, so that what is wrong, or odd, is met
//! by all rules.

mod choices;
mod component;
mod expression;
mod values;

use std::fmt::Write as _;

use saoms_lang::load::vocabulary::{
    COMPONENT, COMPOSITE, COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, Kind, SEVERITY, WIRE, children,
    own_attributes,
};
use saoms_lang::model::Version;
use saoms_lang::registry::Registry;

use choices::Choices;
use component::{COMPONENTS, component};

/// The files of a fleet, each a path and a text; the first is the composite that is asked for.
pub(crate) fn fleet(bytes: &[u8], registry: &Registry) -> Vec<(String, String)> {
    let mut choices = Choices::new(bytes);
    let mut files = vec![(
        "fleet.composite".to_owned(),
        Writer::new(&mut choices, registry, Version::Oasis200912).composite("fleet", "urn:t"),
    )];
    for (path, name) in [("a.composite", "a"), ("parts/b.composite", "b")] {
        if !choices.once_in(3) {
            let version = if choices.once_in(4) { Version::Osoa10 } else { Version::Oasis200912 };
            let namespace = if choices.once_in(4) { "urn:o" } else { "urn:t" };
            let text = Writer::new(&mut choices, registry, version).composite(name, namespace);
            files.push((path.to_owned(), text));
        }
    }
    files.push(("table.csv".to_owned(), values::table(&mut choices)));
    files.push(("value.txt".to_owned(), values::text(&mut choices).to_owned()));
    if choices.once_in(4) {
        let text = Writer::new(&mut choices, registry, Version::Oasis200912).component_type();
        files.push(("robot/Robot001.componentType".to_owned(), text));
    }
    if choices.once_in(4) {
        let inside = choices.of(&["<import namespace=\"urn:o\"/>", "<export namespace=\"urn:t\"/><import/>", "<", ""]);
        let text = format!("<contribution xmlns=\"{}\">{inside}</contribution>", Version::Oasis200912.namespace());
        files.push(("sca-contribution.xml".to_owned(), text));
    }
    files
}

/// Writes the elements of one file.
struct Writer<'c, 'b> {
    choices: &'c mut Choices<'b>,
    registry: &'c Registry,
    version: Version,
    /// True if texts can hold expressions.
    is_replicated: bool,
    text: String,
}

impl<'c, 'b> Writer<'c, 'b> {
    fn new(choices: &'c mut Choices<'b>, registry: &'c Registry, version: Version) -> Self {
        Self { choices, registry, version, is_replicated: false, text: String::new() }
    }

    fn composite(mut self, name: &str, namespace: &str) -> String {
        let _ = write!(
            self.text,
            "<composite xmlns=\"{}\" xmlns:s=\"urn:saoms:1\" xmlns:t=\"urn:t\" xmlns:o=\"urn:o\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\" name=\"{name}\" targetNamespace=\"{namespace}\"",
            self.version.namespace()
        );
        if self.choices.once_in(4) {
            self.attributes(&COMPOSITE, &["name", "targetNamespace"]);
        }
        self.text.push_str(">\n");
        for _ in 0..self.choices.below(3) {
            self.element(&COMPOSITE_PROPERTY);
        }
        for place in 0..=self.choices.below(COMPONENTS.len()) {
            component(&mut self, place);
        }
        for _ in 0..self.choices.below(4) {
            match self.choices.below(6) {
                0 => self.element(&WIRE),
                1 => self.element(&COMPOSITE_SERVICE),
                2 => self.element(&COMPOSITE_REFERENCE),
                3 => self.element(&SEVERITY),
                _ => self.child(&COMPOSITE),
            }
        }
        self.text.push_str("</composite>\n");
        self.text
    }

    fn component_type(mut self) -> String {
        let _ = write!(self.text, "<componentType xmlns=\"{}\">", self.version.namespace());
        for _ in 0..self.choices.below(4) {
            self.child(&COMPONENT);
        }
        self.text.push_str("</componentType>\n");
        self.text
    }

    /// An element that can stand in another one, or an unknown one.
    fn child(&mut self, parent: &'static Kind) {
        let all: Vec<&str> = children(parent).collect();
        let name = if all.is_empty() || self.choices.once_in(32) { "bogus" } else { self.choices.of(&all) };
        match parent.child(name) {
            Some(kind) => self.element(kind),
            None => _ = writeln!(self.text, "<{name} name=\"x\"/>"),
        }
    }

    fn element(&mut self, kind: &'static Kind) {
        let prefix = if std::ptr::eq(kind, &SEVERITY) || kind.name == "loop" { "s:" } else { "" };
        let _ = write!(self.text, "<{prefix}{}", kind.name);
        self.attributes(kind, &[]);
        let has_text = kind.name == "property" && !self.text.ends_with(&['>', '='][..]) && self.choices.below(3) > 0;
        self.text.push('>');
        if has_text {
            let value = values::text(self.choices);
            self.put(value);
        }
        if self.choices.once_in(8) {
            self.child(kind);
        }
        let _ = writeln!(self.text, "</{prefix}{}>", kind.name);
    }

    /// The attributes of an element but for those that it has.
    fn attributes(&mut self, kind: &'static Kind, but: &[&str]) {
        for known in kind.of(self.version).filter(|known| !but.contains(&known.name)) {
            let is_there = if known.required { !self.choices.once_in(24) } else { self.choices.once_in(6) };
            if is_there {
                self.attribute(known.name, known.holds);
            }
        }
        for known in own_attributes(kind).filter(|known| !but.contains(&known.name)) {
            if self.choices.once_in(6) {
                self.attribute(&format!("s:{}", known.name), known.holds);
            }
        }
        if self.choices.once_in(48) {
            self.text.push_str(" bogus=\"\"");
        }
    }

    fn attribute(&mut self, name: &str, holds: saoms_lang::load::vocabulary::Holds) {
        let value = values::held(self.choices, holds, self.registry);
        let _ = write!(self.text, " {name}=\"");
        self.put(&value);
        self.text.push('"');
    }

    /// A text with what XML needs escaped.
    fn put(&mut self, text: &str) {
        for character in text.chars() {
            match character {
                '&' => self.text.push_str("&amp;"),
                '<' => self.text.push_str("&lt;"),
                '"' => self.text.push_str("&quot;"),
                _ => self.text.push(character),
            }
        }
    }
}
