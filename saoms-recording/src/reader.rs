use std::collections::{BTreeMap, HashMap, VecDeque};
use std::fmt;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use saoms_api::host::cdr;
use saoms_registry::schema::Schema;
use serde_json::Value;

use crate::RecordingError;
use crate::file::{ChannelForm, END, ROLE, RUN, SCHEMA, SENDERS};
use crate::format::{LARGEST, LZ4, MAGIC, Take, checksum, decompressed, op};
use crate::messages::Senders;

/// The length of operation and length of a record.
const HEAD: usize = 9;

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
    file: BufReader<File>,
    /// What was read at once and is not looked at yet: a chunk.
    chunk: Vec<u8>,
    /// The place of the next record there.
    place: usize,
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
        let mut file = BufReader::new(File::open(&path).map_err(failed)?);
        let mut magic = [0; MAGIC.len()];
        match file.read_exact(&mut magic) {
            Ok(()) if magic == *MAGIC => {}
            Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(failed(error)),
            _ => return Err(RecordingError::Foreign { path }),
        }
        Ok(Reader {
            path,
            file,
            chunk: Vec::new(),
            place: 0,
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
            if let Some(part) = self.record()? {
                return Ok(Some(part));
            }
        }
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

    /// Reads a record. It may be no part.
    fn record(&mut self) -> Result<Option<Part>, RecordingError> {
        if self.place < self.chunk.len() {
            let chunk = std::mem::take(&mut self.chunk);
            let mut rest = Take(&chunk[self.place..]);
            let found = rest.record().ok_or(()).and_then(|(operation, content)| self.part(operation, content));
            self.place = chunk.len() - rest.0.len();
            self.chunk = chunk;
            return Ok(found.unwrap_or_else(|()| self.is_damaged()));
        }
        let mut head = [0; HEAD];
        if !self.fill(&mut head)? {
            return Ok(None);
        }
        let mut taken = Take(&head);
        let (operation, length) = (taken.number8().unwrap_or(0), taken.number64().unwrap_or(0));
        if length > LARGEST || operation == 0 {
            return Ok(self.is_damaged());
        }
        let mut content = Vec::new();
        // No memory for what only a damaged length says is there.
        let read = (&mut self.file).take(length).read_to_end(&mut content);
        read.map_err(|error| RecordingError::Io { path: self.path.clone(), error })?;
        if (content.len() as u64) < length {
            self.is_cut("it was not finished");
            return Ok(None);
        }
        match operation {
            op::CHUNK => self.open_chunk(&content),
            op::FOOTER => {
                let mut magic = [0; MAGIC.len()];
                self.has_ended = true;
                Ok(if self.fill(&mut magic)? && magic != *MAGIC { self.is_damaged() } else { None })
            }
            _ => Ok(self.part(operation, &content).unwrap_or_else(|()| self.is_damaged())),
        }
    }

    /// Fills bytes from the file; false at its end.
    fn fill(&mut self, bytes: &mut [u8]) -> Result<bool, RecordingError> {
        match self.file.read_exact(bytes) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                self.is_cut("it was not finished");
                Ok(false)
            }
            Err(error) => Err(RecordingError::Io { path: self.path.clone(), error }),
        }
    }

    fn is_cut(&mut self, why: &str) {
        self.has_ended = true;
        self.cut = Some(why.to_owned());
    }

    /// What follows a place that is damaged is not looked at.
    fn is_damaged(&mut self) -> Option<Part> {
        self.is_cut("it is damaged");
        None
    }

    fn open_chunk(&mut self, content: &[u8]) -> Result<Option<Part>, RecordingError> {
        let mut content = Take(content);
        let head = (|| {
            let (_, _) = (content.number64()?, content.number64()?);
            let (size, sum, compression) = (content.number64()?, content.number32()?, content.text()?);
            let length = content.number64()?;
            Some((size, sum, compression, content.bytes(length)?))
        })();
        let Some((size, sum, compression, records)) = head else { return Ok(self.is_damaged()) };
        let records = match &*compression {
            "" => Ok(records.to_vec()),
            LZ4 if size <= LARGEST => decompressed(records, size),
            LZ4 => Err(io::ErrorKind::InvalidData.into()),
            other => {
                let message = format!("it is compressed by `{other}`, which this program does not read");
                return Err(RecordingError::Form { path: self.path.clone(), message });
            }
        };
        match records {
            Ok(records) if sum == 0 || sum == checksum(&records) => {
                (self.chunk, self.place) = (records, 0);
                Ok(None)
            }
            _ => Ok(self.is_damaged()),
        }
    }

    /// The part that a record is, if it is one; an error if its content is not that of such a record.
    fn part(&mut self, operation: u8, content: &[u8]) -> Result<Option<Part>, ()> {
        let mut content = Take(content);
        match operation {
            op::SCHEMA => self.schema(&mut content).map(|()| None),
            op::CHANNEL => self.channel(&mut content).map(|()| None),
            op::MESSAGE => self.message(content),
            op::ATTACHMENT => attachment(&mut content).map(|file| Some(Part::File(file))),
            op::METADATA => self.values(&mut content).map(Some),
            _ => Some(None),
        }
        .ok_or(())
    }

    fn schema(&mut self, content: &mut Take<'_>) -> Option<()> {
        let (id, name, encoding) = (content.number16()?, content.text()?, content.text()?);
        self.schemas.insert(id, (name, encoding, content.sized()?.to_vec()));
        Some(())
    }

    fn channel(&mut self, content: &mut Take<'_>) -> Option<()> {
        let (id, schema) = (content.number16()?, content.number16()?);
        let (topic, encoding, metadata) = (content.text()?, content.text()?, content.map()?);
        let schema = self.schemas.get(&schema).cloned().unwrap_or_default();
        let known = metadata.get(SCHEMA).and_then(|schema| Schema::parse(schema).ok());
        let form = ChannelForm { topic, schema, encoding, metadata };
        // The end of a file says them again.
        self.channels.entry(id).or_insert_with(|| Arc::new(Channel { form, schema: known }));
        Some(())
    }

    /// The message, if it is one of a topic, of the journal or of the log.
    fn message(&mut self, mut content: Take<'_>) -> Option<Option<Part>> {
        let (id, _, time, _) = (content.number16()?, content.number32()?, content.number64()?, content.number64()?);
        let bytes = content.0.to_vec();
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

    fn values(&mut self, content: &mut Take<'_>) -> Option<Part> {
        let (name, values) = (content.text()?, content.map()?);
        let number = |name: &str| values.get(name).and_then(|number| number.parse().ok());
        match &*name {
            RUN => self.start = number("start_ns"),
            END => self.lost = number("lost"),
            _ => {}
        }
        Some(Part::Values(name, values))
    }
}

fn attachment(content: &mut Take<'_>) -> Option<RecordedFile> {
    let (time, _) = (content.number64()?, content.number64()?);
    let (name, media_type, length) = (content.text()?, content.text()?, content.number64()?);
    Some(RecordedFile { name, media_type, data: content.bytes(length)?.to_vec(), time })
}

impl fmt::Debug for Reader {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Reader").field(&self.path).finish()
    }
}
