//! A session of Zenoh.

use std::collections::HashMap;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, PoisonError, RwLock};
use std::thread;
use std::time::Duration;

use saoms_transport::{Bytes, Failure, Status, Transport, TransportEvents};
use zenoh::Wait as _;
use zenoh::key_expr::KeyExpr;
use zenoh::pubsub::Subscriber;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::{Locality, Sample, SampleKind};

use super::probe::probe;
use super::settings::Settings;
use super::{causes, certificates};

/// Longest time for the end of a session.
const PATIENCE: Duration = Duration::from_secs(1);

/// Messages with one key before the key is declared. Zenoh then sends its number and keeps the routes that belong to
/// it; without that it looks them up for each message.
const FREQUENT: u32 = 16;

/// Most keys that are declared by one session.
const DECLARED: usize = 1024;

/// Most keys whose messages are counted.
const COUNTED: usize = 4096;

/// Attempts in a row that fail for one reason before that is told.
const CERTAIN: u32 = 3;

/// The functions of the program, until the session closes.
pub(super) struct Program {
    /// `None` after the session was closed: no function is called any more. Whoever calls one holds this for reading.
    events: RwLock<Option<TransportEvents>>,
    /// True for one that joins a router.
    is_client: bool,
    /// What was said last of the link.
    link: Mutex<(bool, String)>,
    /// Why the last attempt to connect again failed, and how many did in a row.
    refused: Mutex<(String, u32)>,
    settings: Settings,
}

// SAFETY: by the rules of the boundary, the functions may be called from any thread with the state that comes with
// them.
unsafe impl Send for Program {}
// SAFETY: the same.
unsafe impl Sync for Program {}

impl Program {
    /// Tells that the link is there or not, unless that was said.
    fn tell_link(&self, is_up: bool, reason: &str) {
        let mut link = self.link.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.is_client || *link == (is_up, reason.to_owned()) {
            return;
        }
        *link = (is_up, reason.to_owned());
        let events = self.events.read().unwrap_or_else(PoisonError::into_inner);
        let Some(events) = *events else { return };
        // SAFETY: the session is open, so that the state is valid; the text lives until the call returns.
        unsafe { (events.link)(events.state, u32::from(is_up), Bytes::text(reason)) };
    }

    /// Tells why the link does not come again. A router that still has the old link refuses the new one for a moment.
    pub(super) fn cannot_connect(&self, cause: &str) {
        let failure = causes::failure(&self.settings, cause);
        let mut refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        let before = if refused.0 == failure.text { refused.1 } else { 0 };
        *refused = (failure.text, before + 1);
        // That nobody listens goes without saying.
        if failure.status == Status::FAILED && refused.1 >= CERTAIN {
            self.tell_link(false, &refused.0);
        }
    }

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
    keys: RwLock<Keys>,
}

/// The keys that this session puts often.
#[derive(Default)]
struct Keys {
    /// The messages of each key that is not declared.
    counts: HashMap<String, u32>,
    declared: HashMap<String, KeyExpr<'static>>,
}

impl Session {
    /// The declared form of a key, once the key is frequent.
    fn declared(&self, key: &str) -> Result<Option<KeyExpr<'static>>, Failure> {
        let keys = self.keys.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(declared) = keys.declared.get(key) {
            return Ok(Some(declared.clone()));
        }
        let is_full = keys.declared.len() >= DECLARED;
        drop(keys);
        if is_full {
            return Ok(None);
        }
        let mut keys = self.keys.write().unwrap_or_else(PoisonError::into_inner);
        if keys.counts.len() >= COUNTED {
            keys.counts.clear();
        }
        let count = keys.counts.entry(key.to_owned()).or_default();
        *count += 1;
        if *count < FREQUENT || keys.declared.contains_key(key) {
            return Ok(None);
        }
        let declared = self.zenoh.declare_keyexpr(key.to_owned()).wait().map_err(Failure::failed)?;
        keys.counts.remove(key);
        keys.declared.insert(key.to_owned(), declared.clone());
        Ok(Some(declared))
    }
}

