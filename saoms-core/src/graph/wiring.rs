//! Wires and promotions, as far as they can be understood.

use std::collections::{HashMap, HashSet};

use super::diagram::{Component, Diagram, End, Link, LinkKind, Port, State};
use super::read::View;
use crate::expression::{has_expression, pattern};

/// The service that periodic components have without naming it.
const TASK_SERVICE: &str = "TaskInterface";

/// Adds the links of a composite to `diagram`, and what they lead to where that is missing.
pub(super) fn link(view: &View<'_>, diagram: &mut Diagram) {
    let names = diagram.components.iter().enumerate().rev();
    let places = names.map(|(place, component)| (component.name.clone(), place)).collect();
    let mut linker = Linker { diagram, places, seen: HashSet::new(), linked: HashSet::new() };
    linker.targets(view);
    for wire in view.wires() {
        let (Some(source), Some(target)) = (&wire.source, &wire.target) else { continue };
        let from = linker.reference(source);
        linker.wire(from, target);
    }
    linker.autowire(view);
    linker.promotions(view);
}

struct Linker<'d> {
    diagram: &'d mut Diagram,
    places: HashMap<String, usize>,
    seen: HashSet<Link>,
    /// What has a link already.
    linked: HashSet<End>,
}

impl Linker<'_> {
    fn targets(&mut self, view: &View<'_>) {
        for (component, (_, model)) in view.components().enumerate() {
            for (port, reference) in model.references.iter().enumerate() {
                for target in &reference.targets {
                    self.wire(End::Component { component, port }, target);
                }
            }
        }
    }

    fn promotions(&mut self, view: &View<'_>) {
        for (place, service) in view.services().enumerate() {
            let Some(promote) = &service.promote else { continue };
            let interface = self.diagram.services[place].interface.clone();
            let to = self.service(promote, interface.as_deref());
            self.add(LinkKind::Promotion, End::Composite(place), to);
        }
        for (place, reference) in view.references().enumerate() {
            for promote in reference.promote() {
                let from = self.reference(promote);
                self.add(LinkKind::Promotion, from, End::Composite(place));
            }
        }
    }

    /// Wires references without a target to the services of their interface, where the file asks for that.
    fn autowire(&mut self, view: &View<'_>) {
        let count = view.components().count();
        for (component, (composite, model)) in view.components().enumerate() {
            let by_default = composite.autowire.is_some_and(|one| one.value);
            let by_default = model.autowire().map_or(by_default, |one| one.value);
            for port in 0..self.diagram.components[component].references.len() {
                let from = End::Component { component, port };
                let written = model.references.get(port);
                let asked = written.and_then(|one| one.autowire()).map_or(by_default, |one| one.value);
                if !asked || self.linked.contains(&from) {
                    continue;
                }
                let many = written.and_then(|one| one.multiplicity()).is_some_and(|one| one.value.is_many());
                let Some(interface) = self.diagram.components[component].references[port].interface.clone()
                else {
                    continue;
                };
                let found = self.offering(&interface, component, count);
                for to in found.into_iter().take(if many { usize::MAX } else { 1 }) {
                    self.add(LinkKind::Wire, from, to);
                }
            }
        }
    }

    /// The services of this interface of the first `count` components, those that are there, apart from those of `except`.
    fn offering(&self, interface: &str, except: usize, count: usize) -> Vec<End> {
        let all = (0..count).filter(|component| *component != except);
        all.filter_map(|component| {
            let services = &self.diagram.components[component].services;
            let port = services.iter().position(|one| one.interface.as_deref() == Some(interface))?;
            Some(End::Component { component, port })
        })
        .collect()
    }

    fn wire(&mut self, from: End, target: &str) {
        let interface = match from {
            End::Component { component, port } => {
                self.diagram.components[component].references[port].interface.clone()
            }
            End::Composite(_) => None,
        };
        let to = self.service(target, interface.as_deref());
        self.add(LinkKind::Wire, from, to);
    }

    fn add(&mut self, kind: LinkKind, from: End, to: End) {
        let link = Link { kind, from, to };
        if self.seen.insert(link) {
            self.linked.insert(from);
            self.diagram.links.push(link);
        }
    }

    /// The service that `component`, `component/service` or `component/service/binding` names.
    fn service(&mut self, uri: &str, interface: Option<&str>) -> End {
        let (component, name) = self.split(uri);
        let services = &mut self.diagram.components[component].services;
        let port = match &name {
            Some(name) => named(services, name),
            None => {
                let fits = |one: &Port| interface.is_some() && one.interface.as_deref() == interface;
                let place = services.iter().position(fits);
                let place = place.or_else(|| services.iter().position(|one| one.name != TASK_SERVICE));
                place.unwrap_or_else(|| named(services, ""))
            }
        };
        End::Component { component, port }
    }

    /// The reference that `component` or `component/reference` names.
    fn reference(&mut self, uri: &str) -> End {
        let (component, name) = self.split(uri);
        let references = &mut self.diagram.components[component].references;
        let port = match (name, references.len()) {
            (None, 1..) => 0,
            (name, _) => named(references, &name.unwrap_or_default()),
        };
        End::Component { component, port }
    }

    /// The component of a name: also that of replicas for the name of one of them.
    fn place(&self, name: &str) -> Option<usize> {
        if let Some(place) = self.places.get(name) {
            return Some(*place);
        }
        let mut groups = self.diagram.components.iter().enumerate();
        let found = groups.find(|(_, one)| one.name.contains('*') && is_of(name, &one.name));
        found.map(|(place, _)| place)
    }

    /// The component of a URI, drawn as missing when there is none, and what follows it.
    fn split(&mut self, uri: &str) -> (usize, Option<String>) {
        let uri = if has_expression(uri) { pattern(uri) } else { uri.to_owned() };
        let mut parts = uri.trim_start_matches('/').split('/');
        let name = parts.next().unwrap_or_default();
        let place = match self.place(name) {
            Some(place) => place,
            None => {
                self.diagram.components.push(Component {
                    name: name.to_owned(),
                    replicas: None,
                    class: String::new(),
                    state: State::Missing,
                    properties: Vec::new(),
                    services: Vec::new(),
                    references: Vec::new(),
                    inside: None,
                });
                self.places.insert(name.to_owned(), self.diagram.components.len() - 1);
                self.diagram.components.len() - 1
            }
        };
        (place, parts.next().filter(|part| !part.is_empty()).map(str::to_owned))
    }
}

/// Whether a name is that of a replica of a group, such as `Robot*`: a number for each `*`.
fn is_of(name: &str, group: &str) -> bool {
    let mut parts = group.split('*');
    let Some(mut rest) = name.strip_prefix(parts.next().unwrap_or_default()) else { return false };
    for part in parts {
        let number = rest.trim_start_matches('-');
        let number = number.trim_start_matches(|c: char| c.is_ascii_digit());
        if number.len() == rest.len() {
            return false;
        }
        let Some(behind) = number.strip_prefix(part) else { return false };
        rest = behind;
    }
    rest.is_empty()
}

/// The place of the port of this name, which is there from now on.
fn named(ports: &mut Vec<Port>, name: &str) -> usize {
    ports.iter().position(|port| port.name == name).unwrap_or_else(|| {
        ports.push(Port { name: name.to_owned(), interface: None });
        ports.len() - 1
    })
}
