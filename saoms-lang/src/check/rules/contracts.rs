//! Services and references of components, held against their classes.

use std::collections::HashMap;
use std::fmt;

use crate::check::fleet::Fleet;
use crate::check::fleet::classes::ClassIndex;
use crate::check::report::{Report, replacing};
use crate::check::wiring::offer::Offer;
use crate::diagnostic::{Code, Diagnostic, Edit, codes, quoted};
use crate::model::{
    Binding, ComponentElement, InterfaceElement, InterfaceKind, Multiplicity, Part, ReferenceElement,
    ServiceElement,
};
use crate::registry::{InterfaceDeclaration, ReferenceDeclaration};
use crate::source::{Location, Text};
use crate::syntax::{Document, escaped};

/// Checks the services and references of every component.
pub(crate) fn check(fleet: &Fleet<'_>, classes: &[ClassIndex<'_>], report: &mut Report<'_>) {
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        let component = member.component;
        if component.services.len() > 1 {
            let names = component.services.iter().map(|service| &service.name);
            repeated(names, component, "service", "ASM50002", report);
        }
        if !component.services.is_empty() {
            services(place, fleet, classes, report);
        }
        if component.references.len() > 1 {
            let names = component.references.iter().map(|reference| &reference.name);
            repeated(names, component, "reference", "ASM50007", report);
        }
        if !component.references.is_empty() {
            references(place, fleet, classes, report);
        }
    }
    report.about_all();
}

/// The implementation of a component, for messages.
struct Whose<'w>(&'static str, &'w str);

impl fmt::Display for Whose<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} {}", self.0, quoted(self.1))
    }
}

fn whose<'w>(member: usize, fleet: &Fleet<'w>, classes: &'w [ClassIndex<'_>]) -> Option<Whose<'w>> {
    if let Some(class) = fleet.class_of(member, classes) {
        return Some(Whose("class", class.class.name()));
    }
    Some(Whose("composite", &fleet.inner(member)?.main().name))
}

fn services(member: usize, fleet: &Fleet<'_>, classes: &[ClassIndex<'_>], report: &mut Report<'_>) {
    let Some(whose) = whose(member, fleet, classes) else { return };
    for service in &fleet.members[member].component.services {
        let name = &service.name;
        match fleet.offer(member, name, classes) {
            Offer::Service(provider) => {
                if let Some(declared) = fleet.interface_of(provider, classes) {
                    interface(service.interface(), declared, name, "ASM50004", report);
                }
            }
            Offer::Open => {}
            Offer::Missing => {
                let is_reference = fleet
                    .reference_names(member, classes)
                    .is_some_and(|names| names.contains(&name.as_str()));
                if is_reference {
                    swapped(service, &whose, &fleet.members[member].composite.document, report);
                    continue;
                }
                let names = fleet.service_names(member, classes).unwrap_or_default();
                unknown(&codes::UNKNOWN_SERVICE, "service", name, &whose, names.iter().copied(), report);
            }
        }
        if fleet.class_of(member, classes).is_some() {
            bindings(service.bindings(), "the service can be called within the program alone", report);
        }
    }
}

fn references(member: usize, fleet: &Fleet<'_>, classes: &[ClassIndex<'_>], report: &mut Report<'_>) {
    let class = fleet.class_of(member, classes);
    for reference in &fleet.members[member].component.references {
        let name = &reference.name;
        let declared =
            class.and_then(|class| class.references.iter().find(|known| known.name == name.as_str()));
        // Of most nothing is said but where they lead.
        if declared.is_some() && reference.contract.is_none() && reference.details.is_none() {
            continue;
        }
        let Some(whose) = whose(member, fleet, classes) else { return };
        let inner =
            fleet.inner(member).and_then(|inner| inner.references().find(|known| known.name == *name.value));
        if let Some(declared) = declared {
            interface(reference.interface(), &declared.interface, name, "ASM50011", report);
            narrows(reference, of_class(declared), &whose, report);
            bindings(reference.bindings(), "calls through it fail", report);
        } else if let Some(inner) = inner {
            let own = inner.multiplicity().map_or(Multiplicity::One, |own| own.value);
            narrows(reference, own, &whose, report);
        } else {
            let names = fleet.reference_names(member, classes).unwrap_or_default();
            let inner = fleet.inner(member).filter(|_| names.is_empty() && !name.is_empty());
            if let Some(inner) = inner {
                let message = format!("{whose} has no reference {}", quoted(name));
                let one = Diagnostic::new(&codes::UNKNOWN_REFERENCE, name.location, message);
                let promoting =
                    format!("`<reference name=\"{}\" promote=\"COMPONENT/reference\"/>`", escaped(name));
                let help =
                    format!("it has those of its components that it promotes: write {promoting} in it");
                report.push(one.label(inner.main().name.location, "this one").help(help));
                continue;
            }
            unknown(&codes::UNKNOWN_REFERENCE, "reference", name, &whose, names.iter().copied(), report);
        }
    }
}

