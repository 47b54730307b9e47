//! A version of SCA.

use std::collections::BTreeMap;

use super::node::{Documented, NewElement};
use super::own::{any, type_of};
use super::{OWN_FILE, root};
use saoms_lang::load::vocabulary::{
    BINDING_SCA, CALLBACK, COMPONENT, COMPONENT_PROPERTY, COMPONENT_REFERENCE, COMPONENT_SERVICE, COMPOSITE,
    COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, IMPLEMENTATION_COMPOSITE, IMPLEMENTATION_JAVA,
    IMPLEMENTATION_RUST, INCLUDE, INTERFACE_JAVA, INTERFACE_RUST, INTERFACE_WSDL, Kind, LOOP, OWN_ELEMENTS, SEVERITY,
    SEVERITY_PARENTS, WIRE, children, other, own_attributes,
};
use saoms_lang::model::{SAOMS_NAMESPACE, Version};

/// The types of elements, by their names in the schema.
const TYPES: &[(&str, &Kind)] = &[
    ("Composite", &COMPOSITE),
    ("Include", &INCLUDE),
    ("Wire", &WIRE),
    ("Component", &COMPONENT),
    ("ComponentProperty", &COMPONENT_PROPERTY),
    ("ComponentService", &COMPONENT_SERVICE),
    ("ComponentReference", &COMPONENT_REFERENCE),
    ("CompositeProperty", &COMPOSITE_PROPERTY),
    ("CompositeService", &COMPOSITE_SERVICE),
    ("CompositeReference", &COMPOSITE_REFERENCE),
    ("Callback", &CALLBACK),
    ("ImplementationJava", &IMPLEMENTATION_JAVA),
    ("ImplementationComposite", &IMPLEMENTATION_COMPOSITE),
    ("ImplementationRust", &IMPLEMENTATION_RUST),
    ("InterfaceJava", &INTERFACE_JAVA),
    ("InterfaceRust", &INTERFACE_RUST),
    ("InterfaceWsdl", &INTERFACE_WSDL),
    ("BindingSca", &BINDING_SCA),
];

/// Roots of the other files of a contribution, which editors would find undeclared.
const OTHER_ROOTS: &[(&str, &str)] = &[
    (
        "componentType",
        "What the implementation of the same name offers and takes. What is inside is not described here.",
    ),
    ("contribution", "What a folder of composites imports and exports. What is inside is not described here."),
    ("definitions", "Policies. What is inside is not described here."),
];

/// The kinds of elements with unique names within their parent, and the attributes that make the name: of two
/// components of one name another condition or another first index decides.
const UNIQUE: &[(&Kind, &str, &[&str])] = &[
    (&COMPOSITE, "component", &["@name", "@saoms:if", "@saoms:from"]),
    (&COMPOSITE, "property", &["@name"]),
    (&COMPOSITE, "service", &["@name"]),
    (&COMPOSITE, "reference", &["@name"]),
    (&COMPONENT, "property", &["@name"]),
    (&COMPONENT, "service", &["@name"]),
    (&COMPONENT, "reference", &["@name"]),
];

/// The namespaces of attributes that others put on elements of SCA. XSD 1.0 cannot let all pass but that of SAOMS, in
/// which mistakes are to be found.
const FOREIGN: &[&str] = &[
    "http://www.w3.org/XML/1998/namespace",
    "http://www.w3.org/1999/xlink",
    "http://www.w3.org/ns/wsdl-instance",
    "http://www.w3.org/2006/01/wsdl-instance",
    "http://www.w3.org/2004/08/wsdl-instance",
    "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-utility-1.0.xsd",
    "http://tuscany.apache.org/xmlns/sca/1.0",
    "http://tuscany.apache.org/xmlns/sca/1.1",
    "http://frascati.ow2.org/xmlns/sca/1.1",
    "http://fabric3.org/xmlns/sca/2.0-alpha",
    "urn:fabric3.org",
];

/// The schema of a version, with these assertions over components.
pub(super) fn schema(version: Version, assertions: Vec<NewElement>) -> NewElement {
    let doc = format!("The language of composites of {}. Written by `saoms schema`.", version.label());
    let own = NewElement::new("xs:import").with("namespace", SAOMS_NAMESPACE).with("schemaLocation", OWN_FILE);
    let roots = OTHER_ROOTS
        .iter()
        .map(|(name, doc)| NewElement::new("xs:element").with("name", *name).with("type", "sca:Open").doc(doc));
    let mut root = root(version.namespace(), &doc).with("xmlns:sca", version.namespace());
    if !assertions.is_empty() {
        root = root.with("xmlns:vc", "http://www.w3.org/2007/XMLSchema-versioning").with("vc:minVersion", "1.1");
    }
    let has_assertions = !assertions.is_empty();
    let others = TYPES.iter().filter(|(_, kind)| !std::ptr::eq(*kind, &COMPONENT));
    root.child(own)
        .child(element("composite", Some(&COMPOSITE)))
        // Loops, which are of another namespace, hold those of a component.
        .child(element("property", Some(&COMPONENT_PROPERTY)))
        .children(everywhere().into_iter().map(|(name, kind)| element(name, kind)))
        .children(roots)
        .children(others.map(|(_, kind)| complex(kind, version, has_assertions)))
        .child(complex(&COMPONENT, version, has_assertions).children(assertions))
        .child(open())
}

