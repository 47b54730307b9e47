//! The properties that a component gives the composite that implements it, and those that it has of whatever type.

use std::collections::HashMap;

use super::given_twice;
use crate::check::fleet::{Member, Unit};
use crate::check::report::Report;
use crate::check::values::raw::is_one_of_several;
use crate::check::values::value_type::{Typed, check_match};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::expression::has_expression;
use crate::model::{ComponentElement, ComponentProperty, Part, Property, Version};
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// Checks that what a component gives the composite that implements it are properties of that, of types that fit.
pub(crate) fn check(member: &Member<'_>, inner: &Unit<'_>, report: &mut Report<'_>) {
    if member.component.properties.is_empty() {
        return;
    }
    let composites = inner.composites.iter();
    let declared = composites.flat_map(|one| one.properties.iter().map(|property| (property, &*one.document)));
    let declared = declared.map(|(property, document)| Typed { property, document });
    let names: Vec<&str> = declared.clone().map(|one| one.property.name.as_str()).collect();
    // The first of each name.
    let mut by_name: HashMap<&str, Typed<'_>> = HashMap::new();
    declared.for_each(|one| _ = by_name.entry(&one.property.name).or_insert(one));
    let is_partial = member.instance.is_some_and(|instance| instance.partial.is_some());
    let is_known = |one: &&Property| !(one.name.is_empty() || is_partial && has_expression(&one.name));
    for property in member.component.properties.iter().filter(is_known) {
        match by_name.get(property.name.as_str()) {
            Some(declared) => {
                let is_many = declared.property.many().is_some_and(|many| many.value);
                if let (false, [first, second, ..]) = (is_many, property.values()) {
                    several((property, first, second), declared.property, report);
                }
                let own = Typed { property, document: &member.composite.document };
                check_match(own, *declared, None, report);
            }
            // It is the one without a name, which is reported.
            None if names.contains(&"") || inner.hides_names => {}
            None => unknown(property, &names, inner, report),
        }
    }
}

/// Reports a property that a composite does not have.
fn unknown(property: &Property, names: &[&str], inner: &Unit<'_>, report: &mut Report<'_>) {
    let (name, at) = (&property.name, property.name.location);
    if report.skip(&codes::UNKNOWN_PROPERTY, Severity::Error, at) {
        return;
    }
    let message = format!("composite {} has no property {}", quoted(&inner.main().name), quoted(name));
    let known = ("its properties are", names.iter().copied());
    let one = match taken_inside(name, inner) {
        Some(source) => Diagnostic::new(&codes::UNKNOWN_PROPERTY, at, message)
            .label(source, "its value is used here")
            .help(format!("declare it in the composite: `<property name=\"{}\"/>`", escaped(name))),
        None => report.unknown(&codes::UNKNOWN_PROPERTY, at, message, name, known),
    };
    report.push(one);
}

/// The place where a component of a composite takes the value of a property that the composite does not have.
fn taken_inside(name: &str, inner: &Unit<'_>) -> Option<Location> {
    let components = inner.composites.iter().flat_map(|composite| &composite.components);
    let mut sources = components.flat_map(|one| &one.properties).filter_map(Property::source);
    let is_inner = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.');
    let is_it = |source: &&Text| {
        let mut behind = source.split('$').skip(1).filter_map(|rest| rest.strip_prefix(name));
        behind.any(|rest| !rest.starts_with(is_inner))
    };
    Some(sources.find(is_it)?.location)
}

/// Says that a property that its declaration says takes one value is given several.
fn several(
    (property, first, second): (&Property, &ComponentProperty, &ComponentProperty),
    declared: &Property,
    report: &mut Report<'_>,
) {
    let (name, count) = (quoted(&property.name), property.values().len());
    let message = format!("the property {name} allows one value, found {count}");
    let mut one = Diagnostic::new(&codes::MANY_VALUES, second.tag(), message).label(first.tag(), "the first");
    if !std::ptr::eq(property, declared) {
        one = one.label(declared.name.location, "declared here, without `many=\"true\"`");
    }
    report.push(one.help("keep one of them, or write `many=\"true\"` where the property is declared"));
}

/// Checks that a composite gives its property one value, where it takes one.
pub(crate) fn one_value(property: &Property, version: Version, report: &mut Report<'_>) {
    if let [first, second, ..] = property.values()
        && is_one_of_several(property, version)
    {
        several((property, first, second), property, report);
    }
}

/// Reports properties that one component gives twice.
pub(crate) fn repeated(component: &ComponentElement, report: &mut Report<'_>) {
    let mut first: HashMap<&str, &Property> = HashMap::new();
    for property in component.properties.iter().filter(|property| !property.name.is_empty()) {
        match first.get(property.name.as_str()) {
            None => _ = first.insert(&property.name, property),
            Some(first) => report.push(given_twice(property, first)),
        }
    }
}
