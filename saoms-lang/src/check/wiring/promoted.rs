//! What composites say of the services and references that they promote: interfaces, multiplicities, and that nothing
//! overrides them.

use crate::check::contracts::interface;
use crate::check::contracts::offer::{Offer, ReferenceId, parts};
use crate::check::fleet::{Fleet, Kind};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Multiplicity, Part, ReferenceElement, ServiceElement};
use crate::registry::InterfaceDeclaration;
use crate::source::Location;

/// A reference that is promoted, and where that is written.
pub(crate) type Found<'f> = (ReferenceId<'f>, Location);

impl Fleet<'_> {
    /// The interface of a reference, which the innermost class declares that it leads to.
    fn reference_interface(&self, (mut member, name): ReferenceId<'_>) -> Option<&InterfaceDeclaration> {
        let mut name = name.to_owned();
        // Each step leads one composite further in.
        loop {
            if let Some(class) = self.class_of(member) {
                let declared = class.references.iter().find(|declared| declared.name == name)?;
                return Some(&declared.interface);
            }
            let Kind::Composite(scope) = self.members[member].kind else { return None };
            let inner = self.inner(member)?;
            let promote = inner.references().find(|one| one.name == name.as_str())?.promote.first()?;
            let (component, part) = parts(promote);
            member = self.find(scope, component).or_else(|| self.group(scope, component)?.first().copied())?;
            name = match part {
                Some(part) => part.to_owned(),
                None => self.reference_names(member)?.first()?.to_string(),
            };
        }
    }
}

/// Checks the interface that a composite's service says.
pub(crate) fn service(
    service: &ServiceElement,
    (member, name): ReferenceId<'_>,
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) {
    if let Offer::Service(provider) = fleet.offer(member, name)
        && let Some(declared) = fleet.interface_of(provider)
    {
        interface::check(service.contract().interface.as_ref(), declared, &service.name, "ASM60005", report);
    }
}

/// Checks the interface that a composite's reference says, and that all that it promotes has one interface: one target
/// cannot serve two. Whether it has.
pub(crate) fn reference(
    reference: &ReferenceElement,
    found: &[Found<'_>],
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) -> bool {
    if reference.contract().interface.is_none() && found.len() < 2 {
        return true;
    }
    let mut interfaces = found.iter().filter_map(|(place, at)| Some((fleet.reference_interface(*place)?, *at)));
    let Some((first, first_at)) = interfaces.next() else { return true };
    interface::check(reference.contract().interface.as_ref(), first, &reference.name, "ASM60012", report);
    let Some((other, at)) = interfaces.find(|(other, _)| *other != first) else { return true };
    let message = format!(
        "reference {} of the composite promotes references with the interfaces {} and {}",
        quoted(&reference.name),
        quoted(&first.name),
        quoted(&other.name)
    );
    let one = Diagnostic::new(&codes::INTERFACE_DIFFERS, at, message).rule("ASM60008").label(first_at, "the first");
    report.push(one.help("promote each with its own reference: no service has both interfaces"));
    false
}

/// References that are named in one message.
const SHOWN: usize = 3;

/// A reference that takes other numbers of targets than the one that promotes it allows.
struct Narrower<'f> {
    place: ReferenceId<'f>,
    takes: Multiplicity,
    severity: Severity,
}

/// Checks the multiplicities of what a composite's reference promotes, and that it may be overridden. What is wrong
/// with several of them is reported once, as one thing is to be changed.
pub(crate) fn multiplicities<'f>(
    by: &ReferenceElement,
    found: impl Iterator<Item = ReferenceId<'f>>,
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) {
    let mut narrower: Vec<Narrower<'f>> = Vec::new();
    let mut fixed: Vec<(ReferenceId<'f>, Location)> = Vec::new();
    for place @ (member, name) in found {
        let own = fleet.members[member].component.reference(name);
        // Of a class that is not found, which is reported, a reference takes one target as SCA says.
        let usual = (fleet.members[member].kind == Kind::Nothing).then_some(Multiplicity::One);
        let Some(takes) = fleet.multiplicity(place).or(usual) else { continue };
        let said = own.and_then(|own| own.non_overridable).filter(|said| said.value && !takes.is_many());
        fixed.extend(said.map(|said| (place, said.location)));
        let Some(outer) = by.multiplicity else { continue };
        // One that has a target already needs none from outside.
        let has_target = own.is_some_and(|own| !own.targets.is_empty());
        if outer.value.narrows(takes) || has_target && outer.value.is_many() <= takes.is_many() {
            continue;
        }
        // In SCA 1.0 files the two often differ, and other programs take the outer one: it is wrong where a class needs
        // its target.
        let is_error = fleet.members[member].composite.version.is_1_1() || fleet.class_of(member).is_some();
        let severity = if is_error { Severity::Error } else { Severity::Warning };
        narrower.push(Narrower { place, takes, severity });
    }
    if !fixed.is_empty() {
        report.push(overridden(by, &fixed, fleet));
    }
    if let (Some(outer), false) = (by.multiplicity, narrower.is_empty()) {
        let (outer, at) = (outer.value, outer.location);
        report.push(widened(by, (outer, at), &narrower, fleet));
    }
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
    let one = places.into_iter().fold(one, |one, place| one.label(place, "`nonOverridable` is set here"));
    match fixed {
        [_] => one.help("do not promote it, or remove `nonOverridable`"),
        _ => one.help("do not promote them, or remove `nonOverridable`"),
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
            "the multiplicity {} of {} is wider than {} of the promoted reference {} of component {}",
            quoted(outer.name()),
            quoted(&by.name),
            quoted(takes.name()),
            quoted(name),
            quoted(&fleet.members[*member].component.name)
        ),
        _ => {
            let named =
                narrower.iter().map(|one| format!("{} takes {}", uri(one.place, fleet), quoted(one.takes.name())));
            let named: Vec<String> = named.collect();
            format!(
                "{} promotes {} references whose multiplicity is narrower than {}: {}",
                quoted(&by.name),
                narrower.len(),
                quoted(outer.name()),
                shown(&named)
            )
        }
    };
    let severity = narrower.iter().map(|one| one.severity).max().unwrap_or(Severity::Error);
    let fits = |one: &Multiplicity| narrower.iter().all(|inner| one.narrows(inner.takes));
    let fitting: Vec<String> = Multiplicity::ALL.into_iter().filter(fits).map(|one| quoted(one.name())).collect();
    let one = Diagnostic::new(&codes::PROMOTED_MULTIPLICITY, at, message).severity(severity);
    match fitting[..] {
        [] => one.help("promote them with several references: no multiplicity fits all of them"),
        _ => one.help(format!("it can be {}", fitting.join(" or "))),
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
