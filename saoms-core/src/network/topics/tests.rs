//! A program's part of a network of topics, over a transport that notes what it is told.

use std::collections::BTreeMap;
use std::ffi::c_void;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use saoms_abi::{Bytes, Sink, Status, TRANSPORT_VERSION, TopicTransportTable, TransportEvents};
use saoms_api::host::SharedMessage;
use saoms_api::{Cause, Header, Level, Time};
use serde_json::Value;

use super::{TopicFleet, TopicMember, TopicMembership};
use crate::network::control::{ControlRequest, Reply};
use crate::network::exchange::Remembered;
use crate::network::exchange::wire::{Request, Vote};
use crate::network::transport::{Delivered, Opened, Receiver as _, SessionSettings, TopicSession, TopicTransport};
use crate::network::{Fleet, FromRun, Port, Undelivered};

/// What the session was told: topics, with their tokens and whether they are published; and messages.
#[derive(Default)]
struct Wire {
    topics: Mutex<Vec<(Value, u64, bool)>>,
    published: Mutex<Vec<(u64, Vec<u8>)>>,
    is_full: AtomicBool,
}

static TABLE: TopicTransportTable = TopicTransportTable {
    size: size_of::<TopicTransportTable>(),
    version: TRANSPORT_VERSION,
    metadata: Bytes::NONE,
    open,
    judge,
    advertise,
    publish,
    subscribe,
    close,
};

/// The wire of the next session of this thread.
static NEXT: Mutex<Option<Arc<Wire>>> = Mutex::new(None);

unsafe extern "C" fn open(_: Bytes, _: *const TransportEvents, session: *mut *mut c_void, _: Sink) -> Status {
    let wire = NEXT.lock().unwrap().take().unwrap();
    // SAFETY: the caller lends the place of the session.
    unsafe { ptr::write(session, Arc::into_raw(wire).cast_mut().cast()) };
    Status::OK
}

unsafe extern "C" fn judge(_: Bytes, _: Sink) -> Status {
    Status::OK
}

unsafe fn note(session: *mut c_void, topic: Bytes, token: u64, is_published: bool) -> Status {
    // SAFETY: it is the wire of `open`, and the caller lends the text until this returns.
    let (wire, topic) = unsafe { (&*session.cast::<Wire>(), topic.get_text().unwrap()) };
    wire.topics.lock().unwrap().push((serde_json::from_str(topic).unwrap(), token, is_published));
    Status::OK
}

unsafe extern "C" fn advertise(session: *mut c_void, topic: Bytes, token: u64, _: Sink) -> Status {
    // SAFETY: as the caller promises.
    unsafe { note(session, topic, token, true) }
}

unsafe extern "C" fn subscribe(session: *mut c_void, topic: Bytes, token: u64, _: Sink) -> Status {
    // SAFETY: as the caller promises.
    unsafe { note(session, topic, token, false) }
}

unsafe extern "C" fn publish(session: *mut c_void, token: u64, _: u64, message: Bytes, _: Sink) -> Status {
    // SAFETY: as for `note`.
    let (wire, message) = unsafe { (&*session.cast::<Wire>(), message.get().unwrap()) };
    if wire.is_full.load(Ordering::SeqCst) {
        return Status::FULL;
    }
    wire.published.lock().unwrap().push((token, message.to_vec()));
    Status::OK
}

unsafe extern "C" fn close(session: *mut c_void) {
    // SAFETY: it is the wire of `open`, and nobody uses the session any more.
    drop(unsafe { Arc::from_raw(session.cast::<Wire>()) });
}

/// What a fleet is told.
#[derive(Default)]
struct Heard {
    told: Mutex<Vec<String>>,
    delivered: Mutex<Vec<(String, String)>>,
    refused: Mutex<u64>,
    failed: Mutex<Vec<String>>,
}

struct Noting {
    heard: Arc<Heard>,
    topics: BTreeMap<&'static str, bool>,
}

