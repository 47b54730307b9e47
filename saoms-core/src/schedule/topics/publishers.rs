//! Which components may publish on a topic, as their classes and loops declare.

use std::collections::HashMap;
use std::sync::Arc;

use saoms_api::KnownPublisher;
use saoms_lang::assembly::ComponentSpec;

use crate::schedule::shared::Shared;

/// The numbers of the components that declare to publish on each topic, by its name on the bus.
#[derive(Debug, Default)]
pub(in crate::schedule) struct DeclaredPublishers {
    topics: HashMap<String, Vec<u32>>,
}

impl DeclaredPublishers {
    fn of(members: impl Iterator<Item = (u32, Arc<ComponentSpec>)>) -> DeclaredPublishers {
        let mut topics: HashMap<String, Vec<u32>> = HashMap::new();
        for (number, spec) in members {
            for declared in spec.publishes() {
                let publishers = topics.entry(spec.topic(&declared.name).into_owned()).or_default();
                if publishers.last() != Some(&number) {
                    publishers.push(number);
                }
            }
        }
        DeclaredPublishers { topics }
    }
}

impl Shared {
    /// The components that declare to publish on a topic of this name on the bus, without one.
    pub(in crate::schedule) fn publishers(&self, topic: &str, without: u32) -> Vec<KnownPublisher> {
        let mut engine = self.lock();
        let declared = match &engine.publishers {
            Some(known) => Arc::clone(known),
            None => {
                let declared = Arc::new(DeclaredPublishers::of(engine.members_everywhere()));
                engine.publishers = Some(Arc::clone(&declared));
                declared
            }
        };
        let numbers = declared.topics.get(topic).map_or(&[][..], Vec::as_slice);
        let known = |sender: &u32| {
            let (spec, has_begun) = match engine.slots.get(*sender as usize) {
                Some(slot) => (&slot.spec, slot.instances > 0 || slot.is_scheduled()),
                None => engine.networks.elsewhere.get(*sender)?,
            };
            let number = spec.class.declaration().speaker(&spec.values);
            Some(KnownPublisher {
                sender: *sender,
                has_begun,
                number: number.and_then(|number| u32::try_from(number).ok()),
            })
        };
        let known = numbers.iter().filter(|number| **number != without).filter_map(known).collect();
        self.release(engine);
        known
    }
}
