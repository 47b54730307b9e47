use core::ffi::c_void;

use crate::{Bytes, Sink, Status};

/// The version of the boundary to transports, which changes when a table, a structure or a rule of it changes.
pub const TRANSPORT_VERSION: u32 = 1;

/// The section of a transport that holds its metadata: one JSON text, which is read before anything in the library
/// runs.
///
/// | member | meaning |
/// | --- | --- |
/// | `saoms` | `"transport"` |
/// | `abi` | the [`TRANSPORT_VERSION`] |
/// | `package`, `version` | those of the library, for people |
/// | `schemes` | the schemes of the urls that it serves, such as `["tcp", "tls"]`; `""` is a url without one, `host:port` |
/// | `carries` | `"topics"`: it is a [`TopicTransportTable`](crate::TopicTransportTable), of networks of programs that do not speak the program's own language; where it is missing, a [`TransportTable`] |
/// | `entry` | the name of its function of type [`TransportEntry`] or [`TopicTransportEntry`](crate::TopicTransportEntry) |
pub const TRANSPORT_SECTION: &str = ".saoms.transport";

/// The function by which a transport gives its table: it takes the version of the program's boundary.
pub type TransportEntry = unsafe extern "C" fn(version: u32) -> *const TransportTable;

/// The functions of a transport: a library that carries messages between programs, as well as it can. It may lose,
/// repeat and reorder them; the program above makes up for that.
///
/// The first argument of each function but `open` is a session. They are called from any thread, several at once, and
/// never after `close`. A key is text of parts between `/`, of printable ASCII characters without `*`, `$`, `#` and
/// `?`; in the keys of a subscription a part `*` is any one part, and `**` at the end any number of parts.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TransportTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The version of the boundary that the library was built with.
    pub version: u32,
    /// The metadata, as in its own section of the library.
    pub metadata: Bytes,
    /// Joins a network, and with `listen` is the place where others join it. `settings` is a JSON text:
    ///
    /// | member | meaning |
    /// | --- | --- |
    /// | `url` | where the network is, as the composite says it |
    /// | `listen` | true: this program is the network's router, and listens at the url |
    /// | `peer` | the name of this program, where the url is `peers://NAME=host:port,NAME=host:port`: it listens at its address, and reaches the others at theirs, without a router; may be missing |
    /// | `user`, `password` | of the user as which the program joins; may be missing |
    /// | `users` | of a listener: the users that it accepts, each with `user` and `password`; where it is missing, everybody is accepted |
    /// | `access` | of a listener: what each `user` may `put` and `subscribe`, lists of keys; where it is missing, everything |
    /// | `tls` | `ca`, `certificate` and `key`: paths of files; each may be missing. A listener with `ca` accepts only programs with a certificate that it vouches for |
    ///
    /// A transport that cannot do what one of these asks for has to refuse it. Passwords are printed nowhere.
    ///
    /// Waits for no longer than a second. `UNREACHABLE`: nobody answers at the url now, and the program tries again.
    /// `FAILED`: it will not help to try again. Both with a text in `error`. A session that was opened connects again
    /// by itself after its link was lost.
    pub open: unsafe extern "C" fn(
        settings: Bytes,
        events: *const TransportEvents,
        session: *mut *mut c_void,
        error: Sink,
    ) -> Status,
    /// Looks at settings, as those of `open`, without joining a network: before anything starts. Puts a JSON text into
    /// `faults`, a list of what cannot be used: objects with `setting` (`url`, `listen`, `user`, `users`, `access`,
    /// `ca`, `certificate` or `key`) and `text`, what is wrong and what to do. Nothing, or an empty list: all can.
    pub judge: unsafe extern "C" fn(settings: Bytes, faults: Sink) -> Status,
    /// Sends a message, with what the program says beside it, to all sessions of the network that subscribe to its
    /// key, but not to this one. Must not wait for another program, nor for room: a millisecond is the most that it
    /// may take for that, as in the transport over Zenoh. `FULL`: too much waits to be sent; the program keeps the
    /// message and tries again. `urgent` is 1 for the few short messages, such as signs of life, that should overtake
    /// others.
    pub put: unsafe extern "C" fn(
        session: *mut c_void,
        key: Bytes,
        message: Bytes,
        attachment: Bytes,
        urgent: u32,
        error: Sink,
    ) -> Status,
    /// Asks for the messages of all keys that fit, which are delivered with this token. No two subscriptions of a
    /// session have the same token.
    pub subscribe: unsafe extern "C" fn(session: *mut c_void, keys: Bytes, token: u64, error: Sink) -> Status,
    /// Ends the subscription with this token.
    pub unsubscribe: unsafe extern "C" fn(session: *mut c_void, token: u64, error: Sink) -> Status,
    /// Sends what waits, for no longer than a second, leaves the network and frees the session. When it returns, no
    /// function of `events` runs or is called again.
    pub close: unsafe extern "C" fn(session: *mut c_void),
}

// SAFETY: what the pointers lead to is constant.
unsafe impl Sync for TransportTable {}

/// The functions of the program that a session calls, from threads of its own. They do not wait for long, and are
/// valid until `close` returns.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TransportEvents {
    /// The size of this table in bytes.
    pub size: usize,
    /// The program's own; the first argument of each function.
    pub state: *mut c_void,
    /// Delivers a message of a subscription. `FULL`: the program cannot take it now. A session whose thread reads one
    /// connection alone reads no more of that, and delivers the message again after a millisecond, until it is taken or
    /// the session is closed: so its senders slow down, and nothing has to be sent again. One whose thread serves other
    /// connections, too, drops it, as that of Zenoh: the program asks for it again.
    pub deliver:
        unsafe extern "C" fn(state: *mut c_void, token: u64, key: Bytes, message: Bytes, attachment: Bytes) -> Status,
    /// Tells that the link to the network was lost (0) or is there again (1), with a reason for people.
    pub link: unsafe extern "C" fn(state: *mut c_void, is_up: u32, reason: Bytes),
}
