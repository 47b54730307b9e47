//! The services and references of components, with what composites around them say of these.

use super::outer::Outer;
use super::{Expanding, copied, is_foreign, is_policy, is_sca, started};
use crate::check::instance::Instance;
use crate::check::offer::Side;
use crate::check::target::uri;
use crate::model::{Composite, Reference, Service};
use crate::source::Text;
use crate::xml::{Element, Node};

/// Something inside a service or a reference, with the replica that it is written for.
type Within<'a> = (Element<'a>, Option<&'a Instance>);

fn is_binding(element: &Element<'_>) -> bool {
    element.local_name().starts_with("binding.")
}

fn is_interface(element: &Element<'_>) -> bool {
    element.local_name().starts_with("interface.")
}

fn is_callback(element: &Element<'_>) -> bool {
    is_sca(element.namespace()) && element.local_name() == "callback"
}

impl<'a> Expanding<'_, 'a> {
    fn outer(&self, side: Side) -> &Outer<'a> {
        match side {
            Side::Service => &self.services,
            Side::Reference => &self.references,
        }
    }

    /// The services of a component of which something is said.
    pub(super) fn services_of(&self, place: usize) -> Vec<Node> {
        let names = self.names_of(place, Side::Service);
        let all = names.iter().filter_map(|name| {
            let node = self.contract(Side::Service, place, name)?;
            if name.is_empty() { self.leave(Side::Service, place, node) } else { Some(node) }
        });
        all.collect()
    }

    /// Leaves what is said of a service or a reference whose name nobody knows to the composite, which promotes it as it was promoted.
    fn leave(&self, side: Side, place: usize, mut node: Node) -> Option<Node> {
        let step = self.outer(side).steps(place, "").next()?;
        let mut left = self.left.borrow_mut();
        let left = match side {
            Side::Service => &mut left.services,
            Side::Reference => &mut left.references,
        };
        let mut name = format!("{}.{}", self.member(step.owner).path().replace('/', "."), step.outer);
        while left.iter().any(|one| one.attribute("name") == Some(&name)) || self.promotes_as(side, &name) {
            name.push('_');
        }
        node.set("name", name);
        node.set("promote", self.names[place].as_str());
        if let Some(multiplicity) = step.element.attribute("multiplicity") {
            node.set("multiplicity", multiplicity.value());
        }
        left.push(node);
        None
    }

    /// Whether the composite itself has a service or a reference of this name.
    fn promotes_as(&self, side: Side, name: &str) -> bool {
        let mut units = self.fleet.scopes[0].units.iter().map(|unit| &self.fleet.units[*unit]);
        match side {
            Side::Service => units.any(|unit| unit.services().any(|one| one.name == *name)),
            Side::Reference => units.any(|unit| unit.references().any(|one| one.name == *name)),
        }
    }

    /// The references of a component of which something is said.
    pub(super) fn references_of(&self, place: usize) -> Vec<Node> {
        let mut names = self.names_of(place, Side::Reference);
        let wires = self.wires.get(&place).into_iter().flatten();
        for name in wires.map(|wire| wire.name).chain(self.wired(place).iter().map(|(name, _)| name.as_str()))
        {
            if !names.iter().any(|known| known == name) {
                names.push(name.to_owned());
            }
        }
        let mut all = Vec::new();
        for name in &names {
            let mut ends = self.ends((place, name));
            if ends.is_empty() {
                let found = self.wired(place).into_iter().filter(|(known, _)| known == name);
                ends.extend(found.flat_map(|(_, ends)| ends));
            }
            let node = self.contract(Side::Reference, place, name);
            let has_address = node.as_ref().is_some_and(Node::has_address);
            // In SCA 1.1 a reference has either targets or addresses.
            if name.is_empty() || has_address && self.like.version.is_1_1() {
                let source = match name.as_str() {
                    "" => self.names[place].clone(),
                    name => format!("{}/{name}", self.names[place]),
                };
                let wire = |end: String| Node::new("wire").with("source", source.clone()).with("target", end);
                self.left.borrow_mut().wires.extend(ends.into_iter().map(wire));
                all.extend(match name.as_str() {
                    "" => node.and_then(|node| self.leave(Side::Reference, place, node)),
                    _ => node,
                });
                continue;
            }
            let is_said = node.is_some() || !ends.is_empty();
            let mut node = node.unwrap_or_else(|| Node::new("reference").with("name", name.as_str()));
            let addresses = node.take_addresses_of("binding.sca");
            if ends.is_empty() {
                ends = self.addressed((place, name), addresses);
            }
            if !ends.is_empty() {
                node.set("target", ends.join(" "));
            }
            all.extend(is_said.then_some(node));
        }
        all
    }

    /// What the addresses of bindings of SCA lead to that composites around a reference say.
    fn addressed(&self, (place, name): (usize, &str), addresses: Vec<String>) -> Vec<String> {
        let step = self.references.steps(place, name).next();
        let member = self.member(step.map_or(place, |step| step.owner));
        let text = |uri: String| Text::new(uri.trim().into(), member.component.name.location);
        addresses.into_iter().flat_map(|uri| self.leads(&text(uri), (member.scope, None), None)).collect()
    }

    /// What the checker found for the references of a component of a class.
    fn wired(&self, place: usize) -> Vec<(String, Vec<String>)> {
        let Some(class) = self.fleet.class_of(place, self.classes) else { return Vec::new() };
        let references = class.references.iter().zip(self.wiring.of(place));
        let references = references.map(|(declared, found)| {
            let end = |provider: &crate::check::target::Provider| {
                let uri = uri((provider.member, *provider), self.fleet, self.classes);
                let service = uri.split_once('/').map_or("", |(_, service)| service);
                format!("{}/{service}", self.names[provider.member])
            };
            (declared.name.clone(), found.iter().map(end).collect())
        });
        references.filter(|(_, ends): &(_, Vec<_>)| !ends.is_empty()).collect()
    }

    /// The names of the services or references of a component that are written or promoted, each once.
    fn names_of(&self, place: usize, side: Side) -> Vec<String> {
        let component = self.member(place).component;
        let mut names: Vec<String> = match side {
            Side::Service => component.services.iter().map(|one| one.name.to_string()).collect(),
            Side::Reference => component.references.iter().map(|one| one.name.to_string()).collect(),
        };
        for step in self.outer(side).of_member(place) {
            if !names.contains(&step.name) {
                names.push(step.name.clone());
            }
        }
        names
    }

    /// The element of a service or a reference that a component has itself.
    fn own(&self, side: Side, place: usize, name: &str) -> Option<Within<'a>> {
        let member = self.member(place);
        let origin = match side {
            Side::Service => member.component.service(name)?.origin,
            Side::Reference => member.component.reference(name)?.origin,
        };
        Some((origin.element(&member.composite.document), member.instance))
    }

    /// A service or a reference with its own and what composites around it say. `None` where nobody says anything.
    fn contract(&self, side: Side, place: usize, name: &str) -> Option<Node> {
        let own = self.own(side, place, name);
        let around = self.elements_around(side, place, name);
        let inside = |is: fn(&Element<'_>) -> bool| {
            own.into_iter().flat_map(move |(one, instance)| within(one, instance, is))
        };
        let bindings = self.said_around(side, place, name, is_binding);
        let callbacks = self.said_around(side, place, name, is_callback);
        let interfaces: Vec<_> = inside(is_interface).collect();
        let interfaces = if interfaces.is_empty() {
            self.said_around(side, place, name, is_interface)
        } else {
            interfaces
        };
        let bindings: Vec<_> = if bindings.is_empty() { inside(is_binding).collect() } else { bindings };
        let callbacks: Vec<_> = if callbacks.is_empty() { inside(is_callback).collect() } else { callbacks };
        let mut node = match own {
            Some((element, instance)) => {
                let mut node = started(element, &["target"], instance);
                node.set("name", name);
                node
            }
            None => Node::new(side.name()).with("name", name),
        };
        for (outer, _) in &around {
            for said in ["autowire", "wiredByImpl"] {
                if let Some(value) = outer.attribute(said).filter(|_| node.attribute(said).is_none()) {
                    node.set(said, value.value());
                }
            }
        }
        let elements: Vec<Element<'a>> = around.iter().map(|(element, _)| *element).collect();
        Self::policies(&mut node, own.map(|(element, _)| element), &elements);
        let policies = own
            .iter()
            .chain(&around)
            .flat_map(|(one, instance)| within(*one, *instance, |one| is_policy(*one)));
        let rest = inside(|one| one.local_name() == "operation" && is_sca(one.namespace()));
        let foreign = inside(|one| is_foreign(*one) && !is_binding(one) && !is_interface(one));
        let children = policies.chain(interfaces.into_iter().take(1)).chain(rest).chain(bindings);
        let children: Vec<_> = children.chain(callbacks.into_iter().take(1)).chain(foreign).collect();
        // What it is called is not known: the class knows its interface.
        let says_nothing = |(child, _): &Within<'_>| name.is_empty() && is_interface(child);
        let is_empty = children.iter().all(says_nothing) && own.is_none() && !node.has_more_than("name");
        let node = node.children(children.into_iter().map(|(child, instance)| copied(child, instance)));
        (!is_empty).then_some(node)
    }

    /// What is said of a service or a reference by the composites that promote it and the components that these implement.
    fn elements_around(&self, side: Side, place: usize, name: &str) -> Vec<Within<'a>> {
        let mut all = Vec::new();
        for step in self.outer(side).steps(place, name) {
            all.push((step.element, None));
            all.extend(self.own(side, step.owner, step.outer));
            all.extend(self.elements_around(side, step.owner, step.outer));
        }
        all
    }

    /// What those around a service or a reference say of one kind: the outermost that says something counts.
    fn said_around(
        &self,
        side: Side,
        place: usize,
        name: &str,
        is: fn(&Element<'_>) -> bool,
    ) -> Vec<Within<'a>> {
        let mut all: Vec<Within<'a>> = Vec::new();
        for step in self.outer(side).steps(place, name) {
            let mut said = self.said_around(side, step.owner, step.outer, is);
            if said.is_empty() {
                let own = self.own(side, step.owner, step.outer);
                said.extend(own.into_iter().flat_map(|(one, instance)| within(one, instance, is)));
            }
            if said.is_empty() {
                said.extend(within(step.element, None, is));
            }
            let is_new = |(one, _): &Within<'a>| {
                !all.iter().any(|(known, _)| {
                    known.id() == one.id() && known.document().file() == one.document().file()
                })
            };
            let said: Vec<_> = said.into_iter().filter(is_new).collect();
            all.extend(said);
        }
        all
    }

    /// A service of the composite.
    pub(super) fn promoted_service(&self, service: &Service, composite: &'a Composite) -> Node {
        let element = service.origin.element(&composite.document);
        let mut node = started(element, &[], None);
        if let Some(promote) = &service.promote {
            let found = self.promotes(promote, Side::Service, 0);
            node.set("promote", found.first().map_or(promote.as_str(), String::as_str));
        }
        node.children(held(element))
    }

    /// A reference of the composite.
    pub(super) fn promoted_reference(&self, reference: &Reference, composite: &'a Composite) -> Node {
        let element = reference.origin.element(&composite.document);
        let mut node = started(element, &[], None);
        let found = reference.promote().iter().flat_map(|text| self.promotes(text, Side::Reference, 0));
        let found: Vec<String> = found.collect();
        if !found.is_empty() {
            node.set("promote", found.join(" "));
        }
        if !reference.targets.is_empty() {
            let ends =
                reference.targets.iter().flat_map(|text| self.leads(text, (0, None), reference.interface()));
            node.set("target", ends.collect::<Vec<_>>().join(" "));
        }
        node.children(held(element))
    }
}

/// What a service or a reference of the composite holds.
fn held(element: Element<'_>) -> impl Iterator<Item = Node> {
    let is_said = |child: &Element<'_>| {
        let is_documentation = is_sca(child.namespace()) && child.local_name() == "documentation";
        (is_sca(child.namespace()) || is_foreign(*child)) && !is_documentation
    };
    element.children().filter(is_said).map(|child| copied(child, None))
}

/// What is directly inside an element, of one kind.
fn within<'a>(
    element: Element<'a>,
    instance: Option<&'a Instance>,
    is: impl Fn(&Element<'_>) -> bool,
) -> Vec<Within<'a>> {
    element.children().filter(|child| is(child)).map(|child| (child, instance)).collect()
}
