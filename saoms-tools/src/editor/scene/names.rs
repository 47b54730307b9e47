//! Places of names in an outline.

use std::collections::HashMap;

use super::outline::{Named, Outline, Side};

/// The first place of each name in the lists of an outline.
#[derive(Debug)]
pub(crate) struct Names {
    components: HashMap<String, usize>,
    properties: HashMap<String, usize>,
    services: HashMap<String, usize>,
    references: HashMap<String, usize>,
}

impl Names {
    pub(super) fn of(outline: &Outline) -> Self {
        Self {
            components: places(outline.components.iter().map(|one| &one.name)),
            properties: places(outline.properties.iter()),
            services: places(outline.services.iter()),
            references: places(outline.references.iter()),
        }
    }

    pub(crate) fn component(&self, name: &str) -> Option<usize> {
        self.components.get(name).copied()
    }

    pub(crate) fn property(&self, name: &str) -> Option<usize> {
        self.properties.get(name).copied()
    }

    /// The place of a service or a reference of the composite.
    pub(crate) fn promoted(&self, side: Side, name: &str) -> Option<usize> {
        let all = if side == Side::Service { &self.services } else { &self.references };
        all.get(name).copied()
    }
}

fn places<'n>(names: impl Iterator<Item = &'n Named>) -> HashMap<String, usize> {
    let mut places = HashMap::new();
    for (place, name) in names.enumerate() {
        places.entry(name.text.clone()).or_insert(place);
    }
    places
}
