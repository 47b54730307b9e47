//! Components of which nothing is known here but what a file beside their implementation says.

use std::collections::HashSet;

use super::described;
use super::fleet::{Fleet, Kind, Member};
use super::global;
use super::offer::Side;
use super::parameters::{Found, Parameters, Place};
use super::raw::Piece;
use super::report::{Report, list, replacing};
use super::target::{has_several, parts};
use super::value_type::{self, Match, Typed};
use crate::diagnostic::{Code, Diagnostic, Severity, codes, nearest, quoted};
use crate::model::{Component, ComponentType, ImplementationKind, Multiplicity, Part, Property, Reference};
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// What a file says of a component that is taken as given.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    pub(super) described: &'a ComponentType,
    /// Whether that is all there is to know. A script or a bundle has what its file says; a class has what it says itself besides.
    is_whole: bool,
}

impl<'a> Fleet<'a> {
    /// What a file says of a component that is taken as given; `None` where there is none, and for all other components.
    pub(super) fn known(&self, member: usize) -> Option<Known<'a>> {
        if self.members[member].kind != Kind::Given || !self.contribution.describes_any() {
            return None;
        }
        let kind = &self.members[member].component.implementation.as_ref()?.kind;
        let is_whole =
            matches!(kind, ImplementationKind::Other { kind, .. } if kind == "script" || kind == "osgi");
        Some(Known { described: self.component_type(member)?, is_whole })
    }

    /// The names of the services or references of such a component that are written anywhere: it may have more.
    pub(super) fn written_names(&self, member: usize, side: Side) -> Vec<&'a str> {
        let component = self.members[member].component;
        let described = self.known(member).into_iter().flat_map(|known| known.names(side));
        let (services, references) = match side {
            Side::Service => (&component.services[..], &[][..]),
            Side::Reference => (&[][..], &component.references[..]),
        };
        let own = services.iter().map(|one| one.name.as_str());
        let own = own.chain(references.iter().map(|one: &Reference| one.name.as_str()));
        let mut names: Vec<&str> = own.chain(described).filter(|name| !name.is_empty()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Reports the name of a service or reference that such a component does not have, as far as anybody knows. Where nobody does, one that is
    /// nearly a name that the component itself has is probably that one.
    pub(super) fn unknown_name(
        &self,
        member: usize,
        side: Side,
        (code, rule): (&'static Code, Option<&'static str>),
        (name, at): (&str, Location),
        report: &mut Report<'_>,
    ) {
        let component = self.members[member].component;
        // Those that the component has itself are held against the file where they are written.
        let is_own = match side {
            Side::Service => component.service(name).is_some(),
            Side::Reference => component.reference(name).is_some(),
        };
        if is_own || self.members[member].kind != Kind::Given {
            return;
        }
        let known = self.known(member).map(|known| (known, known.names(side).collect::<Vec<_>>()));
        if let Some((known, names)) = known.filter(|(known, names)| known.is_whole || !names.is_empty()) {
            return known.lacks((code, rule), side.name(), (&component.name, name, at), &names, report);
        }
        let own = self.written_names(member, side);
        let Some(meant) = nearest(name, own).filter(|meant| is_slip(name, meant)) else { return };
        let what = side.name();
        let message = format!("component {} declares no {what} {}", quoted(&component.name), quoted(name));
        let mut one = Diagnostic::new(code, at, message).severity(Severity::Warning);
        let declared = match side {
            Side::Service => component.service(meant).map(|one| &one.name),
            Side::Reference => component.reference(meant).map(|one| &one.name),
        };
        if let Some(declared) = declared {
            one = one.label(declared.location, "what it declares");
        }
        one = one.suggest(replacing(name, meant), at, escaped(meant));
        one = one.help("if its class has both, declare this one in the component as well");
        report.push(match rule {
            Some(rule) => one.rule(rule),
            None => one,
        });
    }
}

/// Whether a name that is like another one may be meant for it: not where only their numbers differ, or one adds a word to the other.
fn is_slip(name: &str, meant: &str) -> bool {
    let without = |name: &str| name.replace(|c: char| c.is_ascii_digit(), "");
    name.len().abs_diff(meant.len()) <= 2 && without(name) != without(meant)
}

impl<'a> Known<'a> {
    fn names(&self, side: Side) -> impl Iterator<Item = &'a str> + use<'a> {
        let (services, references) = match side {
            Side::Service => (&self.described.services[..], &[][..]),
            Side::Reference => (&[][..], &self.described.references[..]),
        };
        let services = services.iter().map(|one| &one.name);
        services.chain(references.iter().map(|one| &one.name)).map(|name| name.as_str())
    }

