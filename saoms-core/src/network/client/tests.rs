//! A program's part of a network over a transport that notes what it is told.

mod entering;

use std::collections::{BTreeSet, HashMap};
use std::ffi::c_void;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, LazyLock, Mutex};
use std::thread::{self, ThreadId, sleep};
use std::time::{Duration, Instant};

use saoms_abi::{Bytes, Sink, Status, TRANSPORT_VERSION, TransportEvents, TransportTable};
use saoms_api::host::{SharedMessage, cdr};
use saoms_api::{Cause, Header, Level, Time};

use super::unsent::MOST_BYTES;
use super::{ALIVE, Client, Entrance, FIRST_OF_TOPICS};
use crate::network::control::{ControlRequest, Reply};
use crate::network::exchange::wire::{Alive, Envelope, Reads, Received, Request, Vote};
use crate::network::exchange::{Remembered, Settings};
use crate::network::port::{MOST_AT_ONCE, MOST_BYTES_AT_ONCE};
use crate::network::transport::{Delivered, Opened, Receiver as _, SessionSettings, Transport, TransportSession};
use crate::network::{Fleet, FromRun, Membership, Port, Undelivered, key};

/// Longest time for something that has to happen.
const LONGEST: Duration = Duration::from_secs(60);

/// What a session was told.
#[derive(Default)]
struct Wire {
    /// The key and the envelope of each message, and the thread that put it.
    put: Mutex<Vec<(String, Vec<u8>, ThreadId)>>,
    /// The keys of what is urgent.
    urgent: Mutex<Vec<String>>,
    subscribed: Mutex<Vec<String>>,
    is_full: AtomicBool,
    /// True if it takes long to put something.
    is_slow: AtomicBool,
}

impl Wire {
    /// The numbers of the messages of components that were put.
    fn numbers(&self) -> Vec<u64> {
        self.numbers_by_thread().into_iter().map(|(number, _)| number).collect()
    }

    /// The same with the threads that put them.
    fn numbers_by_thread(&self) -> Vec<(u64, ThreadId)> {
        let put = self.put.lock().unwrap();
        let of_topics = put.iter().filter(|(key, ..)| key.starts_with("saoms/2/topic/"));
        let numbers = of_topics.flat_map(|(_, envelope, by)| {
            let Envelope { number, messages, .. } = cdr::decode(envelope).unwrap();
            (number..number + messages.len() as u64).map(|number| (number, *by))
        });
        numbers.collect()
    }
}

/// The wires of sessions by their urls, until these are opened.
static WIRES: LazyLock<Mutex<HashMap<String, Arc<Wire>>>> = LazyLock::new(Mutex::default);

static TABLE: TransportTable = TransportTable {
    size: size_of::<TransportTable>(),
    version: TRANSPORT_VERSION,
    metadata: Bytes::NONE,
    open,
    judge,
    put,
    subscribe,
    unsubscribe,
    close,
};

unsafe extern "C" fn open(settings: Bytes, _: *const TransportEvents, session: *mut *mut c_void, _: Sink) -> Status {
    // SAFETY: the caller lends the text until this returns.
    let settings: serde_json::Value = serde_json::from_str(unsafe { settings.get_text() }.unwrap()).unwrap();
    let wire = WIRES.lock().unwrap().remove(settings["url"].as_str().unwrap()).unwrap();
    // SAFETY: the caller lends the place of the session.
    unsafe { ptr::write(session, Arc::into_raw(wire).cast_mut().cast()) };
    Status::OK
}

unsafe extern "C" fn judge(_: Bytes, _: Sink) -> Status {
    Status::OK
}

/// # Safety
/// The session is open.
unsafe fn wire<'w>(session: *mut c_void) -> &'w Wire {
    // SAFETY: it is the wire that `open` has given, until `close`.
    unsafe { &*session.cast::<Wire>() }
}

unsafe extern "C" fn put(
    session: *mut c_void,
    key: Bytes,
    _: Bytes,
    attachment: Bytes,
    urgent: u32,
    _: Sink,
) -> Status {
    // SAFETY: the session is open, and the caller lends the bytes until this returns.
    let (wire, key, attachment) = unsafe { (wire(session), key.get_text().unwrap(), attachment.get()) };
    if wire.is_full.load(Ordering::SeqCst) {
        return Status::FULL;
    }
    if wire.is_slow.load(Ordering::SeqCst) {
        sleep(Duration::from_millis(20));
    }
    let by = thread::current().id();
    wire.urgent.lock().unwrap().extend((urgent == 1).then(|| key.to_owned()));
    wire.put.lock().unwrap().push((key.to_owned(), attachment.unwrap().to_vec(), by));
    Status::OK
}

