//! Which components of a fleet run in which program.

use std::collections::BTreeMap;

use smol_str::SmolStr;

use super::{Assembly, ComponentSpec, RemoteTarget, Wire, WireTarget};

impl Assembly {
    /// The components of the whole fleet, those that run here first.
    pub fn all(&self) -> impl Iterator<Item = &ComponentSpec> {
        self.components.iter().chain(&self.elsewhere)
    }

    /// The nodes of the whole fleet by name, each with the number of its components; none in a fleet that is not
    /// divided.
    pub fn nodes(&self) -> BTreeMap<SmolStr, usize> {
        let mut nodes = BTreeMap::new();
        for spec in self.all().filter(|spec| !spec.node.is_empty()) {
            *nodes.entry(spec.node.clone()).or_default() += 1;
        }
        nodes
    }

    /// The part of the fleet that a node runs: its components run, and those of all other nodes are known. Wires to
    /// components of other nodes are set apart.
    #[must_use]
    pub fn at(self, node: &str) -> Assembly {
        let Assembly { components: mut all, elsewhere: mut others, run, places: written, .. } = self;
        let ends = all.iter().map(|spec| {
            let remote = |wire: &Wire| wire.targets.iter().filter_map(|end| remote(&all, spec, end)).collect();
            spec.references.iter().map(remote).collect::<Vec<Box<[RemoteTarget]>>>()
        });
        let ends: Vec<_> = ends.collect();
        for (spec, ends) in all.iter_mut().zip(ends) {
            spec.references.iter_mut().zip(ends).for_each(|(wire, ends)| wire.elsewhere = ends);
        }
        let mut places = Vec::with_capacity(all.len());
        let mut components = Vec::new();
        for spec in all {
            let is_here = spec.node == *node;
            places.push(is_here.then_some(components.len()));
            if is_here { components.push(spec) } else { others.push(spec) }
        }
        for wire in components.iter_mut().flat_map(|spec| &mut spec.references) {
            let here = |end: WireTarget| Some(WireTarget { component: (*places.get(end.component)?)?, ..end });
            wire.targets = std::mem::take(&mut wire.targets).into_iter().filter_map(here).collect();
        }
        // Nobody here calls in their place.
        others.iter_mut().flat_map(|spec| &mut spec.references).for_each(|wire| wire.targets.clear());
        Assembly { components, elsewhere: others, node: node.into(), run, places: written }
    }

    /// The calls between programs that go over the network at a url, each with the component that calls.
    pub fn calls_over<'a>(&'a self, url: &'a str) -> impl Iterator<Item = (&'a ComponentSpec, &'a RemoteTarget)> {
        let is_on = move |spec: &&ComponentSpec| spec.url() == Some(url);
        let ends = |spec: &'a ComponentSpec| spec.references.iter().flat_map(|wire| &wire.elsewhere);
        self.all().filter(is_on).flat_map(move |spec| ends(spec).map(move |end| (spec, end)))
    }
}

impl ComponentSpec {
    /// The address of the network that it is on.
    pub fn url(&self) -> Option<&str> {
        self.task.as_ref()?.url.as_deref()
    }
}

/// The target of a component's wire, if it is in another node.
fn remote(all: &[ComponentSpec], spec: &ComponentSpec, end: &WireTarget) -> Option<RemoteTarget> {
    let provider = all.get(end.component).filter(|provider| provider.node != spec.node)?;
    Some(RemoteTarget {
        component: provider.path.clone(),
        node: provider.node.clone(),
        service: end.service.clone(),
        stops: provider.class.declaration().stops,
    })
}
