//! Messages that a recording has beside those of topics.

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
#[derive(Clone, Debug, Message)]
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
    pub(crate) fn new(time: u64, entry: &JournalEntry) -> JournalRecord {
        let is_change = entry.is_change();
        let mut values = entry.values();
        let name = entry.record_id().to_owned();
        let (record, changed) = if is_change {
            values.remove("entry");
            (String::new(), name)
        } else {
            (name, String::new())
        };
        JournalRecord {
            stamp: stamp(time),
            id: entry.id().0,
            cause: entry.cause().0,
            component: entry.component().to_owned(),
            loop_name: entry.loop_name().unwrap_or_default().to_owned(),
            phase: entry.phase().name().to_owned(),
            record,
            entry: changed,
            text: entry.text(),
            data: serde_json::Value::Object(values).to_string(),
        }
    }
}

/// Nanoseconds as ROS 2 has them.
fn stamp(nanos: u64) -> Time {
    saoms_api::Time::from_nanos(nanos).into()
}
