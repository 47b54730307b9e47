//! Who speaks in messages: nobody outside the fleet speaks in the name of its components.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use saoms_lang::assembly::ComponentSpec;
use saoms_lang::registry::SpeakerField;
use serde_json::Value;

/// The components of a fleet that say who they are in messages, scheduled or not.
#[derive(Debug, Default)]
pub(in crate::schedule) struct Speakers {
    /// By the name of a topic after renaming.
    topics: HashMap<String, SpokenTopic>,
}

/// A topic whose messages say who speaks.
#[derive(Debug, Default)]
struct SpokenTopic {
    fields: Vec<SpeakerField>,
    /// The components that publish it, by their numbers.
    components: HashMap<i128, Arc<ComponentSpec>>,
}

/// A message from outside that has a component of the fleet as its speaker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForeignSpeaker {
    /// The field that says so.
    pub field: String,
    /// Its value.
    pub number: i128,
    /// The path of the component.
    pub component: String,
    /// What to do instead, as the end of a sentence; empty where nothing is known.
    pub instead: String,
}

impl fmt::Display for ForeignSpeaker {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ForeignSpeaker { field, number, component, instead } = self;
        write!(
            formatter,
            "`{field}` is {number}, the number of component `{component}`: only that component can publish messages with this number"
        )?;
        if instead.is_empty() { Ok(()) } else { write!(formatter, "; {instead}") }
    }
}

impl Speakers {
    pub(in crate::schedule) fn of(specs: impl Iterator<Item = Arc<ComponentSpec>>) -> Speakers {
        let mut topics: HashMap<String, SpokenTopic> = HashMap::new();
        for spec in specs {
            let Some(number) = spec.class.declaration().speaker(&spec.values) else { continue };
            for declared in spec.publishes().filter(|topic| !topic.speakers.is_empty()) {
                let topic = topics.entry(spec.topic(&declared.name).into_owned()).or_default();
                for field in &declared.speakers {
                    if !topic.fields.contains(field) {
                        topic.fields.push(field.clone());
                    }
                }
                topic.components.entry(number).or_insert_with(|| Arc::clone(&spec));
            }
        }
        Speakers { topics }
    }

    /// True if the messages of a topic say who speaks.
    pub(in crate::schedule) fn are_named_on(&self, topic: &str) -> bool {
        self.topics.contains_key(topic)
    }

    /// The component in whose name a message from outside speaks.
    pub(in crate::schedule) fn find(&self, topic: &str, message: &Value) -> Option<ForeignSpeaker> {
        let topic = self.topics.get(topic)?;
        topic.fields.iter().find_map(|one| {
            let number = one.speaker(message)?;
            let component = topic.components.get(&number)?.path.clone();
            Some(ForeignSpeaker { field: one.field.clone(), number, component, instead: one.instead.clone() })
        })
    }

    /// The fields of the messages of a topic that say who speaks, in words.
    pub(in crate::schedule) fn fields(&self, topic: &str) -> Vec<String> {
        self.topics.get(topic).map_or_else(Vec::new, |topic| topic.fields.iter().map(ToString::to_string).collect())
    }
}