    /// Reports a name that is not among those that the file has: where the class may have it all the same as a warning. A file that has nothing
    /// of the kind says nothing about a class.
    fn lacks(
        &self,
        (code, rule): (&'static Code, Option<&'static str>),
        what: &str,
        (component, name, at): (&Text, &str, Location),
        names: &[&str],
        report: &mut Report<'_>,
    ) {
        if name.is_empty() || names.contains(&name) || names.is_empty() && !self.is_whole {
            return;
        }
        let message = format!("component {} has no {what} {}", quoted(component), quoted(name));
        let all = if what == "property" { "properties".to_owned() } else { format!("{what}s") };
        let known = (&*format!("its {all} are"), names.iter().copied());
        let mut one = report.unknown(code, at, message, name, known);
        one = one.label(self.described.tag(), "what it has is described here");
        if !self.is_whole {
            one = one
                .severity(Severity::Warning)
                .help(format!("if its class has it, add the {what} to the description"));
        }
        if let Some(rule) = rule {
            one = one.rule(rule);
        }
        report.push(one);
    }
}

/// Checks the services and references that a component writes against what is known of it.
pub(super) fn contracts(component: &Component, known: Known<'_>, report: &mut Report<'_>) {
    let names: Vec<&str> = known.names(Side::Service).collect();
    for name in component.services.iter().map(|one| &one.name) {
        let wrong = (&component.name, name.as_str(), name.location);
        known.lacks((&codes::UNKNOWN_SERVICE, None), "service", wrong, &names, report);
    }
    let names: Vec<&str> = known.names(Side::Reference).collect();
    for reference in &component.references {
        let name = &reference.name;
        let wrong = (&component.name, name.as_str(), name.location);
        known.lacks((&codes::UNKNOWN_REFERENCE, None), "reference", wrong, &names, report);
        described::multiplicity(reference, known.described, report);
    }
}

/// The references that composites promote, by their scopes and components; without a name where a component is promoted as a whole.
pub(super) fn promoted<'a>(fleet: &Fleet<'a>) -> HashSet<(usize, &'a str, Option<&'a str>)> {
    let mut all = HashSet::default();
    if fleet.members.iter().all(|member| member.kind != Kind::Given) {
        return all;
    }
    for unit in &fleet.units {
        for (component, name) in unit.references().flat_map(Reference::promote).map(|uri| parts(uri)) {
            all.insert((unit.scope, component, name));
            for replica in fleet.group(unit.scope, component).into_iter().flatten() {
                all.insert((unit.scope, &fleet.members[*replica].component.name, name));
            }
        }
    }
    all
}

/// Whether a text is nothing but the name of a component that has one service as far as anybody knows: what most targets are.
pub(super) fn is_component(text: &str, scope: usize, fleet: &Fleet<'_>) -> bool {
    let is_odd = |byte: u8| matches!(byte, b'/' | b':' | b'*' | b'$');
    let is_plain = !text.bytes().fold(false, |odd, byte| odd | is_odd(byte));
    is_plain && fleet.find(scope, text).is_some_and(|found| !has_several(found, fleet))
}

/// Reports the references that the component or a file says need a target, and have none: whoever runs the component may still find one.
pub(super) fn unwired<'f>(
    place: usize,
    fleet: &'f Fleet<'_>,
    promoted: &HashSet<(usize, &str, Option<&str>)>,
    is_wired: impl Fn(&'f str) -> bool,
    report: &mut Report<'_>,
) {
    let member = &fleet.members[place];
    let component = member.component;
    let is_promoted = |name| promoted.contains(&(member.scope, component.name.as_str(), name));
    if member.kind != Kind::Given || is_promoted(None) || is_wired("") || fleet.lacks_include(member.scope) {
        return;
    }
    let default = component.autowire().map_or(member.autowire, |said| said.value);
    let described = fleet.known(place).map_or(&[][..], |known| &known.described.references);
    let names: HashSet<&str> = described.iter().map(|one| one.name.as_str()).collect();
    let own = component.references.iter().filter(|own| !names.contains(own.name.as_str()));
    let described = described.iter().map(|declared| (component.reference(&declared.name), Some(declared)));
    for (own, declared) in described.chain(own.map(|own| (Some(own), None))) {
        let mut both = [own, declared].into_iter().flatten();
        let Some(name) = both.clone().next().map(|one| &one.name).filter(|name| !name.is_empty()) else {
            continue;
        };
        let has_end = both.clone().any(|one| {
            !one.targets.is_empty()
                || !one.bindings().is_empty()
                || one.wired_by_impl().is_some_and(|wired| wired.value)
        });
        let autowire = both.clone().find_map(Reference::autowire).map_or(default, |said| said.value);
        // Where nobody says it, a class may.
        let unsaid = if declared.is_some() { Multiplicity::One } else { Multiplicity::Any };
        let given = both.find_map(Reference::multiplicity);
        let multiplicity = given.map_or(unsaid, |given| given.value);
        if has_end || autowire || !multiplicity.is_required() || is_promoted(Some(name)) || is_wired(name) {
            continue;
        }
        let message = format!(
            "reference {} of component {} leads to no service",
            quoted(name),
            quoted(&component.name)
        );
        let at = own.map_or(component.name.location, |own| own.name.location);
        let rule = if multiplicity.is_many() { "ASM50041" } else { "ASM50040" };
        let one = Diagnostic::new(&codes::UNWIRED, at, message).severity(Severity::Warning).rule(rule);
        let one = match (declared, given) {
            (Some(declared), _) => one.label(declared.name.location, "it needs a target by this description"),
            (None, Some(given)) => one.label(given.location, "it needs a target by this"),
            (None, None) => one,
        };
        report.push(match own {
            Some(_) => one.help("give it a `target`"),
            None => one.help(format!("add `<reference name=\"{}\" target=\"...\"/>`", escaped(name))),
        });
    }
}

