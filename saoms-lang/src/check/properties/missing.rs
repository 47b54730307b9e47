//! Properties that are not there: given and not declared, or declared and not given.

use super::Giver;
use crate::assembly::TaskProperties;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::fleet::property_table::PropertyTable;
use crate::check::report::Report;
use crate::check::report::swapped::swapped;
use crate::diagnostic::{Diagnostic, codes, nearest, nearest_equal, quoted};
use crate::load::is_given_otherwise;
use crate::model::Property;
use crate::registry::PropertyDeclaration;
use crate::syntax::Element;

/// Reports a property that a class or a loop does not have.
pub(crate) fn unknown(property: &Property, giver: &Giver<'_, '_>, table: &PropertyTable<'_>, report: &mut Report<'_>) {
    let (name, at) = (&property.name, property.name.location);
    let of = quoted(table.name);
    let document = &giver.member.composite.document;
    if table.references.contains(&name.as_str()) && at.file == document.file() {
        let (written, kinds) = ((property.origin.element(document), &**document), ("property", "reference"));
        let whose = format!("{} {of}", table.what);
        return swapped((&codes::UNKNOWN_PROPERTY, name), written, kinds, &whose, report);
    }
    let is_task = table.is_passive && TaskProperties::declarations().iter().any(|task| task.name == name.as_str());
    let message = format!("{} {of} has no property {}", table.what, quoted(name));
    // What is given already is not meant a second time.
    let given = giver.properties.iter().filter(|one| one.name.location.file == at.file);
    let is_given = |meant: &str| given.clone().any(|one| one.name == *meant);
    let near = nearest_equal(name, table.names());
    let one = match near.first().filter(|_| near.iter().all(|meant| is_given(meant))) {
        Some(given) => Diagnostic::new(&codes::UNKNOWN_PROPERTY, at, message)
            .help(format!("{} is given already: remove one of the two", quoted(given))),
        None => {
            let known = ("its properties are", table.names());
            let elsewhere = if near.is_empty() { belongs_elsewhere(property, giver) } else { None };
            let mut one = match elsewhere {
                Some(help) => Diagnostic::new(&codes::UNKNOWN_PROPERTY, at, message).help(help),
                None => report.unknown(&codes::UNKNOWN_PROPERTY, at, message, name, known),
            };
            one.suggestions.retain(|one| !one.edits.iter().any(|edit| is_given(&edit.replacement)));
            one
        }
    };
    let one = match stands_for(giver, table) {
        Some(lacking) => one.help(format!("did you mean {}, which is missing?", quoted(lacking))),
        None => one,
    };
    report.push(match is_task {
        true => Diagnostic::new(&codes::UNKNOWN_PROPERTY, at, one.message)
            .help(format!("{of} is passive: it is never executed and has no task properties")),
        false if table.names().next().is_none() => one.help(format!("{of} has no properties at all")),
        false => one,
    });
}

/// Where a property belongs that is one of another class of the fleet, or an attribute of SAOMS.
fn belongs_elsewhere(property: &Property, giver: &Giver<'_, '_>) -> Option<String> {
    let name = property.name.as_str();
    if ["count", "from", "overrides", "site", "node", "if"].contains(&name) {
        let value = property.simple_value().map_or("...", |value| value.value.as_str());
        return Some(format!("write it in the start tag of the component: `saoms:{name}=\"{value}\"`"));
    }
    let has_it = |class: &&ClassIndex<'_>| class.table.all.iter().any(|one| one.own().is_some() && one.name == name);
    let class = giver.classes.iter().find(has_it)?;
    Some(format!("class {} has this property: give it to a component of that class", quoted(class.table.name)))
}

/// The only property that has to be given and is not, where the only unknown one is probably meant for it.
fn stands_for<'s>(giver: &Giver<'_, '_>, table: &'s PropertyTable<'_>) -> Option<&'s str> {
    let mut unknown = giver.properties.iter().filter(|given| table.place(&given.name).is_none());
    let (given, None) = (unknown.next()?, unknown.next()) else { return None };
    if given.name.is_empty() || nearest(&given.name, table.names()).is_some() {
        return None;
    }
    let is_given = |name: &str| {
        giver.properties.iter().any(|given| given.name == *name)
            || giver.defaults().any(|(given, _)| given.name == *name)
            || table.preset(name).is_some()
    };
    let required = table.required.iter().map(|place| table.all[*place].main);
    let mut lacking = required.map(|one| one.name.as_str()).filter(|name| !is_given(name));
    let (lacking, None) = (lacking.next()?, lacking.next()) else { return None };
    Some(lacking)
}

/// Reports a property that has to be given and is not.
pub(crate) fn missing(
    giver: &Giver<'_, '_>,
    declaration: &PropertyDeclaration,
    table: &PropertyTable<'_>,
    report: &mut Report<'_>,
) {
    if giver.member.lacks_table() {
        return;
    }
    let name = declaration.name.as_str();
    let document = &giver.member.composite.document;
    let element = giver.origin.element(document);
    let is_meant = |given: &Property| {
        given.name.is_empty() || table.place(&given.name).is_none() && nearest(&given.name, [name]).is_some()
    };
    let is_property = |child: Element<'_>| match child.local_name() {
        "property" => false,
        // As other languages call it.
        "param" | "parameter" | "arg" | "argument" => {
            child.attribute("name").is_some_and(|given| given.value() == name)
        }
        other => nearest(other, ["property"]).is_some(),
    };
    // As an attribute, which SCA 1.0 lets pass.
    let is_attribute = || {
        let implementation = giver.member.component.implementation.as_ref();
        let mut elements = std::iter::once(element)
            .chain(implementation.map(|implementation| implementation.origin.element(document)));
        giver.member.composite.version.is_1_1() && elements.any(|one| one.attribute(name).is_some())
    };
    if stands_for(giver, table) == Some(name) || is_given_otherwise(element, name) {
        return;
    }
    if giver.properties.iter().any(is_meant) || element.children().any(is_property) || is_attribute() {
        // It is there, misspelt, and that is reported.
        return;
    }
    // That of SCA, in which the properties of loops are as well.
    let prefix = giver.member.component.origin.element(document).prefix();
    let tag = prefix.map_or_else(|| "property".to_owned(), |prefix| format!("{prefix}:property"));
    let who = match giver.name.is_empty() {
        true => format!("the {}", giver.what),
        false => format!("{} {}", giver.what, quoted(giver.name)),
    };
    let message = format!("{who} needs the property {}", quoted(name));
    let one = Diagnostic::new(&codes::PROPERTY_MISSING, giver.name.location, message);
    report.push(one.help(format!("add `<{tag} name=\"{name}\">...</{tag}>`: {}", declaration.expected())));
}
