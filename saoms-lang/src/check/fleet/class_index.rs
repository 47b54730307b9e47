//! The classes of a fleet, with what is asked of them at hand.

use std::sync::Arc;

use super::property_table::PropertyTable;
use crate::registry::{ClassTopic, LoopDeclaration, ReferenceDeclaration, RegisteredClass, ServiceDeclaration};

/// A class of the fleet, with its declaration at hand; where components of it have loops, together with these.
pub(crate) struct ClassIndex<'r> {
    pub(crate) class: &'r Arc<RegisteredClass>,
    pub(crate) table: PropertyTable<'r>,
    /// Its services, those that the host serves for it included.
    pub(crate) services: Vec<&'r ServiceDeclaration>,
    /// Those of its loops included, like its topics.
    pub(crate) references: Vec<&'r ReferenceDeclaration>,
    pub(crate) publishes: Vec<&'r ClassTopic>,
    pub(crate) subscribes: Vec<&'r ClassTopic>,
}

impl<'r> ClassIndex<'r> {
    pub(crate) fn new(class: &'r Arc<RegisteredClass>) -> Self {
        let declaration = class.declaration();
        let services = declaration.offers().collect();
        Self {
            class,
            table: PropertyTable::of_class(class),
            services,
            references: declaration.references.iter().collect(),
            publishes: declaration.publishes.iter().collect(),
            subscribes: declaration.subscribes.iter().collect(),
        }
    }

    /// The same together with what these loops use.
    pub(crate) fn with(&self, loops: impl Iterator<Item = &'r LoopDeclaration>) -> Self {
        let mut all = Self::new(self.class);
        for one in loops {
            // A topic that is declared twice in the same way is one; where two differ, both stay to be compared.
            all.publishes.extend(one.publishes.iter().filter(|topic| !self.publishes.contains(topic)));
            all.subscribes.extend(one.subscribes.iter().filter(|topic| !self.subscribes.contains(topic)));
            for reference in &one.references {
                if all.references.iter().all(|known| known.name != reference.name) {
                    all.references.push(reference);
                }
            }
        }
        all
    }

    /// True if the topics it declares are any.
    pub(crate) fn has_topics(&self) -> bool {
        !self.publishes.is_empty() || !self.subscribes.is_empty()
    }
}
