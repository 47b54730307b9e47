//! Wires and promotions, as far as they can be understood.

use std::collections::{HashMap, HashSet};

use super::diagram::{Diagram, DiagramComponent, DiagramEnd, DiagramLink, LinkKind, State};
use super::groups::Groups;
use super::ports::{Ports, Side};
use super::read::View;
use saoms_lang::expression::{has_expression, pattern};
use saoms_lang::model::WireElement;

/// Wires of autowire that are drawn of one composite: each reference that takes several has one to each service of its
/// interface.
const MOST_AUTOWIRED: usize = 20_000;
/// Components that are named and not there that are drawn of one composite.
const MOST_MISSING: usize = 2_000;

/// Adds the links of a composite to `diagram`, and what they lead to where that is missing.
pub(super) fn link(view: &View<'_>, diagram: &mut Diagram, is_inside: bool) {
    let names = diagram.components.iter().enumerate().rev();
    let places = names.map(|(place, component)| (component.name.clone(), place)).collect();
    let groups = Groups::of(diagram.components.iter().map(|component| component.name.as_str()));
    let mut linker = Linker {
        diagram,
        places,
        groups,
        ports: Ports::default(),
        seen: HashSet::new(),
        linked: HashSet::new(),
        left: MOST_MISSING,
        is_inside,
    };
    let is_replacing = |wire: &WireElement| wire.replace.is_some_and(|replace| replace.value);
    let replaced = view.wires().filter(|wire| is_replacing(wire)).filter_map(|wire| wire.source.as_ref());
    let replaced: HashSet<DiagramEnd> = replaced.filter_map(|source| linker.reference(source)).collect();
    linker.targets(view, &replaced);
    for wire in view.wires() {
        let (Some(source), Some(target)) = (&wire.source, &wire.target) else { continue };
        // What leads to nothing that is drawn gives no component a place for it.
        if linker.split(source).is_none() || linker.split(target).is_none() {
            linker.diagram.left_out += 1;
            continue;
        }
        match linker.reference(source) {
            Some(from) => linker.wire(from, target),
            None => linker.diagram.left_out += 1,
        }
    }
    linker.promotions(view);
    linker.autowire(view);
}

struct Linker<'d> {
    diagram: &'d mut Diagram,
    places: HashMap<String, usize>,
    groups: Groups,
    ports: Ports,
    seen: HashSet<DiagramLink>,
    /// The ends that have a link already.
    linked: HashSet<DiagramEnd>,
    /// The number of further components that may be drawn as missing.
    left: usize,
    /// True if the composite is inside a component.
    is_inside: bool,
}

