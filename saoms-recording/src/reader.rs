use std::collections::{BTreeMap, HashMap, VecDeque};
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::records::{AttachmentHeader, Metadata, Record, SchemaHeader, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError, McapResult, parse_record};
use saoms_api::Message;
use saoms_api::host::cdr;
use saoms_core::tape;
use saoms_registry::schema::Schema;
use serde_json::Value;

use crate::RecordingError;
use crate::file::{ChannelForm, END, ROLE, RUN, SCHEMA, SENDERS};
use crate::messages::Senders;
use crate::recording::{TAPE, TAPES};
use crate::writing::DRAWING;

/// No record and no chunk is larger: what says so is damaged.
const LARGEST: usize = 1 << 28;
/// Bytes that are read at once: no memory for what only a damaged length says is there.
const AT_ONCE: usize = 1 << 16;

const DAMAGED: &str = "it is damaged";

/// A channel of a recording.
pub struct Channel {
    pub(crate) form: ChannelForm,
    /// How messages are read; `None` where this program cannot.
    schema: Option<Schema>,
}

/// A message of a recording.
#[derive(Clone, Debug)]
pub struct RecordedMessage {
    /// Its channel.
    pub channel: Arc<Channel>,
    /// When it was sent, in nanoseconds as the file has them.
    pub time: u64,
    /// The component that sent it, if it is of a topic.
    pub component: Option<Arc<str>>,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// A file in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedFile {
    /// Its name.
    pub name: String,
    /// What it has, as `application/json`.
    pub media_type: String,
    /// Its bytes.
    pub data: Vec<u8>,
    pub(crate) time: u64,
}

/// A part of a recording.
#[derive(Clone, Debug)]
pub enum Part {
    /// A message.
    Message(RecordedMessage),
    /// A file.
    File(RecordedFile),
    /// Values by name.
    Values(String, BTreeMap<String, String>),
}

/// The reader of a recording, part by part in the order in which they were written.
///
/// A file that was cut off is read as far as it goes.
pub struct Reader {
    path: PathBuf,
    file: File,
    records: LinearReader,
    schemas: HashMap<u16, (String, String, Vec<u8>)>,
    channels: HashMap<u16, Arc<Channel>>,
    senders: VecDeque<Arc<str>>,
    /// The start of the run, in nanoseconds.
    start: Option<u64>,
    lost: Option<u64>,
    cut: Option<String>,
    has_ended: bool,
}

impl Channel {
    /// The topic.
    pub fn topic(&self) -> &str {
        &self.form.topic
    }

    /// The type of its messages, as ROS 2 calls it.
    pub fn type_name(&self) -> &str {
        &self.form.schema.0
    }

    /// True if its messages are drawings for tools, each of which shows all that its topic is about.
    pub fn is_drawing(&self) -> bool {
        self.form.metadata.get(ROLE).is_some_and(|role| role == DRAWING)
    }

    /// The path of the component whose tape it is.
    pub fn taped_component(&self) -> Option<&str> {
        let is_tape = self.form.metadata.get(ROLE).is_some_and(|role| role == TAPE);
        self.topic().strip_prefix(TAPES).filter(|_| is_tape)
    }

    /// True if it tells something of the others.
    fn has_senders(&self) -> bool {
        self.form.metadata.get(ROLE).is_some_and(|role| role == SENDERS)
    }
}

impl fmt::Debug for Channel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Channel").field(&self.form.topic).finish()
    }
}

impl RecordedMessage {
    /// The step of a component, in a channel with a tape; `None` if it is of another version of the program.
    pub fn step(&self) -> Option<tape::Step> {
        let is_known = self.channel.form.metadata.get(SCHEMA).is_some_and(|schema| schema == tape::Step::SCHEMA);
        is_known.then(|| cdr::decode(&self.bytes).ok()).flatten()
    }

