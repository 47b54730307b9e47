//! Assertions, which XSD 1.0 lacks: the properties of the components of a class, and the values that they take.
//!
//! Each rule of a class is an assertion (XPath 2.0) over `component`, true for components of every other class.

use saoms_api::host::declaration::PropertyKind;
use saoms_api::host::parse_duration;

use super::node::{Documented, NewElement};
use saoms_lang::assembly::TaskProperties;
use saoms_lang::model::Version;
use saoms_lang::registry::{ClassDeclaration, PropertyDeclaration, RegisteredClass, Registry};

/// The number of a text, where it is one.
const INTEGER: &str = "^[+-]?[0-9]+$";
const FLOAT: &str = r"^[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?$";
const DURATION: &str = r"^([0-9]+\.?[0-9]*|\.[0-9]+)\s*(ns|us|µs|ms|s|min|h)?$";

/// The assertions over components of a version of SCA.
pub(super) fn of_components(registry: &Registry, version: Version) -> Vec<NewElement> {
    let classes = registry.iter().filter(|class| !class.is_alias());
    let tests = classes.flat_map(|class| of_class(class.declaration(), registry));
    tests
        .map(|(test, doc)| {
            NewElement::new("xs:assert").with("test", test).with("xpathDefaultNamespace", version.namespace()).doc(&doc)
        })
        .collect()
}

/// The tests of a class, each with what it is about.
fn of_class(declaration: &ClassDeclaration, registry: &Registry) -> Vec<(String, String)> {
    let names: Vec<&str> = [declaration.name.as_str()]
        .into_iter()
        .chain(declaration.also.iter().map(|alias| alias.name.as_str()))
        .collect();
    let task = TaskProperties::declarations().iter().filter(|_| declaration.is_periodic());
    let task = task.filter(|property| declaration.property(&property.name).is_none());
    let properties: Vec<&PropertyDeclaration> = declaration.properties.iter().chain(task).collect();
    let known = list(properties.iter().map(|property| property.name.as_str()));
    let mut tests = vec![(
        format!("{} or (every $name in property/@name satisfies $name = {known})", is_no(&names)),
        format!("The properties of {}.", declaration.name),
    )];
    for property in properties {
        let name = quoted(&property.name);
        let doc = |what: &str| format!("{} of {}: {what}", property.name, declaration.name);
        // A name of the class may preset it.
        let lacks = |name: &&&str| {
            let class = registry.get(name).map(AsRef::as_ref);
            class.is_none_or(|class: &RegisteredClass| {
                class.presets().iter().all(|(preset, _)| *preset != property.name)
            })
        };
        let needing: Vec<&str> = names.iter().filter(lacks).copied().collect();
        if property.required && !needing.is_empty() {
            // A table beside the composite may give it.
            let test = format!("{} or property/@name = {name} or @*:overrides", is_no(&needing));
            tests.push((test, doc("is required.")));
        }
        // What expressions in replicas come to is not known.
        if let Some(test) = of_value(property) {
            let values = format!(
                "property[@name = {name}][not(@source or @file)]/(if (@value) then @value else if (value) then value \
                 else .)"
            );
            tests.push((
                format!(
                    "{} or (every $v in {values}/normalize-space(string(.)) satisfies (contains($v, '${{') or {test}))",
                    is_no(&names)
                ),
                doc(&format!("{}.", property.expected())),
            ));
        }
    }
    tests
}

/// The test of a value `$v`; `None` where every text will do.
fn of_value(property: &PropertyDeclaration) -> Option<String> {
    if !property.allowed.is_empty() {
        return Some(format!("$v = {}", list(property.allowed.iter().map(String::as_str))));
    }
    let number = |pattern: &str, number: String, bound: &dyn Fn(&str) -> Option<String>| {
        let bounds = [(&property.min, "ge"), (&property.max, "le"), (&property.exclusive_max, "lt")];
        let bounds =
            bounds.into_iter().filter_map(|(text, is)| Some(format!("{number} {is} {}", bound(text.as_ref()?)?)));
        let bounds: Vec<String> = bounds.collect();
        let then = if bounds.is_empty() { "true()".to_owned() } else { bounds.join(" and ") };
        format!("(if (matches($v, {})) then {then} else false())", quoted(pattern))
    };
    match property.kind {
        PropertyKind::Boolean => Some("$v = ('true', 'false', '1', '0')".to_owned()),
        PropertyKind::Integer => Some(number(INTEGER, "xs:integer($v)".to_owned(), &|text| Some(text.to_owned()))),
        PropertyKind::Float => Some(number(FLOAT, "xs:double($v)".to_owned(), &|text| Some(text.to_owned()))),
        PropertyKind::Duration => {
            let nanos = |text: &str| parse_duration(text).ok().map(|bound| bound.as_nanos().to_string());
            Some(number(DURATION, nanoseconds(), &nanos))
        }
        PropertyKind::String if property.non_empty => Some("$v != ''".to_owned()),
        PropertyKind::String | PropertyKind::Enumeration | PropertyKind::Complex => None,
    }
}

/// A duration as a number of nanoseconds.
fn nanoseconds() -> String {
    let unit = r"replace($v, '^[0-9.]+\s*', '')";
    let units = [
        ("h", 3_600_000_000_000_u64),
        ("min", 60_000_000_000),
        ("s", 1_000_000_000),
        ("us", 1_000),
        ("µs", 1_000),
        ("ns", 1),
    ];
    let factor = units.into_iter().rev().fold("1000000".to_owned(), |other, (name, factor)| {
        format!("if ({unit} = '{name}') then {factor} else {other}")
    });
    format!(r"xs:decimal(replace($v, '\s*[a-zµ]+$', '')) * ({factor})")
}

/// The test that a component is of none of these classes.
fn is_no(names: &[&str]) -> String {
    let names = list(names.iter().copied());
    format!("not(*[local-name() = ('implementation.java', 'implementation.rust')]/@class = {names})")
}

fn list<'t>(texts: impl Iterator<Item = &'t str>) -> String {
    format!("({})", texts.map(quoted).collect::<Vec<_>>().join(", "))
}

/// As a literal of XPath.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}
