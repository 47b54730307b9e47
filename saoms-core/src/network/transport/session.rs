use std::ffi::c_void;
use std::fmt;
use std::panic::{self, AssertUnwindSafe};
use std::ptr;
use std::sync::Arc;

use saoms_abi::{Bytes, Sink, Status, TransportEvents, TransportTable};
use serde::{Deserialize, Serialize};

use super::Transport;

/// What a session is opened with.
#[derive(Clone, Debug, Serialize)]
pub struct SessionSettings {
    /// Where the network is.
    pub url: String,
    /// True for its router, which listens there.
    pub listen: bool,
    /// The name of the program, for a network whose url names all its programs, and that has no router.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peer: Option<String>,
    /// The user as which a program joins.
    #[serde(flatten)]
    pub account: Option<Account>,
    /// The users that a router accepts; empty: everybody.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub users: Vec<Account>,
    /// What these may do; empty: everything.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub access: Vec<UserKeys>,
    /// The files of a TLS connection.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tls: Option<TlsFiles>,
}

/// A user, with a password that is shown nowhere.
#[derive(Clone, PartialEq, Eq, Serialize)]
pub struct Account {
    /// The user.
    pub user: String,
    /// The password.
    pub password: String,
}

impl fmt::Debug for Account {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Account").field("user", &self.user).finish_non_exhaustive()
    }
}

/// The keys that a user may use, in which `*` stands for one part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UserKeys {
    /// The user.
    pub user: String,
    /// Those under which the user may send.
    pub put: Vec<String>,
    /// Those whose messages the user may receive.
    pub subscribe: Vec<String>,
}

/// Paths of the files of a TLS connection.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TlsFiles {
    /// Certificates of those who may vouch for others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ca: Option<String>,
    /// The certificate of this program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<String>,
    /// The key of this certificate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
}

/// A message that a transport delivers.
#[derive(Clone, Copy, Debug)]
pub struct Delivered<'a> {
    /// The token of the subscription.
    pub token: u64,
    /// The key.
    pub key: &'a str,
    /// The message.
    pub message: &'a [u8],
    /// What its sender said beside it.
    pub attachment: &'a [u8],
}

/// The receiver of what a session delivers, from threads of the transport.
pub trait Receiver: Send + Sync + 'static {
    /// A message arrived. False: there is no room for it now.
    fn deliver(&self, delivered: Delivered<'_>) -> bool;

    /// The link to the network was lost, or is there again, with a reason for people.
    fn link(&self, is_up: bool, reason: &str);
}

/// The outcome of an attempt to open a session that did not fail for good.
#[derive(Debug)]
pub enum Opened<S = TransportSession> {
    /// The session.
    Session(S),
    /// Nobody answers there now: why.
    Unreachable(String),
}

/// A setting that a transport cannot use.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct SettingFault {
    /// Its member of the settings: `url`, `listen`, `user`, `users`, `access`, `ca`, `certificate` or `key`.
    pub setting: String,
    /// What is wrong with it, and what to do.
    pub text: String,
}

impl Transport {
    /// Looks at settings without joining the network: what cannot be used, and why.
    pub fn judge(self, settings: &SessionSettings) -> Vec<SettingFault> {
        judge(self.table.judge, settings)
    }
}

/// The function of a table that looks at settings.
type Judge = unsafe extern "C" fn(Bytes, Sink) -> Status;

/// What cannot be used of settings, and why.
pub(super) fn judge(judge: Judge, settings: &SessionSettings) -> Vec<SettingFault> {
    let text = serde_json::to_string(settings).unwrap_or_default();
    // SAFETY: the table is of this version, and the text lives until the call returns.
    let (status, faults) = called(|faults| unsafe { judge(Bytes::text(&text), faults) });
    let whole = |text: &str| vec![SettingFault { setting: "url".to_owned(), text: text.to_owned() }];
    match status {
        Status::OK if faults.is_empty() => Vec::new(),
        Status::OK => serde_json::from_str(&faults)
            .unwrap_or_else(|error| whole(&format!("its transport answers what is not JSON: {error}"))),
        _ => whole(&faults),
    }
}

/// The function of a table that opens a session.
type Open = unsafe extern "C" fn(Bytes, *const TransportEvents, *mut *mut c_void, Sink) -> Status;

/// A session of a library. Dropping it closes it.
#[derive(Debug)]
pub(super) struct OpenSession {
    pub(super) session: *mut c_void,
    close: unsafe extern "C" fn(*mut c_void),
    /// What the session calls, until it is closed.
    state: *const EventState,
}

struct EventState {
    receiver: Arc<dyn Receiver>,
}

// SAFETY: by the rules of the boundary a session is used from any thread.
unsafe impl Send for OpenSession {}
// SAFETY: the same; several functions may run at once.
unsafe impl Sync for OpenSession {}

