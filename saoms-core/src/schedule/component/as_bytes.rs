//! Messages that libraries send as bytes.

use std::sync::Arc;

use saoms_api::Failure;
use saoms_api::host::SharedMessage;
use saoms_lang::schema::Schema;

use super::host::ComponentHost;
use crate::bus::TopicId;

impl ComponentHost<'_> {
    /// The schema of a topic.
    pub(super) fn schema(&mut self, topic: TopicId) -> Result<Arc<Schema>, Failure> {
        if let Some((_, known)) = self.part.schemas.iter().find(|(known, _)| *known == topic) {
            return Ok(Arc::clone(known));
        }
        let text = self.shared.lock().bus.schema(topic).to_owned();
        let schema = Schema::parse(&text).map_err(|error| Failure::new(format!("the schema of a topic: {error}")))?;
        let schema = Arc::new(schema);
        self.part.schemas.push((topic, Arc::clone(&schema)));
        Ok(schema)
    }

    /// Checks a message that a plugin sent as bytes, before it is published; gives it the key and the block that its
    /// bytes say.
    #[cold]
    pub(super) fn check(&mut self, topic: TopicId, message: SharedMessage) -> Result<SharedMessage, Failure> {
        let schema = self.schema(topic)?;
        let refused = |reason: String| {
            let name = self.shared.lock().bus.name(topic).to_string();
            Err(Failure::new(format!("topic `{name}`: {reason}")))
        };
        if let Err(error) = schema.check(message.bytes()) {
            return refused(format!("what it sends is not a message `{}`: {error}", schema.name()));
        }
        let (key, place) = (schema.key(message.bytes()), schema.place(message.bytes()));
        match (message.key(), key, schema.key_name()) {
            (Some(given), None, _) => refused(format!(
                "the key {given} is given for a message `{}`, which has none: give null, or declare which field is its \
                 `key`",
                schema.name()
            )),
            (Some(given), Some(key), Some(field)) if given != key => refused(format!(
                "the key {given} is given for a message `{}` whose field `{field}` is {key}: give that, or null",
                schema.name()
            )),
            _ => Ok(message.of(key, place)),
        }
    }
}