unsafe extern "C" fn subscribe(session: *mut c_void, keys: Bytes, _: u64, _: Sink) -> Status {
    // SAFETY: as for `put`.
    let (wire, keys) = unsafe { (wire(session), keys.get_text()) };
    wire.subscribed.lock().unwrap().push(keys.unwrap().to_owned());
    Status::OK
}

unsafe extern "C" fn unsubscribe(_: *mut c_void, _: u64, _: Sink) -> Status {
    Status::OK
}

unsafe extern "C" fn close(session: *mut c_void) {
    // SAFETY: it is the wire of `open`, and nobody uses the session any more.
    drop(unsafe { Arc::from_raw(session.cast::<Wire>()) });
}

/// What a fleet is told, each with what was subscribed then.
type Told = Vec<(String, Vec<String>)>;

/// A fleet that does nothing, and notes what it is told, and what was subscribed when it was.
struct Idle {
    has_started: Arc<AtomicBool>,
    told: Arc<Mutex<Told>>,
    lost: Arc<AtomicU64>,
    /// Why the run was ended.
    failed: Arc<Mutex<Vec<String>>>,
    /// True if whatever delivers messages to it panics.
    panics: Arc<AtomicBool>,
    wire: Arc<Wire>,
}

impl Fleet for Idle {
    fn has_started(&self) -> bool {
        self.has_started.load(Ordering::SeqCst)
    }

    fn deliver(&self, messages: &mut Undelivered) {
        assert!(!self.panics.load(Ordering::SeqCst), "a fault of the fleet");
        messages.clear();
    }

    fn serve(&self, _: Request) {}

    fn misses(&self, _: &str) {}

    fn vote(&self) -> Vote {
        Vote::Open
    }

    fn agree(&self, _: bool) {}

    fn tell(&self, _: Level, text: String) {
        self.told.lock().unwrap().push((text, self.wire.subscribed.lock().unwrap().clone()));
    }

    fn count_lost(&self, count: u64, _: &str) {
        self.lost.fetch_add(count, Ordering::SeqCst);
    }

