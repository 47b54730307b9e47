//! Fleets in which classes are taken as given, as one composite: what is known is resolved, what is not stays as it is written.

mod autowired;
mod contracts;
mod ends;
mod outer;
mod values;

use std::cell::RefCell;
use std::collections::BTreeSet;

use super::classes::ClassIndex;
use super::fleet::{Fleet, Kind, Member};
use super::instance::Instance;
use super::offer::Side;
use super::options::Options;
use super::parameters::{Parameters, Place};
use super::report::Report;
use super::room::Room;
use super::wire::{Wire, wires};
use super::wires::Wiring;
use super::{Resolved, Sound};
use crate::assembly::{Expansion, implementation, looped, names, start, valued};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::expression::{has_expression, render};
use crate::hash::Map;
use crate::model::{Component, Composite, Include, Link, Part, SAOMS_NAMESPACE, Version};
use crate::source::Sources;
use crate::xml::{Element, Node};
use outer::Outer;

/// What of a fleet is left to be written.
struct Expanding<'f, 'a> {
    fleet: &'f Fleet<'a>,
    classes: &'f [ClassIndex<'a>],
    wiring: &'f Wiring,
    /// What each component is called, by its place; those that composites implement are not there.
    names: Vec<String>,
    /// How many components of each scope are there.
    beside: Vec<usize>,
    like: &'a Composite,
    /// What composites around each component make of its services and its references.
    services: Outer<'a>,
    references: Outer<'a>,
    wires: Map<usize, Vec<Wire<'f>>>,
    left: RefCell<Left>,
    /// The properties of the composite that are left, since they have no value yet.
    open: RefCell<BTreeSet<String>>,
    faults: RefCell<Vec<Diagnostic>>,
}

/// What is left to the composite, since its components cannot say it.
#[derive(Default)]
struct Left {
    /// Services of components that nobody knows the names of.
    services: Vec<Node>,
    /// References of such.
    references: Vec<Node>,
    /// Wires from references that nobody knows the names of, or that could not say it.
    wires: Vec<Node>,
}

/// Writes a fleet without errors as one composite like the first. What cannot be written so is reported.
pub(super) fn given<'a>(
    sound: Sound<'_, 'a>,
    like: &'a Composite,
    options: &'a Options,
    sources: &Sources,
    library: impl Fn(&Component) -> Option<String>,
    report: &mut Report<'_>,
) -> Option<Expansion> {
    let Sound { fleet, classes, resolved, wiring } = sound;
    // All of it was told.
    let mut unheard = Diagnostics::new();
    let silent = &mut Report::new(sources, &mut unheard);
    silent.assumes = options.assume_classes;
    let mut parameters = Parameters::of(fleet, options, silent);
    parameters.keeps_elements = true;
    let runs: Vec<usize> = (0..fleet.members.len()).filter(|place| fleet.members[*place].runs()).collect();
    let paths: Vec<&str> = runs.iter().map(|place| fleet.members[*place].path()).collect();
    let mut all = vec![String::new(); fleet.members.len()];
    for (place, name) in runs.iter().zip(names(&paths)) {
        all[*place] = name;
    }
    let mut beside = vec![0; fleet.scopes.len()];
    runs.iter().for_each(|place| beside[fleet.members[*place].scope] += 1);
    let expanding = Expanding {
        fleet,
        classes,
        wiring,
        names: all,
        beside,
        like,
        services: Outer::of(Side::Service, fleet, classes),
        references: Outer::of(Side::Reference, fleet, classes),
        wires: wires(fleet, classes, &Room::default(), silent).0,
        left: RefCell::default(),
        open: RefCell::default(),
        faults: RefCell::default(),
    };
    let mut components = Vec::with_capacity(runs.len());
    for (place, resolved) in
        resolved.into_iter().enumerate().filter(|(place, _)| fleet.members[*place].runs())
    {
        expanding.widened(place).into_iter().for_each(|one| report.push(one));
        let library = library(fleet.members[place].component);
        components.push(expanding.component(place, resolved, library, (&mut parameters, silent)));
    }
    let root = expanding.root(components);
    let faults = expanding.faults.into_inner();
    let is_written = faults.is_empty();
    faults.into_iter().for_each(|fault| report.push(fault));
    is_written.then(|| Expansion::given(like.version, root))
}

