//! A session: the topics of a program as ends of a node.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::{BuildHasher as _, RandomState};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use saoms_transport::{Failure, Program, Topic, TopicTransport, connect};
use zenoh::Wait as _;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::CongestionControl;
use zenoh::sample::{Locality, SampleKind};

use crate::key::{End, GID, Keys, attachment, node};
use crate::settings::Settings;

/// Time from the word of a reader that it is there to its first message: it may ask for messages after that word.
const SETTLES: Duration = Duration::from_millis(200);
/// Longest time for the end of a session.
const PATIENCE: Duration = Duration::from_secs(1);

/// A session of a network of ROS 2.
pub(crate) struct Session {
    zenoh: zenoh::Session,
    domain: u32,
    shared: Arc<Shared>,
    ends: Mutex<Ends>,
    /// The tokens of state topics that somebody else begins to read.
    readers: Mutex<Sender<u64>>,
}

/// What callbacks of Zenoh use, too.
struct Shared {
    program: Program,
    /// True for one that joins a router, and false while that is away.
    is_client: bool,
    is_up: Mutex<bool>,
    published: Mutex<HashMap<u64, Published>>,
}

/// A topic that is published.
struct Published {
    publisher: Publisher<'static>,
    gid: [u8; GID],
    count: i64,
    is_state: bool,
    /// Of a state topic, the newest messages by their numbers.
    states: BTreeMap<u64, Vec<u8>>,
}

/// What lives as long as the session.
#[derive(Default)]
struct Ends {
    tokens: Vec<LivelinessToken>,
    subscribers: Vec<Subscriber<()>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Published {
    fn put(&mut self, message: &[u8]) -> Result<(), Failure> {
        self.count += 1;
        let time = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        let beside = attachment(self.count, i64::try_from(time).unwrap_or(i64::MAX), self.gid);
        self.publisher.put(message).attachment(beside).wait().map_err(Failure::failed)
    }
}

impl Shared {
    /// Tells that the router is there or not, unless that was said.
    fn tell(&self, is_up: bool) {
        if std::mem::replace(&mut *lock(&self.is_up), is_up) != is_up {
            self.program.link(is_up, if is_up { "" } else { "the router is away" });
        }
    }

    /// Publishes the newest messages of a state topic again: somebody reads it who has none of them.
    fn repeat(&self, token: u64) {
        if let Some(published) = lock(&self.published).get_mut(&token) {
            for (of, message) in std::mem::take(&mut published.states) {
                // Where there is no router, nobody is there.
                let _ = published.put(&message);
                published.states.insert(of, message);
            }
        }
    }
}

/// Repeats states for readers that begin, until the session is closed.
fn repeat(shared: &Arc<Shared>, readers: &Receiver<u64>) {
    while let Ok(first) = readers.recv() {
        thread::sleep(SETTLES);
        let topics: BTreeSet<u64> = std::iter::once(first).chain(readers.try_iter()).collect();
        topics.into_iter().for_each(|token| shared.repeat(token));
    }
}

impl Session {
    /// The number of this session.
    fn id(&self) -> String {
        self.zenoh.zid().to_string()
    }

