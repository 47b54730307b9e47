//! The step from the model to a diagram.

use std::collections::{HashMap, HashSet};

use super::diagram::{Diagram, DiagramComponent, DiagramSetting, Port, State};
use super::{topics, wiring};
use saoms_lang::check::{Occurrences, TopicUse};
use saoms_lang::expression::pattern;
use saoms_lang::model::{
    self, Composite, Contribution, ImplementationKind, InterfaceElement, Link, Origin, ReferenceElement,
    ServiceElement, WireElement,
};
use saoms_lang::registry::{RegisteredClass, Registry};
use saoms_lang::source::Text;

/// Composites that are drawn inside each other, and components that are drawn in all of them: a few lines of text can
/// name a composite of composites of composites.
const MOST_DEEP: usize = 12;
const MOST_INSIDE: usize = 5_000;

impl Diagram {
    /// The diagram of the composites of a contribution that were asked for, as the one fleet that they are together,
    /// with what they include, and with what is inside the components that composites implement. Classes that are not
    /// registered are drawn with what the file says of them; components that are named and not there are drawn as
    /// missing. Of replicated components there is one box, with how many `census` has; what is not in it is left out.
    pub fn of(contribution: &Contribution, registry: &Registry, census: &Occurrences) -> Self {
        if contribution.asked_for().is_empty() {
            return Self::default();
        }
        let asked_for = (0..contribution.asked_for().len()).collect();
        let mut reader = Reader {
            contribution,
            registry,
            census,
            open: Vec::new(),
            around: Vec::new(),
            times: 1,
            left: MOST_INSIDE,
        };
        reader.diagram(asked_for)
    }
}

/// Composites together with all that they include.
pub(super) struct View<'c> {
    /// Each with what it says of autowire, or else the one that includes it.
    composites: Vec<(&'c Composite, bool)>,
    census: &'c Occurrences,
    /// The components around them.
    around: Vec<Origin>,
}

impl<'c> View<'c> {
    fn of(contribution: &'c Contribution, census: &'c Occurrences, around: Vec<Origin>, places: Vec<usize>) -> Self {
        let all = contribution.composites();
        let autowire = |place: usize, around: bool| all[place].autowire.map_or(around, |one| one.value);
        let mut seen: HashSet<usize> = places.iter().copied().collect();
        let mut places: Vec<(usize, bool)> = places.into_iter().map(|place| (place, autowire(place, false))).collect();
        let mut at = 0;
        while let Some(&(place, around)) = places.get(at) {
            let includes = all[place].includes.iter();
            let includes = includes.filter(|include| census.is_there(include.origin));
            for link in includes.filter_map(|include| contribution.link(include.origin)) {
                if let Link::To(found) = link
                    && seen.insert(*found)
                {
                    places.push((*found, autowire(*found, around)));
                }
            }
            at += 1;
        }
        let composites = places.into_iter().map(|(place, autowire)| (&all[place], autowire)).collect();
        Self { composites, census, around }
    }

    /// The topics that a component of them uses.
    pub(super) fn topics(&self, component: &model::ComponentElement) -> &'c [TopicUse] {
        self.census.topics(&self.around, component.origin)
    }

    pub(super) fn composites(&self) -> impl Iterator<Item = &'c Composite> {
        self.composites.iter().map(|(composite, _)| *composite)
    }

    /// All components, each with whether its composite asks for autowire.
    pub(super) fn components(&self) -> impl Iterator<Item = (bool, &'c model::ComponentElement)> {
        let all = self
            .composites
            .iter()
            .flat_map(|(composite, autowire)| composite.components.iter().map(move |one| (*autowire, one)));
        all.filter(|(_, component)| self.census.range(&self.around, component.origin).is_none_or(|(_, most)| most > 0))
    }

    pub(super) fn wires(&self) -> impl Iterator<Item = &'c WireElement> {
        let all = self.composites().flat_map(|composite| &composite.wires);
        all.filter(|wire| self.census.is_there(wire.origin))
    }

    pub(super) fn services(&self) -> impl Iterator<Item = &'c ServiceElement> {
        self.composites().flat_map(|composite| &composite.services)
    }

    pub(super) fn references(&self) -> impl Iterator<Item = &'c ReferenceElement> {
        self.composites().flat_map(|composite| &composite.references)
    }
}

struct Reader<'c> {
    contribution: &'c Contribution,
    registry: &'c Registry,
    census: &'c Occurrences,
    /// The composites that are being read.
    open: Vec<usize>,
    /// The components that they implement.
    around: Vec<Origin>,
    /// The number of copies of what is being read.
    times: usize,
    /// The number of further components that there may be inside others.
    left: usize,
}

