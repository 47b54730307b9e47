//! Targets: the resolver of URIs such as `Robot001/move`.

use std::borrow::Cow;
use std::ops::Range;

use super::misread_uri::{inside, misread};
use super::offer::{Offer, Side};
use super::replica_index::beyond;
use crate::check::fleet::Fleet;
use crate::check::fleet::classes::{ClassIndex, Fitting};
use crate::check::report::{Report, list, replacing};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::expression::has_expression;
use crate::model::Binding;
use crate::registry::InterfaceDeclaration;
use crate::source::Text;
use crate::syntax::escaped;

/// A service of a component of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Provider {
    pub(crate) member: usize,
    /// The place of the service in the class.
    pub(crate) service: usize,
}

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

/// The component of a URI, and the name behind it.
pub(crate) fn parts(uri: &str) -> (&str, Option<&str>) {
    let (component, rest) =
        uri.split_once('/').map_or((uri, None), |(component, rest)| (component, Some(rest)));
    (component, rest.map(|rest| rest.split('/').next().unwrap_or(rest)))
}

/// The parts of `component/part/binding`, each with its bytes.
pub(crate) struct Uri<'t> {
    /// True if the part is a service or a reference.
    side: Side,
    pub(crate) component: &'t str,
    pub(crate) part: Option<(&'t str, Range<usize>)>,
    pub(crate) binding: Option<(&'t str, Range<usize>)>,
}

impl<'t> Uri<'t> {
    /// Splits a URI of at most `most` parts that names a service or a reference of a component in this scope; another one is reported.
    pub(crate) fn of(
        text: &'t Text,
        (most, side): (usize, Side),
        (scope, fleet): (usize, &Fleet<'_>),
        report: &mut Report<'_>,
    ) -> Option<Self> {
        let mut start = 0;
        let mut parts = text.split('/').map(|part| {
            let at = start..start + part.len();
            start = at.end + 1;
            (part, at)
        });
        let (component, _) = parts.next()?;
        let uri = Self { side, component, part: parts.next(), binding: parts.next() };
        let has_more = parts.next().is_some() || (most < 3 && uri.binding.is_some());
        let inner = [uri.part.as_ref(), uri.binding.as_ref()];
        if component.is_empty() || inner.into_iter().flatten().any(|(part, _)| part.is_empty()) || has_more {
            let form = if most < 3 {
                "`component` or `component/name`"
            } else {
                "`component`, `component/service` or `component/service/binding`"
            };
            let message = format!("{} has the wrong form", quoted(text));
            let one = Diagnostic::new(&codes::URI_MALFORMED, text.location, message);
            let named: Vec<&str> = text.split('/').filter(|part| !part.is_empty()).collect();
            let meant = named.join("/");
            let is_known = named.first().is_some_and(|name| fleet.find(scope, name).is_some());
            let promoted = named.split_first().and_then(|(component, behind)| {
                inside(fleet.find(scope, component)?, behind, side, fleet).filter(|_| most < 3)
            });
            report.push(match promoted {
                Some(promoted) => promoted.told(one, text),
                None if is_known && named.len() <= most => {
                    one.suggest(replacing(text, &meant), text.location, escaped(&meant))
                }
                None => one.help(format!("write {form}")),
            });
            return None;
        }
        Some(uri)
    }

    /// The component, which has to exist in the scope.
    ///
    /// `own` is the component that names it: another one is meant.
    pub(crate) fn member(
        &self,
        text: &Text,
        (scope, own): (usize, Option<usize>),
        fleet: &Fleet<'_>,
        rule: Option<&'static str>,
        report: &mut Report<'_>,
    ) -> Option<usize> {
        let found = fleet.find(scope, self.component);
        if found.is_none() {
            if fleet.is_missing(scope, self.component) {
                return None;
            }
            if let Some(condition) = fleet.absent.get(&(scope, self.component)) {
                let message = format!("the component {} is not there", quoted(self.component));
                let at = report.part(text, 0..self.component.len());
                let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message);
                // Promotions are written in services and references of composites, and have a rule of their own.
                report.push(one.label(*condition, "this is false").help(match rule {
                    None => "give what names it the same condition",
                    Some(_) => {
                        "what a composite promotes has no condition: put both into a composite that is included with this one"
                    }
                }));
                return None;
            }
            let at = report.part(text, 0..self.component.len());
            if let Some([first, ..]) = fleet.group(scope, self.component) {
                let message =
                    format!("{} names all replicas, and one component is expected", quoted(self.component));
                let first = fleet.members[*first].component.name.as_str();
                let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message);
                let one = one.help(format!("name one of them, such as {}", quoted(first)));
                report.push(match rule {
                    Some(rule) => one.rule(rule),
                    None => one,
                });
                return None;
            }
            let message = format!("there is no component {}", quoted(self.component));
            if let Some(misread) = misread(text, scope, self.side, fleet) {
                let one = misread.told(Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message), text);
                report.push(match rule {
                    Some(rule) => one.rule(rule),
                    None => one,
                });
                return None;
            }
            // A reference of a composite can stand for those of all replicas.
            let is_promoted = rule == Some(Side::Reference.rule());
            let (first, last): (Vec<&str>, Vec<&str>) = fleet.group_names(scope).partition(|_| is_promoted);
            let own = own.map(|own| fleet.members[own].component.name.as_str());
            let names = fleet.names(scope).filter(|name| Some(*name) != own);
            let known =
                ("the components are", first.iter().copied().chain(names).chain(last.iter().copied()));
            let one = match beyond(self.component, scope, fleet) {
                Some(beyond) => beyond.told(self.component, own, at, message),
                None => report.unknown(&codes::UNKNOWN_COMPONENT, at, message, self.component, known),
            };
            report.push(match rule {
                Some(rule) => one.rule(rule),
                None => one,
            });
        }
        found
    }
}

