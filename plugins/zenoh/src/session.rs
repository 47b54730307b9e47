//! A session of Zenoh.

use std::collections::HashMap;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, PoisonError, RwLock};
use std::thread;
use std::time::Duration;

use saoms_abi::{Bytes, Status, TransportEvents};
use zenoh::Wait as _;
use zenoh::pubsub::Subscriber;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::{Locality, Sample};

use super::Failure;
use super::probe::probe;
use super::settings::Settings;

/// Longest time for the end of a session.
const PATIENCE: Duration = Duration::from_secs(1);

/// The functions of the program, until the session closes.
struct Program {
    /// `None` after the session was closed: no function is called any more. Whoever calls one holds this for reading.
    events: RwLock<Option<TransportEvents>>,
}

// SAFETY: by the rules of the boundary, the functions may be called from any thread with the state that comes with
// them.
unsafe impl Send for Program {}
// SAFETY: the same.
unsafe impl Sync for Program {}

impl Program {
    fn deliver(&self, token: u64, sample: &Sample) {
        let events = self.events.read().unwrap_or_else(PoisonError::into_inner);
        let Some(events) = *events else { return };
        let message = sample.payload().to_bytes();
        let attachment = sample.attachment().map(|attachment| attachment.to_bytes()).unwrap_or_default();
        let (key, message, attachment) =
            (Bytes::text(sample.key_expr().as_str()), Bytes::lend(&message), Bytes::lend(&attachment));
        // SAFETY: the session is open, so that the state is valid; the bytes live until the call returns. A message for
        // which there is no room is dropped: the thread that reads the network must not wait for one reader.
        let _: Status = unsafe { (events.deliver)(events.state, token, key, message, attachment) };
    }
}

/// A session of a network.
pub(super) struct Session {
    zenoh: zenoh::Session,
    program: Arc<Program>,
    subscribers: Mutex<HashMap<u64, Subscriber<()>>>,
}

impl Session {
    /// Joins a network, or opens one.
    pub(super) fn open(settings: &Settings, events: TransportEvents) -> Result<Session, Failure> {
        if !settings.listen {
            probe(settings.address())?;
        }
        let zenoh = zenoh::open(settings.config()?).wait().map_err(|error| {
            let status = if settings.listen { Status::FAILED } else { Status::UNREACHABLE };
            // Behind its words, Zenoh names a line of its source.
            let text = error.to_string();
            let text = text.split(" at /").next().unwrap_or_default().to_owned();
            Failure { status, text }
        })?;
        let program = Arc::new(Program { events: RwLock::new(Some(events)) });
        Ok(Session { zenoh, program, subscribers: Mutex::default() })
    }

    pub(super) fn put(&self, key: &str, message: &[u8], attachment: &[u8], is_urgent: bool) -> Result<(), Failure> {
        // What the network has no room for is dropped, and sent again by the program: to wait for one slow reader would
        // hold up all others.
        let priority = if is_urgent { Priority::InteractiveHigh } else { Priority::Data };
        let put = self
            .zenoh
            .put(key, message)
            .attachment(attachment)
            .congestion_control(CongestionControl::Drop)
            .priority(priority);
        put.wait().map_err(Failure::failed)
    }

    pub(super) fn subscribe(&self, keys: &str, token: u64) -> Result<(), Failure> {
        let program = Arc::clone(&self.program);
        let subscriber = self.zenoh.declare_subscriber(keys.to_owned());
        // Within a program messages take no network.
        let subscriber =
            subscriber.allowed_origin(Locality::Remote).callback(move |sample| program.deliver(token, &sample));
        let subscriber = subscriber.wait().map_err(Failure::failed)?;
        self.subscribers.lock().unwrap_or_else(PoisonError::into_inner).insert(token, subscriber);
        Ok(())
    }

    pub(super) fn unsubscribe(&self, token: u64) -> Result<(), Failure> {
        let subscriber = self.subscribers.lock().unwrap_or_else(PoisonError::into_inner).remove(&token);
        subscriber.map_or(Ok(()), |subscriber| subscriber.undeclare().wait().map_err(Failure::failed))
    }

    pub(super) fn close(self) {
        // From here on no function of the program is called: a call that runs is waited for.
        *self.program.events.write().unwrap_or_else(PoisonError::into_inner) = None;
        self.subscribers.into_inner().unwrap_or_else(PoisonError::into_inner).clear();
        // It may wait for a peer that does not answer: then it is left to itself.
        let (done, is_done) = channel();
        let zenoh = self.zenoh;
        thread::spawn(move || done.send(zenoh.close().wait().is_ok()));
        let _ = is_done.recv_timeout(PATIENCE);
    }
}