impl Reader<'_> {
    /// The diagram of these composites; its namespace is that of the first.
    fn diagram(&mut self, places: Vec<usize>) -> Diagram {
        let of = |place: &usize| &self.contribution.composites()[*place];
        let names: Vec<&str> = places.iter().map(|place| of(place).name.as_str()).collect();
        let (name, namespace) =
            (names.join(", "), places.first().and_then(|place| of(place).target_namespace.as_ref()));
        let namespace = namespace.map(ToString::to_string);
        let outside = self.open.len();
        // Of several that run together one can be inside of another as well.
        if let [only] = places[..] {
            self.open.push(only);
        }
        let view = View::of(self.contribution, self.census, self.around.clone(), places);
        let mut diagram = Diagram {
            name,
            namespace,
            properties: view
                .composites()
                .flat_map(|one| &one.properties)
                .map(|one| setting(one, self.census))
                .collect(),
            services: view.services().map(|one| port(&one.name, one.contract().interface.as_ref())).collect(),
            references: view.references().map(reference).collect(),
            components: view.components().map(|(_, one)| self.component(one)).collect(),
            links: Vec::new(),
            topics: topics::of(&view),
            left_out: 0,
        };
        topics::join(&mut diagram, self.times > 1);
        self.open.truncate(outside);
        wiring::link(&view, &mut diagram, !self.around.is_empty());
        diagram
    }

    fn component(&mut self, one: &model::ComponentElement) -> DiagramComponent {
        let mut component = component(one, self.registry, self.census);
        if one.replicas.as_ref().is_some() {
            component.replicas = self.census.range(&self.around, one.origin);
        }
        let named = one.implementation.as_ref().and_then(|one| self.contribution.link(one.origin));
        let is_composite =
            one.implementation.as_ref().is_some_and(|one| matches!(one.kind, ImplementationKind::Composite { .. }));
        if is_composite && !matches!(named, Some(Link::To(_))) {
            component.state = State::NotFound;
        }
        if let Some(Link::To(place)) = named
            && !self.open.contains(place)
            && self.open.len() <= MOST_DEEP
        {
            let count = self.contribution.composites()[*place].components.len();
            if let Some(left) = self.left.checked_sub(count) {
                self.left = left;
                let times = self.times;
                self.times = times.saturating_mul(component.replicas.map_or(1, |(_, most)| most));
                self.around.push(one.origin);
                let inside = self.diagram(vec![*place]);
                self.around.pop();
                self.times = times;
                let ports = |ports: &[Port]| {
                    let all = ports.iter().enumerate();
                    let all = all.map(|(place, one)| Port { inside: Some(place), ..one.clone() });
                    all.collect::<Vec<_>>()
                };
                declared(ports(&inside.services), &mut component.services);
                declared(ports(&inside.references), &mut component.references);
                component.inside = Some(Box::new(inside));
            }
        }
        component
    }
}

/// The registered class of a component.
pub(super) fn class_of<'r>(component: &model::ComponentElement, registry: &'r Registry) -> Option<&'r RegisteredClass> {
    registry.get(component.class()?).map(AsRef::as_ref)
}

fn component(component: &model::ComponentElement, registry: &Registry, census: &Occurrences) -> DiagramComponent {
    let class = class_of(component, registry);
    let mut services: Vec<Port> =
        component.services.iter().map(|one| port(&one.name, one.contract().interface.as_ref())).collect();
    let mut references: Vec<Port> = component.references.iter().map(reference).collect();
    if let Some(class) = class {
        // What the host serves for every component is drawn where it is named.
        let interface = |name: &str| Some(name.to_owned()).filter(|name| !name.is_empty());
        let own = class.declaration().services.iter();
        let own = own.map(|one| Port { interface: interface(&one.interface.name), ..Port::named(&one.name) });
        declared(own, &mut services);
        let own = class.declaration().references.iter();
        let own = own.map(|one| Port {
            interface: interface(&one.interface.name),
            many: Some(one.many),
            ..Port::named(&one.name)
        });
        declared(own, &mut references);
    }
    let is_unknown = class.is_none() && component.class().is_some();
    DiagramComponent {
        name: match component.replicas.as_ref() {
            Some(_) => pattern(&component.name),
            None => component.name.to_string(),
        },
        replicas: None,
        class: label(component),
        state: if is_unknown { State::NotFound } else { State::Known },
        properties: component.properties.iter().map(|one| setting(one, census)).collect(),
        services,
        references,
        inside: None,
    }
}

/// Adds what the class or the composite inside declares beyond what the file says.
fn declared(all: impl IntoIterator<Item = Port>, ports: &mut Vec<Port>) {
    let names = ports.iter().enumerate().rev();
    let mut places: HashMap<String, usize> = names.map(|(place, one)| (one.name.clone(), place)).collect();
    for one in all {
        match places.get(&one.name) {
            Some(&place) => {
                let port = &mut ports[place];
                port.interface = port.interface.take().or(one.interface);
                port.many = port.many.or(one.many);
                port.inside = port.inside.or(one.inside);
            }
            None => {
                places.insert(one.name.clone(), ports.len());
                ports.push(one);
            }
        }
    }
}

fn label(component: &model::ComponentElement) -> String {
    let Some(implementation) = &component.implementation else { return String::new() };
    let kind = match &implementation.kind {
        ImplementationKind::Java { class } | ImplementationKind::Rust { class, .. } => {
            return class.as_ref().map_or_else(String::new, ToString::to_string);
        }
        ImplementationKind::Python(class) => {
            return class.name.as_ref().map_or_else(String::new, ToString::to_string);
        }
        ImplementationKind::Composite { name } => {
            return name.as_ref().map_or_else(|| "composite".to_owned(), |name| format!("composite {name}"));
        }
        ImplementationKind::Other { kind, .. } => kind,
    };
    format!("implementation.{kind}")
}

fn port(name: &str, interface: Option<&InterfaceElement>) -> Port {
    let interface = interface.and_then(|one| one.interface.as_ref()).map(ToString::to_string);
    Port { interface, ..Port::named(name) }
}

fn reference(one: &ReferenceElement) -> Port {
    let many = one.multiplicity.map(|one| one.value.is_many());
    Port { many, ..port(&one.name, one.contract().interface.as_ref()) }
}

fn setting(property: &model::Property, census: &Occurrences) -> DiagramSetting {
    let simple = property.simple_value().or_else(|| property.source()).or_else(|| property.file());
    let shown = |text: &Text| if census.is_secret(text.location) { "***".to_owned() } else { text.to_string() };
    DiagramSetting { name: property.name.to_string(), value: simple.map(shown) }
}