impl TopicFleet for Noting {
    fn declared(&self, topic: &str) -> Option<(String, bool)> {
        let is_state = *self.topics.get(topic)?;
        Some((r#"{"name":"Lamp","fields":[{"name":"isOn","type":"bool"}]}"#.to_owned(), is_state))
    }

    fn judge(&self, _: &str, message: &[u8]) -> Result<(), String> {
        if message == b"wrong" { Err("it is wrong".to_owned()) } else { Ok(()) }
    }

    fn count_refused(&self, count: u64) {
        *self.heard.refused.lock().unwrap() += count;
    }
}

impl Fleet for Noting {
    fn has_started(&self) -> bool {
        true
    }

    fn deliver(&self, messages: &mut Undelivered) {
        for (topic, waiting) in std::mem::take(messages) {
            let senders = waiting.into_iter().map(|arrived| (topic.to_string(), arrived.component.to_string()));
            self.heard.delivered.lock().unwrap().extend(senders);
        }
    }

    fn serve(&self, _: Request) {}

    fn misses(&self, _: &str) {}

    fn vote(&self) -> Vote {
        Vote::Open
    }

    fn agree(&self, _: bool) {}

    fn tell(&self, _: Level, text: String) {
        self.heard.told.lock().unwrap().push(text);
    }

    fn count_lost(&self, _: u64, _: &str) {}

    fn fail(&self, reason: String) {
        self.heard.failed.lock().unwrap().push(reason);
    }

    fn is_interrupted(&self) -> bool {
        false
    }

    fn alert(&self, _: &str, _: &str, _: Option<String>) {}

    fn control(&self, _: ControlRequest, _: Reply) {}

    fn mark(&self) {}

    fn has_passed_mark(&self) -> bool {
        true
    }

    fn remember(&self, _: Vec<Remembered>) {}

    fn lose(&self) {}
}

/// A program on a wire.
struct Trial {
    wire: Arc<Wire>,
    port: Arc<Port>,
    heard: Arc<Heard>,
    member: TopicMember<Noting>,
}

impl Trial {
    /// With the event topics `EVENT` and `hall/2 EVENT`, and the state topic `STATE`.
    fn new() -> Trial {
        let (wire, port, heard): (Arc<Wire>, Arc<Port>, Arc<Heard>) = Default::default();
        let settings = SessionSettings {
            url: "test://".to_owned(),
            listen: false,
            peer: None,
            account: None,
            users: Vec::new(),
            access: Vec::new(),
            tls: None,
        };
        static OPENS: Mutex<()> = Mutex::new(());
        let opens = OPENS.lock().unwrap();
        *NEXT.lock().unwrap() = Some(Arc::clone(&wire));
        let opened = TopicSession::open(TopicTransport::of(&TABLE), &settings, Arc::clone(&port) as Arc<_>).unwrap();
        drop(opens);
        let Opened::Session(session) = opened else { panic!("{opened:?}") };
        let topics =
            BTreeMap::from([("EVENT", false), ("hall/2 EVENT", false), ("hall/2_EVENT", false), ("STATE", true)]);
        let fleet = Noting { heard: Arc::clone(&heard), topics };
        let patience = Duration::from_secs(1);
        let membership = TopicMembership { url: "test://".to_owned(), listens: false, patience };
        Trial { wire, port, heard, member: TopicMember::new(session, membership, fleet) }
    }

    fn leave(&mut self, from_run: FromRun) {
        self.port.put(std::iter::once(from_run));
        self.look();
    }

    /// Does what the thread of the network does.
    fn look(&mut self) {
        let waiting = self.port.take();
        self.member.take(waiting);
        self.member.attend(false);
    }

    fn send(&mut self, topic: &str, key: u64, content: &[u8]) {
        let header = Header { sender: 0, sent: Time::START, cause: Cause::default() };
        let message = SharedMessage::from_bytes(header, None, content.to_vec()).of(Some(key), None);
        let (topic, component) = (topic.into(), "Own".into());
        self.leave(FromRun::Message { topic, component, to: None, is_state: true, schema: 0, number: None, message });
    }

    fn published(&self) -> Vec<String> {
        let published = std::mem::take(&mut *self.wire.published.lock().unwrap());
        published.into_iter().map(|(_, message)| String::from_utf8(message).unwrap()).collect()
    }
}

#[test]
fn topics_are_known_to_others_by_their_types_before_there_are_messages() {
    let mut trial = Trial::new();
    trial.leave(FromRun::Publishes { topic: "hall/2 EVENT".into() });
    trial.leave(FromRun::Reads { topic: "STATE".into(), is_state: true, schema: 0 });
    trial.leave(FromRun::Reads { topic: "STATE".into(), is_state: true, schema: 0 });
    let topics = trial.wire.topics.lock().unwrap().clone();
    let known: Vec<(&str, bool, bool)> = topics
        .iter()
        .map(|(topic, _, published)| (topic["topic"].as_str().unwrap(), topic["state"] == true, *published))
        .collect();
    assert_eq!(known, [("hall/_2_EVENT", false, true), ("STATE", true, false)]);
    assert_eq!(
        (&topics[0].0["type"], &topics[0].0["definition"]),
        (&"saoms_msgs/msg/Lamp".into(), &"bool is_on\n".into())
    );
}

#[test]
fn two_topics_that_others_cannot_tell_apart_fail_the_run() {
    let mut trial = Trial::new();
    trial.leave(FromRun::Publishes { topic: "hall/2 EVENT".into() });
    trial.leave(FromRun::Publishes { topic: "hall/2_EVENT".into() });
    let failed = trial.heard.failed.lock().unwrap().clone();
    assert_eq!(failed.len(), 1);
    assert!(failed[0].contains("cannot publish topic `hall/2_EVENT`: others know `hall/2 EVENT` by the same name"));
}

#[test]
fn events_wait_in_their_order_for_room_and_of_states_the_newest() {
    let mut trial = Trial::new();
    trial.wire.is_full.store(true, Ordering::SeqCst);
    for number in 1..=3 {
        trial.send("EVENT", 0, format!("event {number}").as_bytes());
        trial.send("STATE", number % 2, format!("state {number}").as_bytes());
    }
    assert!(trial.published().is_empty());
    trial.wire.is_full.store(false, Ordering::SeqCst);
    trial.look();
    let mut published = trial.published();
    assert_eq!(published.drain(..3).collect::<Vec<_>>(), ["event 1", "event 2", "event 3"]);
    published.sort_unstable();
    assert_eq!(published, ["state 2", "state 3"], "one for each key");
}

#[test]
fn what_is_no_message_is_counted_and_told_once_and_the_rest_is_from_outside() {
    let mut trial = Trial::new();
    trial.leave(FromRun::Reads { topic: "EVENT".into(), is_state: false, schema: 0 });
    let token = trial.wire.topics.lock().unwrap()[0].1;
    let deliver = |trial: &Trial, key: &str, message: &[u8], attachment: &[u8]| {
        assert!(trial.port.deliver(Delivered { token, key, message, attachment }));
    };
    for message in [&b"wrong"[..], b"wrong", b"right"] {
        deliver(&trial, "", message, &[]);
    }
    deliver(&trial, "/talker", b"right", &[]);
    deliver(&trial, "", &[], b"it is no JSON");
    trial.look();
    let outside = |who: &str| ("EVENT".to_owned(), format!("(outside){who}"));
    assert_eq!(*trial.heard.delivered.lock().unwrap(), [outside(""), outside(" /talker")]);
    assert_eq!(*trial.heard.refused.lock().unwrap(), 3);
    let told = trial.heard.told.lock().unwrap().clone();
    assert_eq!(told, ["a message from the network `test://` on topic `EVENT` is refused: it is wrong"]);
}