    /// The message as JSON; `None` if this program cannot read it, as one of another program.
    pub fn json(&self) -> Option<Value> {
        match &self.channel.schema {
            Some(schema) => schema.decode(&self.bytes).ok(),
            None if self.channel.form.encoding == "json" => serde_json::from_slice(&self.bytes).ok(),
            None => None,
        }
    }
}

impl Reader {
    /// Opens a recording.
    ///
    /// # Errors
    /// It cannot be read, or is none.
    pub fn open(path: &Path) -> Result<Reader, RecordingError> {
        let path = path.to_owned();
        let failed = |error| RecordingError::Io { path: path.clone(), error };
        let mut file = File::open(&path).map_err(failed)?;
        let mut magic = [0; MAGIC.len()];
        match file.read_exact(&mut magic) {
            Ok(()) if magic == *MAGIC => {}
            Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(failed(error)),
            _ => return Err(RecordingError::Foreign { path }),
        }
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            // A chunk whose checksum is wrong has nothing that can be believed.
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(LARGEST);
        Ok(Reader {
            path,
            file,
            records: LinearReader::new_with_options(options),
            schemas: HashMap::new(),
            channels: HashMap::new(),
            senders: VecDeque::new(),
            start: None,
            lost: None,
            cut: None,
            has_ended: false,
        })
    }

    /// The next part; `None` at the end.
    ///
    /// # Errors
    /// The system refuses to read, or the file has a form that this program does not know.
    pub fn next_part(&mut self) -> Result<Option<Part>, RecordingError> {
        while !self.has_ended {
            let step = match self.records.next_event() {
                None => Step::End,
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => Step::Fill(wanted),
                Some(Ok(LinearReadEvent::Record { opcode, data })) => Step::Record(record(opcode, data)),
                Some(Err(error)) => Step::Record(Err(error)),
            };
            let record = match step {
                Step::End => break,
                Step::Fill(wanted) => {
                    self.fill(wanted)?;
                    continue;
                }
                Step::Record(record) => record,
            };
            match record.map(|record| record.map_or(Some(None), |record| self.part(record))) {
                Ok(Some(Some(part))) => return Ok(Some(part)),
                Ok(Some(None)) => {}
                Ok(None) => self.is_cut(DAMAGED),
                Err(McapError::UnexpectedEof) => self.is_cut("it was not finished"),
                Err(McapError::UnsupportedCompression(name)) => {
                    self.has_ended = true;
                    let message = format!("it is compressed by `{name}`, which this program does not read");
                    return Err(RecordingError::Form { path: self.path.clone(), message });
                }
                // What follows a place that is damaged is not looked at.
                Err(_) => self.is_cut(DAMAGED),
            }
        }
        self.has_ended = true;
        Ok(None)
    }

    /// Why the file has no end, once all that it has is read; `None` if it is whole.
    pub fn cut(&self) -> Option<&str> {
        self.cut.as_deref()
    }

    /// The start of the run, in the nanoseconds of the file; `None` before that was read, or if another program wrote
    /// it.
    pub fn start(&self) -> Option<u64> {
        self.start
    }

    /// The number of messages, records and lines that were lost; `None` before the end.
    pub fn lost(&self) -> Option<u64> {
        self.lost
    }

    /// The channels that were read so far.
    pub fn channels(&self) -> impl Iterator<Item = &Arc<Channel>> {
        self.channels.values().filter(|channel| !channel.has_senders())
    }

    /// Has the reader of records get more of the file.
    fn fill(&mut self, wanted: usize) -> Result<(), RecordingError> {
        let place = self.records.insert(wanted.min(AT_ONCE));
        let count = loop {
            match self.file.read(place) {
                Ok(count) => break count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(RecordingError::Io { path: self.path.clone(), error }),
            }
        };
        self.records.notify_read(count);
        Ok(())
    }

    fn is_cut(&mut self, why: &str) {
        self.has_ended = true;
        self.cut = Some(why.to_owned());
    }

