//! The boundary of a transport of topics.

use std::ffi::c_void;
use std::ptr;
use std::sync::{PoisonError, RwLock};
use std::thread;
use std::time::Duration;

use saoms_abi::{Bytes, Sink, Status, TransportEvents};
use serde::Deserialize;
use serde_json::Value;

use crate::Failure;
use crate::boundary::{guarded, session};

/// Pause before a message is offered again for which the program had no room.
const ROOM_AGAIN: Duration = Duration::from_millis(1);

/// A transport of topics in Rust, which [`topic_transport!`](crate::topic_transport) puts behind the boundary. A value
/// is a session.
pub trait TopicTransport: Sized + Send + Sync {
    /// Opens a session with settings in JSON, as the boundary has them.
    ///
    /// # Errors
    /// It cannot join the network.
    fn open(settings: &str, program: Program) -> Result<Self, Failure>;

    /// Looks at settings before anything starts: the setting and what is wrong with it.
    ///
    /// # Errors
    /// They cannot be read.
    fn judge(settings: &str) -> Result<Vec<(&'static str, String)>, Failure>;

    /// Says that the program publishes a topic.
    ///
    /// # Errors
    /// It cannot be published.
    fn advertise(&self, topic: Topic, token: u64) -> Result<(), Failure>;

    /// Publishes a message; of a state topic in place of the one before it with the same number.
    ///
    /// # Errors
    /// It cannot be published, now or at all.
    fn publish(&self, token: u64, of: u64, message: &[u8]) -> Result<(), Failure>;

    /// Asks for the messages of a topic.
    ///
    /// # Errors
    /// They cannot be had.
    fn subscribe(&self, topic: Topic, token: u64) -> Result<(), Failure>;

    /// Leaves the network. From then on no function of the program is called.
    fn close(self);
}

/// A topic as the program knows it; its names are as ROS 2 has them.
#[derive(Clone, Debug, Deserialize)]
pub struct Topic {
    /// Its name, without a `/` in front.
    #[serde(rename = "topic")]
    pub name: String,
    /// The type of its messages.
    #[serde(rename = "type")]
    pub kind: String,
    /// The type as a text (`ros2msg`).
    pub definition: String,
    /// The type description whose SHA-256 is the hash of the type.
    pub description: String,
    /// The schema of its messages.
    pub schema: Value,
    /// True where late readers want its newest messages, too.
    pub state: bool,
}

/// The program, which hears what comes over a session until it [leaves](Program::leave).
pub struct Program(RwLock<Option<TransportEvents>>);

// SAFETY: by the rules of the boundary, the functions may be called from any thread with the state that comes with
// them.
unsafe impl Send for Program {}
// SAFETY: the same.
unsafe impl Sync for Program {}

impl Program {
    /// Delivers a message of a subscription, and waits until the program has room for it. `who` is the name of its
    /// sender, where one is known.
    pub fn deliver(&self, token: u64, who: &str, message: &[u8]) {
        while !self.offer(token, who, message, "") {
            thread::sleep(ROOM_AGAIN);
        }
    }

    /// Tells of a message that is none of its topic: why.
    pub fn refuse(&self, token: u64, who: &str, why: &str) {
        while !self.offer(token, who, &[], why) {
            thread::sleep(ROOM_AGAIN);
        }
    }

    /// Offers a message. One that has left takes everything.
    fn offer(&self, token: u64, who: &str, message: &[u8], fault: &str) -> bool {
        let events = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let Some(events) = *events else { return true };
        let (key, message, attachment) = (Bytes::text(who), Bytes::lend(message), Bytes::text(fault));
        // SAFETY: the session is open, so that the state is valid; the bytes live until the call returns.
        unsafe { (events.deliver)(events.state, token, key, message, attachment) != Status::FULL }
    }

    /// Tells that the link was lost, or is there, with a reason for people.
    pub fn link(&self, is_up: bool, reason: &str) {
        let events = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let Some(events) = *events else { return };
        // SAFETY: the session is open, so that the state is valid; the text lives until the call returns.
        unsafe { (events.link)(events.state, u32::from(is_up), Bytes::text(reason)) };
    }

