//! Interfaces of promoted services and references.

use super::offer::Offer;
use super::promotion::ReferenceId;
use super::uri::parts;
use crate::check::fleet::{Fleet, Kind};
use crate::check::report::Report;
use crate::check::rules::interface;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{ReferenceElement, ServiceElement};
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
            let promote = inner.references().find(|one| one.name == name.as_str())?.promote().first()?;
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
    if service.interface().is_some()
        && let Offer::Service(provider) = fleet.offer(member, name)
        && let Some(declared) = fleet.interface_of(provider)
    {
        interface::check(service.interface(), declared, &service.name, "ASM60005", report);
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
    if reference.interface().is_none() && found.len() < 2 {
        return true;
    }
    let interfaces = found.iter().filter_map(|(place, at)| {
        let interface = fleet.reference_interface(*place)?;
        Some((interface, *at))
    });
    let mut interfaces = interfaces;
    let Some((first, first_at)) = interfaces.next() else { return true };
    interface::check(reference.interface(), first, &reference.name, "ASM60012", report);
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
