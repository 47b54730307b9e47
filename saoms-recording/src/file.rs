//! The writer of a file: what a recording and a part of one have in common.

use std::collections::{BTreeMap, HashMap};
use std::io::{self, Write};
use std::sync::Arc;

use saoms_api::Message;
use saoms_api::host::cdr;
use saoms_registry::schema::SchemaError;

use crate::format::{LZ4, MAGIC, Put, checksum, compressed, op};
use crate::messages::Senders;
use crate::ros::RosType;

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

/// What a channel is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
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
        let RosType { name, text } = RosType::of(schema)?;
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

/// The writer of a file. Nothing that it writes can fail: that happens where the bytes are
/// [brought](FileWriter::bring), so that a full disk does not end a recording.
pub(crate) struct FileWriter {
    /// What was written and is not in the file yet.
    unwritten: Vec<u8>,
    /// The place in the file where that begins.
    place: u64,
    /// The records of the present chunk, and for each channel the times and places of its messages there.
    chunk: Vec<u8>,
    index: BTreeMap<u16, Vec<(u64, u64)>>,
    channels: HashMap<ChannelForm, u16>,
    schemas: HashMap<(String, String, Vec<u8>), u16>,
    /// The number of messages of each channel, by its number.
    counts: BTreeMap<u16, u64>,
    /// Times of the first and the last message.
    times: Option<(u64, u64)>,
    summary: Summary,
    senders: u16,
}

/// Records for the end of the file.
#[derive(Default)]
struct Summary {
    schemas: Vec<u8>,
    channels: Vec<u8>,
    chunks: (Vec<u8>, u32),
    attachments: (Vec<u8>, u32),
    metadata: (Vec<u8>, u32),
}

impl FileWriter {
    /// Begins a file.
    pub(crate) fn begin() -> FileWriter {
        let mut unwritten = MAGIC.to_vec();
        unwritten.record(op::HEADER, |to| {
            to.sized(b"ros2");
            to.sized(concat!("saoms ", env!("CARGO_PKG_VERSION")).as_bytes());
        });
        FileWriter {
            unwritten,
            place: 0,
            chunk: Vec::new(),
            index: BTreeMap::new(),
            channels: HashMap::new(),
            schemas: HashMap::new(),
            counts: BTreeMap::new(),
            times: None,
            summary: Summary::default(),
            senders: 0,
        }
    }

    /// The number of a channel; 0 if there are too many.
    pub(crate) fn channel(&mut self, form: &ChannelForm) -> u16 {
        if let Some(known) = self.channels.get(form) {
            return *known;
        }
        let Ok(number) = u16::try_from(self.channels.len() + 1) else { return 0 };
        let schema = self.schema(&form.schema);
        let start = self.chunk.len();
        self.chunk.record(op::CHANNEL, |to| {
            to.number16(number);
            to.number16(schema);
            to.sized(form.topic.as_bytes());
            to.sized(form.encoding.as_bytes());
            to.map(&form.metadata);
        });
        self.summary.channels.extend_from_slice(&self.chunk[start..]);
        self.channels.insert(form.clone(), number);
        number
    }

    /// The number of a schema, of which there are no more than channels.
    fn schema(&mut self, schema: &(String, String, Vec<u8>)) -> u16 {
        let (name, encoding, data) = schema;
        if name.is_empty() {
            return 0;
        }
        if let Some(known) = self.schemas.get(schema) {
            return *known;
        }
        let number = self.schemas.len() as u16 + 1;
        let start = self.chunk.len();
        self.chunk.record(op::SCHEMA, |to| {
            to.number16(number);
            to.sized(name.as_bytes());
            to.sized(encoding.as_bytes());
            to.sized(data);
        });
        self.summary.schemas.extend_from_slice(&self.chunk[start..]);
        self.schemas.insert(schema.clone(), number);
        number
    }

