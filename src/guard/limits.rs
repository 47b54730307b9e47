//! Limits of the process that code of a library lowers: the program could neither write what it was asked for nor get
//! memory, and would blame nobody.

use std::mem::MaybeUninit;
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::output::eprint;

const LIMITS: [(libc::__rlimit_resource_t, &str); 7] = [
    (libc::RLIMIT_AS, "RLIMIT_AS"),
    (libc::RLIMIT_DATA, "RLIMIT_DATA"),
    (libc::RLIMIT_STACK, "RLIMIT_STACK"),
    (libc::RLIMIT_NOFILE, "RLIMIT_NOFILE"),
    (libc::RLIMIT_NPROC, "RLIMIT_NPROC"),
    (libc::RLIMIT_FSIZE, "RLIMIT_FSIZE"),
    (libc::RLIMIT_CPU, "RLIMIT_CPU"),
];

/// Those of the program.
static KEPT: OnceLock<[Option<libc::rlimit>; LIMITS.len()]> = OnceLock::new();

fn present(resource: libc::__rlimit_resource_t) -> Option<libc::rlimit> {
    let mut limit = MaybeUninit::<libc::rlimit>::uninit();
    // SAFETY: the limit is written to where there is room for it.
    let is_known = unsafe { libc::getrlimit(resource, limit.as_mut_ptr()) } == 0;
    // SAFETY: the call has written it.
    is_known.then(|| unsafe { limit.assume_init() })
}

/// Keeps the limits as those of the program.
pub(super) fn keep() {
    KEPT.get_or_init(|| LIMITS.map(|(resource, _)| present(resource)));
}

/// Raises again what code of a library lowered, which is told once.
pub(super) fn take_back(who: &str, place: &str) {
    static TOLD: Mutex<Vec<&str>> = Mutex::new(Vec::new());
    let Some(all) = KEPT.get() else { return };
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut raised, mut lost) = (Vec::new(), Vec::new());
    for ((resource, name), kept) in LIMITS.iter().zip(all) {
        let Some((kept, now)) = kept.zip(present(*resource)).filter(|(kept, now)| now.rlim_cur < kept.rlim_cur) else {
            continue;
        };
        // Without privileges, the upper one stays where it is.
        let within = libc::rlimit { rlim_cur: kept.rlim_cur.min(now.rlim_max), rlim_max: now.rlim_max };
        // SAFETY: both are limits of the system.
        let is_raised = unsafe {
            libc::setrlimit(*resource, &raw const kept) == 0
                || libc::setrlimit(*resource, &raw const within) == 0 && within.rlim_cur == kept.rlim_cur
        };
        if !told.contains(name) {
            told.push(name);
            if is_raised { raised.push(*name) } else { lost.push(*name) }
        }
    }
    let is = if raised.len() == 1 { "it is" } else { "they are" };
    let lost_too = "the program cannot raise it again, and may fail".to_owned();
    for (names, then) in [(raised, format!("{is} raised again")), (lost, lost_too)] {
        if !names.is_empty() {
            eprint(&format!("warning: {who} lowered {} of the process{place}: {then}\n", names.join(", ")));
        }
    }
}
