//! The transport over Zenoh.
//!
//! A url `host:port` or `tcp/host:port` is TCP, `tls/host:port` is TLS. The program that listens is a router; the
//! others are its clients. A url `peers://NAME=host:port,NAME=host:port`, or `peers+tls://`, names all programs: each
//! listens at its own address, and the later ones connect to those before them. No multicast, no gossip: nothing is
//! heard that the url does not name.

mod causes;
mod certificates;
mod probe;
mod session;
mod settings;

use std::ffi::c_void;
use std::panic::{self, AssertUnwindSafe};
use std::ptr;

use saoms_abi::{Bytes, Sink, Status, TRANSPORT_VERSION, TransportEvents, TransportTable};

use self::session::Session;
use self::settings::Settings;

/// The metadata.
const TEXT: &str = concat!(
    r#"{"saoms":"transport","abi":1,"package":"saoms-zenoh","version":""#,
    env!("CARGO_PKG_VERSION"),
    r#"","schemes":["","tcp","tls","peers","peers+tls"],"entry":"saoms_transport_zenoh"}"#
);

#[used]
#[unsafe(link_section = ".saoms.transport")]
static METADATA: [u8; TEXT.len()] = {
    let mut bytes = [0; TEXT.len()];
    bytes.copy_from_slice(TEXT.as_bytes());
    bytes
};

static TABLE: TransportTable = TransportTable {
    size: size_of::<TransportTable>(),
    version: TRANSPORT_VERSION,
    metadata: Bytes::lend(&METADATA),
    open,
    judge,
    put,
    subscribe,
    unsubscribe,
    close,
};

/// Gives the table of the transport.
#[unsafe(no_mangle)]
pub extern "C" fn saoms_transport_zenoh(_version: u32) -> *const TransportTable {
    &raw const TABLE
}

/// Runs what a function of the boundary does: nothing unwinds out of it.
fn guarded(error: Sink, code: impl FnOnce() -> Result<(), Failure>) -> Status {
    let (status, text) = match panic::catch_unwind(AssertUnwindSafe(code)) {
        Ok(Ok(())) => return Status::OK,
        Ok(Err(Failure { status, text })) => (status, text),
        Err(_) => (Status::PANICKED, "the transport panicked".to_owned()),
    };
    // SAFETY: the program waits for the call that it gave this sink to.
    unsafe { error.put(text.as_bytes()) };
    status
}

/// A failure of a function of the boundary.
struct Failure {
    status: Status,
    text: String,
}

impl Failure {
    fn failed(error: impl ToString) -> Failure {
        Failure { status: Status::FAILED, text: error.to_string() }
    }
}

unsafe extern "C" fn open(
    settings: Bytes,
    events: *const TransportEvents,
    session: *mut *mut c_void,
    error: Sink,
) -> Status {
    guarded(error, || {
        // SAFETY: the program lends the text for the time of the call.
        let text = unsafe { settings.get_text() }.map_err(Failure::failed)?;
        let settings: Settings = serde_json::from_str(text).map_err(Failure::failed)?;
        // SAFETY: the program lends the table for the time of the call; it is copied.
        let events = unsafe { events.as_ref() }.ok_or_else(|| Failure::failed("the events are null"))?;
        let opened = Box::into_raw(Box::new(Session::open(settings, *events)?));
        // SAFETY: the program has a place for the session.
        unsafe { ptr::write(session, opened.cast()) };
        Ok(())
    })
}

unsafe extern "C" fn judge(settings: Bytes, faults: Sink) -> Status {
    guarded(faults, || {
        // SAFETY: the program lends the text for the time of the call.
        let text = unsafe { settings.get_text() }.map_err(Failure::failed)?;
        let settings: Settings = serde_json::from_str(text).map_err(Failure::failed)?;
        let found = settings.unfit().into_iter().chain(certificates::judge(&settings));
        let found: Vec<_> =
            found.map(|(setting, text)| serde_json::json!({"setting": setting, "text": text})).collect();
        // SAFETY: the program waits for the call that it gave this sink to.
        unsafe { faults.put(serde_json::Value::from(found).to_string().as_bytes()) };
        Ok(())
    })
}

/// The session that a function was called with.
///
/// # Safety
/// It is one that `open` made, and was not closed.
unsafe fn session<'a>(session: *mut c_void) -> &'a Session {
    // SAFETY: as the caller promises.
    unsafe { &*session.cast::<Session>() }
}

unsafe extern "C" fn put(
    of: *mut c_void,
    key: Bytes,
    message: Bytes,
    attachment: Bytes,
    urgent: u32,
    error: Sink,
) -> Status {
    // SAFETY: by the rules of the boundary, the session is open and the bytes are lent for the time of the call.
    guarded(error, || unsafe {
        let key = key.get_text().map_err(Failure::failed)?;
        let message = message.get().map_err(Failure::failed)?;
        session(of).put(key, message, attachment.get().map_err(Failure::failed)?, urgent != 0)
    })
}

unsafe extern "C" fn subscribe(of: *mut c_void, keys: Bytes, token: u64, error: Sink) -> Status {
    // SAFETY: as for `put`.
    guarded(error, || unsafe { session(of).subscribe(keys.get_text().map_err(Failure::failed)?, token) })
}

unsafe extern "C" fn unsubscribe(of: *mut c_void, token: u64, error: Sink) -> Status {
    // SAFETY: as for `put`.
    guarded(error, || unsafe { session(of) }.unsubscribe(token))
}

unsafe extern "C" fn close(session: *mut c_void) {
    // SAFETY: by the rules of the boundary, the session was made by `open` and is used by nobody any more.
    let session = unsafe { Box::from_raw(session.cast::<Session>()) };
    // What it says when it panics is on standard error already.
    let _ = panic::catch_unwind(AssertUnwindSafe(|| session.close()));
}