    fn say(&self, key: String) -> Result<(), Failure> {
        let token = self.zenoh.liveliness().declare_token(key).wait().map_err(Failure::failed)?;
        lock(&self.ends).tokens.push(token);
        Ok(())
    }
}

impl TopicTransport for Session {
    fn open(settings: &str, program: Program) -> Result<Self, Failure> {
        let settings = Settings::read(settings)?;
        if let Some((_, text)) = settings.judge().into_iter().next() {
            return Err(Failure::failed(text));
        }
        let is_client = !settings.listen;
        if is_client {
            // Zenoh says of all faults that it timed out.
            drop(connect(settings.address())?);
        }
        let zenoh = zenoh::open(settings.config()?).wait().map_err(|error| {
            // Behind its words, Zenoh names a line of its source.
            let text = error.to_string();
            let text = text.split(" at /").next().unwrap_or_default();
            match () {
                () if is_client => Failure::unreachable("who listens there is no router of Zenoh, or is about to start"),
                () if text.contains("Address already in use") => Failure::failed(
                    "another program listens at this port, such as `rmw_zenohd`: join that, or give the broker another `port`",
                ),
                () => Failure::failed(text),
            }
        })?;
        let (is_up, published) = (Mutex::new(true), Mutex::default());
        let shared = Arc::new(Shared { program, is_client, is_up, published });
        if is_client {
            let weak = Arc::downgrade(&shared);
            let info = zenoh.info();
            let listener = info.transport_events_listener().callback(move |event| {
                if let Some(shared) = weak.upgrade() {
                    shared.tell(event.kind() == SampleKind::Put);
                }
            });
            listener.background().wait().map_err(Failure::failed)?;
        }
        let (readers, begun) = channel();
        let own = Arc::clone(&shared);
        let thread = thread::Builder::new().name("saoms-ros2".to_owned());
        thread.spawn(move || repeat(&own, &begun)).map_err(Failure::failed)?;
        let (ends, readers) = (Mutex::default(), Mutex::new(readers));
        let session = Session { zenoh, domain: Settings::domain()?, shared, ends, readers };
        session.say(node(session.domain, &session.id()))?;
        Ok(session)
    }

    fn judge(settings: &str) -> Result<Vec<(&'static str, String)>, Failure> {
        Ok(Settings::read(settings)?.judge())
    }

    fn advertise(&self, topic: Topic, token: u64) -> Result<(), Failure> {
        let keys = Keys::of(self.domain, &topic);
        let publisher = self.zenoh.declare_publisher(keys.messages()).congestion_control(CongestionControl::Block);
        let publisher = publisher.allowed_destination(Locality::Remote).wait().map_err(Failure::failed)?;
        let random = RandomState::new();
        let mut gid = [0; GID];
        gid[..8].copy_from_slice(&random.hash_one(0).to_le_bytes());
        gid[8..].copy_from_slice(&random.hash_one(1).to_le_bytes());
        let published = Published { publisher, gid, count: 0, is_state: topic.state, states: BTreeMap::new() };
        lock(&self.shared.published).insert(token, published);
        if topic.state {
            let begun = lock(&self.readers).clone();
            let liveliness = self.zenoh.liveliness();
            let readers = liveliness.declare_subscriber(keys.readers()).callback(move |sample| {
                if sample.kind() == SampleKind::Put {
                    // With the thread that takes it, the session ends.
                    let _ = begun.send(token);
                }
            });
            lock(&self.ends).subscribers.push(readers.wait().map_err(Failure::failed)?);
        }
        self.say(keys.token(&self.id(), token, End::Publisher))
    }

    fn publish(&self, token: u64, of: u64, message: &[u8]) -> Result<(), Failure> {
        if self.shared.is_client && !*lock(&self.shared.is_up) {
            return Err(Failure::full());
        }
        let mut published = lock(&self.shared.published);
        let published = published.get_mut(&token).ok_or_else(|| Failure::failed("the topic was not advertised"))?;
        if published.is_state {
            published.states.insert(of, message.to_vec());
        }
        published.put(message)
    }

    fn subscribe(&self, topic: Topic, token: u64) -> Result<(), Failure> {
        let keys = Keys::of(self.domain, &topic);
        let (shared, own) = (Arc::clone(&self.shared), keys.clone());
        // Within a program messages take no network.
        let subscriber = self.zenoh.declare_subscriber(keys.all_messages()).allowed_origin(Locality::Remote);
        let subscriber = subscriber.callback(move |sample| match own.fault(sample.key_expr().as_str()) {
            None => shared.program.deliver(token, "", &sample.payload().to_bytes()),
            Some(why) => shared.program.refuse(token, "", &why),
        });
        lock(&self.ends).subscribers.push(subscriber.wait().map_err(Failure::failed)?);
        self.say(keys.token(&self.id(), token, End::Subscriber))
    }

    fn close(self) {
        self.shared.program.leave();
        // It may wait for a peer that does not answer: then it is left to itself.
        let (done, is_done) = channel();
        thread::spawn(move || {
            drop(self.ends.into_inner());
            lock(&self.shared.published).clear();
            done.send(self.zenoh.close().wait().is_ok())
        });
        let _ = is_done.recv_timeout(PATIENCE);
    }
}
