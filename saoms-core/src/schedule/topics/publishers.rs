//! Which components may publish on a topic, as their classes and loops declare, and who speaks there by which number.

use std::collections::HashMap;
use std::sync::Arc;

use saoms_api::KnownPublisher;
use saoms_lang::assembly::ComponentSpec;

use crate::schedule::engine::Engine;
use crate::schedule::shared::Shared;

/// The components that declare to publish on each topic, by its name on the bus.
#[derive(Debug, Default)]
pub(in crate::schedule) struct DeclaredPublishers {
    topics: HashMap<String, Declared>,
}

/// The components that declare to publish on a topic.
#[derive(Debug, Default)]
struct Declared {
    /// Their numbers.
    publishers: Vec<u32>,
    /// Those that have a number by which they say who speaks, by that number: of several with one number the first.
    speakers: HashMap<u32, u32>,
}

impl DeclaredPublishers {
    fn of(members: impl Iterator<Item = (u32, Arc<ComponentSpec>)>) -> DeclaredPublishers {
        let mut topics: HashMap<String, Declared> = HashMap::new();
        for (number, spec) in members {
            let speaks_as = speaker_number(&spec);
            for declared in spec.publishes() {
                let topic = topics.entry(spec.topic(&declared.name).into_owned()).or_default();
                if topic.publishers.last() != Some(&number) {
                    topic.publishers.push(number);
                }
                if let Some(speaks_as) = speaks_as.filter(|_| !declared.speakers.is_empty()) {
                    topic.speakers.entry(speaks_as).or_insert(number);
                }
            }
        }
        DeclaredPublishers { topics }
    }
}

/// The number by which a component says who speaks in messages.
fn speaker_number(spec: &ComponentSpec) -> Option<u32> {
    spec.class.declaration().speaker(&spec.values).and_then(|number| u32::try_from(number).ok())
}

impl Engine {
    /// The components that declare to publish on each topic, as the fleet is now.
    fn declared_publishers(&mut self) -> Arc<DeclaredPublishers> {
        if let Some(known) = &self.publishers {
            return Arc::clone(known);
        }
        let declared = Arc::new(DeclaredPublishers::of(self.members_everywhere()));
        self.publishers = Some(Arc::clone(&declared));
        declared
    }
}

impl Shared {
    /// The components that declare to publish on a topic of this name on the bus, without one.
    pub(in crate::schedule) fn publishers(&self, topic: &str, without: u32) -> Vec<KnownPublisher> {
        let mut engine = self.lock();
        let declared = engine.declared_publishers();
        let numbers = declared.topics.get(topic).map_or(&[][..], |topic| &topic.publishers);
        let known = |sender: &u32| {
            let (spec, has_begun) = match engine.slots.get(*sender as usize) {
                Some(slot) => (&slot.spec, slot.instances > 0 || slot.is_scheduled()),
                None => engine.networks.elsewhere.get(*sender)?,
            };
            Some(KnownPublisher { sender: *sender, has_begun, number: speaker_number(spec) })
        };
        let known = numbers.iter().filter(|number| **number != without).filter_map(known).collect();
        self.release(engine);
        known
    }

    /// The component that declares to publish on a topic of this name on the bus, and says by this number who speaks.
    pub(in crate::schedule) fn speaker(&self, topic: &str, number: u32) -> Option<u32> {
        let mut engine = self.lock();
        let declared = engine.declared_publishers();
        let speaker = declared.topics.get(topic).and_then(|topic| topic.speakers.get(&number)).copied();
        self.release(engine);
        speaker
    }
}
