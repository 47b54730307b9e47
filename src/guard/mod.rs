//! What libraries of plugins can do to the process, told by name: a crash, an end, code that does not return.

mod crash;
mod hang;

mod signals;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Once, mpsc};
use std::time::Duration;
use std::{process, ptr, thread};

pub(crate) use hang::waited_for;
pub(crate) use signals::keep as keep_signals;

use crate::output::{eprint, keep_folder, keep_from_libraries};

/// True once the program ends by itself, and not because code of a library ended it.
static ENDS: AtomicBool = AtomicBool::new(false);

static INSTALLED: Once = Once::new();

/// How long what libraries printed with the functions of C may take to be written at the end.
const FLUSH_PATIENCE: Duration = Duration::from_millis(200);

/// Watches over code of libraries from now on. Asked before the first is loaded.
pub(crate) fn install() {
    INSTALLED.call_once(|| {
        keep_folder();
        crash::install();
        keep_from_libraries();
        if let Err(error) = hang::watch() {
            eprint(&format!("warning: nobody watches for code that does not return: {error}\n"));
        }
    });
}

/// Says that the program ends by itself.
pub(crate) fn ends_by_itself() {
    ENDS.store(true, Ordering::SeqCst);
}

/// Ends the process. Where there may be libraries, without what they have for its end (`atexit`, destructors of static
/// variables): it could hang, crash, or give another exit code.
pub(crate) fn exit(code: i32) -> ! {
    ends_by_itself();
    if INSTALLED.is_completed() {
        let (flushed, all) = mpsc::channel();
        let flush = move || {
            // SAFETY: null stands for all streams.
            unsafe { libc::fflush(ptr::null_mut()) };
            let _ = flushed.send(());
        };
        // On a thread of its own: a thread of a library may hold a stream for ever.
        if thread::Builder::new().spawn(flush).is_ok() {
            let _ = all.recv_timeout(FLUSH_PATIENCE);
        }
        // SAFETY: nothing runs after it.
        unsafe { libc::_exit(code) }
    }
    process::exit(code)
}
