//! What the services and references of composites say, held against what they promote.

use super::classes::ClassIndex;
use super::contracts;
use super::fleet::{Fleet, Kind};
use super::offer::Offer;
use super::promote::Place;
use super::report::Report;
use super::target::parts;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Reference, Service, Version};
use crate::registry::InterfaceDeclaration;
use crate::source::Location;

/// A reference that is promoted, and where that is written.
pub(super) type Found<'f> = (Place<'f>, Location);

impl Fleet<'_> {
    /// The interface of a reference, which the innermost class declares that it leads to.
    fn reference_interface<'c>(
        &self,
        (mut member, name): Place<'_>,
        classes: &'c [ClassIndex<'_>],
    ) -> Option<&'c InterfaceDeclaration> {
        let mut name = name.to_owned();
        // Each step leads one composite further in.
        loop {
            if let Some(class) = self.class_of(member, classes) {
                let declared = class.references.iter().find(|declared| declared.name == name)?;
                return Some(&declared.interface);
            }
            let Kind::Composite(scope) = self.members[member].kind else { return None };
            let inner = self.inner(member)?;
            let promote = inner.references().find(|one| one.name == name.as_str())?.promote().first()?;
            let (component, part) = parts(promote);
            member =
                self.find(scope, component).or_else(|| self.group(scope, component)?.first().copied())?;
            name = match part {
                Some(part) => part.to_owned(),
                None => self.reference_names(member, classes)?.first()?.to_string(),
            };
        }
    }

    /// Whether the implementation of a component wires its reference, as far as that is written.
    fn is_wired_by_impl(&self, (member, name): Place<'_>) -> bool {
        let own = self.members[member].component.reference(name);
        let described = self.component_type(member);
        let described = described.and_then(|one| one.references.iter().find(|one| one.name == name));
        let inner = self.inner(member).and_then(|inner| inner.references().find(|one| one.name == name));
        let mut all = [own, described, inner].into_iter().flatten();
        all.find_map(Reference::wired_by_impl).is_some_and(|wired| wired.value)
    }
}

/// Checks the interface that a composite's service says.
pub(super) fn service(
    service: &Service,
    (member, name): Place<'_>,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) {
    if service.interface().is_some()
        && let Offer::Service(provider) = fleet.offer(member, name, classes)
        && let Some(declared) = fleet.interface_of(provider, classes)
    {
        contracts::interface(service.interface(), declared, &service.name, "ASM60005", report);
    }
}

/// Checks the interface that a composite's reference says, and that all that it promotes has one interface: one target cannot serve two. Whether
/// it has.
pub(super) fn reference(
    reference: &Reference,
    found: &[Found<'_>],
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) -> bool {
    if reference.interface().is_none() && found.len() < 2 {
        return true;
    }
    let interfaces = found.iter().filter_map(|(place, at)| {
        let interface = fleet.reference_interface(*place, classes)?;
        Some((interface, *at))
    });
    let mut interfaces = interfaces;
    let Some((first, first_at)) = interfaces.next() else { return true };
    contracts::interface(reference.interface(), first, &reference.name, "ASM60012", report);
    let Some((other, at)) = interfaces.find(|(other, _)| *other != first) else { return true };
    let message = format!(
        "reference {} of the composite promotes references with the interfaces {} and {}",
        quoted(&reference.name),
        quoted(&first.name),
        quoted(&other.name)
    );
    report.push(
        Diagnostic::new(&codes::INTERFACE_DIFFERS, at, message)
            .rule("ASM60008")
            .label(first_at, "the first")
            .help("promote each by a reference of its own: no service has both interfaces"),
    );
    false
}

/// Checks that all that a composite's reference promotes is wired by its implementation, or nothing is, as the reference says.
pub(super) fn wired(
    reference: &Reference,
    found: &[Found<'_>],
    version: Version,
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) {
    let severity = if version.is_1_1() { Severity::Error } else { Severity::Warning };
    let is_wired = |place: &Place<'_>| fleet.is_wired_by_impl(*place);
    let one = if let Some(said) = reference.wired_by_impl() {
        let Some(((_, name), other)) = found.iter().find(|(place, _)| is_wired(place) != said.value) else {
            return;
        };
        let message = format!(
            "reference {} of the composite says `wiredByImpl=\"{}\"`, and promotes reference {} that says otherwise",
            quoted(&reference.name),
            said.value,
            quoted(name)
        );
        Diagnostic::new(&codes::WIRED_BY_IMPLEMENTATION, said.location, message)
            .rule("ASM60036")
            .label(*other, "promoted here")
    } else {
        let Some(((first, first_at), rest)) = found.split_first() else { return };
        let Some((_, at)) = rest.iter().find(|(place, _)| is_wired(place) != is_wired(first)) else { return };
        let message = format!(
            "reference {} of the composite promotes a reference that its implementation wires, and one that it does not",
            quoted(&reference.name)
        );
        Diagnostic::new(&codes::WIRED_BY_IMPLEMENTATION, *at, message)
            .rule("ASM60035")
            .label(*first_at, "the first")
    };
    report.push(one.severity(severity).help("give all of them one `wiredByImpl`, or promote them apart"));
}
