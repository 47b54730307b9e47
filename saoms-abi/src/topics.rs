use core::ffi::c_void;

use crate::{Bytes, Sink, Status, TransportEvents};

/// The function by which a transport of topics gives its table: it takes the version of the program's boundary.
pub type TopicTransportEntry = unsafe extern "C" fn(version: u32) -> *const TopicTransportTable;

/// The functions of a transport of topics: a library that exchanges messages with programs that do not speak the
/// program's own language, such as nodes of ROS 2. It knows topics and the types of their messages, and has the
/// metadata of a transport, whose member `carries` is `"topics"`.
///
/// The first argument of each function but `open` and `judge` is a session. They are called from any thread, several
/// at once, and never after `close`. Messages are CDR, with its header of four bytes. A topic is a JSON text:
///
/// | member | meaning |
/// | --- | --- |
/// | `topic` | its name, of the characters that names of ROS 2 may have, without a `/` in front |
/// | `type` | the type of its messages, as `saoms_msgs/msg/Position` |
/// | `definition` | the type as a text of ROS 2 (`ros2msg`), with the types in it |
/// | `description` | the type description as the JSON text whose SHA-256 is its hash (`RIHS01`) |
/// | `schema` | the type as declarations of messages have it, with the names of ROS 2 |
/// | `state` | true: its newest messages are wanted by late readers, too |
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TopicTransportTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The version of the boundary that the library was built with.
    pub version: u32,
    /// The metadata, as in its own section of the library.
    pub metadata: Bytes,
    /// As [`open`](crate::TransportTable::open) of other transports, with the same settings. `events.deliver` takes the
    /// messages of topics, with the token of the subscription; the key is the name of who sent the message, or empty.
    /// The attachment is empty, or says why what came is no message of the topic: it is counted and told. A session
    /// offers again for what there was no room. `events.link` with 1 and a reason tells what is wrong while the link is
    /// there.
    pub open: unsafe extern "C" fn(
        settings: Bytes,
        events: *const TransportEvents,
        session: *mut *mut c_void,
        error: Sink,
    ) -> Status,
    /// As [`judge`](crate::TransportTable::judge) of other transports.
    pub judge: unsafe extern "C" fn(settings: Bytes, faults: Sink) -> Status,
    /// Says that the program publishes a topic. No two topics of a session, published or subscribed, have the same
    /// token.
    pub advertise: unsafe extern "C" fn(session: *mut c_void, topic: Bytes, token: u64, error: Sink) -> Status,
    /// Publishes a message of the topic that was advertised with this token. `of` is a number: of a state topic the
    /// message takes the place of the one before it with the same number. Called by a thread that does nothing else: it
    /// may wait for as long as the network is congested. `FULL`: there is no link, or too much waits to be sent; the
    /// program keeps the message and tries again.
    pub publish: unsafe extern "C" fn(session: *mut c_void, token: u64, of: u64, message: Bytes, error: Sink) -> Status,
    /// Asks for the messages of a topic, which are delivered with this token.
    pub subscribe: unsafe extern "C" fn(session: *mut c_void, topic: Bytes, token: u64, error: Sink) -> Status,
    /// Sends what waits, for no longer than a second, leaves the network and frees the session. When it returns, no
    /// function of `events` runs or is called again.
    pub close: unsafe extern "C" fn(session: *mut c_void),
}

// SAFETY: what the pointers lead to is constant.
unsafe impl Sync for TopicTransportTable {}
