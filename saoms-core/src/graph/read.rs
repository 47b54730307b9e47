//! From the model to a diagram.

use super::diagram::{Component, Diagram, Port, Setting, State};
use super::{topics, wiring};
use crate::model::{self, Composite, ImplementationKind, Interface};
use crate::registry::{Class, Registry};

impl Diagram {
    /// What there is to draw of a composite. Classes that are not registered are drawn with what the file says of them;
    /// components that are named and not there are drawn as missing.
    pub fn of(composite: &Composite, registry: &Registry) -> Self {
        let mut diagram = Self {
            name: composite.name.to_string(),
            namespace: composite.target_namespace.as_ref().map(ToString::to_string),
            properties: composite.properties.iter().map(setting).collect(),
            services: composite
                .services
                .iter()
                .map(|one| port(&one.name, one.interface.as_deref()))
                .collect(),
            references: composite
                .references
                .iter()
                .map(|one| port(&one.name, one.interface.as_deref()))
                .collect(),
            components: composite.components.iter().map(|one| component(one, registry)).collect(),
            links: Vec::new(),
            topics: topics::of(composite, registry),
        };
        wiring::link(composite, &mut diagram);
        diagram
    }
}

/// The registered class of a component.
pub(super) fn class_of<'r>(component: &model::Component, registry: &'r Registry) -> Option<&'r Class> {
    registry.get(component.class()?).map(AsRef::as_ref)
}

fn component(component: &model::Component, registry: &Registry) -> Component {
    let class = class_of(component, registry);
    let mut services: Vec<Port> =
        component.services.iter().map(|one| port(&one.name, one.interface.as_deref())).collect();
    let mut references: Vec<Port> =
        component.references.iter().map(|one| port(&one.name, one.interface.as_deref())).collect();
    if let Some(class) = class {
        // What the host serves for every component is drawn where it is named.
        let own = class.declaration().services.iter();
        declared(own.map(|one| (&*one.name, &*one.interface.name)), &mut services);
        let own = class.declaration().references.iter();
        declared(own.map(|one| (&*one.name, &*one.interface.name)), &mut references);
    }
    let is_unknown = class.is_none() && component.class().is_some();
    Component {
        name: component.name.to_string(),
        class: label(component),
        state: if is_unknown { State::UnknownClass } else { State::Known },
        properties: component.properties.iter().map(setting).collect(),
        services,
        references,
    }
}

/// Adds what the class declares beyond what the file says.
fn declared<'c>(all: impl Iterator<Item = (&'c str, &'c str)>, ports: &mut Vec<Port>) {
    for (name, interface) in all {
        match ports.iter_mut().find(|port| port.name == name) {
            Some(port) => _ = port.interface.get_or_insert_with(|| interface.to_owned()),
            None => ports.push(Port { name: name.to_owned(), interface: Some(interface.to_owned()) }),
        }
    }
}

fn label(component: &model::Component) -> String {
    let Some(implementation) = &component.implementation else { return String::new() };
    let kind = match &implementation.kind {
        ImplementationKind::Java { class } | ImplementationKind::Rust { class, .. } => {
            return class.as_ref().map_or_else(String::new, ToString::to_string);
        }
        ImplementationKind::Composite { name } => {
            return name.as_ref().map_or_else(|| "composite".to_owned(), |name| format!("composite {name}"));
        }
        ImplementationKind::Other { kind, .. } => kind,
    };
    format!("implementation.{kind}")
}

fn port(name: &str, interface: Option<&Interface>) -> Port {
    let interface = interface.and_then(|one| one.interface.as_ref()).map(ToString::to_string);
    Port { name: name.to_owned(), interface }
}

fn setting(property: &model::Property) -> Setting {
    let simple = property.simple_value().or_else(|| property.source()).or_else(|| property.file());
    Setting { name: property.name.to_string(), value: simple.map(ToString::to_string) }
}
