//! Services that are offered over the web: each has a path of its own, and an interface that can be shown as JSON.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashSet};

use smol_str::SmolStr;

use super::{operations, wrong_address};
use crate::assembly::WebService;
use crate::check::contracts::offer::{Offer, Provider, parts};
use crate::check::fleet::{Fleet, Unit};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{AddressFault, AddressHelp, Binding, HttpAddress, Part, ServiceElement, WebPath};
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// A service that is to be offered.
struct Offered<'f> {
    provider: Provider,
    element: &'f ServiceElement,
    /// The component that offers it, as its path has it: empty for the outermost composite.
    by: &'f str,
    /// The component to which it belongs, for the severities that are set there.
    about: usize,
}

/// The paths at which services are offered, by the nodes that offer them.
type Paths = BTreeMap<(SmolStr, WebPath), Location>;

/// The services that components offer over the web. Faults are reported.
pub(super) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) -> BTreeMap<usize, Vec<WebService>> {
    let mut services: BTreeMap<usize, Vec<WebService>> = BTreeMap::new();
    let mut paths = Paths::new();
    for offered in offered(fleet) {
        report.about(&fleet.members[offered.about]);
        for binding in offered.element.contract().bindings.iter().filter(|binding| binding.is_rest()) {
            let Some(service) = service(&offered, binding, fleet, &mut paths, report) else { continue };
            services.entry(offered.provider.member).or_default().push(service);
        }
    }
    report.about_all();
    services
}

/// The services with a binding to the web whose classes are known.
fn offered<'f>(fleet: &'f Fleet<'_>) -> Vec<Offered<'f>> {
    let mut all = Vec::new();
    let has_web = |element: &&ServiceElement| element.contract().bindings.iter().any(Binding::is_rest);
    for (member, of) in fleet.members.iter().enumerate() {
        for element in of.component.services.iter().filter(has_web) {
            if let Offer::Service(provider) = fleet.offer(member, &element.name) {
                all.push(Offered { provider, element, by: of.path(), about: member });
            }
        }
    }
    for unit in &fleet.units {
        let owner = fleet.scopes[unit.scope].owner;
        for element in unit.services().filter(has_web) {
            // The bindings that a component writes are all that its service has.
            let own = owner.and_then(|owner| fleet.members[owner].component.service(&element.name));
            if own.is_some_and(|own| !own.contract().bindings.is_empty()) {
                continue;
            }
            let Some(provider) = promoted(unit, element, fleet) else { continue };
            let by = owner.map_or("", |owner| fleet.members[owner].path());
            all.push(Offered { provider, element, by, about: owner.unwrap_or(provider.member) });
        }
    }
    all.retain(|one| fleet.class_of(one.provider.member).is_some());
    all
}

/// The service that a composite promotes. What is wrong with it is reported where it is promoted.
fn promoted(unit: &Unit<'_>, element: &ServiceElement, fleet: &Fleet<'_>) -> Option<Provider> {
    let (component, part) = parts(element.promote.as_ref()?);
    let member = fleet.find(unit.scope, component)?;
    match fleet.offer(member, part.or_else(|| fleet.only_service(member))?) {
        Offer::Service(provider) => Some(provider),
        Offer::Open | Offer::Missing => None,
    }
}

