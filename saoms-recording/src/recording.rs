use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::extension::DrawingRegistration;
use saoms_api::host::{TopicDeclaration, cdr};
use saoms_api::{Failure, Level, Message, Time};
use saoms_core::observe::{
    Beginning, Interest, LostEvents, Observer, Occurrence, Records, RunEvent, SentMessage, WriterEvents, create_file,
};
use saoms_core::report::RunReport;
use saoms_core::schedule::Handle;
use saoms_core::tape::Step;
use serde_json::json;

use crate::drawer::{Drawer, Heard, HeardTopic};
use crate::file::{ChannelForm, Item};
use crate::messages::{JournalRecord, Log};
use crate::queue::Queue;
use crate::writing::{Head, Place, Writing};

/// The topics of journal and log. Tools know the one of the log.
const JOURNAL_TOPIC: &str = "/saoms/journal";
const LOG_TOPIC: &str = "/rosout";
/// Their channels.
const JOURNAL: u16 = 0;
const LOG: u16 = 1;

/// Records of the journal that are put into the queue at once.
const AT_ONCE: usize = 256;

/// What a recording says of a run beside what the run itself says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedRun {
    /// The name of the first composite.
    pub name: String,
    /// Names and texts of the files that say what the fleet is.
    pub files: Vec<(String, String)>,
    /// The node that runs, of a fleet in several programs.
    pub node: Option<String>,
    /// The version of the program.
    pub version: String,
    /// The topics whose messages are recorded, those of drawings included; `None` is all.
    pub topics: Option<Vec<String>>,
    /// The components whose tapes are recorded, by their paths.
    pub components: Vec<String>,
    /// The size of a file after which another one begins; `None` is no limit.
    pub limit: Option<u64>,
}

/// The observer that records a run: messages, journal and log.
///
/// A thread of its own writes. What comes faster than it can write is counted and lost in real time; in virtual time
/// the run waits. What cannot be written is counted, too, and tried again.
pub struct Recording {
    path: PathBuf,
    mode: Option<u32>,
    run: RecordedRun,
    /// The drawings that are wanted.
    drawings: Vec<&'static DrawingRegistration>,
    shared: Arc<Shared>,
    topics: Mutex<Topics>,
    /// The memory for the bytes of a message, and for records.
    bytes: Mutex<Vec<u8>>,
    piece: Mutex<Piece>,
    thread: Mutex<Option<JoinHandle<Writing>>>,
    /// What the thread has left.
    writing: Mutex<Option<Writing>>,
}

/// What the recording and its thread have in common.
pub(crate) struct Shared {
    pub(crate) queue: Queue,
    pub(crate) events: Box<dyn WriterEvents>,
    /// The number of messages, records and lines that are not in the file.
    pub(crate) lost: Arc<AtomicU64>,
    pub(crate) written: AtomicU64,
    /// The time of the start of the run, in nanoseconds.
    pub(crate) start: AtomicU64,
    /// True in virtual time, which waits for the recording.
    pub(crate) waits: AtomicBool,
    /// True if the last message found no room.
    is_full: AtomicBool,
    /// True if the file took not all that was written.
    pub(crate) is_stuck: AtomicBool,
}

impl Shared {
    /// Tells that everything is recorded again, if it is.
    pub(crate) fn tell_that_it_works(&self) {
        if !self.is_full.load(Ordering::Relaxed) && !self.is_stuck.load(Ordering::Relaxed) {
            self.events.works();
        }
    }
}

/// The memory for records of the journal that come at once.
#[derive(Default)]
struct Piece {
    record: JournalRecord,
    /// Of one record, and of all.
    encoded: Vec<u8>,
    bytes: Vec<u8>,
    items: Vec<Item>,
}

