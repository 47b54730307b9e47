//! Promotions: the services and references that composites take from their components.

use std::collections::{HashMap, HashSet};

use super::ends::WebEnd;
use super::promoted::{self, Found};
use super::unwired::DanglingNames;
use super::uri::{Uri, spread};
use crate::check::contracts::offer::{ReferenceId, parts};
use crate::check::contracts::repeated_names::Owner;
use crate::check::fleet::{Fleet, Kind, Side, Unit};
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Binding, Part, ReferenceElement};
use crate::source::Text;

/// The references that are promoted.
#[derive(Default)]
pub(crate) struct Promoted<'f> {
    /// By composites that run by themselves, with the targets that these give them: nothing else around them can.
    pub(crate) outermost: HashMap<ReferenceId<'f>, Vec<&'f Text>>,
    /// The services of the web to which these lead.
    pub(crate) outermost_web: HashMap<ReferenceId<'f>, Vec<WebEnd<'f>>>,
    /// By composites that implement components: to these references of theirs.
    pub(crate) to: HashMap<ReferenceId<'f>, Vec<ReferenceId<'f>>>,
    /// Those that one composite's reference promotes together although their interfaces differ, which is reported.
    pub(crate) differing: HashSet<ReferenceId<'f>>,
    /// Names of promoted parts that are not there, which is reported.
    pub(crate) dangling: DanglingNames<'f>,
}

/// Checks that what composites promote exists, and that their services and references have names of their own.
pub(crate) fn check<'f>(fleet: &'f Fleet<'_>, report: &mut Report<'_>) -> Promoted<'f> {
    let mut all = Promoted::default();
    // What is wrong where a component is implemented counts, and is said once.
    let is_outermost = |unit: &&Unit<'_>| fleet.scopes[unit.scope].owner.is_none();
    let inner = fleet.units.iter().filter(|unit| !is_outermost(unit));
    for unit in inner.chain(fleet.units.iter().filter(is_outermost)) {
        // No component takes what a composite offers that runs by itself: other programs run one of SCA 1.0 with faults
        // in that. One that is written for components of this one is another matter, and so is one that implements one.
        let is_own = || fleet.scopes[unit.scope].members.iter().any(|member| fleet.class_of(*member).is_some());
        let is_1_0 = || unit.composites.iter().all(|composite| !composite.version.is_1_1());
        let is_lenient = is_outermost(&unit) && is_1_0() && !is_own();
        let most = if is_lenient { Severity::Warning } else { Severity::Error };
        report.within(most, None, |report| all.add(unit, fleet, report));
    }
    all
}

impl<'f> Promoted<'f> {
    /// Adds what a composite promotes. Faults are reported.
    fn add(&mut self, unit: &'f Unit<'_>, fleet: &'f Fleet<'_>, report: &mut Report<'_>) {
        let owner = Owner {
            name: &|| "the composite".to_owned(),
            code: &codes::COMPOSITE_PART_REPEATED,
            severity: Severity::Error,
            help: "give each its own name",
        };
        owner.check("services", "ASM60003", unit.services().map(|one| &one.name), report);
        owner.check("references", "ASM60006", unit.references().map(|one| &one.name), report);
        for (service, promote) in unit.services().filter_map(|one| Some((one, one.promote.as_ref()?))) {
            if let Some(found) = find((promote, promote), Side::Service, unit, fleet, report) {
                promoted::service(service, found, fleet, report);
            }
        }
        unit.references().for_each(|reference| self.reference(reference, unit, fleet, report));
    }

    /// Adds what a composite's reference promotes.
    fn reference(
        &mut self,
        reference: &'f ReferenceElement,
        unit: &'f Unit<'_>,
        fleet: &'f Fleet<'_>,
        report: &mut Report<'_>,
    ) {
        if reference.promote.is_empty() {
            self.dangling.add(unit.scope, None, fleet);
        }
        let mut found: Vec<Found<'f>> = Vec::new();
        for promote in &reference.promote {
            for (text, _) in spread(promote, unit.scope, fleet) {
                match find((&text, promote), Side::Reference, unit, fleet, report) {
                    Some(one) => found.push((one, text.location)),
                    None => {
                        // Replicas have the same references.
                        self.dangling.add(unit.scope, Some(promote), fleet);
                        break;
                    }
                }
            }
        }
        promoted::multiplicities(reference, found.iter().map(|(inner, _)| *inner), fleet, report);
        let is_one = promoted::reference(reference, &found, fleet, report);
        // What is taken as given wires itself.
        let found = found.into_iter().map(|(inner, _)| inner);
        let found: Vec<ReferenceId<'f>> =
            found.filter(|(member, _)| fleet.members[*member].kind != Kind::Given).collect();
        if !is_one {
            self.differing.extend(&found);
        }
        if let Some(owner) = fleet.scopes[unit.scope].owner {
            for inner in found {
                self.to.entry(inner).or_default().push((owner, &reference.name));
            }
            return;
        }
        let has_address = || has_address(&reference.contract().bindings);
        let needs_target = || found.iter().any(|inner| needs_target(*inner, fleet));
        if reference.targets.is_empty() && !has_address() && needs_target() {
            unwired(reference, report);
        }
        for inner in found {
            self.outermost_web.entry(inner).or_default().extend(WebEnd::of(reference));
            self.outermost.entry(inner).or_default().extend(&reference.targets);
        }
    }
}

/// True if a binding says where calls go, so that nothing else has to.
pub(super) fn has_address(bindings: &[Binding]) -> bool {
    bindings.iter().any(|binding| !(binding.is_sca && binding.kind == "sca"))
}