fn repeated<'a>(
    names: impl ExactSizeIterator<Item = &'a Text> + Clone,
    component: &ComponentElement,
    what: &str,
    rule: &'static str,
    report: &mut Report<'_>,
) {
    /// So many are compared with each other sooner than they are in a table.
    const FEW: usize = 8;
    let are_own = || {
        let mut later = names.clone();
        std::iter::from_fn(|| later.next().map(|name| (name, later.clone())))
            .all(|(name, mut later)| name.is_empty() || later.all(|other| other.value != name.value))
    };
    if names.len() <= FEW && are_own() {
        return;
    }
    let mut seen: HashMap<&str, Location> = HashMap::new();
    for name in names.filter(|name| !name.is_empty()) {
        if let Some(first) = seen.get(name.as_str()) {
            let message = format!("component {} has two {what}s {}", quoted(&component.name), quoted(name));
            let one = Diagnostic::new(&codes::CONTRACT_REPEATED, name.location, message);
            report.push(one.rule(rule).label(*first, "the first").help("keep one of them"));
        } else {
            seen.insert(name, name.location);
        }
    }
}

/// Reports a service that is a reference, for which its `target` is no further mistake.
fn swapped(service: &ServiceElement, whose: &Whose<'_>, document: &Document, report: &mut Report<'_>) {
    let element = service.origin.element(document);
    if let Some(target) = element.attribute("target") {
        report.withdraw(&codes::UNKNOWN_ATTRIBUTE, target.name_span().in_file(document.file()));
    }
    let tag = match element.prefix() {
        Some(prefix) => format!("{prefix}:reference"),
        None => "reference".to_owned(),
    };
    let spans = [Some(element.name_span()), element.end_name_span()].into_iter().flatten();
    let edits = spans.map(|span| Edit { location: span.in_file(document.file()), replacement: tag.clone() });
    let message = format!("{} of {whose} is a reference, and no service", quoted(&service.name));
    let one = Diagnostic::new(&codes::UNKNOWN_SERVICE, service.name.location, message);
    report.push(one.suggest_edits(replacing(element.name(), &tag), edits.collect()));
}

fn unknown<'n>(
    code: &'static Code,
    what: &str,
    name: &Text,
    whose: &Whose<'_>,
    known: impl Iterator<Item = &'n str> + Clone,
    report: &mut Report<'_>,
) {
    if name.is_empty() {
        return;
    }
    let message = format!("{whose} has no {what} {}", quoted(name));
    let one = report.unknown(code, name.location, message, name, (&format!("its {what}s are"), known));
    report.push(one);
}

/// True if the interface that a file names is that of the class.
pub(crate) fn interface(
    given: Option<&InterfaceElement>,
    declared: &InterfaceDeclaration,
    of: &str,
    rule: &'static str,
    report: &mut Report<'_>,
) {
    let Some(given) = given else { return };
    let named = given.interface.as_ref();
    if named.is_some_and(|name| name.as_str() == declared.name && can_name(given.kind)) {
        return;
    }
    let (of, expected) = (quoted(of), quoted(&declared.name));
    let one = match &given.interface {
        Some(name) if can_name(given.kind) => {
            let message = format!("the interface of {of} is {expected}, not {}", quoted(name));
            Diagnostic::new(&codes::INTERFACE_DIFFERS, name.location, message).suggest(
                replacing(name, &declared.name),
                name.location,
                escaped(&declared.name),
            )
        }
        // One without its name, which is reported.
        None if matches!(given.kind, InterfaceKind::Java | InterfaceKind::Rust) => return,
        _ => {
            let message = format!("the interface of {of} is {expected}, which this element cannot name");
            Diagnostic::new(&codes::INTERFACE_DIFFERS, given.tag(), message)
                .help(format!("write `<interface.java interface=\"{}\"/>`, or leave it out", declared.name))
        }
    };
    report.push(one.rule(rule));
}

/// True if elements of this kind can name an interface of a class.
const fn can_name(kind: InterfaceKind) -> bool {
    matches!(kind, InterfaceKind::Java | InterfaceKind::Rust | InterfaceKind::Other)
}

/// The number of targets a reference of the class can have.
pub(crate) fn of_class(declared: &ReferenceDeclaration) -> Multiplicity {
    match (declared.optional, declared.many) {
        (true, false) => Multiplicity::ZeroOrOne,
        (false, false) => Multiplicity::One,
        (true, true) => Multiplicity::Any,
        (false, true) => Multiplicity::OneOrMore,
    }
}

/// Checks that the multiplicity that a component gives narrows that of what implements it.
pub(crate) fn narrows(
    reference: &ReferenceElement,
    own: Multiplicity,
    whose: &dyn fmt::Display,
    report: &mut Report<'_>,
) {
    let Some(given) = reference.multiplicity() else { return };
    if given.value.narrows(own) {
        return;
    }
    let message = format!(
        "the multiplicity of {} is {} in {whose}: {} does not narrow it",
        quoted(&reference.name),
        quoted(own.name()),
        quoted(given.value.name())
    );
    let one = Diagnostic::new(&codes::MULTIPLICITY_WIDER, given.location, message);
    let narrower = Multiplicity::ALL.into_iter().filter(|one| one.narrows(own));
    let names: Vec<&str> = narrower.map(Multiplicity::name).collect();
    report.push(match own {
        Multiplicity::One => one.help("leave `multiplicity` out: `1..1` is the default"),
        _ => one.help(format!(
            "it can be {}",
            names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(" or ")
        )),
    });
}

fn bindings(bindings: &[Binding], so: &str, report: &mut Report<'_>) {
    for binding in bindings {
        if binding.is_sca && binding.kind == "sca" {
            continue;
        }
        let message = format!("{} is not served: {so}", quoted(&format!("binding.{}", binding.kind)));
        let one = Diagnostic::new(&codes::BINDING_NOT_SERVED, binding.tag(), message);
        report.push(
            one.help(
                "remove it; other machines are reached through topics and the `url` of a message broker",
            ),
        );
    }
}