/// The topics of the run.
#[derive(Default)]
struct Topics {
    /// Those that are wanted, as they are declared.
    wanted: HashMap<String, WantedTopic>,
    /// Where the messages of those go that had some.
    ways: HashMap<Arc<str>, Way>,
    /// The channels of tapes, by the paths of their components.
    tapes: HashMap<String, u16>,
    /// The numbers of the next channel, and of the next topic that drawings hear.
    next: u16,
    next_heard: usize,
}

struct WantedTopic {
    schema: String,
    is_recorded: bool,
    /// The topic, until drawings have heard of it, and its number from then on.
    heard: Option<Result<HeardTopic, usize>>,
}

/// The topic of the tape of a component, before its path.
pub(crate) const TAPES: &str = "/saoms/tape/";
/// The role of its channel.
pub(crate) const TAPE: &str = "tape";

/// Where the messages of a topic go.
#[derive(Clone, Copy, Default)]
struct Way {
    channel: Option<u16>,
    heard: Option<usize>,
    /// True if there is no channel although there should be one.
    is_lost: bool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Recording {
    /// The recording that is written to a path when the run begins.
    /// The file has these permissions where it is new, whatever mask code of a library has set.
    pub fn new(path: &Path, mode: Option<u32>, run: RecordedRun, events: Box<dyn WriterEvents>) -> Recording {
        let shared = Shared {
            queue: Queue::new(),
            events,
            lost: Arc::default(),
            written: AtomicU64::new(0),
            start: AtomicU64::new(0),
            waits: AtomicBool::new(false),
            is_full: AtomicBool::new(false),
            is_stuck: AtomicBool::new(false),
        };
        let (shared, path) = (Arc::new(shared), path.to_owned());
        let mut drawings = DrawingRegistration::linked();
        drawings.retain(|one| one.topics.iter().any(|drawn| run.topics.as_ref().is_none_or(|all| names(all, drawn))));
        let (topics, bytes, piece, thread, writing) = Default::default();
        Recording { path, mode, run, drawings, shared, topics, bytes, piece, thread, writing }
    }

    /// The number of messages, records and lines that are not in the file.
    pub fn lost(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.shared.lost)
    }

    /// Has times be those of a run that goes on from its state folder, once that is used.
    pub fn outlive(&self, handle: &Handle) {
        let passed = handle.recalled().map_or(0, Time::as_nanos);
        if !self.shared.waits.load(Ordering::Relaxed) {
            self.shared.start.fetch_sub(passed, Ordering::Relaxed);
        }
    }

    /// Nanoseconds of a time of the run: of the wall clock, and in virtual time of that.
    fn at(&self, time: Time) -> u64 {
        self.shared.start.load(Ordering::Relaxed).saturating_add(time.as_nanos())
    }

    fn put(&self, items: &[Item], bytes: &[u8], heard: Option<Heard>) {
        let Shared { queue, events, lost, waits, is_full, .. } = &*self.shared;
        if queue.put(items, bytes, heard, waits.load(Ordering::Relaxed)) {
            if is_full.swap(false, Ordering::Relaxed) {
                self.shared.tell_that_it_works();
            }
        } else {
            lost.fetch_add(items.len().max(1) as u64, Ordering::Relaxed);
            if !is_full.swap(true, Ordering::Relaxed) {
                let path = self.path.display();
                events.fails(&format!("messages come faster than they can be recorded to `{path}`, and are lost"));
            }
        }
    }

    /// Puts what is of no topic of the fleet.
    fn tell(&self, channel: u16, time: u64, bytes: &[u8]) {
        self.put(&[Item { channel, sender: None, time, end: bytes.len() }], bytes, None);
    }