/// The texts that a text stands for which names components of a scope: itself, or one for each replica of a group, with its place.
pub(crate) fn spread<'t>(
    text: &'t Text,
    scope: usize,
    fleet: &'t Fleet<'_>,
) -> impl Iterator<Item = (Cow<'t, Text>, Option<usize>)> + use<'t> {
    let (component, _) = parts(text);
    let members = fleet.group(scope, component);
    let itself = members.is_none().then_some((Cow::Borrowed(text), None));
    let rest = &text[component.len()..];
    let named = members.into_iter().flatten().map(move |&member| {
        let name = format!("{}{rest}", fleet.members[member].component.name);
        (Cow::Owned(Text::new(name.into(), text.location)), Some(member))
    });
    itself.into_iter().chain(named)
}

/// The service that a target in a scope leads to, for a reference of a component with this interface, or with any. Faults are reported.
///
/// Without the name of a service the component has to have exactly one with the interface.
pub(crate) fn target(
    text: &Text,
    (scope, own): (usize, Option<usize>),
    interface: Option<&InterfaceDeclaration>,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) -> Target {
    // An expression that is still there has a fault, which is reported.
    if report.assumes && is_address(text) || fleet.scopes[scope].is_faulty && has_expression(text) {
        return Target::Open;
    }
    let Some(uri) = Uri::of(text, (3, Side::Service), (scope, fleet), report) else { return Target::Wrong };
    let is_elsewhere =
        || fleet.find(scope, uri.component).is_none() && !fleet.is_missing(scope, uri.component);
    if scope == 0 && report.assumes && is_elsewhere() {
        elsewhere(text, (uri.component, own), fleet, report);
        return Target::Open;
    }
    let Some(member) = uri.member(text, (scope, own), fleet, None, report) else {
        return Target::Wrong;
    };
    let component = fleet.members[member].component;
    let Some((name, at)) = uri.part.clone() else {
        return match interface {
            Some(interface) => only_service(text, member, interface, fleet, classes, report),
            None => Target::Open,
        };
    };
    let provider = match fleet.offer(member, name, classes) {
        Offer::Service(provider) => provider,
        Offer::Open => {
            let at = report.part(text, at);
            let code = (&codes::UNKNOWN_TARGET_SERVICE, None);
            fleet.unknown_name(member, Side::Service, code, (name, at), report);
            // The bindings that a component writes are all that its service has.
            if component.service(name).is_some_and(|service| !service.bindings().is_empty()) {
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
                report.push(promoted.told(one, text));
                return Target::Wrong;
            }
            let names = fleet.service_names(member, classes).unwrap_or_default();
            let known = ("its services are", names.iter().copied());
            let one = report.unknown(&codes::UNKNOWN_TARGET_SERVICE, at, message, name, known);
            let offers = fleet.offers(member, classes);
            let is_fitting =
                |offer: Offer| interface.is_some_and(|interface| fits(offer, interface, fleet, classes));
            let mut fitting = offers.iter().filter(|(_, offer)| is_fitting(*offer));
            report.push(match (fitting.next(), fitting.next()) {
                (Some((fitting, _)), None) if one.suggestions.is_empty() => {
                    one.suggest(replacing(name, fitting), at, escaped(fitting))
                }
                _ => one,
            });
            return Target::Wrong;
        }
    };
    let Some(found) = fleet.interface_of(provider, classes) else { return Target::Open };
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
        let offers = fleet.offers(member, classes);
        let fitting = offers.iter().find(|(_, offer)| fits(*offer, interface, fleet, classes));
        report.push(match fitting {
            Some((fitting, _)) => one.suggest(replacing(name, fitting), at, escaped(fitting)),
            None => one.help(offered(member, interface, fleet, classes)),
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
    let declared = component.service(name).map_or(&[][..], |service| service.bindings());
    // A binding without a name has that of its service, and a service without bindings has one of SCA.
    let called = |known: &'_ Binding| known.name.as_ref().map_or(name, |name| name.as_str()) == *binding;
    if declared.iter().any(called) || declared.is_empty() && *binding == name {
        return true;
    }
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
    false
}

/// True if a target is an address on a network rather than a component.
pub(crate) fn is_address(text: &str) -> bool {
    let scheme = text.split(':').next().unwrap_or_default();
    scheme.len() < text.len()
        && !scheme.contains('/')
        && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
}

/// Says that a target is not in the composites at hand. Where things are taken as given, it may be in others of its domain.
fn elsewhere(
    text: &Text,
    (component, own): (&str, Option<usize>),
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) {
    let message = format!("there is no component {} in these composites", quoted(component));
    let at = report.part(text, 0..component.len());
    let own = own.map(|own| fleet.members[own].component.name.as_str());
    let known = ("the components are", fleet.names(0).filter(|name| Some(*name) != own));
    let one = match beyond(component, 0, fleet) {
        Some(beyond) => beyond.told(component, own, at, message),
        None => report.unknown(&codes::UNKNOWN_COMPONENT, at, message, component, known),
    };
    report.push(
        one.severity(Severity::Warning)
            .help("it is taken as given: another composite of the domain may have it"),
    );
}

fn fits(
    offer: Offer,
    interface: &InterfaceDeclaration,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
) -> bool {
    matches!(offer, Offer::Service(provider) if fleet.interface_of(provider, classes) == Some(interface))
}

fn only_service(
    text: &Text,
    member: usize,
    interface: &InterfaceDeclaration,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) -> Target {
    if let Some(class) = fleet.class_of(member, classes)
        && let Fitting::One(service) = class.fitting(interface)
    {
        return Target::Service(Provider { member, service });
    }
    if fleet.service_names(member, classes).is_none() {
        return Target::Open;
    }
    let offers = fleet.offers(member, classes);
    let mut fitting = offers.iter().filter(|(_, offer)| fits(*offer, interface, fleet, classes));
    match (fitting.next(), fitting.next()) {
        (Some((_, Offer::Service(provider))), None) => Target::Service(*provider),
        (None, _) if offers.iter().any(|(_, offer)| *offer == Offer::Open) => Target::Open,
        (None, _) => {
            let message = format!(
                "component {} offers no service with the interface {}",
                quoted(text),
                quoted(&interface.name)
            );
            let one = Diagnostic::new(&codes::WIRE_INTERFACE, text.location, message);
            report.push(one.help(offered(member, interface, fleet, classes)));
            Target::Wrong
        }
        (Some(_), _) => {
            let fitting = offers.iter().filter(|(_, offer)| fits(*offer, interface, fleet, classes));
            let names = fitting.map(|(name, _)| *name);
            let message = format!(
                "component {} has several services with the interface {}",
                quoted(text),
                quoted(&interface.name)
            );
            let help = format!("name one of {}: `{text}/...`", list(names));
            report.push(Diagnostic::new(&codes::TARGET_AMBIGUOUS, text.location, message).help(help));
            Target::Wrong
        }
    }
}

/// The services that a component offers in place of the interface that is asked for, for help.
fn offered(
    member: usize,
    interface: &InterfaceDeclaration,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
) -> String {
    let mut all = Vec::new();
    for (name, offer) in fleet.offers(member, classes) {
        let Offer::Service(provider) = offer else { continue };
        let Some(found) = fleet.interface_of(provider, classes) else { continue };
        if found.name == interface.name {
            return "it offers the interface with other operations: build both components from one version"
                .to_owned();
        }
        all.push(format!("{} ({})", quoted(name), found.name));
    }
    match all.join(", ") {
        none if none.is_empty() => "it offers no services".to_owned(),
        all => format!("it offers {all}"),
    }
}

/// `component/service`: how a service is named where the component is that offers it, which may do so for one inside of it.
pub(crate) fn uri(
    (offering, provider): (usize, Provider),
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
) -> String {
    let component = &fleet.members[offering].component.name;
    let offers = fleet.offers(offering, classes);
    let service = offers.iter().find(|(_, offer)| *offer == Offer::Service(provider));
    format!("{component}/{}", service.map_or("", |(name, _)| name))
}