/// A text of a replica with its numbers; `None` for what stays as it is.
fn numbered(instance: Option<&Instance>) -> impl Fn(&str) -> Option<String> {
    move |text| {
        let instance = instance.filter(|_| has_expression(text))?;
        render(text, &mut |name| instance.value(name)).ok()
    }
}

/// An element as it is written, with the numbers of a replica.
fn copied(element: Element<'_>, instance: Option<&Instance>) -> Node {
    Node::copied(element, is_sca, numbered(instance))
}

/// The start of an element as it is written, without attributes of these names, and without what SAOMS resolves.
fn started(element: Element<'_>, without: &[&str], instance: Option<&Instance>) -> Node {
    let stays = |name: &str, namespace: &str| {
        namespace != SAOMS_NAMESPACE && !(namespace.is_empty() && without.contains(&name))
    };
    Node::started(element, stays, numbered(instance))
}

fn is_sca(namespace: &str) -> bool {
    Version::from_namespace(namespace).is_some()
}

/// What belongs to intents and policy sets, and is written as elements.
fn is_policy(element: Element<'_>) -> bool {
    is_sca(element.namespace()) && matches!(element.local_name(), "requires" | "policySetAttachment")
}

/// What other programs add.
fn is_foreign(element: Element<'_>) -> bool {
    let is_known = is_sca(element.namespace()) || element.namespace() == SAOMS_NAMESPACE;
    if is_known { element.local_name() == "extensions" } else { true }
}