    /// The part that a record is, if it is one; nothing if it does not fit to those before it.
    fn part(&mut self, record: Record<'static>) -> Option<Option<Part>> {
        match record {
            Record::Schema { header: SchemaHeader { id, name, encoding }, data } => {
                self.schemas.insert(id, (name, encoding, data.into_owned()));
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                let (topic, encoding, metadata) = (channel.topic, channel.message_encoding, channel.metadata);
                let known = metadata.get(SCHEMA).and_then(|schema| Schema::parse(schema).ok());
                let form = ChannelForm { topic, schema, encoding, metadata };
                // The end of a file says them again.
                self.channels.entry(channel.id).or_insert_with(|| Arc::new(Channel { form, schema: known }));
            }
            Record::Message { header, data } => {
                return self.message(header.channel_id, header.log_time, data.into_owned());
            }
            Record::Attachment { header: AttachmentHeader { log_time: time, name, media_type, .. }, data, .. } => {
                let data = data.into_owned();
                return Some(Some(Part::File(RecordedFile { name, media_type, data, time })));
            }
            Record::Metadata(values) => return Some(Some(self.values(values))),
            _ => {}
        }
        Some(None)
    }

    /// The message, if it is one of a topic, of the journal or of the log.
    fn message(&mut self, id: u16, time: u64, bytes: Vec<u8>) -> Option<Option<Part>> {
        let channel = Arc::clone(self.channels.get(&id)?);
        if channel.has_senders() {
            let Senders { components, senders } = cdr::decode(&bytes).unwrap_or_default();
            let components: Vec<Arc<str>> = components.into_iter().map(Arc::from).collect();
            self.senders = senders.iter().filter_map(|one| components.get(*one as usize).cloned()).collect();
            return Some(None);
        }
        let is_of_topic = !channel.form.metadata.contains_key(ROLE);
        let component = if is_of_topic { self.senders.pop_front() } else { None };
        Some(Some(Part::Message(RecordedMessage { channel, time, component, bytes })))
    }

    fn values(&mut self, Metadata { name, metadata: values }: Metadata) -> Part {
        let number = |name: &str| values.get(name).and_then(|number| number.parse().ok());
        match &*name {
            RUN => self.start = number("start_ns"),
            END => self.lost = number("lost"),
            _ => {}
        }
        Part::Values(name, values)
    }
}

/// What the reader of records wants, or has.
enum Step {
    /// The end of the file.
    End,
    /// So many bytes of the file.
    Fill(usize),
    Record(McapResult<Option<Record<'static>>>),
}

/// A record that may be a part of a recording, or that a part needs; `None` for any other.
fn record(operation: u8, content: &[u8]) -> McapResult<Option<Record<'static>>> {
    match operation {
        op::ATTACHMENT if !has_all_of_attachment(content) => {
            Err(McapError::BadAttachmentLength { header: 0, available: content.len() as u64 })
        }
        op::SCHEMA | op::CHANNEL | op::MESSAGE | op::ATTACHMENT | op::METADATA => {
            parse_record(operation, content).map(|record| Some(record.into_owned()))
        }
        _ => Ok(None),
    }
}

/// True if an attachment is as long as its lengths say: `mcap` 0.26 panics at one that ends before its checksum.
fn has_all_of_attachment(content: &[u8]) -> bool {
    const TIMES: usize = 16;
    const DATA: usize = 8;
    const CHECKSUM: usize = 4;
    let after_text = |start: usize| {
        let length = content.get(start..)?.first_chunk::<4>()?;
        start.checked_add(4)?.checked_add(usize::try_from(u32::from_le_bytes(*length)).ok()?)
    };
    let head = after_text(TIMES).and_then(after_text).and_then(|end| end.checked_add(DATA + CHECKSUM));
    head.is_some_and(|end| end <= content.len())
}

impl fmt::Debug for Reader {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Reader").field(&self.path).finish()
    }
}
