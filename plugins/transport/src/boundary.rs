//! The boundary to the program.

use std::ffi::c_void;
use std::panic::{self, AssertUnwindSafe};
use std::ptr;

use saoms_abi::{Bytes, Sink, Status, TransportEvents};

/// A transport in Rust, which [`transport!`](crate::transport) puts behind the boundary. A value is a session.
pub trait Transport: Sized + Send + Sync {
    /// Opens a session with settings in JSON, as the boundary has them.
    ///
    /// # Errors
    /// It cannot join the network.
    fn open(settings: &str, events: TransportEvents) -> Result<Self, Failure>;

    /// Looks at settings before anything starts: the setting and what is wrong with it.
    ///
    /// # Errors
    /// They cannot be read.
    fn judge(settings: &str) -> Result<Vec<(&'static str, String)>, Failure>;

    /// Sends a message.
    ///
    /// # Errors
    /// It cannot be sent, now or at all.
    fn put(&self, key: &str, message: &[u8], attachment: &[u8], is_urgent: bool) -> Result<(), Failure>;

    /// Asks for the messages of keys.
    ///
    /// # Errors
    /// They cannot be had.
    fn subscribe(&self, keys: &str, token: u64) -> Result<(), Failure>;

    /// Ends a subscription.
    ///
    /// # Errors
    /// It cannot be ended.
    fn unsubscribe(&self, token: u64) -> Result<(), Failure>;

    /// Leaves the network. From then on no function of the program is called.
    fn close(self);
}

/// A failure of a function of the boundary.
#[derive(Clone, Debug)]
pub struct Failure {
    /// What it means to the program.
    pub status: Status,
    /// A text for people.
    pub text: String,
}

impl Failure {
    /// A failure that does not pass if it is tried again.
    pub fn failed(error: impl ToString) -> Failure {
        Failure { status: Status::FAILED, text: error.to_string() }
    }

    /// Nobody answers now.
    pub fn unreachable(error: impl ToString) -> Failure {
        Failure { status: Status::UNREACHABLE, text: error.to_string() }
    }

    /// There is no room now.
    pub fn full() -> Failure {
        Failure { status: Status::FULL, text: String::new() }
    }
}

/// Makes a library of a [`Transport`]: its metadata, its table, and its entry.
#[macro_export]
macro_rules! transport {
    ($transport:ty, $entry:ident, schemes: $schemes:literal) => {
        $crate::metadata!($entry, schemes: $schemes, carries: "");

        static TABLE: $crate::TransportTable = $crate::TransportTable {
            size: size_of::<$crate::TransportTable>(),
            version: $crate::TRANSPORT_VERSION,
            metadata: $crate::Bytes::lend(&METADATA),
            open: $crate::open::<$transport>,
            judge: $crate::judge::<$transport>,
            put: $crate::put::<$transport>,
            subscribe: $crate::subscribe::<$transport>,
            unsubscribe: $crate::unsubscribe::<$transport>,
            close: $crate::close::<$transport>,
        };

        /// Gives the table of the transport.
        #[unsafe(no_mangle)]
        pub extern "C" fn $entry(_version: u32) -> *const $crate::TransportTable {
            &raw const TABLE
        }
    };
}

/// The metadata of a library, in their section.
#[doc(hidden)]
#[macro_export]
macro_rules! metadata {
    ($entry:ident, schemes: $schemes:literal, carries: $carries:literal) => {
        /// The metadata.
        const TEXT: &str = concat!(
            r#"{"saoms":"transport","abi":1,"package":""#,
            env!("CARGO_PKG_NAME"),
            r#"","version":""#,
            env!("CARGO_PKG_VERSION"),
            r#"","schemes":"#,
            $schemes,
            $carries,
            r#","entry":""#,
            stringify!($entry),
            r#""}"#
        );

        #[used]
        #[unsafe(link_section = ".saoms.transport")]
        static METADATA: [u8; TEXT.len()] = {
            let mut bytes = [0; TEXT.len()];
            bytes.copy_from_slice(TEXT.as_bytes());
            bytes
        };
    };
}

/// Runs what a function of the boundary does: nothing unwinds out of it.
pub(crate) fn guarded(error: Sink, code: impl FnOnce() -> Result<(), Failure>) -> Status {
    let (status, text) = match panic::catch_unwind(AssertUnwindSafe(code)) {
        Ok(Ok(())) => return Status::OK,
        Ok(Err(Failure { status, text })) => (status, text),
        Err(_) => (Status::PANICKED, "the transport panicked".to_owned()),
    };
    // SAFETY: the program waits for the call that it gave this sink to.
    unsafe { error.put(text.as_bytes()) };
    status
}

/// The session that a function was called with.
///
/// # Safety
/// It is one that `open` made, and was not closed.
pub(crate) unsafe fn session<'a, T>(session: *mut c_void) -> &'a T {
    // SAFETY: as the caller promises.
    unsafe { &*session.cast::<T>() }
}

/// The function `open` of a table.
///
/// # Safety
/// It is called by the rules of [`TransportTable`](saoms_abi::TransportTable), as all functions of a table.
pub unsafe extern "C" fn open<T: Transport>(
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
        let opened = Box::into_raw(Box::new(T::open(settings, *events)?));
        // SAFETY: the program has a place for the session.
        unsafe { ptr::write(session, opened.cast()) };
        Ok(())
    })
}

