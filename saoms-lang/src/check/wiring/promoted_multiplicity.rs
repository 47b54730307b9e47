//! Multiplicities of promoted references, and references that must not be overridden.

use super::promotion::ReferenceId;
use crate::check::fleet::{Fleet, Kind};
use crate::check::report::{Report, list};
use crate::check::rules::multiplicity::of_class;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Multiplicity, Part, ReferenceElement};
use crate::source::Location;

/// References that are named in one message.
const SHOWN: usize = 3;

/// A reference that takes other numbers of targets than the one that promotes it allows.
struct Narrower<'f> {
    place: ReferenceId<'f>,
    takes: Multiplicity,
    severity: Severity,
}

/// Checks what a composite's reference promotes. What is wrong with several of them is told once, as one thing is to be
/// changed.
pub(crate) fn check<'f>(
    by: &ReferenceElement,
    found: impl Iterator<Item = ReferenceId<'f>>,
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) {
    let mut narrower: Vec<Narrower<'f>> = Vec::new();
    let mut fixed: Vec<(ReferenceId<'f>, Location)> = Vec::new();
    for place @ (member, name) in found {
        let own = fleet.members[member].component.reference(name);
        let Some((takes, is_known)) = takes(place, fleet) else { continue };
        let said = own.and_then(|own| own.non_overridable()).filter(|said| said.value && !takes.is_many());
        fixed.extend(said.map(|said| (place, said.location)));
        let Some(outer) = by.multiplicity() else { continue };
        // One that has a target already needs none from outside.
        let has_target = own.is_some_and(|own| !own.targets.is_empty());
        if outer.value.narrows(takes) || has_target && outer.value.is_many() <= takes.is_many() {
            continue;
        }
        // In SCA 1.0 files the two often differ, and other programs take the outer one: it is wrong where a class needs
        // its target.
        let is_error = fleet.members[member].composite.version.is_1_1() || is_known;
        let severity = if is_error { Severity::Error } else { Severity::Warning };
        narrower.push(Narrower { place, takes, severity });
    }
    if !fixed.is_empty() {
        report.push(overridden(by, &fixed, fleet));
    }
    if let (Some(outer), false) = (by.multiplicity(), narrower.is_empty()) {
        let (outer, at) = (outer.value, outer.location);
        report.push(widened(by, (outer, at), &narrower, fleet));
    }
}

/// The number of targets a reference of a component takes, as far as that is known, and whether its class is.
fn takes((member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> Option<(Multiplicity, bool)> {
    let own = fleet.members[member].component.reference(name);
    let class = fleet.class_of(member);
    let declared = class.and_then(|class| class.references.iter().find(|declared| declared.name == name));
    let given = own.and_then(|own| own.multiplicity()).map(|given| given.value);
    let takes = match declared {
        Some(declared) => given.unwrap_or(of_class(declared)),
        // The multiplicity is in a class that is not known here.
        None if fleet.members[member].kind == Kind::Given => given?,
        None => fleet.multiplicity_of((member, name)),
    };
    Some((takes, declared.is_some()))
}

fn overridden(by: &ReferenceElement, fixed: &[(ReferenceId<'_>, Location)], fleet: &Fleet<'_>) -> Diagnostic {
    let message = match fixed {
        [((member, name), _)] => {
            let component = quoted(&fleet.members[*member].component.name);
            format!("reference {} of component {component} must not be overridden", quoted(name))
        }
        _ => {
            let named: Vec<String> = fixed.iter().map(|(place, _)| uri(*place, fleet)).collect();
            format!("the references {} must not be overridden", shown(&named))
        }
    };
    let at = if by.name.is_empty() { by.tag() } else { by.name.location };
    let mut places: Vec<Location> = Vec::new();
    // Replicas say it in one place.
    for (_, place) in fixed {
        if places.len() < SHOWN && !places.contains(place) {
            places.push(*place);
        }
    }
    let one = Diagnostic::new(&codes::PROMOTED_FIXED, at, message);
    let one = places.into_iter().fold(one, |one, place| one.label(place, "said here"));
    match fixed {
        [_] => one.help("do not promote it, or leave `nonOverridable` out"),
        _ => one.help("do not promote them, or leave `nonOverridable` out"),
    }
}

fn widened(
    by: &ReferenceElement,
    (outer, at): (Multiplicity, Location),
    narrower: &[Narrower<'_>],
    fleet: &Fleet<'_>,
) -> Diagnostic {
    let message = match narrower {
        [Narrower { place: (member, name), takes, .. }] => format!(
            "{} promotes reference {} of component {}, which takes {}: {} does not narrow it",
            quoted(&by.name),
            quoted(name),
            quoted(&fleet.members[*member].component.name),
            quoted(takes.name()),
            quoted(outer.name())
        ),
        _ => {
            let named =
                narrower.iter().map(|one| format!("{} takes {}", uri(one.place, fleet), quoted(one.takes.name())));
            let named: Vec<String> = named.collect();
            format!(
                "{} promotes {} references that {} does not narrow: {}",
                quoted(&by.name),
                narrower.len(),
                quoted(outer.name()),
                shown(&named)
            )
        }
    };
    let severity = narrower.iter().map(|one| one.severity).max().unwrap_or(Severity::Error);
    let fits = |one: &Multiplicity| narrower.iter().all(|inner| one.narrows(inner.takes));
    let fitting: Vec<&str> = Multiplicity::ALL.into_iter().filter(fits).map(Multiplicity::name).collect();
    let one = Diagnostic::new(&codes::PROMOTED_MULTIPLICITY, at, message).severity(severity);
    match fitting[..] {
        [] => one.help("none fits all of them: promote them by several references"),
        _ => one.help(format!("it can be {}", list(fitting))),
    }
}

fn uri((member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> String {
    quoted(&format!("{}/{name}", fleet.members[member].component.name))
}

/// The first of several things.
fn shown(named: &[String]) -> String {
    match named {
        [most @ .., last] if named.len() <= SHOWN => format!("{} and {last}", most.join(", ")),
        _ => format!("{} and {} more", named[..SHOWN].join(", "), named.len() - SHOWN),
    }
}