    /// Writes messages, whose bytes stand one after the other.
    pub(crate) fn write(&mut self, items: &[Item], bytes: &[u8]) {
        let mut senders = Senders::default();
        let mut places: HashMap<&Arc<str>, u32> = HashMap::new();
        for sender in items.iter().filter_map(|item| item.sender.as_ref()) {
            let place = *places.entry(sender).or_insert(senders.components.len() as u32);
            if place as usize == senders.components.len() {
                senders.components.push(sender.to_string());
            }
            senders.senders.push(place);
        }
        if let Some(first) = items.iter().find(|item| item.sender.is_some()) {
            if self.senders == 0
                && let Ok(form) = ChannelForm::of(SENDERS_TOPIC, Senders::SCHEMA, Some(SENDERS))
            {
                self.senders = self.channel(&form);
            }
            // They come before the messages, so that who reads knows who sent one when it comes.
            self.message(self.senders, first.time, &cdr::encode(&senders));
        }
        let mut start = 0;
        for Item { channel, time, end, .. } in items {
            self.message(*channel, *time, bytes.get(start..*end).unwrap_or_default());
            start = *end;
        }
    }

    fn message(&mut self, channel: u16, time: u64, bytes: &[u8]) {
        if channel == 0 {
            return;
        }
        if self.chunk.len() >= CHUNK {
            self.end_chunk();
        }
        let count = self.counts.entry(channel).or_default();
        *count += 1;
        let sequence = *count as u32;
        self.index.entry(channel).or_default().push((time, self.chunk.len() as u64));
        let (first, last) = self.times.unwrap_or((time, time));
        self.times = Some((first.min(time), last.max(time)));
        self.chunk.record(op::MESSAGE, |to| {
            to.number16(channel);
            to.number32(sequence);
            // Recorded and sent: nobody knows when it was recorded, and that is of no use.
            to.number64(time);
            to.number64(time);
            to.extend_from_slice(bytes);
        });
    }

    fn here(&self) -> u64 {
        self.place + self.unwritten.len() as u64
    }

    /// Ends the present chunk. A chunk is in the file as a whole or not at all.
    pub(crate) fn end_chunk(&mut self) {
        // One with channels alone has to wait for a message: it would have no time.
        if self.index.values().all(Vec::is_empty) {
            return;
        }
        let times = self.index.values().flatten().map(|(time, _)| *time);
        let (first, last) = (times.clone().min().unwrap_or(0), times.max().unwrap_or(0));
        // Where it does not fit into a frame, it stands as it is.
        let frame = compressed(&self.chunk).ok();
        let compression = if frame.is_some() { LZ4 } else { "" };
        let (size, sum, start) = (self.chunk.len() as u64, checksum(&self.chunk), self.here());
        let records = frame.as_deref().unwrap_or(&self.chunk);
        self.unwritten.record(op::CHUNK, |to| {
            to.number64(first);
            to.number64(last);
            to.number64(size);
            to.number32(sum);
            to.sized(compression.as_bytes());
            to.number64(records.len() as u64);
            to.extend_from_slice(records);
        });
        let (stored, end) = (records.len() as u64, self.here());
        let mut places = Vec::new();
        for (channel, entries) in &mut self.index {
            if entries.is_empty() {
                continue;
            }
            places.number16(*channel);
            places.number64(self.place + self.unwritten.len() as u64);
            // Readers expect them in the order of times.
            entries.sort();
            self.unwritten.record(op::MESSAGE_INDEX, |to| {
                to.number16(*channel);
                to.number32(entries.len() as u32 * 16);
                for (time, place) in entries.drain(..) {
                    to.number64(time);
                    to.number64(place);
                }
            });
        }
        let indexes = self.here() - end;
        let (chunks, count) = &mut self.summary.chunks;
        *count += 1;
        chunks.record(op::CHUNK_INDEX, |to| {
            for number in [first, last, start, end - start] {
                to.number64(number);
            }
            to.sized(&places);
            to.number64(indexes);
            to.sized(compression.as_bytes());
            to.number64(stored);
            to.number64(size);
        });
        self.chunk.clear();
    }

