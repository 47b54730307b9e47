//! Messages of a component as a transport carries them: their bytes, and an envelope beside them.

use std::sync::Arc;

use saoms_api::host::cdr;

use super::incoming::Arrived;
use super::outgoing::Sent;
use super::wire::{Enclosed, Envelope, InCell, LARGEST_NUMBER};

/// Events in one frame, at most, and their bytes, at most, but for those of a single one.
const MOST_MESSAGES: usize = 512;
const MOST_BYTES: usize = 48 << 10;

/// Messages of a component on a topic, whose numbers follow one another: one, or several events.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// The program that sends them.
    program: u64,
    messages: Vec<Sent>,
    /// Number of their bytes.
    size: usize,
}

impl Frame {
    pub(super) fn new(program: u64, message: Sent) -> Frame {
        let size = message.bytes.len();
        Frame { program, messages: vec![message], size }
    }

    /// Adds an event; gives it back if it does not follow the last one, or there is no room for it.
    pub(super) fn add(&mut self, event: Sent) -> Result<(), Sent> {
        let follows = |last: &Sent| {
            last.number + 1 == event.number && last.component == event.component && last.schema == event.schema
        };
        let has_room = self.messages.len() < MOST_MESSAGES && self.size + event.bytes.len() <= MOST_BYTES;
        if !has_room || !self.messages.last().is_some_and(follows) {
            return Err(event);
        }
        self.size += event.bytes.len();
        self.messages.push(event);
        Ok(())
    }

    /// The bytes of the messages, and their [`Envelope`].
    pub fn encode(&self) -> (Arc<[u8]>, Arc<[u8]>) {
        let enclosed = self.messages.iter().map(|sent| Enclosed {
            size: u32::try_from(sent.bytes.len()).unwrap_or(u32::MAX),
            to: sent.to.as_deref().unwrap_or_default().to_owned(),
            key: sent.key.unwrap_or_default(),
            has_key: sent.key.is_some(),
            sent: sent.sent,
            cause: sent.cause,
        });
        let first = self.messages.first();
        let envelope = cdr::encode(&Envelope {
            program: self.program,
            component: first.map(|sent| sent.component.to_string()).unwrap_or_default(),
            schema: first.map_or(0, |sent| sent.schema),
            number: first.map_or(0, |sent| sent.number),
            messages: enclosed.collect(),
            cells: first.map(|sent| sent.cells.clone()).unwrap_or_default(),
        });
        let bytes = match self.messages.as_slice() {
            [message] => Arc::clone(&message.bytes),
            messages => messages
                .iter()
                .fold(Vec::with_capacity(self.size), |mut all, message| {
                    all.extend_from_slice(&message.bytes);
                    all
                })
                .into(),
        };
        (bytes, envelope.into())
    }
}

/// A frame of another program.
pub(super) struct ArrivedFrame {
    pub(super) program: u64,
    pub(super) schema: u64,
    /// The messages with their numbers.
    pub(super) messages: Vec<(u64, Arrived)>,
    /// The cells that a message of a state topic concerns.
    pub(super) cells: Vec<InCell>,
}

impl ArrivedFrame {
    /// Reads a frame; `None` if its envelope does not fit its bytes.
    pub(super) fn decode(bytes: &[u8], envelope: &[u8]) -> Option<ArrivedFrame> {
        let Envelope { program, component, schema, number, messages, cells } = cdr::decode(envelope).ok()?;
        if number > LARGEST_NUMBER {
            return None;
        }
        let component: Arc<str> = component.into();
        let mut rest = bytes;
        let mut arrived = Vec::with_capacity(messages.len());
        for (number, Enclosed { size, to, key, has_key, sent, cause }) in (number..).zip(messages) {
            let (bytes, behind) = rest.split_at_checked(usize::try_from(size).ok()?)?;
            rest = behind;
            let (component, key) = (Arc::clone(&component), has_key.then_some(key));
            let bytes = bytes.to_owned();
            arrived.push((number, Arrived { component, to, key, sent, cause, bytes, origin: 0, number }));
        }
        rest.is_empty().then_some(ArrivedFrame { program, schema, messages: arrived, cells })
    }
}