impl<'a> Expanding<'_, 'a> {
    fn member(&self, place: usize) -> &Member<'a> {
        &self.fleet.members[place]
    }

    /// The composite: what is left of it beside its components, and these.
    fn root(&self, components: Vec<Node>) -> Node {
        let document = &self.like.document;
        let element = self.like.origin.element(document);
        let units = &self.fleet.scopes[0].units;
        let composites = || units.iter().flat_map(|unit| self.fleet.units[*unit].composites.iter().copied());
        let mut all = Vec::new();
        for composite in composites() {
            let is_left = |include: &&Include| {
                matches!(self.fleet.contribution.link(include.origin), Some(Link::Missing(_)))
            };
            let left = composite.includes.iter().filter(is_left);
            all.extend(left.map(|include| copied(include.origin.element(&composite.document), None)));
        }
        let open = self.open.borrow();
        for composite in composites() {
            let left = composite.properties.iter().filter(|property| open.contains(property.name.as_str()));
            all.extend(left.map(|property| copied(property.origin.element(&composite.document), None)));
        }
        for composite in composites() {
            all.extend(composite.services.iter().map(|service| self.promoted_service(service, composite)));
        }
        let Left { services, references, wires } = self.left.take();
        all.extend(services.into_iter().chain(components));
        for composite in composites() {
            all.extend(composite.references.iter().map(|one| self.promoted_reference(one, composite)));
        }
        all.extend(references.into_iter().chain(wires));
        for composite in composites() {
            let children = composite.document.root().children();
            let kept = children.filter(|child| is_foreign(*child) || is_policy(*child));
            let kept = kept.filter(|child| !is_policy(*child) || std::ptr::eq(composite, self.like));
            all.extend(kept.map(|child| copied(child, None)));
        }
        started(element, &[], None).children(all)
    }

    /// A component with all that is in it.
    fn component(
        &self,
        place: usize,
        resolved: Option<Box<Resolved<'a>>>,
        library: Option<String>,
        (parameters, report): (&mut Parameters<'a>, &mut Report<'_>),
    ) -> Node {
        let member = self.member(place);
        let (component, document, instance) = (member.component, &member.composite.document, member.instance);
        let element = component.origin.element(document);
        let mut node = start(started(element, &["autowire"], instance), member.path(), &self.names[place]);
        let around = self.around(place);
        Self::policies(&mut node, Some(element), &around);
        let usual = self.like.autowire.is_some_and(|said| said.value);
        let said = component.autowire().map(|said| said.value);
        if let Some(autowire) = said.or((member.autowire != usual).then_some(member.autowire)) {
            node.set("autowire", autowire.to_string());
        }
        let own = element.children().filter(|child| is_policy(*child)).map(|child| (child, instance));
        let outer = around.iter().flat_map(|one| one.children().filter(|child| is_policy(*child)));
        let policies: Vec<_> = own.chain(outer.map(|child| (child, None))).collect();
        node = node.children(policies.into_iter().map(|(child, instance)| copied(child, instance)));
        let at = Place { unit: member.unit, composite: member.composite, instance };
        let (made, loops) = match (resolved, member.kind) {
            (Some(resolved), Kind::Class(class)) => {
                let Resolved { values, task, loops, .. } = *resolved;
                let class = std::sync::Arc::clone(self.classes[class].class);
                let spec =
                    super::spec(member.path(), class, library, (values, task), Vec::new(), loops.specs);
                let mut made = vec![implementation(&spec)];
                made.extend(valued(&spec));
                (made, looped(&spec))
            }
            _ => {
                let implementation = component.implementation.as_ref().map(|one| {
                    let mut node = copied(one.origin().element(document), instance);
                    if let Some(library) = library {
                        node.set("library", library);
                    }
                    node
                });
                let mut made: Vec<Node> = implementation.into_iter().collect();
                for property in &component.properties {
                    made.extend(self.property(at, property, parameters, report));
                }
                let mut loops = Vec::new();
                for one in component.loops() {
                    let mut node = copied(one.origin().element(document), instance);
                    node.clear();
                    for property in &one.properties {
                        node = node.children(self.property(at, property, parameters, report));
                    }
                    loops.push(node);
                }
                (made, loops)
            }
        };
        let foreign = element
            .children()
            .filter(|child| is_foreign(*child) && !child.local_name().starts_with("implementation."));
        node.children(made)
            .children(self.services_of(place))
            .children(self.references_of(place))
            .children(loops)
            .children(foreign.map(|child| copied(child, instance)))
    }

    /// What is around a component and has intents and policy sets for it: composites, what they implement, and so on.
    fn around(&self, place: usize) -> Vec<Element<'a>> {
        let mut all = Vec::new();
        let mut member = self.member(place);
        loop {
            let main = self.fleet.units[member.unit].main();
            all.push(member.composite.document.root());
            if !std::ptr::eq(main, member.composite) {
                all.push(main.document.root());
            }
            let Some(owner) = self.fleet.scopes[member.scope].owner else { break };
            member = self.member(owner);
            let document = &member.composite.document;
            all.extend(member.component.implementation.as_ref().map(|one| one.origin().element(document)));
            all.push(member.component.origin.element(document));
        }
        let root = self.like.document.root();
        let is_root =
            |one: &Element<'_>| one.id() == root.id() && one.document().file() == root.document().file();
        all.retain(|one| !is_root(one));
        all
    }

    /// Gives what is written of `own` the intents and policy sets of those around it as well.
    fn policies(node: &mut Node, own: Option<Element<'a>>, around: &[Element<'a>]) {
        for name in ["requires", "policySets"] {
            let mut known = BTreeSet::new();
            let all = own.iter().map(|one| (one, true)).chain(around.iter().map(|one| (one, false)));
            for (element, is_own) in all {
                for word in element.attribute(name).into_iter().flat_map(|one| one.words()) {
                    let (prefix, local) = word.split_once(':').unwrap_or(("", &word));
                    let namespace = element.resolve_prefix(prefix).unwrap_or_default();
                    if known.insert((namespace.clone().into_owned(), local.to_owned())) && !is_own {
                        node.add_name(name, (prefix, &namespace), local);
                    }
                }
            }
        }
    }
}