/// A service as it is offered by a binding; `None` after a fault was reported.
fn service(
    offered: &Offered<'_>,
    binding: &Binding,
    fleet: &Fleet<'_>,
    paths: &mut Paths,
    report: &mut Report<'_>,
) -> Option<WebService> {
    let Provider { member, service } = offered.provider;
    let declared = fleet.class_of(member)?.services[service];
    let name = quoted(&offered.element.name);
    if declared.is_of_host() {
        let message = format!("the service {name} is not one of its class, and is not offered over the web");
        let one = Diagnostic::new(&codes::WEB_SERVICE, binding.tag(), message);
        report.push(one.help("the control server starts and stops components: `/v1/components/{component}/start`"));
        return None;
    }
    let operations = match operations(&declared.interface) {
        Ok(operations) => operations,
        Err(why) => {
            let interface = quoted(&declared.interface.name);
            let message = format!("the interface {interface} of service {name} cannot be offered over the web: {why}");
            report.push(Diagnostic::new(&codes::WEB_SERVICE, binding.tag(), message));
            return None;
        }
    };
    let place = binding.uri.as_ref().map_or(binding.tag(), |uri| uri.location);
    let path = match &binding.uri {
        Some(uri) => path(uri, report)?,
        None => WebPath::of_service(offered.by, &offered.element.name),
    };
    match paths.entry((fleet.members[member].node.clone(), path.clone())) {
        Entry::Vacant(free) => _ = free.insert(place),
        Entry::Occupied(taken) => {
            let message = format!("the path {} of service {name} is that of another service", quoted(path.as_str()));
            let one = Diagnostic::new(&codes::WEB_PATH_REPEATED, place, message);
            let one = if *taken.get() == place { one } else { one.label(*taken.get(), "the other service") };
            report.push(one.help(match fleet.members[member].instance {
                Some(_) => {
                    "give each replica its own: `uri=\".../${index}\"`, or leave `uri` out: the default has the name of \
                     the component"
                }
                None => "give each its own, or leave `uri` out: the default has the name of the component",
            }));
            return None;
        }
    }
    Some(WebService {
        path,
        service: declared.name.clone(),
        interface: declared.interface.name.clone(),
        operations,
        deadline: offered.element.deadline.as_ref().map(|deadline| deadline.value),
        place,
    })
}

/// The path of a `uri`; `None` after a fault was reported.
fn path(uri: &Text, report: &mut Report<'_>) -> Option<WebPath> {
    let told = |fault: AddressFault, report: &mut Report<'_>| report.push(wrong_address(uri, uri.location, fault));
    // As others write it, with the server that is to offer it.
    if uri.contains("://") {
        let target = match HttpAddress::parse(uri, &AddressHelp::SERVICES) {
            Ok(address) => address.target,
            Err(fault) => {
                let help = "the control server of the run offers the service: write its path alone, such as `/stock`";
                told(AddressFault { help: help.to_owned(), ..fault }, report);
                return None;
            }
        };
        return match WebPath::parse(&target) {
            Ok(path) => {
                let message = format!("the host of {} has no effect", quoted(uri));
                let one = Diagnostic::new(&codes::WEB_ADDRESS, uri.location, message).severity(Severity::Warning);
                let one = one.help("the service is offered where `saoms run --serve ADDRESS:PORT` says");
                let path_alone = path.to_string();
                report.push(one.mend(format!("write the path alone: {}", quoted(&path_alone)), escaped(&path_alone)));
                Some(path)
            }
            Err(fault) => {
                told(fault, report);
                None
            }
        };
    }
    match WebPath::parse(uri) {
        Ok(path) => Some(path),
        Err(fault) => {
            told(fault, report);
            None
        }
    }
}

/// Reports deadlines of services that are not offered over the web.
pub(super) fn unused_deadlines(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let mut told: HashSet<Location> = HashSet::new();
    let of_members = fleet
        .members
        .iter()
        .enumerate()
        .flat_map(|(member, of)| of.component.services.iter().map(move |element| (Some(member), element)));
    let of_units = fleet.units.iter().flat_map(|unit| unit.services().map(|element| (None, element)));
    for (member, element) in of_members.chain(of_units) {
        let Some(deadline) = &element.deadline else { continue };
        if element.contract().bindings.iter().any(Binding::is_rest) || !told.insert(deadline.location) {
            continue;
        }
        match member {
            Some(member) => report.about(&fleet.members[member]),
            None => report.about_all(),
        }
        let of = quoted(&element.name);
        let message = format!("the deadline of service {of} has no effect: it is not offered over the web");
        let one = Diagnostic::new(&codes::CALL_DEADLINE_UNUSED, deadline.location, message);
        report.push(one.help("remove it, or offer the service over the web: write `<binding.rest/>` in it"));
    }
    report.about_all();
}