impl Linker<'_> {
    /// Wires references to their targets, but those to which a wire gives others in their place.
    fn targets(&mut self, view: &View<'_>, replaced: &HashSet<DiagramEnd>) {
        for (component, (_, model)) in view.components().enumerate() {
            for (port, reference) in model.references.iter().enumerate() {
                let from = DiagramEnd::Component { component, port };
                let stands = !replaced.contains(&from);
                for target in reference.targets.iter().filter(|_| stands) {
                    self.wire(from, target);
                }
            }
        }
    }

    /// Links each promotion of the composite to the promoted part, and gives it the interface of that.
    fn promotions(&mut self, view: &View<'_>) {
        for (place, service) in view.services().enumerate() {
            let Some(promote) = &service.promote else { continue };
            let interface = self.diagram.services[place].interface.clone();
            let Some(to) = self.service(promote, interface.as_deref()) else {
                self.diagram.left_out += 1;
                continue;
            };
            if let DiagramEnd::Component { component, port } = to {
                let inner = &self.diagram.components[component].services[port];
                self.diagram.services[place].interface = interface.or_else(|| inner.interface.clone());
            }
            self.add(LinkKind::Promotion, DiagramEnd::Composite(place), to);
        }
        for (place, reference) in view.references().enumerate() {
            for promote in &reference.promote {
                let Some(from) = self.reference(promote) else {
                    self.diagram.left_out += 1;
                    continue;
                };
                if let DiagramEnd::Component { component, port } = from {
                    let inner = &self.diagram.components[component].references[port];
                    let outer = &mut self.diagram.references[place].interface;
                    *outer = outer.take().or_else(|| inner.interface.clone());
                }
                self.add(LinkKind::Promotion, from, DiagramEnd::Composite(place));
            }
        }
    }

    /// Wires references without a target to the services of their interface, where the file asks for that.
    fn autowire(&mut self, view: &View<'_>) {
        let mut offers: Option<HashMap<String, Vec<(usize, usize)>>> = None;
        let mut left = MOST_AUTOWIRED;
        for (component, (is_default, model)) in view.components().enumerate() {
            let is_default = model.autowire.map_or(is_default, |one| one.value);
            for port in 0..self.diagram.components[component].references.len() {
                let from = DiagramEnd::Component { component, port };
                let written = model.references.get(port);
                let is_asked = written.and_then(|one| one.autowire).map_or(is_default, |one| one.value);
                if !is_asked || self.linked.contains(&from) {
                    continue;
                }
                let offers = offers.get_or_insert_with(|| self.offers(view.components().count()));
                let one = &self.diagram.components[component].references[port];
                let Some(all) = one.interface.as_ref().and_then(|interface| offers.get(interface)) else {
                    continue;
                };
                let own = all.binary_search_by_key(&component, |(component, _)| *component);
                let others = all.len() - usize::from(own.is_ok());
                let most = if one.many == Some(true) { others } else { others.min(1) };
                let drawn = most.min(left);
                let offered = all.iter().filter(|(offering, _)| *offering != component);
                for &(component, port) in offered.take(drawn) {
                    let link =
                        DiagramLink { kind: LinkKind::Wire, from, to: DiagramEnd::Component { component, port } };
                    if self.seen.insert(link) {
                        self.diagram.links.push(link);
                    }
                }
                left -= drawn;
                self.diagram.left_out += most - drawn;
            }
        }
    }

    /// The components among the first `count`, those that are there, that offer each interface, in order, each with the
    /// place of its first such service.
    fn offers(&self, count: usize) -> HashMap<String, Vec<(usize, usize)>> {
        let mut all: HashMap<String, Vec<(usize, usize)>> = HashMap::new();
        for (component, one) in self.diagram.components[..count].iter().enumerate() {
            for (port, service) in one.services.iter().enumerate() {
                let Some(interface) = &service.interface else { continue };
                let offers = match all.get_mut(interface) {
                    Some(offers) => offers,
                    None => all.entry(interface.clone()).or_default(),
                };
                if offers.last().is_none_or(|(last, _)| *last != component) {
                    offers.push((component, port));
                }
            }
        }
        all
    }

    fn wire(&mut self, from: DiagramEnd, target: &str) {
        let interface = match from {
            DiagramEnd::Component { component, port } => {
                self.diagram.components[component].references[port].interface.clone()
            }
            DiagramEnd::Composite(_) => None,
        };
        match self.service(target, interface.as_deref()) {
            Some(to) => self.add(LinkKind::Wire, from, to),
            None => self.diagram.left_out += 1,
        }
    }

    fn add(&mut self, kind: LinkKind, from: DiagramEnd, to: DiagramEnd) {
        let link = DiagramLink { kind, from, to };
        if self.seen.insert(link) {
            // What is promoted is wired around the composite, where there is something around it.
            if kind == LinkKind::Wire || self.is_inside {
                self.linked.insert(from);
            }
            self.diagram.links.push(link);
        }
    }

    /// The service that `component`, `component/service` or `component/service/binding` names; `None` where that is not
    /// drawn.
    fn service(&mut self, uri: &str, interface: Option<&str>) -> Option<DiagramEnd> {
        let (component, name) = self.split(uri)?;
        let port = match &name {
            Some(name) => self.ports.named(self.diagram, component, Side::Services, name),
            None => self.ports.meant(self.diagram, component, interface),
        };
        Some(DiagramEnd::Component { component, port })
    }

    /// The reference that `component` or `component/reference` names; `None` where that is not drawn.
    fn reference(&mut self, uri: &str) -> Option<DiagramEnd> {
        let (component, name) = self.split(uri)?;
        let port = match (name, self.diagram.components[component].references.len()) {
            (None, 1..) => 0,
            (name, _) => self.ports.named(self.diagram, component, Side::References, &name.unwrap_or_default()),
        };
        Some(DiagramEnd::Component { component, port })
    }

    /// The component of a URI, drawn as missing when there is none, and what follows it; `None` where there are too
    /// many that are missing.
    fn split(&mut self, uri: &str) -> Option<(usize, Option<String>)> {
        let uri = if has_expression(uri) { pattern(uri) } else { uri.to_owned() };
        let mut parts = uri.trim_start_matches('/').split('/');
        let name = parts.next().unwrap_or_default();
        // Replicas are one component, also under the name of one of them.
        let place = match self.places.get(name).copied().or_else(|| self.groups.find(name)) {
            Some(place) => place,
            None => {
                self.left = self.left.checked_sub(1)?;
                self.diagram.components.push(DiagramComponent {
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
        Some((place, parts.next().filter(|part| !part.is_empty()).map(str::to_owned)))
    }
}