    /// From here on no function of the program is called: a call that runs is waited for.
    pub fn leave(&self) {
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

/// Makes a library of a [`TopicTransport`]: its metadata, its table, and its entry.
#[macro_export]
macro_rules! topic_transport {
    ($transport:ty, $entry:ident, schemes: $schemes:literal) => {
        $crate::metadata!($entry, schemes: $schemes, carries: r#","carries":"topics""#);

        static TABLE: $crate::TopicTransportTable = $crate::TopicTransportTable {
            size: size_of::<$crate::TopicTransportTable>(),
            version: $crate::TRANSPORT_VERSION,
            metadata: $crate::Bytes::lend(&METADATA),
            open: $crate::topics::open::<$transport>,
            judge: $crate::topics::judge::<$transport>,
            advertise: $crate::topics::advertise::<$transport>,
            publish: $crate::topics::publish::<$transport>,
            subscribe: $crate::topics::subscribe::<$transport>,
            close: $crate::topics::close::<$transport>,
        };

        /// Gives the table of the transport.
        #[unsafe(no_mangle)]
        pub extern "C" fn $entry(_version: u32) -> *const $crate::TopicTransportTable {
            &raw const TABLE
        }
    };
}

/// The function `open` of a table.
///
/// # Safety
/// It is called by the rules of [`TopicTransportTable`](saoms_abi::TopicTransportTable), as all functions of a table.
pub unsafe extern "C" fn open<T: TopicTransport>(
    settings: Bytes,
    events: *const TransportEvents,
    session: *mut *mut c_void,
    error: Sink,
) -> Status {
    guarded(error, || {
        // SAFETY: the program lends the text for the time of the call.
        let settings = unsafe { settings.get_text() }.map_err(Failure::failed)?;
        // SAFETY: the program lends the table for the time of the call; it is copied.
        let events = unsafe { events.as_ref() }.ok_or_else(|| Failure::failed("the events are null"))?;
        let program = Program(RwLock::new(Some(*events)));
        let opened = Box::into_raw(Box::new(T::open(settings, program)?));
        // SAFETY: the program has a place for the session.
        unsafe { ptr::write(session, opened.cast()) };
        Ok(())
    })
}

/// The function `judge` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn judge<T: TopicTransport>(settings: Bytes, faults: Sink) -> Status {
    // SAFETY: as the caller promises.
    unsafe { crate::boundary::judged(settings, faults, T::judge) }
}

/// The function `advertise` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn advertise<T: TopicTransport>(
    of: *mut c_void,
    topic: Bytes,
    token: u64,
    error: Sink,
) -> Status {
    // SAFETY: by the rules of the boundary, the session is open and the text is lent for the time of the call.
    guarded(error, || unsafe { session::<T>(of).advertise(read(topic)?, token) })
}

/// The function `publish` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn publish<T: TopicTransport>(
    session_of: *mut c_void,
    token: u64,
    of: u64,
    message: Bytes,
    error: Sink,
) -> Status {
    // SAFETY: as for `advertise`.
    guarded(error, || unsafe { session::<T>(session_of).publish(token, of, message.get().map_err(Failure::failed)?) })
}

/// The function `subscribe` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn subscribe<T: TopicTransport>(
    of: *mut c_void,
    topic: Bytes,
    token: u64,
    error: Sink,
) -> Status {
    // SAFETY: as for `advertise`.
    guarded(error, || unsafe { session::<T>(of).subscribe(read(topic)?, token) })
}

/// The function `close` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn close<T: TopicTransport>(session: *mut c_void) {
    // SAFETY: as the caller promises.
    unsafe { crate::boundary::closed(session, T::close) };
}

/// A topic in JSON.
///
/// # Safety
/// The text is lent.
unsafe fn read(topic: Bytes) -> Result<Topic, Failure> {
    // SAFETY: as the caller promises.
    let text = unsafe { topic.get_text() }.map_err(Failure::failed)?;
    serde_json::from_str(text).map_err(Failure::failed)
}
