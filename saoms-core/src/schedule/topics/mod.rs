//! Topics of a running fleet, as operators see them, and who publishes, speaks and takes there.

pub(super) mod publishers;
pub(super) mod speakers;
pub(super) mod takers;

use std::sync::Arc;

use saoms_api::rule::nearest;
use serde_json::Value;

use super::engine::Engine;
use super::inject::InjectError;
use super::shared::Shared;
use crate::bus::TopicId;
use crate::observe::{Observer, SentMessage};
use crate::status::{TopicReaderStatus, TopicStatus};
use saoms_lang::schema::Schema;

impl Engine {
    /// The topic of this name.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn topic(&self, topic: &str) -> Result<TopicId, InjectError> {
        self.bus.find(topic).ok_or_else(|| {
            let known: Vec<String> = self.bus.names().map(str::to_owned).collect();
            let nearest = nearest(topic, known.iter().map(String::as_str)).map(str::to_owned);
            InjectError::UnknownTopic { topic: topic.to_owned(), nearest, known }
        })
    }
}

/// All topics with their publishers and readers. The topics of a component whose code runs are those that it declares.
pub(super) fn topics(shared: &Shared) -> Vec<TopicStatus> {
    let speakers = shared.speakers();
    let engine = shared.lock();
    let mut all: Vec<(TopicId, TopicStatus)> = engine
        .bus
        .topics()
        .map(|id| {
            let status = TopicStatus {
                name: engine.bus.name(id).to_string(),
                kind: engine.bus.kind(id).name(),
                message: engine.bus.message(id).to_owned(),
                schema: serde_json::from_str(engine.bus.schema(id)).unwrap_or(Value::Null),
                speakers: speakers.fields(engine.bus.name(id)),
                publishers: Vec::new(),
                readers: Vec::new(),
            };
            (id, status)
        })
        .collect();
    for slot in engine.slots.iter().filter(|slot| slot.is_member() && slot.is_alive()) {
        let component = || slot.name.to_string();
        let Some(body) = &slot.body else {
            let (declared, spec) = (slot.spec.class.declaration(), &slot.spec);
            for (_, topic) in &mut all {
                let is_it = |name: &str| spec.topic(name) == topic.name;
                if declared.publishes.iter().any(|one| is_it(&one.name)) {
                    topic.publishers.push(component());
                }
                if declared.subscribes.iter().any(|one| is_it(&one.name)) {
                    topic.readers.push(TopicReaderStatus { component: component(), waiting: None, queue: None });
                }
            }
            continue;
        };
        for (id, topic) in &mut all {
            if body.part.publishers.contains(id) {
                topic.publishers.push(component());
            }
            if let Some(reader) = body.part.subscriptions.iter().find(|one| engine.bus.topic_of(one) == *id) {
                let (waiting, queue) = engine.bus.waiting(reader).unzip();
                topic.readers.push(TopicReaderStatus { component: component(), waiting, queue });
            }
        }
    }
    all.into_iter().map(|(_, topic)| topic).collect()
}

/// The messages that a state topic retains, the oldest first.
///
/// # Errors
/// The fleet has no such topic.
pub(super) fn retained(shared: &Shared, topic: &str) -> Result<Vec<SentMessage>, InjectError> {
    let engine = shared.lock();
    let id = engine.topic(topic)?;
    Ok(engine.retained(id))
}

/// Lets an observer get the messages of a topic, or no more. Gives the schema of the messages.
pub(super) fn watch(
    shared: &Shared,
    topic: &str,
    observer: &Arc<dyn Observer>,
    wanted: bool,
) -> Result<Schema, InjectError> {
    let mut engine = shared.lock();
    let id = engine.topic(topic)?;
    if let Some(number) = shared.observers.number(observer) {
        if wanted {
            engine.bus.observe(id, &[number]);
        } else {
            engine.bus.ignore(id, number);
        }
        engine.bus.watch_all(id, number, wanted && observer.hears_others());
        engine.tell_interest(id);
    }
    let schema = engine.bus.schema(id).to_owned();
    let message = engine.bus.message(id).to_owned();
    drop(engine);
    let malformed = |error: saoms_lang::schema::SchemaError| InjectError::Content {
        topic: topic.to_owned(),
        message,
        error: error.to_string(),
    };
    Schema::parse(&schema).map_err(malformed)
}
