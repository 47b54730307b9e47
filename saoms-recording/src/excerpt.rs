//! A part of a recording as a recording of its own.

use std::io::{self, Write};
use std::sync::Arc;

use crate::Channel;
use crate::file::{FileWriter, Item};
use crate::reader::{Part, RecordedMessage};

/// Bytes of messages that are written at once.
const AT_ONCE: usize = 1 << 20;

/// The writer of a part of a recording.
pub struct Excerpt<'a> {
    to: &'a mut dyn Write,
    writer: FileWriter,
    /// The channels so far, with their numbers.
    channels: Vec<(Arc<Channel>, u16)>,
    items: Vec<Item>,
    bytes: Vec<u8>,
}

impl<'a> Excerpt<'a> {
    /// Begins a file.
    pub fn begin(to: &'a mut dyn Write) -> Excerpt<'a> {
        Excerpt { to, writer: FileWriter::begin(), channels: Vec::new(), items: Vec::new(), bytes: Vec::new() }
    }

    /// Adds a part.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn add(&mut self, part: &Part) -> io::Result<()> {
        match part {
            Part::Message(RecordedMessage { channel, time, component, bytes }) => {
                let number = self.channel(channel)?;
                self.bytes.extend_from_slice(bytes);
                let (sender, end) = (component.clone(), self.bytes.len());
                self.items.push(Item { channel: number, sender, time: *time, end });
                if end >= AT_ONCE { self.flush() } else { Ok(()) }
            }
            Part::File(file) => {
                self.flush()?;
                self.writer.attach(&file.name, &file.media_type, file.time, &file.data);
                Ok(())
            }
            Part::Values(name, values) => {
                self.flush()?;
                self.writer.metadata(name, values);
                Ok(())
            }
        }
    }

    /// The number of a channel, of which a file has so many at most.
    fn channel(&mut self, channel: &Arc<Channel>) -> io::Result<u16> {
        if let Some((_, number)) = self.channels.iter().find(|(known, _)| Arc::ptr_eq(known, channel)) {
            return Ok(*number);
        }
        match self.writer.channel(&channel.form) {
            0 => Err(io::Error::other("it has too many topics")),
            number => {
                self.channels.push((Arc::clone(channel), number));
                Ok(number)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.write(&self.items, &self.bytes);
        self.items.clear();
        self.bytes.clear();
        self.writer.bring(self.to)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        self.flush()?;
        self.writer.finish();
        self.writer.bring(self.to)
    }
}
