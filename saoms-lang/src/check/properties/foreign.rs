//! Components that have no class here, and are known by a file beside their implementation alone.

use crate::check::fleet::{Fleet, Kind, Member, Side};
use crate::check::parameters::Parameters;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Severity, codes, nearest, quoted};
use crate::model::{ComponentElement, ComponentType, ImplementationKind, Part, ReferenceElement, ServiceElement};
use crate::source::{Location, Text};
use crate::syntax::escaped;
use std::collections::{BTreeSet, HashSet};

/// The component type of a component that is taken as given.
#[derive(Clone, Copy)]
pub(crate) struct ForeignType<'a> {
    pub(crate) described: &'a ComponentType,
    /// True if that is all there is to know, as of scripts and bundles: a class may have more than its file says.
    is_whole: bool,
}

impl<'a> Fleet<'a> {
    /// The component type of a component that is taken as given, where there is one.
    pub(crate) fn known(&self, member: usize) -> Option<ForeignType<'a>> {
        if self.members[member].kind != Kind::Given || !self.contribution.describes_any() {
            return None;
        }
        let kind = &self.members[member].component.implementation.as_ref()?.kind;
        let is_whole = matches!(kind, ImplementationKind::Other { kind, .. } if kind == "script" || kind == "osgi");
        Some(ForeignType { described: self.component_type(member)?, is_whole })
    }

    /// The names of the services or references of such a component that are written anywhere: it may have more.
    pub(crate) fn written_names(&self, member: usize, side: Side) -> Vec<&'a str> {
        let component = self.members[member].component;
        let described = self.known(member).into_iter().flat_map(|known| known.names(side));
        let own = names(side, &component.services, &component.references).map(Text::as_str);
        let names: BTreeSet<&str> = own.chain(described).filter(|name| !name.is_empty()).collect();
        names.into_iter().collect()
    }

    /// Reports the name of a service or reference that such a component does not have, as far as that is known. Where
    /// it is not, one that is nearly a name that the component itself has is probably that one.
    pub(crate) fn unknown_name(
        &self,
        member: usize,
        side: Side,
        (code, rule): (&'static Code, Option<&'static str>),
        (name, at): (&str, Location),
        report: &mut Report<'_>,
    ) {
        let component = self.members[member].component;
        // Those that the component has itself are held against the file where they are written.
        let mut own = names(side, &component.services, &component.references);
        if own.any(|own| own == name) || self.members[member].kind != Kind::Given {
            return;
        }
        let known = self.known(member).map(|known| (known, known.names(side).collect::<Vec<_>>()));
        if let Some((known, names)) = known.filter(|(known, names)| known.is_whole || !names.is_empty()) {
            return known.lacks((code, rule), side.name(), (&component.name, name, at), &names, report);
        }
        let Some(meant) = nearest(name, self.written_names(member, side)).filter(|meant| is_slip(name, meant)) else {
            return;
        };
        let what = side.name();
        let message = format!("component {} declares no {what} {}", quoted(&component.name), quoted(name));
        let mut one = Diagnostic::new(code, at, message).severity(Severity::Warning);
        if let Some(declared) = names(side, &component.services, &component.references).find(|own| *own == meant) {
            one = one.label(declared.location, "its own declaration");
        }
        one = one.suggest(replacing(name, meant), at, escaped(meant));
        one.rule = rule.or(one.rule);
        report.push(one.help("if its class has both, declare this one in the component as well"));
    }
}

/// True if a name may be meant for one like it: not where only numbers differ, or a word more.
fn is_slip(name: &str, meant: &str) -> bool {
    let without = |name: &str| name.replace(|c: char| c.is_ascii_digit(), "");
    name.len().abs_diff(meant.len()) <= 2 && without(name) != without(meant)
}

/// The names of the services, or of the references.
fn names<'a>(
    side: Side,
    services: &'a [ServiceElement],
    references: &'a [ReferenceElement],
) -> impl Iterator<Item = &'a Text> + use<'a> {
    let services = services.iter().filter(move |_| side == Side::Service).map(|one| &one.name);
    let references = references.iter().filter(move |_| side == Side::Reference).map(|one| &one.name);
    services.chain(references)
}

impl<'a> ForeignType<'a> {
    fn names(&self, side: Side) -> impl Iterator<Item = &'a str> + use<'a> {
        names(side, &self.described.services, &self.described.references).map(Text::as_str)
    }

    /// Reports a name that is not among those that the file has: where the class may have it all the same as a warning.
    /// A file that has nothing of the kind says nothing about a class.
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
        one = one.label(self.described.tag(), "its component type");
        if !self.is_whole {
            one = one
                .severity(Severity::Warning)
                .help(format!("if the class has it, add the {what} to the component type"));
        }
        one.rule = rule.or(one.rule);
        report.push(one);
    }
}

/// Checks the services and references that a component writes against what is known of it.
pub(crate) fn contracts(component: &ComponentElement, known: ForeignType<'_>, report: &mut Report<'_>) {
    for (side, code) in [(Side::Service, &codes::UNKNOWN_SERVICE), (Side::Reference, &codes::UNKNOWN_REFERENCE)] {
        let described: Vec<&str> = known.names(side).collect();
        for name in names(side, &component.services, &component.references) {
            let wrong = (&component.name, name.as_str(), name.location);
            known.lacks((code, None), side.name(), wrong, &described, report);
        }
    }
}

/// Checks the properties of a component that has no class here: where they come from, and what a file says of them.
pub(crate) fn properties<'a>(
    member: &Member<'a>,
    known: Option<ForeignType<'a>>,
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) {
    let component = member.component;
    for property in component.properties.iter().filter(|property| !property.name.is_empty()) {
        if known.is_none() && member.instance.is_none() && property.only_text().is_some() {
            // A text of whatever type.
            continue;
        }
        // Faults of its `source` are reported.
        let _ = parameters.taken(member, property, report);
        let Some(known) = known else { continue };
        let names: Vec<&str> = known.described.properties.iter().map(|one| one.name.as_str()).collect();
        let wrong = (&component.name, property.name.as_str(), property.name.location);
        known.lacks((&codes::UNKNOWN_PROPERTY, None), "property", wrong, &names, report);
    }
}

/// Makes warnings of missing files of components that are taken as given: they may come with the implementation.
pub(crate) fn lower_missing_files(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let given = fleet.members.iter().filter(|member| member.kind == Kind::Given);
    let properties = given.flat_map(|member| &member.component.properties);
    let places: HashSet<Location> = properties.filter_map(|one| Some(one.file()?.location)).collect();
    report.diagnostics().adjust(0, |one| {
        if one.code == &codes::FILE_NOT_FOUND && places.contains(&one.location) {
            one.severity = Severity::Warning;
        }
    });
}
