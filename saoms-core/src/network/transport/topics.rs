use std::sync::Arc;

use saoms_abi::{Bytes, Status, TopicTransportTable};
use serde::Serialize;
use serde_json::Value;

use super::session::{OpenSession, called, done};
use super::{Opened, Receiver, SessionSettings, TopicTransport};

/// A topic as other programs know it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicForm {
    /// Its name, as names of ROS 2 are.
    pub topic: String,
    /// The type of its messages.
    #[serde(rename = "type")]
    pub kind: String,
    /// The type as a text of ROS 2.
    pub definition: String,
    /// The type description, whose hash ROS 2 knows.
    pub description: String,
    /// The schema of its messages, with the names of ROS 2.
    pub schema: Value,
    /// True where late readers want its newest messages, too.
    pub state: bool,
}

/// A session of a transport of topics. Dropping it closes it.
#[derive(Debug)]
pub struct TopicSession {
    table: &'static TopicTransportTable,
    open: OpenSession,
}

impl TopicSession {
    /// Opens a session.
    ///
    /// # Errors
    /// It will not help to try again: why.
    pub fn open(
        transport: TopicTransport,
        settings: &SessionSettings,
        receiver: Arc<dyn Receiver>,
    ) -> Result<Opened<TopicSession>, String> {
        let table = transport.table;
        Ok(match OpenSession::open((table.open, table.close), settings, receiver)? {
            Opened::Session(open) => Opened::Session(TopicSession { table, open }),
            Opened::Unreachable(why) => Opened::Unreachable(why),
        })
    }

    /// Says that the program publishes a topic.
    ///
    /// # Errors
    /// The transport refuses it: why.
    pub fn advertise(&self, topic: &TopicForm, token: u64) -> Result<(), String> {
        let topic = serde_json::to_string(topic).map_err(|error| error.to_string())?;
        // SAFETY: the session is open, and the text lives until the call returns.
        done(called(|error| unsafe { (self.table.advertise)(self.open.session, Bytes::text(&topic), token, error) }))
    }

    /// Publishes a message; of a state topic in place of the one before it with the same number. False: there is no
    /// room for it now.
    ///
    /// # Errors
    /// The transport cannot publish it.
    pub fn publish(&self, token: u64, of: u64, message: &[u8]) -> Result<bool, String> {
        let (status, error) = called(|error| {
            // SAFETY: the session is open, and the bytes live until the call returns.
            unsafe { (self.table.publish)(self.open.session, token, of, Bytes::lend(message), error) }
        });
        match status {
            Status::OK => Ok(true),
            Status::FULL => Ok(false),
            _ => Err(error),
        }
    }

    /// Asks for the messages of a topic.
    ///
    /// # Errors
    /// The transport refuses it: why.
    pub fn subscribe(&self, topic: &TopicForm, token: u64) -> Result<(), String> {
        let topic = serde_json::to_string(topic).map_err(|error| error.to_string())?;
        // SAFETY: the session is open, and the text lives until the call returns.
        done(called(|error| unsafe { (self.table.subscribe)(self.open.session, Bytes::text(&topic), token, error) }))
    }
}
