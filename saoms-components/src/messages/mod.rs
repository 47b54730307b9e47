//! Messages and topics of the fleet. Each message stands in the file of its subject, with its topic, which says who
//! publishes and reads it, and with its validation.

mod environment;
mod handling;
mod jobs;
mod movement;
mod passage;
mod strain;
mod team;
mod visit;

use saoms_api::host::TopicDeclaration;
use saoms_api::{Message, Topic};

pub use environment::*;
pub use handling::*;
pub use jobs::*;
pub use movement::*;
pub use passage::*;
pub use strain::*;
pub use team::*;
pub use visit::*;

/// True if a topic is declared to carry the messages of this one, whatever its name.
pub(crate) fn carries<M: Message>(declared: &TopicDeclaration<'_>, topic: &Topic<M>) -> bool {
    let topic = topic.declaration();
    (declared.kind, declared.message, declared.schema) == (topic.kind, topic.message, topic.schema)
}
