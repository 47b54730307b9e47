//! Diagrams: the parts of a picture.

use saoms_api::host::TopicKind;

/// A composite as a picture shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagram {
    /// Its name.
    pub name: String,
    /// Its target namespace.
    pub namespace: Option<String>,
    /// Its properties.
    pub properties: Vec<DiagramSetting>,
    /// The services that it promotes.
    pub services: Vec<Port>,
    /// The references that it promotes.
    pub references: Vec<Port>,
    /// Its components in order; last those that are named and not there.
    pub components: Vec<DiagramComponent>,
    /// Wires and promotions.
    pub links: Vec<DiagramLink>,
    /// The topics of its components, in the order of their first use.
    pub topics: Vec<DiagramTopic>,
    /// The number of wires that are left out: of those that autowire makes there can be as many as the product of all
    /// ends, and those to components that are not there have a box each.
    pub left_out: usize,
}

/// A component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiagramComponent {
    /// Its name; that of a replicated one with `*` for each expression.
    pub name: String,
    /// The fewest and the most replicas in one of the composites that it is in, where it is replicated and that is
    /// known.
    pub replicas: Option<(usize, usize)>,
    /// The name of its class, or the kind of its implementation; empty where the file says nothing.
    pub class: String,
    /// The knowledge about the class.
    pub state: State,
    /// Its properties.
    pub properties: Vec<DiagramSetting>,
    /// Its services.
    pub services: Vec<Port>,
    /// Its references.
    pub references: Vec<Port>,
    /// The diagram inside, when a composite implements it.
    pub inside: Option<Box<Diagram>>,
}

impl DiagramComponent {
    /// Its name as a picture has it: `Robot* × 40` for forty replicas, `Robot* × 2–4` where halls have two to four.
    pub(super) fn label(&self) -> String {
        match self.replicas {
            Some((least, most)) if least != most => format!("{} \u{d7} {least}\u{2013}{most}", self.name),
            Some((count, _)) => format!("{} \u{d7} {count}", self.name),
            None => self.name.clone(),
        }
    }
}

impl Diagram {
    /// The number of wires that are left out of it and of the diagrams inside.
    pub fn all_left_out(&self) -> usize {
        let inside = self.components.iter().filter_map(|component| component.inside.as_deref());
        self.left_out + inside.map(Self::all_left_out).sum::<usize>()
    }

    /// True if this is so of the diagram, or of one inside its components.
    pub(super) fn any(&self, is_so: &dyn Fn(&Self) -> bool) -> bool {
        let mut inside = self.components.iter().filter_map(|component| component.inside.as_deref());
        is_so(self) || inside.any(|inside| inside.any(is_so))
    }
}

/// The knowledge about a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Its class is registered, or its implementation is of another kind.
    Known,
    /// Its class is not registered, or its composite is not found.
    NotFound,
    /// Something names it, and the composite does not have it.
    Missing,
}

/// A property and its value as the file gives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiagramSetting {
    /// Its name.
    pub name: String,
    /// Its value; `None` when there is none, or it is no simple one.
    pub value: Option<String>,
}

/// A service or a reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name; empty when only its component is named.
    pub name: String,
    /// Its interface, where that is known.
    pub interface: Option<String>,
    /// True for a reference that takes several targets; `None` where the file does not say it.
    pub many: Option<bool>,
    /// The place among the services or references of the composite that implements its component.
    pub inside: Option<usize>,
}

impl Port {
    /// A port with a name alone.
    pub(super) fn named(name: &str) -> Self {
        Self { name: name.to_owned(), interface: None, many: None, inside: None }
    }
}

/// A wire or a promotion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DiagramLink {
    /// A wire or a promotion.
    pub kind: LinkKind,
    /// The side that calls: a reference of a component, or a service of the composite.
    pub from: DiagramEnd,
    /// The side that is called: a service of a component, or a reference of the composite.
    pub to: DiagramEnd,
}

/// The kind of a link: a wire or a promotion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LinkKind {
    /// From a component's reference to a component's service.
    Wire,
    /// Between a part of the composite and the part of a component that it promotes.
    Promotion,
}

/// An end of a link: the place of a service or reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DiagramEnd {
    /// Of a component.
    Component {
        /// The component's place.
        component: usize,
        /// The place among its services or references.
        port: usize,
    },
    /// Of the composite, with the place among its services or references.
    Composite(usize),
}

/// A topic with its ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiagramTopic {
    /// Its name after renaming, or what its names have in common, with `*` for the rest.
    pub name: String,
    /// Its names, where replicas have one each that all their ends share.
    pub names: Vec<String>,
    /// State or event.
    pub kind: TopicKind,
    /// The type of its messages.
    pub message: String,
    /// The places of the components that publish it, in order.
    pub publishers: Vec<usize>,
    /// The places of the components that read it, in order.
    pub subscribers: Vec<usize>,
}