    fn fail(&self, reason: String) {
        self.failed.lock().unwrap().push(reason);
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
struct Program {
    wire: Arc<Wire>,
    port: Arc<Port>,
    has_started: Arc<AtomicBool>,
    told: Arc<Mutex<Told>>,
    /// Number of the messages that were counted as lost.
    lost: Arc<AtomicU64>,
    /// Why its run was ended.
    failed: Arc<Mutex<Vec<String>>>,
    /// Set to true, it panics where it delivers what arrived.
    panics: Arc<AtomicBool>,
    client: Client,
}

/// A session on the wire of this url.
fn session(url: &str, port: &Arc<Port>, is_router: bool) -> TransportSession {
    let settings = SessionSettings {
        url: url.to_owned(),
        listen: is_router,
        peer: None,
        account: None,
        users: Vec::new(),
        access: Vec::new(),
        tls: None,
    };
    let opened = TransportSession::open(Transport::of(&TABLE), &settings, Arc::clone(port) as Arc<_>).unwrap();
    let Opened::Session(session) = opened else { panic!("{opened:?}") };
    session
}

/// The settings of the program.
fn own() -> Settings {
    Settings {
        program: 1,
        began: 5,
        name: "own".to_owned(),
        patience: 1_000_000_000,
        limit: 1 << 20,
        linger: 0,
        components: BTreeSet::from(["Own".to_owned()]),
        others: BTreeSet::new(),
        memory: None,
    }
}

fn program(url: &str) -> Program {
    let (wire, port, has_started, told) =
        (Arc::<Wire>::default(), Arc::<Port>::default(), Arc::default(), Arc::default());
    let (lost, failed, panics): (Arc<AtomicU64>, Arc<Mutex<Vec<String>>>, Arc<AtomicBool>) = Default::default();
    WIRES.lock().unwrap().insert(url.to_owned(), Arc::clone(&wire));
    let session = session(url, &port, false);
    let member = own();
    let fleet = Idle {
        has_started: Arc::clone(&has_started),
        told: Arc::clone(&told),
        lost: Arc::clone(&lost),
        failed: Arc::clone(&failed),
        panics: Arc::clone(&panics),
        wire: Arc::clone(&wire),
    };
    let membership = Membership { url: url.to_owned(), ..Membership::default() };
    let mut entrance = Entrance::default();
    entrance.add(session, &port, member, &membership, false, Instant::now()).unwrap();
    let entered = entrance.into_all().pop().unwrap();
    let mut client = Client::prepare(entered, membership, fleet).unwrap();
    client.begin();
    Program { wire, port, has_started, told, lost, failed, panics, client }
}

fn message(size: usize) -> FromRun {
    message_of("Own", size)
}

fn message_of(component: &str, size: usize) -> FromRun {
    let header = Header { sender: 0, sent: Time::default(), cause: Cause::default() };
    FromRun::Message {
        topic: "EVENTS".into(),
        component: component.into(),
        to: None,
        is_state: false,
        schema: 0,
        number: None,
        message: SharedMessage::from_bytes(header, None, vec![7; size]),
    }
}

#[track_caller]
fn wait(what: &str, is_so: impl Fn() -> bool) {
    let since = Instant::now();
    while !is_so() {
        assert!(since.elapsed() < LONGEST, "{what}");
        sleep(Duration::from_millis(1));
    }
}

#[test]
fn what_waits_for_room_in_a_transport_is_bounded() {
    const SIZE: usize = 1 << 20;
    let Program { wire, port, .. } = &program("full");
    wire.is_full.store(true, Ordering::SeqCst);
    let most = MOST_BYTES / SIZE;
    for _ in 0..most + 16 {
        port.put([message(SIZE)].into_iter());
    }
    // What is left once it has taken something later is taken after all of these.
    for topic in ["LAST", "LATER"] {
        port.put([FromRun::Reads { topic: topic.into(), is_state: false, schema: 0 }].into_iter());
        wait("the port is not emptied", || wire.subscribed.lock().unwrap().iter().any(|keys| keys.contains(topic)));
    }
    wire.is_full.store(false, Ordering::SeqCst);
    let numbers = || wire.numbers().len();
    wait("nothing is put", || numbers() > 0);
    port.put([message(8)].into_iter());
    let last = most as u64 + 17;
    wait("what comes after it is not put", || wire.numbers().contains(&last));
    assert!(numbers() <= most + 1, "{} of {last}", numbers());
}

#[test]
fn a_program_has_joined_once_what_its_components_read_is_subscribed() {
    let Program { port, has_started, told, .. } = &program("joins");
    let has_joined = || {
        let told = told.lock().unwrap();
        told.iter().find(|(text, _)| text.contains("has joined the network at `joins`")).cloned()
    };
    port.put([FromRun::Reads { topic: "FIRST".into(), is_state: false, schema: 0 }].into_iter());
    port.put([FromRun::Reads { topic: "LAST".into(), is_state: false, schema: 0 }].into_iter());
    has_started.store(true, Ordering::SeqCst);
    wait("it has not joined", || has_joined().is_some());
    let (_, subscribed) = has_joined().unwrap();
    for topic in ["FIRST", "LAST"] {
        assert!(subscribed.iter().any(|keys| keys.contains(topic)), "{subscribed:?}");
    }
    assert_eq!(told.lock().unwrap().iter().filter(|(text, _)| text.contains("has joined")).count(), 1);
}

#[test]
fn a_few_short_messages_are_put_by_the_thread_that_leaves_them() {
    let Program { wire, port, .. } = &program("at once");
    let own = thread::current().id();
    let newest = || wire.numbers_by_thread().last().copied();
    // While the thread of the network is at work, it puts them.
    let puts_one = || {
        port.put([message(8)].into_iter());
        newest().is_some_and(|(_, by)| by == own)
    };
    wait("the thread of the network does not sleep", puts_one);
    wait("the thread of the network does not sleep on", puts_one);
    let before = wire.numbers().len();
    port.put((0..MOST_AT_ONCE).map(|_| message(8)));
    let mut sent = MOST_AT_ONCE;
    wait("not all are put", || wire.numbers().len() >= before + sent);

    // More of them, or longer ones, would hold the caller up.
    for many in [(0..=MOST_AT_ONCE).map(|_| message(8)).collect(), vec![message(MOST_BYTES_AT_ONCE + 1)]] {
        sent += many.len();
        port.put(many.into_iter());
        wait("not all are put", || wire.numbers().len() >= before + sent);
        assert_ne!(newest().map(|(_, by)| by), Some(own));
    }
    let numbers = wire.numbers();
    assert!(numbers.is_sorted(), "{numbers:?}");
}

/// A sign of life of a program that reads what is sent, and has received all before this number.
fn reader(port: &Port, number: u64, next: u64) {
    let topic = || "EVENTS".to_owned();
    let alive = Alive {
        program: 2,
        name: "reader".to_owned(),
        number,
        patience: 60_000,
        reads: vec![Reads { topic: topic() }],
        received: vec![Received { program: 1, topic: topic(), next }],
        ..Alive::default()
    };
    let (key, message) = (key::alive(2), cdr::encode(&alive));
    assert!(port.deliver(Delivered { token: ALIVE, key: &key, message: &message, attachment: &[] }));
}

/// A program with a reader that is there, and has not received what it sent.
fn with_reader(url: &str) -> Program {
    let program = program(url);
    reader(&program.port, 1, 1);
    let told = || program.told.lock().unwrap().iter().any(|(text, _)| text.contains("`reader` is on the network"));
    wait("the reader is not heard", told);
    program.port.put([message(8)].into_iter());
    wait("nothing is put", || program.wire.numbers() == [1]);
    program
}

#[test]
fn who_is_there_is_waited_for_although_nobody_who_is_away_is() {
    let Program { port, told, lost, client, .. } = with_reader("lingers");
    thread::scope(|scope| {
        scope.spawn(|| drop(client));
        sleep(Duration::from_millis(500));
        reader(&port, 2, 2);
    });
    assert_eq!(lost.load(Ordering::SeqCst), 0, "{:?}", told.lock().unwrap());
}

#[test]
fn a_panic_in_the_part_of_a_network_fails_the_run_whichever_thread_it_is_in() {
    let wakes = |port: &Port| reader(port, 2, 1);
    let frame = |port: &Port| {
        // It is taken by the thread that brings it, once that of the network sleeps.
        let key = "saoms/2/topic/EVENTS/Other";
        port.deliver(Delivered { token: FIRST_OF_TOPICS, key, message: b"", attachment: b"" });
    };
    for (url, cause) in [("panics", &wakes as &dyn Fn(&Port)), ("panics at once", &frame)] {
        let Program { port, has_started, told, lost, failed, panics, client, .. } = with_reader(url);
        panics.store(true, Ordering::SeqCst);
        cause(&port);
        let is_told = || told.lock().unwrap().iter().any(|(text, _)| text.contains("a fault of the fleet"));
        wait("nothing is told", is_told);
        assert!(failed.lock().unwrap().is_empty(), "it starts still");
        has_started.store(true, Ordering::SeqCst);
        wait("the run goes on", || !failed.lock().unwrap().is_empty());
        assert!(failed.lock().unwrap()[0].contains(&format!("its part of the network `{url}`")));
        assert_eq!(lost.load(Ordering::SeqCst), 1);
        drop(client);
    }
}

#[test]
fn the_last_sign_of_life_of_a_program_overtakes_none_of_its_states_and_is_repeated() {
    let Program { wire, client, .. } = program("leaves");
    let signs = |all: &[String]| all.iter().filter(|key| **key == key::alive(1)).count();
    wait("it gives no sign of life", || signs(&wire.urgent.lock().unwrap()) > 0);
    drop(client);
    let put: Vec<String> = wire.put.lock().unwrap().iter().map(|(key, ..)| key.clone()).collect();
    assert_eq!(put.last(), Some(&key::alive(1)));
    assert_eq!(signs(&put), signs(&wire.urgent.lock().unwrap()) + 3, "the last ones are in order with all else");
}

#[test]
fn what_a_slow_transport_has_not_taken_is_left_to_the_thread_of_the_network() {
    let Program { wire, port, .. } = &program("slow");
    let own = thread::current().id();
    let by_own = || wire.numbers_by_thread().iter().filter(|(_, by)| *by == own).count();
    let mut sent = 0;
    wait("the thread of the network does not sleep", || {
        port.put([message(8)].into_iter());
        by_own() > 0
    });
    wire.is_slow.store(true, Ordering::SeqCst);
    let (all, before) = (wire.numbers().len(), by_own());
    // Each is a message of its own on the network.
    let several = |round: usize| (0..MOST_AT_ONCE).map(move |place| message_of(&format!("Own{place}"), 8 + round));
    for round in 0..2 {
        port.put(several(round));
        sent += MOST_AT_ONCE;
        wait("not all are put", || wire.numbers().len() >= all + sent);
        assert!(by_own() <= before + 1, "it waits for one at most, and for none after that");
    }
    assert!(wire.numbers().is_sorted());
}

#[test]
fn a_program_whose_run_did_not_begin_waits_for_nobody() {
    let Program { told, lost, client, .. } = with_reader("abandoned");
    // Its reader never says that it has received anything, and gives signs of life for a minute.
    client.abandon();
    assert_eq!(lost.load(Ordering::SeqCst), 1);
    assert!(!told.lock().unwrap().iter().any(|(text, _)| text.contains("this program waits")));
}
