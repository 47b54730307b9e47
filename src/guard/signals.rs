//! The signals that end a run: code of a library may take them over, as middleware for robots does, and nobody could
//! end the run any more.

use std::ffi::c_int;
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::output::eprint;

struct Kept {
    signal: c_int,
    name: &'static str,
    action: libc::sigaction,
    is_told: AtomicBool,
}

static KEPT: OnceLock<Vec<Kept>> = OnceLock::new();

/// Keeps these signals handled as they are now.
pub(crate) fn keep(signals: &[(c_int, &'static str)]) {
    let kept = |&(signal, name): &(c_int, &'static str)| {
        Some(Kept { signal, name, action: action(signal)?, is_told: AtomicBool::new(false) })
    };
    KEPT.get_or_init(|| signals.iter().filter_map(kept).collect());
}

fn action(signal: c_int) -> Option<libc::sigaction> {
    let mut action = MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: no new action is given, and the present one is written to where there is room for it.
    let is_known = unsafe { libc::sigaction(signal, ptr::null(), action.as_mut_ptr()) } == 0;
    // SAFETY: the call has written it.
    is_known.then(|| unsafe { action.assume_init() })
}

/// Takes back what libraries took over, which is told once.
pub(super) fn take_back() {
    for kept in KEPT.get().into_iter().flatten() {
        if action(kept.signal).is_none_or(|now| now.sa_sigaction == kept.action.sa_sigaction) {
            continue;
        }
        // SAFETY: the action was that of the program before.
        unsafe { libc::sigaction(kept.signal, &raw const kept.action, ptr::null_mut()) };
        if !kept.is_told.swap(true, Ordering::Relaxed) {
            let name = kept.name;
            eprint(&format!("warning: code of a library took over the signal {name}: it ends the run again\n"));
        }
    }
}
