//! What libraries of plugins can do to the process, told by name: a crash, an end, code that does not return.

mod blame;
mod crash;
mod end;
mod floats;
mod hang;
mod hardware;
#[cfg(target_arch = "x86_64")]
mod jump;
mod limits;
mod own_end;
#[cfg(target_arch = "x86_64")]
mod raised;
#[cfg(target_arch = "x86_64")]
mod real;
mod signals;
mod stray;
mod thread_end;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Once, mpsc};
use std::time::Duration;
use std::{process, ptr, thread};

pub(crate) use hang::waited_for;
pub(crate) use hardware::{STOP_PATIENCE, still_moves};
pub(crate) use own_end::{handles_ends, has_own_end, watch_ends};
use saoms_api::host::present::{self, Function, Owner};
use signals::UseAs;
pub(crate) use signals::{forget as forget_signals, keep as keep_signals};

use crate::Exit;
use crate::output::{eprint, fail, has_failed, has_lost_descriptors, keep_folder, keep_from_libraries, keep_mask};

/// True once the program ends by itself, and not because code of a library ended it.
static ENDS: AtomicBool = AtomicBool::new(false);

static INSTALLED: Once = Once::new();

/// How long the program waits for the ends of its threads with thread-local variables of libraries, and how long while
/// one of their destructors runs.
const THREADS_PATIENCE: (Duration, Duration) = (Duration::from_millis(200), Duration::from_secs(5));

/// How long what libraries printed with the functions of C may take to be written at the end.
const FLUSH_PATIENCE: Duration = Duration::from_millis(200);

/// Watches over code of libraries from now on. Asked before the first is loaded.
pub(crate) fn install() {
    INSTALLED.call_once(|| {
        keep_folder();
        keep_mask();
        floats::keep();
        limits::keep();
        thread_end::prepare();
        #[cfg(target_arch = "x86_64")]
        jump::prepare();
        #[cfg(target_arch = "x86_64")]
        raised::prepare();
        blame::keep_process();
        crash::install();
        end::install();
        stray::install();
        watch_ends();
        signals::keep_for(libc::SIGPIPE, "SIGPIPE", UseAs::Pipe);
        signals::keep_for(libc::SIGCHLD, "SIGCHLD", UseAs::Child);
        present::look_after(look);
        keep_from_libraries();
        hardware::prepare();
        if let Err(error) = hang::watch() {
            eprint(&format!("warning: code that does not return will not be detected: {error}\n"));
        }
    });
}

/// Looks at what code of a library that begins has done to the process.
fn look(owner: &'static Owner, function: Function) {
    let place = format!(" {}", function.place());
    signals::unblock(&owner.text, &place);
    signals::take_back(&owner.text, &place);
    floats::take_back(&owner.text, &place);
    limits::take_back(&owner.text, &place);
    tell_lost_descriptors(&owner.text, &place);
}

/// The libraries whose code runs here, for a text in quotes.
pub(crate) fn libraries() -> String {
    let mut all = String::new();
    blame::for_each_library(|part| all.push_str(part));
    all
}

/// Looks at what code of libraries has done, before the program writes what it was asked for.
pub(crate) fn look_at_end() {
    if INSTALLED.is_completed() {
        look_again();
    }
}

/// Looks at what code of libraries that has run for longer has done.
fn look_again() {
    let who = format!("code of library `{}`", libraries());
    signals::take_back(&who, "");
    limits::take_back(&who, "");
    tell_lost_descriptors(&who, "");
}

fn tell_lost_descriptors(who: &str, place: &str) {
    static TOLD: AtomicBool = AtomicBool::new(false);
    if has_lost_descriptors() && !TOLD.swap(true, Ordering::SeqCst) {
        fail();
        eprint(&format!(
            "error: {who} closed descriptors of the program{place}: files and standard output may be incomplete; it may \
             close only what it opened\n"
        ));
    }
}

/// Says that the program ends by itself.
pub(crate) fn ends_by_itself() {
    ENDS.store(true, Ordering::SeqCst);
}

/// Ends the process. Where there may be libraries, without what they have for its end (`atexit`, destructors of static
/// variables): it could hang, crash, or give another exit code.
pub(crate) fn exit(code: i32) -> ! {
    let mut code = code;
    if INSTALLED.is_completed() {
        if let Some(owner) = thread_end::wait(THREADS_PATIENCE) {
            let place = Function::ThreadEnd.place();
            eprint(&format!("warning: {} has not returned {place}\n", owner.text));
        }
        look_again();
        if code == Exit::Done as i32 && has_failed() {
            code = Exit::Failed as i32;
        }
    }
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
        blame::leave(code)
    }
    process::exit(code)
}
