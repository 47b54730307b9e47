use std::collections::HashMap;
use std::sync::Arc;

use serde_json::Value;

use super::ClassTopic;

/// The schemas of messages that are known: classes that use a topic share one.
#[derive(Clone, Debug, Default)]
pub(super) struct Schemas(HashMap<String, Vec<Arc<Value>>>);

impl Schemas {
    /// Lets these topics share the schemas that are known, and keeps those that are not.
    pub(super) fn share<'t>(&mut self, topics: impl Iterator<Item = &'t mut ClassTopic>) {
        for topic in topics {
            let known = self.0.entry(topic.message.clone()).or_default();
            match known.iter().find(|known| **known == topic.schema) {
                Some(known) => topic.schema = Arc::clone(known),
                None => known.push(Arc::clone(&topic.schema)),
            }
        }
    }
}