/// The name of the type of an element.
pub(super) fn name_of(kind: &Kind) -> &'static str {
    if std::ptr::eq(kind, &LOOP) {
        return "Loop";
    }
    if std::ptr::eq(kind, &SEVERITY) {
        return "Severity";
    }
    TYPES.iter().find(|(_, known)| std::ptr::eq(*known, kind)).map_or("Open", |(name, _)| name)
}

/// The elements that are the same wherever they stand, sorted.
fn everywhere() -> BTreeMap<&'static str, Option<&'static Kind>> {
    let all = TYPES.iter().flat_map(|(_, kind)| children(kind).map(|name| (name, kind.child(name))));
    all.filter(|(name, _)| is_same_everywhere(name)).collect()
}

/// Those of a composite differ from those of its components.
fn is_same_everywhere(name: &str) -> bool {
    !matches!(name, "property" | "service" | "reference" | "value")
}

/// The declaration of an element; where its parts are not known, anything can stand in it.
fn element(name: &str, kind: Option<&Kind>) -> NewElement {
    let type_name = kind.map_or("Open", name_of);
    let doc = kind.map_or_else(|| other(name).unwrap_or_default(), |kind| kind.doc);
    let unique = UNIQUE.iter().filter(|(of, ..)| kind.is_some_and(|kind| std::ptr::eq(*of, kind)));
    let unique = unique.map(|(_, what, by)| {
        NewElement::new("xs:unique")
            .with("name", format!("{what}-of-{name}"))
            .child(NewElement::new("xs:selector").with("xpath", format!("sca:{what}")))
            .children(by.iter().map(|path| NewElement::new("xs:field").with("xpath", *path)))
    });
    NewElement::new("xs:element").with("name", name).with("type", format!("sca:{type_name}")).doc(doc).children(unique)
}

/// The type of an element. Other namespaces are open, as far as XSD can say so; that of SAOMS has what is known alone.
fn complex(kind: &'static Kind, version: Version, has_assertions: bool) -> NewElement {
    let node = NewElement::new("xs:complexType").with("name", name_of(kind));
    let is_property = [&COMPONENT_PROPERTY, &COMPOSITE_PROPERTY].into_iter().any(|one| std::ptr::eq(one, kind));
    let node = if is_property {
        // A value can have elements of any namespace, and say types (`xsi:type`) that no schema here knows.
        node.with("mixed", "true").child(holding([skipped("xs:any")]))
    } else {
        let parts = children(kind).map(|name| match is_same_everywhere(name) {
            true => NewElement::new("xs:element").with("ref", format!("sca:{name}")),
            false => element(name, kind.child(name)),
        });
        let own = own_children(kind).map(|name| NewElement::new("xs:element").with("ref", format!("saoms:{name}")));
        let others: Vec<NewElement> = match has_assertions {
            true => {
                let any =
                    NewElement::new("xs:any").with("notNamespace", format!("##targetNamespace {SAOMS_NAMESPACE}"));
                own.chain([any.with("processContents", "lax")]).collect()
            }
            // Beside the wildcard, XSD 1.0 would find elements of SAOMS ambiguous.
            false => vec![any("##other")],
        };
        node.child(holding(parts.chain(others)))
    };
    let own =
        own_attributes(kind).map(|known| NewElement::new("xs:attribute").with("ref", format!("saoms:{}", known.name)));
    // The schema of SCA 1.0 lets any attribute pass.
    let others = NewElement::new("xs:anyAttribute");
    let others = match (version.is_1_1(), has_assertions) {
        (true, true) => others.with("notNamespace", format!("##targetNamespace ##local {SAOMS_NAMESPACE}")),
        (false, true) => others.with("notNamespace", SAOMS_NAMESPACE),
        (true, false) => others.with("namespace", FOREIGN.join(" ")),
        (false, false) => others.with("namespace", format!("##targetNamespace ##local {}", FOREIGN.join(" "))),
    };
    node.children(attributes(kind, version)).children(own).child(others.with("processContents", "lax"))
}

/// The elements of SAOMS that can stand in an element.
fn own_children(kind: &'static Kind) -> impl Iterator<Item = &'static str> {
    let holds = move |name: &&str| match *name {
        name if name == LOOP.name => std::ptr::eq(kind, &COMPONENT),
        name if name == SEVERITY.name => SEVERITY_PARENTS.contains(&kind.name),
        name => children(kind).any(|child| child == name),
    };
    OWN_ELEMENTS.iter().copied().filter(holds)
}

/// The declarations of the attributes of an element.
pub(super) fn attributes(kind: &'static Kind, version: Version) -> impl Iterator<Item = NewElement> {
    kind.of(version).map(move |known| {
        let is_required = known.required || known.name == "targetNamespace" && version.is_1_1();
        let node =
            NewElement::new("xs:attribute").with("name", known.name).with("type", type_of(known.holds, known.required));
        let node = if is_required { node.with("use", "required") } else { node };
        node.doc(known.doc)
    })
}

/// Any number of these in any order.
pub(super) fn holding(parts: impl IntoIterator<Item = NewElement>) -> NewElement {
    NewElement::new("xs:choice").with("minOccurs", "0").with("maxOccurs", "unbounded").children(parts)
}

/// Anything, not looked at.
fn skipped(name: &'static str) -> NewElement {
    NewElement::new(name).with("namespace", "##any").with("processContents", "skip")
}

/// The type of what is not described here.
fn open() -> NewElement {
    NewElement::new("xs:complexType")
        .with("name", "Open")
        .with("mixed", "true")
        .doc("What is not described here: anything.")
        .child(holding([skipped("xs:any")]))
        .child(skipped("xs:anyAttribute"))
}
