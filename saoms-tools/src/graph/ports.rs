//! The services and references of components by their names and interfaces.

use std::collections::HashMap;

use super::diagram::{Diagram, Port};

/// The service that periodic components have without naming it.
const TASK_SERVICE: &str = "TaskInterface";

/// The kind of a port of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Side {
    Services,
    References,
}

impl Side {
    fn ports(self, diagram: &mut Diagram, component: usize) -> &mut Vec<Port> {
        let component = &mut diagram.components[component];
        match self {
            Self::Services => &mut component.services,
            Self::References => &mut component.references,
        }
    }
}

/// Ports of a component that are gone through without an index.
const FEW: usize = 8;

/// The index of ports by name, for components that have many.
#[derive(Default)]
pub(super) struct Ports {
    sides: HashMap<(usize, Side), Index>,
}

#[derive(Default)]
struct Index {
    by_name: HashMap<String, usize>,
    by_interface: HashMap<String, usize>,
    /// The first that is not the one that all periodic components have.
    first: Option<usize>,
}

impl Index {
    fn add(&mut self, place: usize, port: &Port) {
        self.by_name.entry(port.name.clone()).or_insert(place);
        if let Some(interface) = &port.interface {
            self.by_interface.entry(interface.clone()).or_insert(place);
        }
        if self.first.is_none() && port.name != TASK_SERVICE {
            self.first = Some(place);
        }
    }
}

impl Ports {
    fn index(&mut self, diagram: &mut Diagram, component: usize, side: Side) -> &mut Index {
        self.sides.entry((component, side)).or_insert_with(|| {
            let mut index = Index::default();
            let ports = side.ports(diagram, component);
            ports.iter().enumerate().for_each(|(place, port)| index.add(place, port));
            index
        })
    }

    /// The place of the port of this name, which is there from now on.
    pub(super) fn named(&mut self, diagram: &mut Diagram, component: usize, side: Side, name: &str) -> usize {
        let ports = side.ports(diagram, component);
        if ports.len() < FEW {
            let known = ports.iter().position(|port| port.name == name);
            return known.unwrap_or_else(|| {
                ports.push(Port::named(name));
                ports.len() - 1
            });
        }
        let index = self.index(diagram, component, side);
        if let Some(place) = index.by_name.get(name) {
            return *place;
        }
        let ports = side.ports(diagram, component);
        let port = Port::named(name);
        index.add(ports.len(), &port);
        ports.push(port);
        ports.len() - 1
    }

    /// The service that is meant where only its component is named: the first with this interface, or else the first.
    pub(super) fn meant(&mut self, diagram: &mut Diagram, component: usize, interface: Option<&str>) -> usize {
        let services = &diagram.components[component].services;
        let meant = if services.len() < FEW {
            let fits = |port: &Port| interface.is_some() && port.interface.as_deref() == interface;
            let first = || services.iter().position(|port| port.name != TASK_SERVICE);
            services.iter().position(fits).or_else(first)
        } else {
            let index = self.index(diagram, component, Side::Services);
            let fitting = interface.and_then(|interface| index.by_interface.get(interface));
            fitting.copied().or(index.first)
        };
        match meant {
            Some(place) => place,
            None => self.named(diagram, component, Side::Services, ""),
        }
    }
}