    /// Adds a file.
    pub(crate) fn attach(&mut self, name: &str, media_type: &str, time: u64, data: &[u8]) {
        self.end_chunk();
        let start = self.here();
        self.unwritten.record(op::ATTACHMENT, |to| {
            to.number64(time);
            to.number64(time);
            to.sized(name.as_bytes());
            to.sized(media_type.as_bytes());
            to.number64(data.len() as u64);
            to.extend_from_slice(data);
            // No checksum.
            to.number32(0);
        });
        let length = self.here() - start;
        let (attachments, count) = &mut self.summary.attachments;
        *count += 1;
        attachments.record(op::ATTACHMENT_INDEX, |to| {
            for number in [start, length, time, time, data.len() as u64] {
                to.number64(number);
            }
            to.sized(name.as_bytes());
            to.sized(media_type.as_bytes());
        });
    }

    /// Adds values by name.
    pub(crate) fn metadata(&mut self, name: &str, values: &BTreeMap<String, String>) {
        self.end_chunk();
        let start = self.here();
        self.unwritten.record(op::METADATA, |to| {
            to.sized(name.as_bytes());
            to.map(values);
        });
        let length = self.here() - start;
        let (metadata, count) = &mut self.summary.metadata;
        *count += 1;
        metadata.record(op::METADATA_INDEX, |to| {
            to.number64(start);
            to.number64(length);
            to.sized(name.as_bytes());
        });
    }

    /// Ends the file: nothing is to be written any more.
    pub(crate) fn finish(&mut self) {
        self.end_chunk();
        // No checksum of all that: each chunk has its own.
        self.unwritten.record(op::DATA_END, |to| to.number32(0));
        let start = self.here();
        let Summary { schemas, channels, chunks, attachments, metadata } = std::mem::take(&mut self.summary);
        let mut statistics = Vec::new();
        let (first, last) = self.times.unwrap_or_default();
        statistics.record(op::STATISTICS, |to| {
            to.number64(self.counts.values().sum());
            to.number16(self.schemas.len() as u16);
            to.number32(self.channels.len() as u32);
            for count in [attachments.1, metadata.1, chunks.1] {
                to.number32(count);
            }
            to.number64(first);
            to.number64(last);
            to.number32(self.counts.len() as u32 * 10);
            for (channel, count) in &self.counts {
                to.number16(*channel);
                to.number64(*count);
            }
        });
        let mut offsets = Vec::new();
        for (operation, records) in [
            (op::SCHEMA, &schemas),
            (op::CHANNEL, &channels),
            (op::STATISTICS, &statistics),
            (op::CHUNK_INDEX, &chunks.0),
            (op::ATTACHMENT_INDEX, &attachments.0),
            (op::METADATA_INDEX, &metadata.0),
        ] {
            if !records.is_empty() {
                offsets.record(op::SUMMARY_OFFSET, |to| {
                    to.push(operation);
                    to.number64(self.here());
                    to.number64(records.len() as u64);
                });
                self.unwritten.extend_from_slice(records);
            }
        }
        let offsets_start = self.here();
        self.unwritten.extend_from_slice(&offsets);
        self.unwritten.record(op::FOOTER, |to| {
            to.number64(start);
            to.number64(offsets_start);
            to.number32(0);
        });
        self.unwritten.extend_from_slice(MAGIC);
    }

    /// Brings what was written to its place. What has no room there stays for the next time.
    pub(crate) fn bring(&mut self, to: &mut dyn Write) -> io::Result<()> {
        let mut done = 0;
        let result = loop {
            if done == self.unwritten.len() {
                break Ok(());
            }
            match to.write(&self.unwritten[done..]) {
                Ok(0) => break Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => done += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => break Err(error),
            }
        };
        self.unwritten.drain(..done);
        self.place += done as u64;
        result
    }
}
