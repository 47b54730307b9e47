//! Signals that code of a library sends or lets a timer send, and that nobody handles: they would end the program
//! without a word. They are told once each and ignored; those from outside end the program as ever.

use std::ffi::{c_int, c_void};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

use super::blame::{Blame, blame, is_program, write, write_of_libraries};
use super::signals::{action, default_again, set};

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
    // SAFETY: the system lends what it knows of the signal.
    let origin = unsafe { Origin::of(info) };
    let is_of_terminal = origin.code == libc::SI_KERNEL && OF_TERMINAL.contains(&signal);
    if !is_program() || origin.is_of_another_process() || is_of_terminal {
        return default_again(signal);
    }
    if TOLD[place].swap(true, Ordering::SeqCst) {
        return;
    }
    let name = STRAYS.get(place).map_or(REAL_TIME, |(_, name)| name);
    origin.tell(ptr::from_ref(&top) as usize, "warning: ", name, ": it was ignored\n");
}

/// Who sent a signal.
pub(super) struct Origin {
    code: c_int,
    /// The process, if one did.
    sender: Option<c_int>,
}

impl Origin {
    /// The origin of a signal.
    ///
    /// # Safety
    /// It is what the system gave to a signal handler.
    pub(super) unsafe fn of(info: *const libc::siginfo_t) -> Origin {
        // SAFETY: as the caller promises; of a signal that a process sent, the system knows which.
        let (code, sender) = unsafe { ((*info).si_code, (*info).si_pid()) };
        let is_sent = [libc::SI_USER, libc::SI_TKILL, libc::SI_QUEUE].contains(&code);
        Origin { code, sender: is_sent.then_some(sender) }
    }

    fn is_of_another_process(&self) -> bool {
        // SAFETY: the call takes no pointers and never fails.
        self.sender.is_some_and(|sender| sender != unsafe { libc::getpid() })
    }

    /// True if this process sent it, or lets a timer send it.
    pub(super) fn is_of_this_process(&self) -> bool {
        self.sender.is_some() && !self.is_of_another_process() || self.code == libc::SI_TIMER
    }

    /// Tells which code sent it to this process, and what comes of it. The top of the present stack is there.
    pub(super) fn tell(&self, top: usize, before: &str, name: &str, after: &str) {
        // Only one that a thread sends to itself or to another thread comes to a certain thread.
        let blamed = if self.code == libc::SI_TKILL { blame(top) } else { Blame::Nobody };
        match blamed {
            Blame::Call(owner, function) => {
                write(&[before, &owner.text, " sent the signal ", name, " ", function.place(), after]);
            }
            Blame::Thread(library) => {
                write(&[before, "a thread of library `", library, "` sent the signal ", name, after]);
            }
            Blame::Nobody => {
                let is_sent = self.sender.is_some();
                let how = if is_sent { "sent the signal " } else { "let a timer or a limit send the signal " };
                write_of_libraries(before, &[how, name, after]);
            }
        }
    }
}
