use std::collections::HashMap;

use roxmltree::{Document, Node};
use saoms_api::host::Registration;
use saoms_api::{Class, Component, Failure, Properties, PropertyField};

use super::*;
use saoms_lang::assembly::TaskProperties;
use saoms_lang::load::vocabulary::{COMPOSITE, Kind, children};

/// The way a lamp shines.
#[derive(Clone, Copy, PropertyField)]
enum Shining {
    /// All the time.
    Steady,
    /// On and off.
    Blinking,
}

#[derive(Properties)]
#[expect(dead_code, reason = "only its declaration is looked at")]
struct LampProperties {
    /// More than <nothing> & "less" than the sun.
    #[property(default = 5.0, range = 0.5..=10.0, unit = "lx")]
    brightness: f64,
    /// The way it shines.
    shining: Shining,
}

/// Gives light.
#[derive(Class)]
#[class(name = "example.Lamp", passive, also("example.Torch"))]
struct Lamp;

impl Component for Lamp {
    type Properties = LampProperties;

    fn new(_: LampProperties) -> Result<Self, Failure> {
        Ok(Lamp)
    }
}

fn lamps() -> Vec<XsdSchema> {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Lamp>()).unwrap();
    schemas(&registry, Xsd::V1_0)
}

/// The values of the enumerations of a type in the schema of SAOMS, with what is said of each.
fn values(name: &str) -> HashMap<String, String> {
    let text = &lamps()[3].text;
    let document = Document::parse(text).unwrap();
    let is_type = |node: &Node<'_, '_>| node.has_tag_name(("http://www.w3.org/2001/XMLSchema", "simpleType"));
    let found = document.descendants().find(|node| is_type(node) && node.attribute("name") == Some(name));
    let all = found.unwrap().descendants().filter(|node| node.tag_name().name() == "enumeration");
    let said = |node: Node<'_, '_>| {
        node.descendants()
            .find_map(|inner| inner.text().map(str::trim).filter(|text| !text.is_empty()).map(str::to_owned))
    };
    all.map(|node| (node.attribute("value").unwrap().to_owned(), said(node).unwrap())).collect()
}

#[test]
fn classes_properties_and_values_are_names_with_what_there_is_to_say_about_them() {
    assert_eq!(
        values("ClassName"),
        HashMap::from(
            [
                ("example.Lamp", "Gives light.\nRequired: `shining`."),
                ("example.Torch", "Another name of example.Lamp.\nGives light.\nRequired: `shining`."),
            ]
            .map(|(name, doc)| (name.to_owned(), doc.to_owned()))
        )
    );
    let properties = values("PropertyName");
    assert_eq!(
        properties["brightness"],
        "example.Lamp: a number from 0.5 to 10.0 [lx], `5.0` unless given. More than <nothing> & \"less\" than the sun."
    );
    assert_eq!(properties["shining"], "example.Lamp: `steady` or `blinking`, required. The way it shines.");
    for task in TaskProperties::declarations() {
        assert!(properties[&task.name].starts_with("every periodic class: "), "{}", task.name);
    }
    assert_eq!(values("Value")["blinking"], "A value of `shining`");
}

/// The elements that an element of a type can hold by a schema, and its attributes.
type Shape<'a> = (Vec<&'a str>, Vec<&'a str>);

fn shapes<'a>(document: &'a Document<'_>) -> HashMap<&'a str, Shape<'a>> {
    let types = document.root_element().children().filter(|node| node.tag_name().name() == "complexType");
    let named = |node: Node<'a, '_>, tag: &str| {
        let all = node.descendants().filter(|inner| inner.tag_name().name() == tag);
        let name =
            |inner: Node<'a, '_>| inner.attribute("name").or_else(|| inner.attribute("ref")?.strip_prefix("sca:"));
        all.filter_map(name).collect::<Vec<_>>()
    };
    types.map(|node| (node.attribute("name").unwrap(), (named(node, "element"), named(node, "attribute")))).collect()
}

fn compare(kind: &'static Kind, version: Version, shapes: &HashMap<&str, Shape<'_>>) {
    let (elements, attributes) = &shapes[sca::name_of(kind)];
    let known: Vec<&str> = kind.of(version).map(|known| known.name).collect();
    assert_eq!(*attributes, known, "{} of {}", kind.name, version.label());
    for name in children(kind) {
        // Properties take elements of any name.
        assert!(elements.contains(&name) || name == "value", "{name} in {} of {}", kind.name, version.label());
        if let Some(child) = kind.child(name) {
            compare(child, version, shapes);
        }
    }
}

#[test]
fn a_schema_lets_pass_what_the_loader_knows() {
    let all = lamps();
    for version in Version::ALL {
        let schema = all.iter().find(|schema| schema.namespace == version.namespace()).unwrap();
        let document = Document::parse(&schema.text).unwrap();
        compare(&COMPOSITE, version, &shapes(&document));
    }
}

#[test]
fn every_type_that_is_named_is_there_and_every_element_and_attribute_is_documented() {
    let all = lamps();
    let own = Document::parse(&all[3].text).unwrap();
    for schema in &all {
        let document = Document::parse(&schema.text).unwrap();
        let declared = |document: &Document<'_>, name: &str| {
            let mut types = document.root_element().children();
            types.any(|node| node.attribute("name") == Some(name))
        };
        for node in document.descendants().filter(Node::is_element) {
            for named in ["type", "base", "ref"].into_iter().filter_map(|name| node.attribute(name)) {
                let (prefix, name) = named.split_once(':').unwrap();
                let is_there = match prefix {
                    "sca" => declared(&document, name),
                    "saoms" => declared(&own, name),
                    _ => true,
                };
                assert!(is_there, "{named} in {}", schema.file);
            }
            let tag = node.tag_name().name();
            let is_documented = node.descendants().any(|inner| inner.tag_name().name() == "documentation");
            let needs = matches!(tag, "element" | "attribute") && node.attribute("ref").is_none();
            assert!(is_documented || !needs, "{:?} in {}", node.attribute("name"), schema.file);
        }
    }
}

#[test]
fn a_registry_without_classes_has_no_empty_enumerations() {
    let all = schemas(&Registry::new(), Xsd::V1_0);
    let own = &all[3].text;
    assert!(
        own.contains("<xs:simpleType name=\"ClassName\">")
            && !own.contains("<xs:restriction base=\"xs:token\">\n        </")
    );
    Document::parse(own).unwrap();
}

#[test]
fn the_catalog_leads_to_each_schema() {
    let all = lamps();
    let text = catalog(&all);
    let document = Document::parse(&text).unwrap();
    let entries = document.root_element().children().filter(Node::is_element);
    let found: Vec<_> =
        entries.map(|entry| (entry.attribute("name").unwrap(), entry.attribute("uri").unwrap())).collect();
    assert_eq!(found, all.iter().map(|schema| (schema.namespace, schema.file)).collect::<Vec<_>>());
}