/// Checks the properties of a component that has no class here: where they come from, and what a file says of them.
pub(super) fn properties<'a>(
    member: &Member<'a>,
    known: Option<Known<'a>>,
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) {
    let component = member.component;
    let place = Place { unit: member.unit, composite: member.composite, instance: member.instance };
    for property in component.properties.iter().filter(|property| !property.name.is_empty()) {
        if known.is_none() && member.instance.is_none() && property.only_text().is_some() {
            // A text of whatever type.
            continue;
        }
        let found = parameters.taken(place, property, report);
        if let (Some(known), Ok(found)) = (known, &found) {
            described::lacks_value((property, member.composite.version), found, known.described, report);
        }
        let source = property.source().filter(|_| property.r#type().is_none());
        let source = source.and_then(|source| Some((source, parameters.declaration(member.unit, source)?)));
        let own = Typed { property, document: &member.composite.document };
        let Some(known) = known else {
            fits(own, None, &found, report);
            continue;
        };
        let all = &known.described.properties;
        let Some(declared) = all.iter().find(|declared| declared.name == *property.name.value) else {
            let names: Vec<&str> = all.iter().map(|one| one.name.as_str()).collect();
            let wrong = (&component.name, property.name.as_str(), property.name.location);
            known.lacks((&codes::UNKNOWN_PROPERTY, None), "property", wrong, &names, report);
            continue;
        };
        let typed = Typed { property: declared, document: &known.described.document };
        if let Some((source, from)) = source
            && !value_type::matches(typed, from, Match::Source(source.location), report)
        {
            continue;
        }
        fits(own, Some(typed), &found, report);
    }
    if let Some(known) = known {
        described::supplied(component, known.described, report);
    }
}

/// Whether what a component gives for a property is what it is declared to be.
fn fits(own: Typed<'_>, declared: Option<Typed<'_>>, found: &Result<Found<'_>, ()>, report: &mut Report<'_>) {
    let Ok(found) = found else { return };
    if !many(own.property, declared.map(|declared| declared.property), found, report) {
        return;
    }
    if let Some(declared) = declared {
        if !value_type::matches(own, declared, Match::Declaration, report) {
            return;
        }
        if found.source.is_none() && own.property.element().is_none() && own.property.r#type().is_none() {
            global::given(declared, own, report);
        }
    }
    let typed: Vec<Typed<'_>> = [Some(own), declared].into_iter().flatten().collect();
    for piece in &found.raw.0 {
        match piece {
            Piece::Text(text) => {
                let _ = typed.iter().all(|typed| value_type::holds(*typed, text, &codes::VALUE_TYPE, report));
            }
            Piece::Whole(text, ..) => {
                let _ = typed.iter().all(|typed| value_type::holds(*typed, text, &codes::VALUE_TYPE, report));
            }
            Piece::Elements(elements, _) => {
                let simple = typed.iter().find_map(value_type::simple);
                if let (Some(of), Some(first)) = (simple, elements.first()) {
                    let message = format!(
                        "the property {} is of the type {}, and has elements inside: {}",
                        quoted(&own.property.name),
                        quoted(of),
                        list(elements.iter().map(|one| one.name()))
                    );
                    let one = Diagnostic::new(&codes::VALUE_TYPE, first.name_location(), message);
                    report.push(one.label(of.location, "the type"));
                }
            }
        }
    }
}

/// Whether a component gives as many values as it can.
fn many(own: &Property, declared: Option<&Property>, found: &Found<'_>, report: &mut Report<'_>) -> bool {
    if declared.and_then(Property::many).is_some_and(|many| many.value) {
        return true;
    }
    let name = quoted(&own.name);
    let said = own.many();
    if let (Some(declared), Some(many)) = (declared, said.filter(|many| many.value)) {
        let message = format!("the property {name} takes one value, and is said here to take several");
        let one = Diagnostic::new(&codes::MANY_VALUES, many.location, message);
        report.push(one.label(declared.name.location, "declared here, without `many=\"true\"`"));
        return false;
    }
    let [first, second, ..] = &found.raw.0[..] else { return true };
    let message = format!("the property {name} takes one value, and here are {}", found.raw.0.len());
    let one = Diagnostic::new(&codes::MANY_VALUES, second.location(), message);
    let one = one.label(first.location(), "the first");
    // Where nobody says how many it takes, a class may.
    let one = match (declared, said) {
        (Some(declared), _) => one.label(declared.name.location, "declared here, without `many=\"true\"`"),
        (None, Some(said)) if !said.value => one.label(said.location, "it takes one"),
        _ => return true,
    };
    report.push(one);
    false
}
