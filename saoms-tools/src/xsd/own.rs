//! The additions of SAOMS to SCA, and the names and types that all schemas share.

use std::collections::BTreeMap;

use super::node::{Documented, NewElement};
use super::root;
use super::sca::{attributes as declared, holding, name_of};
use super::words::{Names, Words};
use saoms_lang::diagnostic::{Severity, SeverityLevel};
use saoms_lang::load::vocabulary::{
    Holds, IMPLEMENTATION_RUST, INTERFACE_RUST, Kind, Known, LOOP, OWN_ATTRIBUTES, SEVERITY, children,
};
use saoms_lang::model::{Multiplicity, SAOMS_NAMESPACE, Version};

const DOC: &str =
    "What SAOMS adds to SCA, and the names that its classes and plugins bring. Written by `saoms schema`.";

/// Values of attributes that are not written. With these as defaults every component has what tells it from others of
/// its name, so that `xs:unique` holds for those without a condition, too. They stand on the declarations: libxml2 does
/// not know defaults of references to these.
pub(super) const DEFAULTS: [(&str, &str); 2] = [("if", "true"), ("from", "1")];

pub(super) fn schema(words: &Words) -> NewElement {
    let own = [&LOOP, &SEVERITY, &IMPLEMENTATION_RUST, &INTERFACE_RUST];
    // Several elements can have an attribute.
    let attributes: BTreeMap<&str, &Known> = OWN_ATTRIBUTES.iter().map(|(_, known)| (known.name, known)).collect();
    let attributes = attributes.into_values().map(|known| {
        let node = NewElement::new("xs:attribute").with("name", known.name).with("type", type_of(known.holds, false));
        let default = DEFAULTS.iter().find(|(name, _)| *name == known.name);
        let node = default.into_iter().fold(node, |node, (_, value)| node.with("default", *value));
        node.doc(known.doc)
    });
    root(SAOMS_NAMESPACE, DOC)
        .children(own.map(|kind| {
            NewElement::new("xs:element")
                .with("name", kind.name)
                .with("type", format!("saoms:{}", name_of(kind)))
                .doc(kind.doc)
        }))
        .children(attributes)
        .children(own.map(complex))
        .children(simple())
        .children([
            names("ClassName", "A class of components.", &words.classes, "saoms:Given"),
            names("PropertyName", "A property of a component or a loop.", &words.properties, "saoms:Name"),
            names("ServiceName", "A service of a component.", &words.services, "saoms:Name"),
            names("ReferenceName", "A reference of a component.", &words.references, "saoms:Name"),
            names("InterfaceName", "An interface.", &words.interfaces, "xs:token"),
            names("LoopName", "A loop within a component.", &words.loops, "saoms:Name"),
            names("LoopClassName", "A class of loops.", &words.loop_classes, "saoms:Given"),
            names("Value", "The value of a property.", &words.values, "xs:string"),
        ])
}

/// Elements of SAOMS stand in files of any version of SCA, so what they hold of SCA is not named.
fn complex(kind: &'static Kind) -> NewElement {
    let has_parts = children(kind).next().is_some();
    let content = has_parts.then(|| holding([any("##other")]));
    NewElement::new("xs:complexType")
        .with("name", name_of(kind))
        .children(content)
        .children(declared(kind, Version::Oasis200912))
        .child(NewElement::new("xs:anyAttribute").with("namespace", "##other").with("processContents", "lax"))
}

pub(super) fn any(namespace: &str) -> NewElement {
    NewElement::new("xs:any").with("namespace", namespace).with("processContents", "lax")
}

/// The type of an attribute.
pub(super) fn type_of(holds: Holds, is_required: bool) -> &'static str {
    match holds {
        Holds::Name => "saoms:Name",
        Holds::PropertyName => "saoms:PropertyName",
        Holds::ServiceName => "saoms:ServiceName",
        Holds::ReferenceName => "saoms:ReferenceName",
        Holds::Class => "saoms:ClassName",
        Holds::Interface => "saoms:InterfaceName",
        Holds::LoopName => "saoms:LoopName",
        Holds::LoopClass => "saoms:LoopClassName",
        Holds::Value => "saoms:Value",
        Holds::Boolean => "xs:boolean",
        Holds::Multiplicity => "saoms:Multiplicity",
        Holds::Variable | Holds::Code => "saoms:Given",
        Holds::Level => "saoms:Level",
        Holds::Composite | Holds::End if is_required => "saoms:Given",
        Holds::Composite
        | Holds::End
        | Holds::Ends
        | Holds::Source
        | Holds::Type
        | Holds::Element
        | Holds::File
        | Holds::Table
        | Holds::Library
        | Holds::Namespace
        | Holds::Uri
        | Holds::Names
        | Holds::Number
        | Holds::Condition
        | Holds::Text => "xs:token",
    }
}

fn simple() -> [NewElement; 4] {
    let multiplicity = |value: Multiplicity| {
        let doc = match value {
            Multiplicity::ZeroOrOne => "A target or none.",
            Multiplicity::One => "One target.",
            Multiplicity::Any => "Any number of targets.",
            Multiplicity::OneOrMore => "One target or more.",
        };
        enumeration(value.name(), doc)
    };
    let level = |level: SeverityLevel| {
        let doc = match level {
            SeverityLevel::Allow => "They are kept for the record alone.",
            SeverityLevel::Set(Severity::Note) => "They are worth knowing.",
            SeverityLevel::Set(Severity::Warning) => "They are probably not meant.",
            SeverityLevel::Set(Severity::Error) => "Nothing starts with them.",
        };
        enumeration(level.name(), doc)
    };
    [
        restricted("xs:token", [NewElement::new("xs:pattern").with("value", r"([^\s/]|$\{[^}]*\})+")])
            .named("Name", "A name: without blanks and `/` but in expressions, as `${index}`."),
        restricted("xs:token", [NewElement::new("xs:minLength").with("value", "1")])
            .named("Given", "A text that is not empty."),
        restricted("xs:token", Multiplicity::ALL.map(multiplicity))
            .named("Multiplicity", "How many targets a reference takes."),
        restricted("xs:token", SeverityLevel::ALL.map(level)).named("Level", "How bad diagnostics of a code are."),
    ]
}

/// A type of names: those that are known, and any other that `otherwise` lets pass.
fn names(name: &'static str, doc: &str, known: &Names, otherwise: &'static str) -> NewElement {
    let values = known.iter().map(|(name, doc)| enumeration(name, doc));
    let mut union = NewElement::new("xs:union");
    if !known.is_empty() {
        union = union.child(NewElement::new("xs:simpleType").child(restriction("xs:token", values)));
    }
    let other = NewElement::new("xs:simpleType").child(restriction(otherwise, []));
    Simple(union.child(other)).named(name, doc)
}

fn enumeration(value: &str, doc: &str) -> NewElement {
    NewElement::new("xs:enumeration").with("value", value).doc(doc)
}

fn restriction(base: &'static str, facets: impl IntoIterator<Item = NewElement>) -> NewElement {
    NewElement::new("xs:restriction").with("base", base).children(facets)
}

fn restricted(base: &'static str, facets: impl IntoIterator<Item = NewElement>) -> Simple {
    Simple(restriction(base, facets))
}

/// A simple type.
struct Simple(NewElement);

impl Simple {
    fn named(self, name: &'static str, doc: &str) -> NewElement {
        NewElement::new("xs:simpleType").with("name", name).doc(doc).child(self.0)
    }
}
