//! Targets: the services that URIs such as `Robot001/move` lead to.

use super::misread_uri::{inside, unknown_component};
use super::uri::{Uri, is_address};
use crate::check::contracts::offer::{Offer, Provider};
use crate::check::fleet::{Fleet, Side};
use crate::check::options::Options;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::expression::has_expression;
use crate::registry::InterfaceDeclaration;
use crate::source::Text;

/// The end of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// To this service.
    Service(Provider),
    /// To something that cannot be looked at.
    Open,
    /// Nowhere; reported.
    Wrong,
}

/// The service that a target in a scope leads to, for a reference of a component with this interface, or with any.
/// Faults are reported.
///
/// Without the name of a service the component has to have exactly one with the interface.
pub(crate) fn target(
    text: &Text,
    (scope, own): (usize, Option<usize>),
    interface: Option<&InterfaceDeclaration>,
    (fleet, options): (&Fleet<'_>, &Options),
    report: &mut Report<'_>,
) -> Target {
    // An expression that is still there has a fault, which is reported.
    if options.assume_classes && is_address(text) || fleet.scopes[scope].fault.is_some() && has_expression(text) {
        return Target::Open;
    }
    let Some(uri) = Uri::of(text, (3, Side::Service), (scope, fleet), report) else { return Target::Wrong };
    let uri = Uri { wants: interface, ..uri };
    let is_elsewhere = || fleet.find(scope, uri.component).is_none() && !fleet.is_missing(scope, uri.component);
    if scope == 0 && options.assume_classes && is_elsewhere() {
        let at = report.part(text, 0..uri.component.len());
        let message = format!("there is no component {} in these composites", quoted(uri.component));
        let one = unknown_component(uri.component, (scope, own), (Side::Service, false), at, message, fleet, report);
        let help = "it is not checked: another composite of the domain may have it";
        report.push(one.severity(Severity::Warning).help(help));
        return Target::Open;
    }
    let Some(member) = uri.member(text, (scope, own), fleet, None, report) else {
        return Target::Wrong;
    };
    let component = fleet.members[member].component;
    let Some((name, at)) = uri.part.clone() else {
        return match interface {
            Some(interface) => only_service(text, member, interface, fleet, report),
            None => Target::Open,
        };
    };
    let provider = match fleet.offer(member, name) {
        Offer::Service(provider) => provider,
        Offer::Open => {
            let at = report.part(text, at);
            let code = (&codes::UNKNOWN_TARGET_SERVICE, None);
            fleet.unknown_name(member, Side::Service, code, (name, at), report);
            // The bindings that a component writes are all that its service has.
            if component.service(name).is_some_and(|service| !service.contract().bindings.is_empty()) {
                bound(text, &uri, (member, name), fleet, report);
            }
            return Target::Open;
        }
        Offer::Missing => {
            let at = report.part(text, at);
            let message = format!("component {} has no service {}", quoted(&component.name), quoted(name));
            let behind: Vec<&str> = text.split('/').skip(1).collect();
            if let Some(promoted) = inside(member, &behind, Side::Service, fleet) {
                let one = Diagnostic::new(&codes::UNKNOWN_TARGET_SERVICE, at, message);
                report.push(promoted.add_to(one, text));
                return Target::Wrong;
            }
            let names = fleet.service_names(member).unwrap_or_default();
            let known = ("its services are", names.iter().copied());
            let one = report.unknown(&codes::UNKNOWN_TARGET_SERVICE, at, message, name, known);
            let offers = fleet.offers(member);
            let is_fitting = |offer: Offer| interface.is_some_and(|interface| fits(offer, interface, fleet));
            let mut fitting = offers.iter().filter(|(_, offer)| is_fitting(*offer));
            report.push(match (fitting.next(), fitting.next()) {
                (Some((fitting, _)), None) if one.suggestions.is_empty() => one.replace(name, at, fitting),
                _ => one,
            });
            return Target::Wrong;
        }
    };
    let Some(found) = fleet.interface_of(provider) else { return Target::Open };
    if let Some(interface) = interface.filter(|interface| found != *interface) {
        let at = report.part(text, at);
        let message = format!(
            "service {} of component {} has the interface {}, and the reference needs {}",
            quoted(name),
            quoted(&component.name),
            quoted(&found.name),
            quoted(&interface.name)
        );
        let one = Diagnostic::new(&codes::WIRE_INTERFACE, at, message);
        let offers = fleet.offers(member);
        let fitting = offers.iter().find(|(_, offer)| fits(*offer, interface, fleet));
        report.push(match fitting {
            Some((fitting, _)) => one.replace(name, at, fitting),
            None => one.help(offered(member, interface, fleet)),
        });
        return Target::Wrong;
    }
    if !bound(text, &uri, (member, name), fleet, report) {
        return Target::Wrong;
    }
    Target::Service(provider)
}

/// True if the service of a component has the binding that a URI names.
fn bound(
    text: &Text,
    uri: &Uri<'_>,
    (member, name): (usize, &str),
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) -> bool {
    let Some((binding, at)) = &uri.binding else { return true };
    let component = fleet.members[member].component;
    let declared = component.service(name).map_or(&[][..], |service| &service.contract().bindings);
    // A binding without a name has that of its service, and a service without bindings has one of SCA.
    let names = declared.iter().map(|known| known.name.as_ref().map_or(name, |name| name.as_str()));
    let known: Vec<&str> = if declared.is_empty() { vec![name] } else { names.collect() };
    if known.contains(binding) {
        return true;
    }
    let at = report.part(text, at.clone());
    let message =
        format!("service {} of component {} has no binding {}", quoted(name), quoted(&component.name), quoted(binding));
    let known = ("its bindings are", known.iter().copied());
    let one = report.unknown(&codes::UNKNOWN_BINDING, at, message, binding, known);
    report.push(one);
    false
}

pub(super) fn fits(offer: Offer, interface: &InterfaceDeclaration, fleet: &Fleet<'_>) -> bool {
    matches!(offer, Offer::Service(provider) if fleet.interface_of(provider) == Some(interface))
}

fn only_service(
    text: &Text,
    member: usize,
    interface: &InterfaceDeclaration,
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) -> Target {
    if fleet.service_names(member).is_none() {
        return Target::Open;
    }
    let offers = fleet.offers(member);
    let fitting: Vec<_> = offers.iter().filter(|(_, offer)| fits(*offer, interface, fleet)).collect();
    match fitting[..] {
        [(_, Offer::Service(provider))] => return Target::Service(*provider),
        [] if offers.iter().any(|(_, offer)| *offer == Offer::Open) => return Target::Open,
        [] => {
            let message =
                format!("component {} offers no service with the interface {}", quoted(text), quoted(&interface.name));
            let one = Diagnostic::new(&codes::WIRE_INTERFACE, text.location, message);
            report.push(one.help(offered(member, interface, fleet)));
        }
        _ => {
            let message = format!(
                "component {} has several services with the interface {}",
                quoted(text),
                quoted(&interface.name)
            );
            let help = format!("name one of {}: `{text}/...`", list(fitting.iter().map(|(name, _)| *name)));
            report.push(Diagnostic::new(&codes::TARGET_AMBIGUOUS, text.location, message).help(help));
        }
    }
    Target::Wrong
}

/// The services that a component offers in place of the interface that is asked for, for help.
fn offered(member: usize, interface: &InterfaceDeclaration, fleet: &Fleet<'_>) -> String {
    let mut all = Vec::new();
    for (name, offer) in fleet.offers(member) {
        let Offer::Service(provider) = offer else { continue };
        let Some(found) = fleet.interface_of(provider) else { continue };
        if found.name == interface.name {
            let difference = interface.difference(found);
            return format!(
                "it offers the interface with other operations: {difference}; build both components from one version"
            );
        }
        all.push(format!("{} ({})", quoted(name), found.name));
    }
    match all.join(", ") {
        none if none.is_empty() => "it offers no services".to_owned(),
        all => format!("it offers {all}"),
    }
}

/// `component/service`: how a service is named where the component is that offers it, which may do so for one inside of
/// it.
pub(crate) fn uri((offering, provider): (usize, Provider), fleet: &Fleet<'_>) -> String {
    let component = &fleet.members[offering].component.name;
    let offers = fleet.offers(offering);
    let service = offers.iter().find(|(_, offer)| *offer == Offer::Service(provider));
    format!("{component}/{}", service.map_or("", |(name, _)| name))
}
