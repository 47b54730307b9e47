//! Signals that code of a library sends or lets a timer send, and that nobody handles: they would end the program
//! without a word. They are told once each and ignored; those from outside end the program as ever.

use std::ffi::{c_int, c_void};
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

use super::blame::{Blame, blame, is_program, write, write_of_libraries};
use super::signals::{action, set};

const STRAYS: [(c_int, &str); 13] = [
    (libc::SIGALRM, "SIGALRM"),
    (libc::SIGUSR1, "SIGUSR1"),
    (libc::SIGUSR2, "SIGUSR2"),
    (libc::SIGVTALRM, "SIGVTALRM"),
    (libc::SIGPROF, "SIGPROF"),
    (libc::SIGIO, "SIGIO"),
    (libc::SIGPWR, "SIGPWR"),
    (libc::SIGSTKFLT, "SIGSTKFLT"),
    (libc::SIGXCPU, "SIGXCPU"),
    (libc::SIGQUIT, "SIGQUIT"),
    (libc::SIGTSTP, "SIGTSTP"),
    (libc::SIGTTIN, "SIGTTIN"),
    (libc::SIGTTOU, "SIGTTOU"),
];

/// Those that the terminal sends, where the system is the sender.
const OF_TERMINAL: [c_int; 4] = [libc::SIGQUIT, libc::SIGTSTP, libc::SIGTTIN, libc::SIGTTOU];

/// What stands for all real-time signals, whose numbers are no constants.
const REAL_TIME: &str = "SIGRTMIN or a later one";

static TOLD: [AtomicBool; STRAYS.len() + 1] = [const { AtomicBool::new(false) }; STRAYS.len() + 1];

pub(super) fn install() {
    for signal in STRAYS.into_iter().map(|(signal, _)| signal).chain(libc::SIGRTMIN()..=libc::SIGRTMAX()) {
        if action(signal).is_some_and(|now| now.sa_sigaction == libc::SIG_DFL) {
            let handler: extern "C" fn(c_int, *mut libc::siginfo_t, *mut c_void) = strayed;
            // SAFETY: what the handler calls is safe in a signal handler.
            unsafe {
                set(signal, handler as *const () as usize, libc::SA_SIGINFO | libc::SA_ONSTACK | libc::SA_RESTART)
            };
        }
    }
}

extern "C" fn strayed(signal: c_int, info: *mut libc::siginfo_t, _: *mut c_void) {
    let top = 0_u8;
    let place = STRAYS.iter().position(|(known, _)| *known == signal).unwrap_or(STRAYS.len());
    // SAFETY: the system lends what it knows of the signal; of one that a process sent, that is which.
    let (code, sender) = unsafe { ((*info).si_code, (*info).si_pid()) };
    let is_sent = [libc::SI_USER, libc::SI_TKILL, libc::SI_QUEUE].contains(&code);
    // SAFETY: the calls take no pointers but one to an action that is whole.
    unsafe {
        let is_of_terminal = code == libc::SI_KERNEL && OF_TERMINAL.contains(&signal);
        if !is_program() || is_sent && sender != libc::getpid() || is_of_terminal {
            let default: libc::sigaction = MaybeUninit::zeroed().assume_init();
            libc::sigaction(signal, &raw const default, ptr::null_mut());
            libc::raise(signal);
            return;
        }
    }
    if TOLD[place].swap(true, Ordering::SeqCst) {
        return;
    }
    let name = STRAYS.get(place).map_or(REAL_TIME, |(_, name)| name);
    // Only one that a thread sends to itself or to another thread comes to a certain thread.
    let blamed = if code == libc::SI_TKILL { blame(ptr::from_ref(&top) as usize) } else { Blame::Nobody };
    match blamed {
        Blame::Call(owner, function) => {
            let place = function.place();
            write(&["warning: ", &owner.text, " sent the signal ", name, " ", place, ": it was ignored\n"]);
        }
        Blame::Thread(library) => {
            write(&["warning: a thread of library `", library, "` sent the signal ", name, ": it was ignored\n"]);
        }
        Blame::Nobody => {
            let how = if is_sent { "sent the signal " } else { "let a timer or a limit send the signal " };
            write_of_libraries("warning: ", &[how, name, ": it was ignored\n"]);
        }
    }
}