/// The function `judge` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn judge<T: Transport>(settings: Bytes, faults: Sink) -> Status {
    // SAFETY: as the caller promises.
    unsafe { judged(settings, faults, T::judge) }
}

/// Looks at settings, and puts what cannot be used into a sink.
///
/// # Safety
/// The text is lent, and the sink is that of the call.
pub(crate) unsafe fn judged(
    settings: Bytes,
    faults: Sink,
    judge: impl FnOnce(&str) -> Result<Vec<(&'static str, String)>, Failure>,
) -> Status {
    guarded(faults, || {
        // SAFETY: as the caller promises.
        let found = judge(unsafe { settings.get_text() }.map_err(Failure::failed)?)?;
        let found = found.into_iter().map(|(setting, text)| serde_json::json!({"setting": setting, "text": text}));
        let found: serde_json::Value = found.collect::<Vec<_>>().into();
        // SAFETY: the program waits for the call that it gave this sink to.
        unsafe { faults.put(found.to_string().as_bytes()) };
        Ok(())
    })
}

/// The function `put` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn put<T: Transport>(
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
        session::<T>(of).put(key, message, attachment.get().map_err(Failure::failed)?, urgent != 0)
    })
}

/// The function `subscribe` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn subscribe<T: Transport>(of: *mut c_void, keys: Bytes, token: u64, error: Sink) -> Status {
    // SAFETY: as for `put`.
    guarded(error, || unsafe { session::<T>(of).subscribe(keys.get_text().map_err(Failure::failed)?, token) })
}

/// The function `unsubscribe` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn unsubscribe<T: Transport>(of: *mut c_void, token: u64, error: Sink) -> Status {
    // SAFETY: as for `put`.
    guarded(error, || unsafe { session::<T>(of) }.unsubscribe(token))
}

/// The function `close` of a table.
///
/// # Safety
/// As for [`open`].
pub unsafe extern "C" fn close<T: Transport>(session: *mut c_void) {
    // SAFETY: as the caller promises.
    unsafe { closed(session, T::close) };
}

/// Closes a session.
///
/// # Safety
/// As for [`open`].
pub(crate) unsafe fn closed<T>(session: *mut c_void, close: impl FnOnce(T)) {
    // SAFETY: by the rules of the boundary, the session was made by `open` and is used by nobody any more.
    let session = unsafe { Box::from_raw(session.cast::<T>()) };
    // What it says when it panics is on standard error already.
    let _ = panic::catch_unwind(AssertUnwindSafe(|| close(*session)));
}