    /// Where the messages of a topic go.
    fn way(&self, topic: &Arc<str>) -> Way {
        let mut topics = lock(&self.topics);
        if let Some(known) = topics.ways.get(topic) {
            return *known;
        }
        let Topics { wanted, ways, next, next_heard, .. } = &mut *topics;
        let mut way = Way::default();
        if let Some(wanted) = wanted.get_mut(&**topic) {
            let form = wanted.is_recorded.then(|| ChannelForm::of(topic, &wanted.schema, None).ok()).flatten();
            way.channel = form.filter(|_| *next < u16::MAX).map(|form| {
                self.shared.queue.open(form);
                *next += 1;
                *next - 1
            });
            way.is_lost = wanted.is_recorded && way.channel.is_none();
            way.heard = wanted.heard.take().map(|heard| {
                heard.map_or_else(
                    |number| number,
                    |heard| {
                        self.shared.queue.hear(heard);
                        *next_heard += 1;
                        *next_heard - 1
                    },
                )
            });
            wanted.heard = way.heard.map(Err);
        }
        ways.insert(Arc::clone(topic), way);
        way
    }

    /// The channel of the tape of a component.
    fn tape(&self, component: &str) -> Option<u16> {
        let mut topics = lock(&self.topics);
        if let Some(known) = topics.tapes.get(component) {
            return Some(*known);
        }
        let form = ChannelForm::of(&format!("{TAPES}{component}"), Step::SCHEMA, Some(TAPE)).ok();
        let form = form.filter(|_| topics.next < u16::MAX)?;
        self.shared.queue.open(form);
        topics.next += 1;
        let channel = topics.next - 1;
        topics.tapes.insert(component.to_owned(), channel);
        Some(channel)
    }

    /// Waits until the thread has written all that came.
    fn close(&self) {
        self.shared.queue.close();
        if let Some(writing) = lock(&self.thread).take().and_then(|thread| thread.join().ok()) {
            *lock(&self.writing) = Some(writing);
        }
    }

    fn head(&self, beginning: &Beginning<'_>) -> Head {
        let RecordedRun { name, files, node, version, .. } = self.run.clone();
        let clock = if beginning.is_virtual { "virtual" } else { "real" };
        let mut values = BTreeMap::from([
            ("name".to_owned(), name),
            ("version".to_owned(), version),
            ("seed".to_owned(), beginning.seed.to_string()),
            ("clock".to_owned(), clock.to_owned()),
        ]);
        values.extend(node.map(|node| ("node".to_owned(), node)));
        Head { values, files }
    }
}

/// True if topics are named that a drawing has: in a site `/North/scene`, and else `/scene`.
fn names(all: &[String], drawn: &str) -> bool {
    all.iter().any(|topic| topic.starts_with('/') && topic.rsplit('/').next() == Some(drawn))
}

impl fmt::Debug for Recording {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Recording").field(&self.path).finish()
    }
}

impl Observer for Recording {
    fn interest(&self) -> Interest {
        Interest { journal: true, log: Some(Level::Info), ..Interest::NONE }
    }

    fn begin(&self, beginning: &Beginning<'_>) -> Result<(), Failure> {
        let path = self.path.display();
        let failed = |error: &dyn fmt::Display| Failure::new(format!("`{path}` cannot be recorded to: {error}"));
        let file = create_file(&self.path, self.mode).map_err(|error| failed(&error))?;
        self.shared.waits.store(beginning.is_virtual, Ordering::Relaxed);
        if !beginning.is_virtual {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
            self.shared.start.store(u64::try_from(now).unwrap_or(u64::MAX), Ordering::Relaxed);
        }
        for (topic, schema, role) in
            [(JOURNAL_TOPIC, JournalRecord::SCHEMA, "journal"), (LOG_TOPIC, Log::SCHEMA, "log")]
        {
            let form = ChannelForm::of(topic, schema, Some(role)).map_err(|error| failed(&error))?;
            self.shared.queue.open(form);
        }
        lock(&self.topics).next = LOG + 1;
        let head = self.head(beginning);
        let place = Place::new(self.path.clone(), self.mode, self.run.limit);
        let drawer = (Drawer::new(&self.drawings), self.run.topics.clone());
        let writing = Writing::begin((place, file), head, drawer, Arc::clone(&self.shared));
        let thread = thread::Builder::new().name("saoms-recording".to_owned()).spawn(|| writing.run());
        *lock(&self.thread) = Some(thread.map_err(|error| failed(&error))?);
        Ok(())
    }

