//! Which components of a fleet run in which program.

use std::collections::BTreeMap;

use smol_str::SmolStr;

use super::{Assembly, ComponentSpec, WireTarget};

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

    /// The part of the fleet that a node runs: its components run, and those of all other nodes are known.
    #[must_use]
    pub fn at(self, node: &str) -> Assembly {
        let mut places = Vec::with_capacity(self.components.len());
        let (mut components, mut elsewhere) = (Vec::new(), self.elsewhere);
        for spec in self.components {
            let is_here = spec.node == *node;
            places.push(is_here.then_some(components.len()));
            if is_here { components.push(spec) } else { elsewhere.push(spec) }
        }
        // The checker refuses wires between nodes, and nobody calls from elsewhere.
        for wire in components.iter_mut().flat_map(|spec| &mut spec.references) {
            let here = |end: WireTarget| Some(WireTarget { component: (*places.get(end.component)?)?, ..end });
            wire.targets = std::mem::take(&mut wire.targets).into_iter().filter_map(here).collect();
        }
        elsewhere.iter_mut().flat_map(|spec| &mut spec.references).for_each(|wire| wire.targets.clear());
        Assembly { components, elsewhere, node: node.into(), run: self.run, networks: self.networks }
    }
}
