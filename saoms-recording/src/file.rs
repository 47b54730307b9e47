//! The writer of a file: what a recording and a part of one have in common.

use std::collections::{BTreeMap, HashMap};
use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mcap::records::MessageHeader;
use mcap::write::{Metadata, NoSeek};
use mcap::{Attachment, Compression, McapResult, WriteOptions, Writer};
use saoms_api::Message;
use saoms_api::host::cdr;
use saoms_registry::ros::RosType;
use saoms_registry::schema::SchemaError;

use crate::messages::Senders;

/// The name of the metadata of a run.
pub(crate) const RUN: &str = "saoms";
/// The name of the metadata about what a recording lacks.
pub(crate) const END: &str = "saoms.end";
/// What the metadata of a channel say: the schema of its messages, and what it is, if it is no topic.
pub(crate) const SCHEMA: &str = "saoms.schema";
pub(crate) const ROLE: &str = "saoms.role";

/// The role of the channel that says who sent the messages.
pub(crate) const SENDERS: &str = "senders";
/// The topic of that channel.
const SENDERS_TOPIC: &str = "/saoms/senders";

/// Bytes of a chunk, after which the next one begins.
const CHUNK: usize = 1 << 20;
/// Bytes of a message there beside its own.
const RECORD: usize = 31;

/// What a channel is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ChannelForm {
    pub(crate) topic: String,
    /// Name and encoding of the schema, and the schema; without a name there is none.
    pub(crate) schema: (String, String, Vec<u8>),
    pub(crate) encoding: String,
    pub(crate) metadata: BTreeMap<String, String>,
}

impl ChannelForm {
    /// A channel of messages in CDR with this schema of a declaration.
    pub(crate) fn of(topic: &str, schema: &str, role: Option<&str>) -> Result<ChannelForm, SchemaError> {
        let RosType { name, text, .. } = RosType::of(schema)?;
        let mut metadata = BTreeMap::from([(SCHEMA.to_owned(), schema.to_owned())]);
        metadata.extend(role.map(|role| (ROLE.to_owned(), role.to_owned())));
        let schema = (name, "ros2msg".to_owned(), text.into_bytes());
        Ok(ChannelForm { topic: topic.to_owned(), schema, encoding: "cdr".to_owned(), metadata })
    }
}

/// A message on its way to a file.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    /// The number of its channel; 0 where there is none, so that it is left out.
    pub(crate) channel: u16,
    /// Its sender, if it is of a topic.
    pub(crate) sender: Option<Arc<str>>,
    /// Nanoseconds.
    pub(crate) time: u64,
    /// Where its bytes end.
    pub(crate) end: usize,
}

/// The writer of a file. It writes to memory, so that a full disk does not end a recording: only that the bytes are
/// [brought](FileWriter::bring) can fail.
pub(crate) struct FileWriter {
    /// `None` once the file has its end.
    mcap: Option<Writer<NoSeek<Unwritten>>>,
    unwritten: Unwritten,
    /// Bytes that are in the file.
    place: u64,
    /// Bytes of the messages of the present chunk, and the number of chunks before it.
    chunk: usize,
    chunks: u64,
    /// The number of messages of each channel, by its number.
    counts: Vec<u32>,
    senders: u16,
}

/// What was written and is not in the file yet. A chunk comes here as a whole.
#[derive(Clone, Default)]
struct Unwritten(Arc<Mutex<Vec<u8>>>);

