use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::host::{TopicDeclaration, cdr};
use saoms_api::{Failure, Level, Message, Time};
use saoms_core::observe::{Beginning, Interest, LostEvents, Observer, Occurrence, Records, RunEvent, SentMessage};
use saoms_core::report::RunReport;
use saoms_core::schedule::Handle;
use serde_json::json;

use crate::file::{ChannelForm, END, Item, RUN};
use crate::messages::{JournalRecord, Log};
use crate::queue::Queue;
use crate::writing::{Head, Writing};

/// The topics of journal and log. Tools know the one of the log.
const JOURNAL_TOPIC: &str = "/saoms/journal";
const LOG_TOPIC: &str = "/rosout";
/// Their channels.
const JOURNAL: u16 = 0;
const LOG: u16 = 1;

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
    /// The topics whose messages are recorded; `None` is all.
    pub topics: Option<Vec<String>>,
}

/// Who hears that a recording loses something.
pub trait RecordingEvents: Send + Sync {
    /// From now on something is lost.
    fn fails(&self, text: &str);
    /// Everything is recorded again.
    fn works(&self);
}

/// The observer that records a run: messages, journal and log.
///
/// A thread of its own writes. What comes faster than it can write is counted and lost in real time; in virtual time
/// the run waits. What cannot be written is counted, too, and tried again.
pub struct Recording {
    path: PathBuf,
    mode: Option<u32>,
    run: RecordedRun,
    shared: Arc<Shared>,
    topics: Mutex<Topics>,
    /// The memory for the bytes of a message.
    bytes: Mutex<Vec<u8>>,
    thread: Mutex<Option<JoinHandle<Writing>>>,
    /// What the thread has left.
    writing: Mutex<Option<Writing>>,
}

/// What the recording and its thread have in common.
pub(crate) struct Shared {
    pub(crate) queue: Queue,
    pub(crate) events: Box<dyn RecordingEvents>,
    /// The number of messages, records and lines that are not in the file.
    pub(crate) lost: Arc<AtomicU64>,
    pub(crate) written: AtomicU64,
    /// The time of the start of the run, in nanoseconds.
    pub(crate) start: AtomicU64,
    waits: AtomicBool,
    /// True if the last message found no room.
    is_full: AtomicBool,
}

/// The topics of the run.
#[derive(Default)]
struct Topics {
    /// The schemas of those that are recorded.
    schemas: HashMap<String, String>,
    /// The channels of those that had messages; `None` where there is none.
    channels: HashMap<Arc<str>, Option<u16>>,
    next: u16,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Recording {
    /// The recording that is written to a path when the run begins.
    /// The file has these permissions where it is new, whatever mask code of a library has set.
    pub fn new(path: &Path, mode: Option<u32>, run: RecordedRun, events: Box<dyn RecordingEvents>) -> Recording {
        let shared = Shared {
            queue: Queue::new(),
            events,
            lost: Arc::default(),
            written: AtomicU64::new(0),
            start: AtomicU64::new(0),
            waits: AtomicBool::new(false),
            is_full: AtomicBool::new(false),
        };
        let (shared, path) = (Arc::new(shared), path.to_owned());
        let (topics, bytes) = (Mutex::default(), Mutex::default());
        Recording { path, mode, run, shared, topics, bytes, thread: Mutex::default(), writing: Mutex::default() }
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

    fn put(&self, channel: u16, sender: Option<Arc<str>>, time: u64, bytes: &[u8]) {
        let Shared { queue, events, lost, waits, is_full, .. } = &*self.shared;
        let item = Item { channel, sender, time, end: 0 };
        if queue.put(item, bytes, waits.load(Ordering::Relaxed)) {
            if is_full.swap(false, Ordering::Relaxed) {
                events.works();
            }
        } else {
            lost.fetch_add(1, Ordering::Relaxed);
            if !is_full.swap(true, Ordering::Relaxed) {
                let path = self.path.display();
                events.fails(&format!("messages come faster than they can be recorded to `{path}`, and are lost"));
            }
        }
    }

    /// The channel of a topic.
    fn channel(&self, topic: &Arc<str>) -> Option<u16> {
        let mut topics = lock(&self.topics);
        if let Some(known) = topics.channels.get(topic) {
            return *known;
        }
        let schema = topics.schemas.get(&**topic).cloned();
        let form = schema.and_then(|schema| ChannelForm::of(topic, &schema, None).ok());
        let channel = form.filter(|_| topics.next < u16::MAX).map(|form| {
            topics.next += 1;
            self.shared.queue.open(form);
            topics.next - 1
        });
        topics.channels.insert(Arc::clone(topic), channel);
        channel
    }

    /// Waits until the thread has written all that came.
    fn close(&self) {
        self.shared.queue.close();
        if let Some(writing) = lock(&self.thread).take().and_then(|thread| thread.join().ok()) {
            *lock(&self.writing) = Some(writing);
        }
    }

    fn create(&self) -> io::Result<File> {
        let mut options = OpenOptions::new();
        options.write(true).create(true).truncate(true).mode(self.mode.unwrap_or(0o666));
        options.open(&self.path)
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
        Head { name: RUN, values, files }
    }
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
        let file = self.create().map_err(|error| failed(&error))?;
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
        let writing = Writing::begin(&self.path, file, head, Arc::clone(&self.shared));
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
        self.put(LOG, None, time, &cdr::encode(&log));
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        let is_wanted = self.run.topics.as_ref().is_none_or(|topics| topics.iter().any(|topic| topic == name));
        if is_wanted {
            let mut topics = lock(&self.topics);
            if !topics.schemas.contains_key(name) {
                topics.schemas.insert(name.to_owned(), declared.schema.to_owned());
            }
        }
        is_wanted
    }

    fn hears_others(&self) -> bool {
        true
    }

    fn message(&self, sent: &SentMessage) {
        let SentMessage { topic, component, message, .. } = sent;
        let Some(channel) = self.channel(topic) else {
            self.shared.lost.fetch_add(1, Ordering::Relaxed);
            return;
        };
        let mut bytes = lock(&self.bytes);
        message.encode_into(&mut bytes);
        self.put(channel, Some(Arc::clone(component)), self.at(message.header().sent), &bytes);
    }

    fn lost(&self, lost: LostEvents) {
        self.shared.lost.fetch_add(lost.messages, Ordering::Relaxed);
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        self.shared.lost.fetch_add(records.lost, Ordering::Relaxed);
        for entry in records.entries {
            let time = self.at(entry.time());
            self.put(JOURNAL, None, time, &cdr::encode(&JournalRecord::new(time, entry)));
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
        let lost = self.shared.lost.load(Ordering::Relaxed).to_string();
        let report = serde_json::to_vec(&report.without_records()).unwrap_or_default();
        writing.end(time, &report, (END, &BTreeMap::from([("lost".to_owned(), lost)])));
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