/// True if the reference of a component comes to that of a class, by nothing that has an address of its own.
fn needs_target(place: ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
    let mut waiting = vec![place];
    let mut seen = HashSet::new();
    while let Some((member, name)) = waiting.pop() {
        if !seen.insert((member, name)) {
            continue;
        }
        let own = fleet.members[member].component.reference(name);
        if own.is_some_and(|own| has_address(&own.contract().bindings)) {
            continue;
        }
        let Some(inner) = fleet.inner(member) else {
            if fleet.class_of(member).is_some() {
                return true;
            }
            continue;
        };
        for reference in inner.references().filter(|one| one.name == name && !has_address(&one.contract().bindings)) {
            for promote in &reference.promote {
                let (component, part) = parts(promote);
                let Some(member) = fleet.find(inner.scope, component) else { continue };
                let only = || match &fleet.members[member].component.references[..] {
                    [only] => Some(only.name.as_str()),
                    _ => None,
                };
                waiting.extend(part.or_else(only).map(|name| (member, name)));
            }
        }
    }
    false
}

fn unwired(reference: &ReferenceElement, report: &mut Report<'_>) {
    let message = format!(
        "reference {} of the composite is not wired to a service: calls through it fail",
        quoted(&reference.name)
    );
    let at = if reference.name.is_empty() { reference.tag() } else { reference.name.location };
    let one = Diagnostic::new(&codes::PROMOTED_UNWIRED, at, message);
    report.push(one.help(
        "wire the component's reference inside the composite: a composite that runs by itself has nothing around it",
    ));
}

/// The name of what a URI promotes of a component that is taken as given, as far as it is written anywhere. Faults are
/// reported.
fn find_given<'f>(
    text: &Text,
    uri: &Uri<'_>,
    member: usize,
    side: Side,
    fleet: &'f Fleet<'_>,
    report: &mut Report<'_>,
) -> Option<&'f str> {
    let known = fleet.written_names(member, side);
    if let Some((name, at)) = &uri.part {
        let at = report.part(text, at.clone());
        let code = (&codes::UNKNOWN_PROMOTED, Some(side.rule()));
        fleet.unknown_name(member, side, code, (name, at), report);
        return known.into_iter().find(|known| known == name);
    }
    match known[..] {
        [only] => Some(only),
        _ => None,
    }
}

/// Reports a service that promotes a reference of replicas: it is to be one, too.
fn is_of_replicas(uri: &Uri<'_>, (scope, written): (usize, &Text), fleet: &Fleet<'_>, report: &mut Report<'_>) -> bool {
    let first = fleet.group(scope, uri.component).and_then(|group| group.first().copied());
    let Some((first, (name, at))) = first.zip(uri.part.as_ref()) else { return false };
    if !fleet.reference_names(first).is_some_and(|names| names.contains(name)) {
        return false;
    }
    let message = format!("component {} has no service {}", quoted(uri.component), quoted(name));
    let one = Diagnostic::new(&codes::UNKNOWN_PROMOTED, report.part(written, at.clone()), message);
    let help = format!("{} is a reference: promote it with `<reference ...>`", quoted(name));
    report.push(one.rule(Side::Service.rule()).help(help));
    true
}

/// The part that a URI promotes, that of one of the replicas for which it is written. Faults are reported.
fn find<'f>(
    (text, written): (&Text, &Text),
    side: Side,
    unit: &Unit<'_>,
    fleet: &'f Fleet<'_>,
    report: &mut Report<'_>,
) -> Option<ReferenceId<'f>> {
    let uri = Uri::of(text, (2, side), (unit.scope, fleet), report)?;
    if side == Side::Service && is_of_replicas(&uri, (unit.scope, written), fleet, report) {
        return None;
    }
    let member = uri.member(text, (unit.scope, None), fleet, Some(side.rule()), report)?;
    let (services, references) = (fleet.service_names(member), fleet.reference_names(member));
    let (names, other, others) = match side {
        Side::Service => (services, "reference", references),
        Side::Reference => (references, "service", services),
    };
    let Some(names) = names else {
        return find_given(text, &uri, member, side, fleet, report).map(|name| (member, name));
    };
    let (what, component) = (side.name(), quoted(parts(written).0));
    let only = match side {
        Side::Service => fleet.only_service(member),
        Side::Reference => (names.len() == 1).then(|| names[0]),
    };
    let code = &codes::UNKNOWN_PROMOTED;
    let one = match (&uri.part, only) {
        (Some((name, at)), _) => {
            if let Some(name) = names.iter().find(|known| *known == name) {
                return Some((member, name));
            }
            let message = format!("component {component} has no {what} {}", quoted(name));
            let known = (&*format!("its {what}s are"), names.iter().copied());
            // What is written of a group of replicas differs in its component alone.
            let at = report.part(written, written.len().saturating_sub(text.len() - at.start)..written.len());
            let one = report.unknown(code, at, message, name, known);
            match others.is_some_and(|names| names.contains(name)) {
                true => one.help(format!("{} is a {other}: promote it with `<{other} ...>`", quoted(name))),
                false => one,
            }
        }
        (None, Some(only)) => return Some((member, only)),
        (None, None) if names.is_empty() => {
            Diagnostic::new(code, text.location, format!("component {component} has no {what}s to promote"))
        }
        (None, None) => {
            let message = format!("component {component} has several {what}s: name the one to promote");
            let help = format!("write `{text}/` and one of {}", list(names));
            Diagnostic::new(code, text.location, message).help(help)
        }
    };
    report.push(one.rule(side.rule()));
    None
}
