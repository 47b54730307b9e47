//! The `<wire>` elements, and the references that they start from.

use std::collections::BTreeMap;

use super::target::target;
use super::unwired::DanglingNames;
use super::uri::{Uri, has_room, spread};
use crate::check::contracts::offer::{Offer, ReferenceId, parts};
use crate::check::fleet::{Fleet, Kind, Side};
use crate::check::options::Options;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, Edit, codes, quoted};
use crate::limits::Budget;
use crate::source::Text;
use crate::syntax::escaped;

/// A `<wire>` that starts from a reference.
#[derive(Clone, Copy)]
pub(crate) struct Wire<'f> {
    pub(crate) target: &'f Text,
    pub(crate) scope: usize,
    pub(crate) is_replacing: bool,
}

/// The `<wire>` elements of all composites by the reference they start from, whose name is empty where any may be
/// meant, and those that start nowhere.
pub(crate) fn wires<'f>(
    fleet: &'f Fleet<'_>,
    options: &Options,
    ends_left: &Budget,
    report: &mut Report<'_>,
) -> (BTreeMap<ReferenceId<'f>, Vec<Wire<'f>>>, DanglingNames<'f>) {
    let mut all: BTreeMap<ReferenceId<'f>, Vec<Wire<'f>>> = BTreeMap::new();
    let mut dangling = DanglingNames::default();
    for (place, unit) in fleet.units.iter().enumerate() {
        let scope = unit.scope;
        for wire in unit.composites.iter().flat_map(|composite| &composite.wires) {
            let (Some(source), Some(to)) = (&wire.source, &wire.target) else {
                dangling.add(scope, wire.source.as_ref(), fleet);
                continue;
            };
            if fleet.is_absent_wire(place, wire) {
                let _ = Uri::of(source, (2, Side::Reference), (scope, fleet), report);
                let _ = Uri::of(to, (3, Side::Service), (scope, fleet), report);
                continue;
            }
            let is_replacing = wire.replace.is_some_and(|replace| replace.value);
            if let Some(from) = backwards((source, to), scope, fleet) {
                let message = format!(
                    "this wire is reversed: {} offers a service, and {} is a reference",
                    quoted(source),
                    quoted(to)
                );
                let one = Diagnostic::new(&codes::UNKNOWN_WIRE_SOURCE, source.location, message);
                let swapped = [(source, to), (to, source)];
                let edit = |(one, other): (&Text, &Text)| Edit { location: one.location, replacement: escaped(other) };
                report.push(one.suggest_edits("swap `source` and `target`", swapped.map(edit).into()));
                let (_, name) = from;
                if has_room(ends_left, to, scope, fleet, report) {
                    for (one, _) in spread(to, scope, fleet) {
                        let Some(member) = fleet.find(scope, parts(&one).0) else { continue };
                        all.entry((member, name)).or_default().push(Wire { target: source, scope, is_replacing });
                    }
                }
                continue;
            }
            if !has_room(ends_left, source, scope, fleet, report) {
                continue;
            }
            for (one, _) in spread(source, scope, fleet) {
                let Some(from) = source_of(&one, source, scope, fleet, report) else {
                    dangling.add(scope, Some(source), fleet);
                    // Both ends can be wrong. All replicas of a group have the same faults.
                    if let Some((to, _)) = spread(to, scope, fleet).next() {
                        target(&to, (scope, None), None, (fleet, options), report);
                    }
                    continue;
                };
                all.entry(from).or_default().push(Wire { target: to, scope, is_replacing });
            }
        }
    }
    (all, dangling)
}

/// The component and the reference that are the target of a wire, where the source is a service. Of a group of replicas
/// it is the first.
fn backwards<'f>((source, to): (&Text, &'f Text), scope: usize, fleet: &'f Fleet<'_>) -> Option<ReferenceId<'f>> {
    let reference = parts(to).1?;
    let (first, _) = spread(to, scope, fleet).next()?;
    let ends = [source, &first].map(|end| fleet.find(scope, parts(end).0));
    let [Some(from), Some(member)] = ends else { return None };
    let is_reference = |member, name| fleet.reference_names(member).is_some_and(|names| names.contains(&name));
    let is_service = |member, name| matches!(fleet.offer(member, name), Offer::Service(_));
    let starts_at_service = match parts(source).1 {
        Some(service) => !is_reference(from, service) && is_service(from, service),
        // It could mean the only reference, and there is none.
        None => fleet.reference_names(from).is_some_and(|names| names.is_empty()),
    };
    let is_backwards = starts_at_service && is_reference(member, reference) && !is_service(member, reference);
    is_backwards.then_some((member, reference))
}

/// The component and the reference that a wire starts from; an empty name where any reference may be meant. `source` is
/// `written`, or one of the replicas that this stands for.
fn source_of<'f>(
    source: &Text,
    written: &'f Text,
    scope: usize,
    fleet: &'f Fleet<'_>,
    report: &mut Report<'_>,
) -> Option<ReferenceId<'f>> {
    let uri = Uri::of(source, (2, Side::Reference), (scope, fleet), report)?;
    let member = uri.member(source, (scope, None), fleet, None, report)?;
    let named = parts(written).1.unwrap_or_default();
    let Some(names) = fleet.reference_names(member) else {
        if let Some((name, at)) = &uri.part {
            let at = report.part(source, at.clone());
            fleet.unknown_name(member, Side::Reference, (&codes::UNKNOWN_WIRE_SOURCE, None), (name, at), report);
        }
        return (fleet.members[member].kind == Kind::Given).then_some((member, named));
    };
    let component = quoted(uri.component);
    match (&uri.part, &names[..]) {
        (Some((name, _)), names) if names.contains(name) => Some((member, named)),
        (Some((name, at)), names) => {
            let at = report.part(source, at.clone());
            let message = format!("component {component} has no reference {}", quoted(name));
            if fleet.offer(member, name) != Offer::Missing {
                let one = Diagnostic::new(&codes::UNKNOWN_WIRE_SOURCE, at, message);
                let help = format!("{} is a service: a wire goes from a reference to a service", quoted(name));
                report.push(one.help(help));
                return None;
            }
            let known = ("its references are", names.iter().copied());
            let one = report.unknown(&codes::UNKNOWN_WIRE_SOURCE, at, message, name, known);
            report.push(one);
            None
        }
        (None, [only]) => Some((member, *only)),
        (None, []) => {
            let message = format!("component {component} has no references");
            let one = Diagnostic::new(&codes::UNKNOWN_WIRE_SOURCE, source.location, message);
            report.push(one.help("a wire goes from a reference to a service"));
            None
        }
        (None, _) => {
            let message = format!("component {component} has several references");
            let help = format!("name one of {}: `{source}/...`", list(names.iter().copied()));
            report.push(Diagnostic::new(&codes::UNKNOWN_WIRE_SOURCE, source.location, message).help(help));
            None
        }
    }
}
