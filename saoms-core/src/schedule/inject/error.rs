//! Errors of messages from outside.

use std::fmt;

use crate::schedule::topics::speakers::ForeignSpeaker;

/// Error of a message from outside that was not accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InjectError {
    /// The fleet has no such topic.
    UnknownTopic {
        /// The name that was given.
        topic: String,
        /// The most similar topic, if there is a similar one.
        nearest: Option<String>,
        /// All topics of the fleet.
        known: Vec<String>,
    },
    /// The message does not fit the schema of the topic.
    Content {
        /// The topic.
        topic: String,
        /// The name of its messages.
        message: String,
        /// Found and expected content.
        error: String,
    },
    /// It speaks in the name of a component of the fleet.
    Speaker {
        /// The topic.
        topic: String,
        /// The component, and what says so.
        speaker: Box<ForeignSpeaker>,
    },
    /// The run ends.
    Ending,
}

impl fmt::Display for InjectError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InjectError::UnknownTopic { topic, nearest: Some(near), .. } => {
                write!(formatter, "the fleet has no topic `{topic}`; did you mean `{near}`?")
            }
            InjectError::UnknownTopic { topic, known, .. } if known.is_empty() => {
                write!(formatter, "the fleet has no topic `{topic}`: it has no topics")
            }
            InjectError::UnknownTopic { topic, known, .. } => {
                write!(formatter, "the fleet has no topic `{topic}`; its topics are: {}", known.join(", "))
            }
            InjectError::Content { topic, message, error } => {
                write!(formatter, "topic `{topic}`: this is not a message `{message}`: {error}")
            }
            InjectError::Speaker { topic, speaker } => write!(formatter, "topic `{topic}`: {speaker}"),
            InjectError::Ending => formatter.write_str("the run ends"),
        }
    }
}

impl std::error::Error for InjectError {}