    fn event(&self, event: &RunEvent) {
        let level = event.what.level();
        if matches!(event.what, Occurrence::Console { .. }) || level > Level::Info {
            return;
        }
        let time = self.at(event.time);
        let log = Log::new(time, level, event.component.as_deref(), event.what.to_string());
        self.tell(LOG, time, &cdr::encode(&log));
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        let is_recorded = self.run.topics.as_ref().is_none_or(|topics| topics.iter().any(|topic| topic == name));
        let is_heard = self.drawings.iter().any(|one| (one.wants)(declared));
        if is_recorded || is_heard {
            let mut topics = lock(&self.topics);
            // After a change of the fleet, a topic may have messages of another type.
            if topics.wanted.get(name).is_none_or(|known| known.schema != declared.schema) {
                let heard = is_heard.then(|| Ok(HeardTopic::of(name, declared)));
                let wanted = WantedTopic { schema: declared.schema.to_owned(), is_recorded, heard };
                topics.wanted.insert(name.to_owned(), wanted);
                topics.ways.remove(name);
            }
        }
        is_recorded || is_heard
    }

    fn hears_others(&self) -> bool {
        true
    }

    fn message(&self, sent: &SentMessage) {
        let SentMessage { topic, component, message, .. } = sent;
        let Way { channel, heard, is_lost } = self.way(topic);
        self.shared.lost.fetch_add(u64::from(is_lost), Ordering::Relaxed);
        let mut bytes = lock(&self.bytes);
        bytes.clear();
        let item = channel.map(|channel| {
            message.encode_into(&mut bytes);
            let (sender, time) = (Some(Arc::clone(component)), self.at(message.header().sent));
            Item { channel, sender, time, end: bytes.len() }
        });
        self.put(item.as_slice(), &bytes, heard.map(|topic| Heard::Message(topic, message.clone())));
    }

    fn wants_tape(&self, component: &str) -> bool {
        self.run.components.iter().any(|one| one == component)
    }

    fn step(&self, component: &str, step: &Step) {
        match self.tape(component) {
            Some(channel) => {
                let mut bytes = lock(&self.bytes);
                cdr::encode_into(step, &mut bytes);
                self.tell(channel, self.at(Time::from_nanos(step.time)), &bytes);
            }
            None => drop(self.shared.lost.fetch_add(1, Ordering::Relaxed)),
        }
    }

    fn lost(&self, lost: LostEvents) {
        self.shared.lost.fetch_add(lost.messages, Ordering::Relaxed);
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        self.shared.lost.fetch_add(records.lost, Ordering::Relaxed);
        let mut piece = lock(&self.piece);
        let Piece { record, encoded, bytes, items } = &mut *piece;
        for entries in records.entries.chunks(AT_ONCE) {
            bytes.clear();
            items.clear();
            for entry in entries {
                let time = self.at(entry.time());
                record.set(time, entry);
                cdr::encode_into(record, encoded);
                bytes.extend_from_slice(encoded);
                items.push(Item { channel: JOURNAL, sender: None, time, end: bytes.len() });
            }
            self.put(items, bytes, None);
        }
        Ok(())
    }

    fn conclude(&self, report: &mut RunReport) {
        self.close();
        let Shared { written, lost, .. } = &*self.shared;
        let counts = json!({ "written": written.load(Ordering::Relaxed), "lost": lost.load(Ordering::Relaxed) });
        report.sections.insert("recorded".to_owned(), counts);
    }

    fn end(&self, report: &RunReport) {
        let Some(mut writing) = lock(&self.writing).take() else { return };
        let time = self.at(Time::from_nanos((report.time_s * 1e9) as u64));
        let report = serde_json::to_vec(report).unwrap_or_default();
        writing.end(time, &report);
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        // A run that did not start has no end.
        self.close();
        if let Some(mut writing) = lock(&self.writing).take() {
            writing.finish();
        }
    }
}
