//! What URIs such as `Robot001/move` stand for.

use std::ops::Range;

use super::classes::ClassIndex;
use super::fleet::Fleet;
use super::report::{Report, escaped, list, replacing};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::registry::InterfaceDeclaration;
use crate::source::Text;

/// A service of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Provider {
    pub(super) member: usize,
    /// The place of the service in the class.
    pub(super) service: usize,
}

/// The parts of `component/part/binding`, each with its bytes.
pub(super) struct Uri<'t> {
    pub(super) component: &'t str,
    pub(super) part: Option<(&'t str, Range<usize>)>,
    pub(super) binding: Option<(&'t str, Range<usize>)>,
}

impl<'t> Uri<'t> {
    /// Splits a URI of at most `most` parts; another one is reported.
    pub(super) fn of(text: &'t Text, most: usize, report: &mut Report<'_>) -> Option<Self> {
        let mut start = 0;
        let mut parts = text.split('/').map(|part| {
            let at = start..start + part.len();
            start = at.end + 1;
            (part, at)
        });
        let (component, _) = parts.next()?;
        let uri = Self { component, part: parts.next(), binding: parts.next() };
        let has_more = parts.next().is_some() || (most < 3 && uri.binding.is_some());
        let inner = [uri.part.as_ref(), uri.binding.as_ref()];
        if component.is_empty() || inner.into_iter().flatten().any(|(part, _)| part.is_empty()) || has_more {
            let form = if most < 3 {
                "`component` or `component/name`"
            } else {
                "`component`, `component/service` or `component/service/binding`"
            };
            let message = format!("{} has the wrong form", quoted(text));
            report.push(
                Diagnostic::new(&codes::URI_MALFORMED, text.location, message).help(format!("write {form}")),
            );
            return None;
        }
        Some(uri)
    }

    /// The component, which has to exist.
    pub(super) fn member(&self, text: &Text, fleet: &Fleet<'_>, report: &mut Report<'_>) -> Option<usize> {
        let found = fleet.find(self.component);
        if found.is_none() {
            let message = format!("there is no component {}", quoted(self.component));
            let at = report.part(text, 0..self.component.len());
            let known = ("the components are", fleet.names());
            let one = report.unknown(&codes::UNKNOWN_COMPONENT, at, message, self.component, known);
            report.push(one);
        }
        found
    }
}

/// The service that a target leads to, for a reference with this interface. Faults are reported.
///
/// Without the name of a service the component has to have exactly one with the interface.
pub(super) fn provider(
    text: &Text,
    interface: &InterfaceDeclaration,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) -> Option<Provider> {
    let uri = Uri::of(text, 3, report)?;
    let member = uri.member(text, fleet, report)?;
    let class = fleet.class_of(member, classes)?;
    let component = fleet.members[member].component;
    let names = || class.services.iter().map(|service| service.name.as_str());
    let Some((name, at)) = uri.part.clone() else {
        return only_service(text, member, interface, class, report);
    };
    let Some(service) = class.services.iter().position(|service| service.name == name) else {
        let at = report.part(text, at);
        let message = format!("component {} has no service {}", quoted(&component.name), quoted(name));
        let known = ("its services are", names());
        let one = report.unknown(&codes::UNKNOWN_TARGET_SERVICE, at, message, name, known);
        report.push(one);
        return None;
    };
    let found = &class.services[service].interface;
    if found != interface {
        let at = report.part(text, at);
        let message = format!(
            "service {} of component {} has the interface {}, and the reference needs {}",
            quoted(name),
            quoted(&component.name),
            quoted(&found.name),
            quoted(&interface.name)
        );
        let one = Diagnostic::new(&codes::WIRE_INTERFACE, at, message);
        let fitting = class.services.iter().find(|service| service.interface == *interface);
        report.push(match fitting {
            Some(fitting) => one.suggest(replacing(name, &fitting.name), at, escaped(&fitting.name)),
            None => one.help(offers(class, interface)),
        });
        return None;
    }
    if let Some((binding, at)) = &uri.binding {
        let declared = component.service(name).map_or(&[][..], |service| &service.bindings);
        // A binding without a name has that of its service, and a service without bindings has one of SCA.
        let named = |known: &crate::model::Binding| {
            known.name.as_ref().map_or(name, |name| name.as_str()) == *binding
        };
        if !(declared.iter().any(named) || declared.is_empty() && *binding == name) {
            let at = report.part(text, at.clone());
            let message = format!(
                "service {} of component {} has no binding {}",
                quoted(name),
                quoted(&component.name),
                quoted(binding)
            );
            let known = declared.iter().map(|known| known.name.as_ref().map_or(name, |name| name.as_str()));
            let known: Vec<&str> = if declared.is_empty() { vec![name] } else { known.collect() };
            let known = ("its bindings are", known.iter().copied());
            let one = report.unknown(&codes::UNKNOWN_BINDING, at, message, binding, known);
            report.push(one);
            return None;
        }
    }
    Some(Provider { member, service })
}

fn only_service(
    text: &Text,
    member: usize,
    interface: &InterfaceDeclaration,
    class: &ClassIndex<'_>,
    report: &mut Report<'_>,
) -> Option<Provider> {
    let fitting =
        |(_, service): &(usize, &&crate::registry::ServiceDeclaration)| service.interface == *interface;
    let mut fits = class.services.iter().enumerate().filter(fitting);
    match (fits.next(), fits.next()) {
        (Some((service, _)), None) => Some(Provider { member, service }),
        (None, _) => {
            let message = format!(
                "component {} offers no service with the interface {}",
                quoted(text),
                quoted(&interface.name)
            );
            let one = Diagnostic::new(&codes::WIRE_INTERFACE, text.location, message);
            report.push(one.help(offers(class, interface)));
            None
        }
        (Some(_), Some(_)) => {
            let names =
                class.services.iter().enumerate().filter(fitting).map(|(_, service)| service.name.as_str());
            let message = format!(
                "component {} has several services with the interface {}",
                quoted(text),
                quoted(&interface.name)
            );
            let help = format!("name one of {}: `{text}/...`", list(names));
            report.push(Diagnostic::new(&codes::TARGET_AMBIGUOUS, text.location, message).help(help));
            None
        }
    }
}

/// What a component offers in place of the interface that is asked for.
fn offers(class: &ClassIndex<'_>, interface: &InterfaceDeclaration) -> String {
    if class.services.iter().any(|service| service.interface.name == interface.name) {
        return "it offers the interface with other operations: build both components from one version"
            .to_owned();
    }
    let offers = class
        .services
        .iter()
        .map(|service| format!("{} ({})", quoted(&service.name), service.interface.name));
    match offers.collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => "it offers no services".to_owned(),
        all => format!("it offers {all}"),
    }
}