impl Transport for Session {
    /// Joins a network, or opens one.
    fn open(settings: &str, events: TransportEvents) -> Result<Session, Failure> {
        let settings = Settings::read(settings)?;
        let endpoint = settings.endpoint();
        let is_client = !settings.listen && settings.of_peers().is_none();
        if is_client {
            probe(settings.address())?;
            causes::listen(&endpoint);
        }
        let prepared = settings.prepare()?;
        let zenoh = zenoh::open(prepared.config.clone()).wait().map_err(|error| {
            if is_client {
                return causes::failure(&settings, &causes::last(&endpoint).unwrap_or_default());
            }
            // Behind its words, Zenoh names a line of its source.
            let text = error.to_string();
            let text = text.split(" at /").next().unwrap_or_default();
            Failure::failed(match () {
                () if text.contains("Address already in use") => {
                    "another program listens at this port: end it, or give the broker another `port`".to_owned()
                }
                () if text.contains("Cannot assign requested address") => {
                    "this machine does not have this address: give the broker one of its own as `IP`, or `0.0.0.0` for all".to_owned()
                }
                () if text.contains("Permission denied") => "this user may not listen at this port: take one from 1024 on".to_owned(),
                () => text.to_owned(),
            })
        })?;
        let link = Mutex::new((true, String::new()));
        let program = Arc::new(Program {
            events: RwLock::new(Some(events)),
            is_client,
            link,
            refused: Mutex::default(),
            settings,
        });
        if is_client {
            causes::tell(&endpoint, Arc::downgrade(&program));
            let weak = Arc::downgrade(&program);
            let info = zenoh.info();
            let listener = info.transport_events_listener().callback(move |event| {
                let Some(program) = weak.upgrade() else { return };
                match event.kind() {
                    SampleKind::Put => {
                        *program.refused.lock().unwrap_or_else(PoisonError::into_inner) = Default::default();
                        program.tell_link(true, "");
                    }
                    SampleKind::Delete => program.tell_link(false, "the broker is away"),
                }
            });
            listener.background().wait().map_err(Failure::failed)?;
        }
        Ok(Session { zenoh, program, subscribers: Mutex::default(), keys: RwLock::default() })
    }

    fn judge(settings: &str) -> Result<Vec<(&'static str, String)>, Failure> {
        let settings = Settings::read(settings)?;
        Ok(settings.unfit().into_iter().chain(certificates::judge(&settings)).collect())
    }

    fn put(&self, key: &str, message: &[u8], attachment: &[u8], is_urgent: bool) -> Result<(), Failure> {
        // What the network has no room for is dropped, and sent again by the program: to wait for one slow reader would
        // hold up all others.
        let priority = if is_urgent { Priority::InteractiveHigh } else { Priority::Data };
        let declared = self.declared(key)?;
        let put = match declared {
            Some(declared) => self.zenoh.put(declared, message),
            None => self.zenoh.put(key, message),
        };
        let put = put.attachment(attachment).congestion_control(CongestionControl::Drop).priority(priority);
        put.wait().map_err(Failure::failed)
    }

    fn subscribe(&self, keys: &str, token: u64) -> Result<(), Failure> {
        let program = Arc::clone(&self.program);
        let subscriber = self.zenoh.declare_subscriber(keys.to_owned());
        // Within a program messages take no network.
        let subscriber =
            subscriber.allowed_origin(Locality::Remote).callback(move |sample| program.deliver(token, &sample));
        let subscriber = subscriber.wait().map_err(Failure::failed)?;
        self.subscribers.lock().unwrap_or_else(PoisonError::into_inner).insert(token, subscriber);
        Ok(())
    }

    fn unsubscribe(&self, token: u64) -> Result<(), Failure> {
        let subscriber = self.subscribers.lock().unwrap_or_else(PoisonError::into_inner).remove(&token);
        subscriber.map_or(Ok(()), |subscriber| subscriber.undeclare().wait().map_err(Failure::failed))
    }

    fn close(self) {
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