impl OpenSession {
    /// Opens a session by the functions of a table.
    pub(super) fn open(
        (open, close): (Open, unsafe extern "C" fn(*mut c_void)),
        settings: &SessionSettings,
        receiver: Arc<dyn Receiver>,
    ) -> Result<Opened<OpenSession>, String> {
        let text = serde_json::to_string(settings).map_err(|error| error.to_string())?;
        let state: *const EventState = Box::into_raw(Box::new(EventState { receiver }));
        let events =
            TransportEvents { size: size_of::<TransportEvents>(), state: state.cast_mut().cast(), deliver, link };
        let mut session = ptr::null_mut();
        let (status, error) = called(|error| {
            // SAFETY: the table is of this version; all that is lent lives until the call returns, the state until the
            // session is closed.
            unsafe { open(Bytes::text(&text), &raw const events, &raw mut session, error) }
        });
        if status == Status::OK && !session.is_null() {
            return Ok(Opened::Session(OpenSession { session, close, state }));
        }
        // SAFETY: there is no session that would call anything with it.
        drop(unsafe { Box::from_raw(state.cast_mut()) });
        match status {
            Status::UNREACHABLE => Ok(Opened::Unreachable(error)),
            Status::OK => Err("it gave no session".to_owned()),
            _ => Err(error),
        }
    }
}

impl Drop for OpenSession {
    fn drop(&mut self) {
        // SAFETY: nobody else has the session any more. When the call returns, nobody calls anything with the state.
        unsafe {
            (self.close)(self.session);
            drop(Box::from_raw(self.state.cast_mut()));
        }
    }
}

/// A session of a transport. Dropping it closes it.
#[derive(Debug)]
pub struct TransportSession {
    table: &'static TransportTable,
    open: OpenSession,
    is_router: bool,
}

impl TransportSession {
    /// Opens a session.
    ///
    /// # Errors
    /// It will not help to try again: why.
    pub fn open(
        transport: Transport,
        settings: &SessionSettings,
        receiver: Arc<dyn Receiver>,
    ) -> Result<Opened, String> {
        let table = transport.table;
        Ok(match OpenSession::open((table.open, table.close), settings, receiver)? {
            Opened::Session(open) => Opened::Session(TransportSession { table, open, is_router: settings.listen }),
            Opened::Unreachable(why) => Opened::Unreachable(why),
        })
    }

    /// True for the router of its network.
    pub fn is_router(&self) -> bool {
        self.is_router
    }

    /// Sends a message; urgent ones are few and short, and should overtake others. False: there is no room for it now.
    ///
    /// # Errors
    /// The transport cannot send it.
    pub fn put(&self, key: &str, message: &[u8], attachment: &[u8], is_urgent: bool) -> Result<bool, String> {
        let (status, error) = called(|error| {
            let (key, message, attachment) = (Bytes::text(key), Bytes::lend(message), Bytes::lend(attachment));
            // SAFETY: the session is open, and the bytes live until the call returns.
            unsafe { (self.table.put)(self.open.session, key, message, attachment, u32::from(is_urgent), error) }
        });
        match status {
            Status::OK => Ok(true),
            Status::FULL => Ok(false),
            _ => Err(error),
        }
    }

    /// Asks for the messages of keys.
    ///
    /// # Errors
    /// The transport refuses.
    pub fn subscribe(&self, keys: &str, token: u64) -> Result<(), String> {
        // SAFETY: the session is open, and the text lives until the call returns.
        done(called(|error| unsafe { (self.table.subscribe)(self.open.session, Bytes::text(keys), token, error) }))
    }

    /// Ends a subscription.
    ///
    /// # Errors
    /// The transport cannot.
    pub fn unsubscribe(&self, token: u64) -> Result<(), String> {
        // SAFETY: the session is open.
        done(called(|error| unsafe { (self.table.unsubscribe)(self.open.session, token, error) }))
    }
}

/// Calls a function of a transport, and gives what it says with its status.
pub(super) fn called(call: impl FnOnce(Sink) -> Status) -> (Status, String) {
    unsafe extern "C" fn put(state: *mut c_void, bytes: Bytes) {
        // SAFETY: the state is the text below, which lives until the call returns; the callee lends the bytes.
        if let (Some(text), Ok(bytes)) = unsafe { (state.cast::<String>().as_mut(), bytes.get()) } {
            text.push_str(&String::from_utf8_lossy(bytes));
        }
    }
    let mut error = String::new();
    let status = call(Sink { state: (&raw mut error).cast(), put });
    (status, error)
}

pub(super) fn done((status, error): (Status, String)) -> Result<(), String> {
    if status == Status::OK { Ok(()) } else { Err(error) }
}

unsafe extern "C" fn deliver(state: *mut c_void, token: u64, key: Bytes, message: Bytes, attachment: Bytes) -> Status {
    let delivered = || {
        // SAFETY: the state is that of an open session, and the bytes are lent for the time of the call.
        let (state, key, message, attachment) =
            unsafe { (state.cast::<EventState>().as_ref(), key.get_text(), message.get(), attachment.get()) };
        let (Some(state), Ok(key), Ok(message), Ok(attachment)) = (state, key, message, attachment) else {
            return Status::FAILED;
        };
        match state.receiver.deliver(Delivered { token, key, message, attachment }) {
            true => Status::OK,
            false => Status::FULL,
        }
    };
    panic::catch_unwind(AssertUnwindSafe(delivered)).unwrap_or(Status::PANICKED)
}

unsafe extern "C" fn link(state: *mut c_void, is_up: u32, reason: Bytes) {
    let told = || {
        // SAFETY: as for `deliver`.
        if let (Some(state), Ok(reason)) = unsafe { (state.cast::<EventState>().as_ref(), reason.get_text()) } {
            state.receiver.link(is_up != 0, reason);
        }
    };
    // What a receiver says when it panics is on standard error already.
    let _ = panic::catch_unwind(AssertUnwindSafe(told));
}