impl Unwritten {
    fn lock(&self) -> MutexGuard<'_, Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Write for Unwritten {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.lock().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl FileWriter {
    /// Begins a file.
    pub(crate) fn begin() -> FileWriter {
        let unwritten = Unwritten::default();
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("saoms ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Lz4))
            // Chunks end by time, too, and are counted.
            .chunk_size(None)
            .disable_seeking(true)
            // Each chunk has a checksum of its own.
            .calculate_data_section_crc(false);
        // Memory takes everything.
        let mcap = options.create(NoSeek::new(unwritten.clone())).ok();
        FileWriter { mcap, unwritten, place: 0, chunk: 0, chunks: 0, counts: Vec::new(), senders: 0 }
    }

    /// The number of a channel; 0 if there are too many.
    pub(crate) fn channel(&mut self, form: &ChannelForm) -> u16 {
        let Some(mcap) = &mut self.mcap else { return 0 };
        let ChannelForm { topic, schema: (name, encoding, data), encoding: of_messages, metadata } = form;
        let schema = if name.is_empty() { Ok(0) } else { mcap.add_schema(name, encoding, data) };
        // Numbers begin with 1.
        schema.and_then(|schema| mcap.add_channel(schema, topic, of_messages, metadata)).unwrap_or(0)
    }

    /// Writes messages, whose bytes stand one after the other. Gives the number of those that have no channel.
    pub(crate) fn write(&mut self, items: &[Item], bytes: &[u8]) -> u64 {
        let mut senders = Senders::default();
        let mut places: HashMap<&Arc<str>, u32> = HashMap::new();
        for sender in items.iter().filter(|item| item.channel != 0).filter_map(|item| item.sender.as_ref()) {
            let place = *places.entry(sender).or_insert(senders.components.len() as u32);
            if place as usize == senders.components.len() {
                senders.components.push(sender.to_string());
            }
            senders.senders.push(place);
        }
        if let Some(first) = items.iter().find(|item| item.channel != 0 && item.sender.is_some()) {
            if self.senders == 0
                && let Ok(form) = ChannelForm::of(SENDERS_TOPIC, Senders::SCHEMA, Some(SENDERS))
            {
                self.senders = self.channel(&form);
            }
            // They come before the messages, so that who reads knows who sent one when it comes.
            self.message(self.senders, first.time, &cdr::encode(&senders));
        }
        let (mut start, mut left_out) = (0, 0);
        for Item { channel, time, end, .. } in items {
            let is_written = self.message(*channel, *time, bytes.get(start..*end).unwrap_or_default());
            left_out += u64::from(!is_written);
            start = *end;
        }
        left_out
    }

    /// Writes a message; false if it has no channel.
    fn message(&mut self, channel: u16, time: u64, bytes: &[u8]) -> bool {
        if self.chunk >= CHUNK {
            self.end_chunk();
        }
        let Some(mcap) = self.mcap.as_mut().filter(|_| channel != 0) else { return false };
        let place = usize::from(channel);
        self.counts.resize(self.counts.len().max(place + 1), 0);
        self.counts[place] = self.counts[place].wrapping_add(1);
        let sequence = self.counts[place];
        // Recorded and sent: nobody knows when it was recorded, and that is of no use.
        let header = MessageHeader { channel_id: channel, sequence, log_time: time, publish_time: time };
        self.chunk += bytes.len() + RECORD;
        mcap.write_to_known_channel(&header, bytes).is_ok()
    }

    /// Ends the present chunk. A chunk is in the file as a whole or not at all.
    pub(crate) fn end_chunk(&mut self) {
        // One with channels alone has to wait for a message: it would have no time.
        if std::mem::take(&mut self.chunk) > 0 {
            self.put(Writer::flush);
            self.chunks += 1;
        }
    }

    /// Adds a file.
    pub(crate) fn attach(&mut self, name: &str, media_type: &str, time: u64, data: &[u8]) {
        self.end_chunk();
        let (name, media_type, data) = (name.to_owned(), media_type.to_owned(), data.into());
        self.put(|mcap| mcap.attach(&Attachment { log_time: time, create_time: time, name, media_type, data }));
    }

    /// Adds values by name.
    pub(crate) fn metadata(&mut self, name: &str, values: &BTreeMap<String, String>) {
        self.end_chunk();
        let metadata = Metadata { name: name.to_owned(), metadata: values.clone() };
        self.put(|mcap| mcap.write_metadata(&metadata));
    }

    /// Ends the file: nothing is written any more.
    pub(crate) fn finish(&mut self) {
        self.end_chunk();
        self.put(|mcap| mcap.finish().map(drop));
        self.mcap = None;
    }

    /// Writes something to memory, which takes everything.
    fn put(&mut self, put: impl FnOnce(&mut Writer<NoSeek<Unwritten>>) -> McapResult<()>) {
        let _ = self.mcap.as_mut().map(put);
    }

    /// The number of chunks, whose index is in memory until the file has its end.
    pub(crate) fn chunks(&self) -> u64 {
        self.chunks
    }

    /// Bytes of the file as far as it is written.
    pub(crate) fn size(&self) -> u64 {
        self.place + self.unwritten.lock().len() as u64
    }

    /// True if it has messages and can have more.
    pub(crate) fn is_open(&self) -> bool {
        self.mcap.is_some() && !self.counts.is_empty()
    }

    /// Brings what was written to its place. What has no room there stays for the next time.
    pub(crate) fn bring(&mut self, to: &mut dyn Write) -> io::Result<()> {
        let mut unwritten = self.unwritten.lock();
        let mut done = 0;
        let result = loop {
            if done == unwritten.len() {
                break Ok(());
            }
            match to.write(&unwritten[done..]) {
                Ok(0) => break Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => done += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => break Err(error),
            }
        };
        unwritten.drain(..done);
        self.place += done as u64;
        result
    }
}
