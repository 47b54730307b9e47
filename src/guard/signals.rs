//! Signals that the program handles: those that end a run, those of a crash, that of a reader that went away, and that
//! of a command that ended. Code of a library may take them over or block them, as middleware for robots does; nobody
//! could end the run any more, or would hear of a crash.

use std::ffi::c_int;
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::output::eprint;

struct Kept {
    signal: c_int,
    name: &'static str,
    use_as: UseAs,
    action: libc::sigaction,
    is_told: AtomicBool,
}

/// What the program handles a signal for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum UseAs {
    End,
    Crash,
    Pipe,
    /// To hear how commands ended.
    Child,
}

static KEPT: Mutex<Vec<Kept>> = Mutex::new(Vec::new());

/// Keeps these signals handled as they are now: they end the run.
pub(crate) fn keep(signals: &[(c_int, &'static str)]) {
    signals.iter().for_each(|(signal, name)| keep_for(*signal, name, UseAs::End));
}

/// Keeps none any more that ends the run.
pub(crate) fn forget() {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).retain(|kept| kept.use_as != UseAs::End);
}

/// Keeps a signal handled as it is now.
pub(super) fn keep_for(signal: c_int, name: &'static str, use_as: UseAs) {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(action) = action(signal).filter(|_| kept.iter().all(|known| known.signal != signal)) {
        kept.push(Kept { signal, name, use_as, action, is_told: AtomicBool::new(false) });
    }
}

pub(super) fn action(signal: c_int) -> Option<libc::sigaction> {
    let mut action = MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: no new action is given, and the present one is written to where there is room for it.
    let is_known = unsafe { libc::sigaction(signal, ptr::null(), action.as_mut_ptr()) } == 0;
    // SAFETY: the call has written it.
    is_known.then(|| unsafe { action.assume_init() })
}

/// The signals of a crash.
const OF_CRASHES: [c_int; 7] =
    [libc::SIGSEGV, libc::SIGBUS, libc::SIGILL, libc::SIGFPE, libc::SIGABRT, libc::SIGTRAP, libc::SIGSYS];

/// The signals that wait while one is handled: all but those of a crash. The stack for signals has no room for several
/// of them on top of each other.
pub(super) fn waiting() -> libc::sigset_t {
    let mut set = MaybeUninit::<libc::sigset_t>::zeroed();
    // SAFETY: the set is written before it is read.
    unsafe {
        libc::sigfillset(set.as_mut_ptr());
        for signal in OF_CRASHES {
            libc::sigdelset(set.as_mut_ptr(), signal);
        }
        set.assume_init()
    }
}

/// Lets a function handle a signal.
///
/// # Safety
/// The function is one for these flags, and all that it calls is safe in a signal handler.
pub(super) unsafe fn set(signal: c_int, handler: usize, flags: c_int) {
    // SAFETY: all zeros are an action; the rest is as the caller promises.
    unsafe {
        let mut action: libc::sigaction = MaybeUninit::zeroed().assume_init();
        action.sa_sigaction = handler;
        action.sa_flags = flags;
        action.sa_mask = waiting();
        libc::sigaction(signal, &raw const action, ptr::null_mut());
    }
}

/// Does what a signal does by itself, at once, although it is being handled. A signal handler asks.
pub(super) fn default_again(signal: c_int) {
    // SAFETY: all zeros are the default action; the set is written before it is used.
    unsafe {
        let default: libc::sigaction = MaybeUninit::zeroed().assume_init();
        let mut own = MaybeUninit::<libc::sigset_t>::zeroed().assume_init();
        libc::sigemptyset(&raw mut own);
        libc::sigaddset(&raw mut own, signal);
        libc::sigaction(signal, &raw const default, ptr::null_mut());
        libc::raise(signal);
        libc::pthread_sigmask(libc::SIG_UNBLOCK, &raw const own, ptr::null_mut());
    }
}

/// Takes back what code of a library took over, which is told once.
pub(super) fn take_back(who: &str, place: &str) {
    for kept in KEPT.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        let Some(now) = action(kept.signal).filter(|now| now.sa_sigaction != kept.action.sa_sigaction) else {
            continue;
        };
        let is_function = now.sa_sigaction != libc::SIG_DFL && now.sa_sigaction != libc::SIG_IGN;
        let what = match kept.use_as {
            UseAs::End => "it ends the run again",
            // Runtimes of other languages need theirs: those of Go and Java find null pointers so.
            UseAs::Crash if is_function => "a crash may not be reported with the name of the library",
            UseAs::Crash => "crashes are reported with the name of the library again",
            UseAs::Pipe | UseAs::Child if is_function => continue,
            UseAs::Pipe => "it is ignored again",
            UseAs::Child => "the ends of commands are heard again",
        };
        if kept.use_as != UseAs::Crash || !is_function {
            // SAFETY: the action was that of the program before.
            unsafe { libc::sigaction(kept.signal, &raw const kept.action, ptr::null_mut()) };
        }
        if !kept.is_told.swap(true, Ordering::Relaxed) {
            eprint(&format!("warning: {who} took over the signal {}{place}: {what}\n", kept.name));
        }
    }
}

/// Unblocks what code of a library blocked on this thread.
pub(super) fn unblock(who: &str, place: &str) {
    let mut blocked = Vec::new();
    // SAFETY: the sets are written before they are read; no pointer leads elsewhere.
    unsafe {
        let mut now = MaybeUninit::<libc::sigset_t>::zeroed().assume_init();
        let mut back = MaybeUninit::<libc::sigset_t>::zeroed().assume_init();
        libc::pthread_sigmask(libc::SIG_BLOCK, ptr::null(), &raw mut now);
        libc::sigemptyset(&raw mut back);
        for kept in KEPT.lock().unwrap_or_else(PoisonError::into_inner).iter() {
            if matches!(kept.use_as, UseAs::End | UseAs::Crash) && libc::sigismember(&raw const now, kept.signal) == 1 {
                libc::sigaddset(&raw mut back, kept.signal);
                blocked.push(kept.name);
            }
        }
        libc::pthread_sigmask(libc::SIG_UNBLOCK, &raw const back, ptr::null_mut());
    }
    static TOLD: Mutex<Vec<String>> = Mutex::new(Vec::new());
    if blocked.is_empty() {
        return;
    }
    let blocked = blocked.join(", ");
    let line = format!("warning: {who} blocked the signals {blocked}{place}: they are unblocked again\n");
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    // A check constructs each component, and a run once more.
    if !told.contains(&line) {
        eprint(&line);
        told.push(line);
    }
}
