//! Messages that a recording has beside those of topics.

use std::fmt::Write;

use saoms_api::builtin_interfaces::Time;
use saoms_api::{Level, Message};
use saoms_core::journal::JournalEntry;

/// A line of the log, as ROS 2 has it: tools show it as such.
#[derive(Clone, Debug, Message)]
#[message(name = "rcl_interfaces/msg/Log", constants(
    DEBUG: u8 = 10,
    INFO: u8 = 20,
    WARN: u8 = 30,
    ERROR: u8 = 40,
    FATAL: u8 = 50,
))]
pub(crate) struct Log {
    pub(crate) stamp: Time,
    pub(crate) level: u8,
    /// The component; empty for the whole fleet.
    pub(crate) name: String,
    pub(crate) msg: String,
    pub(crate) file: String,
    pub(crate) function: String,
    pub(crate) line: u32,
}

/// A record of the journal.
#[derive(Clone, Debug, Default, Message)]
#[message(name = "saoms_msgs/msg/JournalRecord")]
pub(crate) struct JournalRecord {
    pub(crate) stamp: Time,
    /// Its number in the run.
    pub(crate) id: u64,
    /// The number of the record that it follows from; 0 is none.
    pub(crate) cause: u64,
    pub(crate) component: String,
    /// The loop; empty outside of loops.
    pub(crate) loop_name: String,
    pub(crate) phase: String,
    /// Its name; empty for a change of the knowledge.
    pub(crate) record: String,
    /// The entry of the knowledge that changed; empty for all other records.
    pub(crate) entry: String,
    pub(crate) text: String,
    /// Its values by name, as JSON.
    pub(crate) data: String,
}

/// Who sent the messages of topics that follow in the file, in their order.
#[derive(Clone, Debug, Default, Message)]
#[message(name = "saoms_msgs/msg/Senders")]
pub(crate) struct Senders {
    pub(crate) components: Vec<String>,
    /// Of each message the place of its sender among the components.
    pub(crate) senders: Vec<u32>,
}

impl Log {
    pub(crate) fn new(time: u64, level: Level, component: Option<&str>, text: String) -> Log {
        let level = match level {
            Level::Error => Log::ERROR,
            Level::Warning => Log::WARN,
            Level::Info => Log::INFO,
            Level::Debug => Log::DEBUG,
        };
        let name = component.unwrap_or_default().to_owned();
        Log { stamp: stamp(time), level, name, msg: text, file: String::new(), function: String::new(), line: 0 }
    }
}

impl JournalRecord {
    /// Becomes the record of an entry. The memory of its texts is reused, since most messages of a recording are
    /// records.
    pub(crate) fn set(&mut self, time: u64, entry: &JournalEntry) {
        fn copy(text: &str, to: &mut String) {
            to.clear();
            to.push_str(text);
        }
        self.stamp = stamp(time);
        (self.id, self.cause) = (entry.id().0, entry.cause().0);
        copy(entry.component(), &mut self.component);
        copy(entry.loop_name().unwrap_or_default(), &mut self.loop_name);
        copy(entry.phase().name(), &mut self.phase);
        let (record, changed) = if entry.is_change() { ("", entry.record_id()) } else { (entry.record_id(), "") };
        copy(record, &mut self.record);
        copy(changed, &mut self.entry);
        self.text.clear();
        // A `String` takes everything.
        let _ = write!(self.text, "{}", entry.displayed_text());
        let mut data = std::mem::take(&mut self.data).into_bytes();
        data.clear();
        // Neither memory nor numbers and texts by name are refused.
        let _ = serde_json::to_writer(&mut data, &entry.record_values());
        self.data = String::from_utf8(data).unwrap_or_default();
    }
}

/// Nanoseconds as ROS 2 has them.
fn stamp(nanos: u64) -> Time {
    saoms_api::Time::from_nanos(nanos).into()
}
