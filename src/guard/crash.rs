//! A crash in code of a library: one line says in whose, before the system ends the process as it does without it.

use std::ffi::{c_int, c_void};
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use saoms_api::host::present::{libraries, library_at};

use super::blame::{Blame, blame, for_each_library, is_program, write};
use super::hardware;
use super::signals::{UseAs, keep_for, waiting};
use super::stray::Origin;

/// The signals of a crash, with what they mean.
const CRASHES: [(c_int, &str); 7] = [
    (libc::SIGSEGV, "SIGSEGV: it accessed memory that is not its own"),
    (libc::SIGBUS, "SIGBUS: it accessed memory that does not exist"),
    (libc::SIGILL, "SIGILL: it executed an invalid instruction, as `__builtin_trap` does"),
    (libc::SIGFPE, "SIGFPE: a division by zero"),
    (libc::SIGABRT, "SIGABRT: it called `abort`, or threw an exception that nobody caught"),
    (libc::SIGTRAP, "SIGTRAP: it executed a breakpoint"),
    (libc::SIGSYS, "SIGSYS: it called the system as it must not"),
];

const OVERFLOW: &str = "SIGSEGV: its stack overflowed";

/// How far from the top of a stack an access may be that overflows it.
const NEAR: usize = 1 << 20;

/// What was done about these signals before: the standard library of Rust tells overflows of its own stacks.
static BEFORE: [OnceLock<libc::sigaction>; CRASHES.len()] = [const { OnceLock::new() }; CRASHES.len()];

pub(super) fn install() {
    for ((signal, meaning), before) in CRASHES.iter().zip(&BEFORE) {
        let mut old = MaybeUninit::<libc::sigaction>::uninit();
        // SAFETY: all zeros are an action; what is called then is safe in a signal handler.
        unsafe {
            let mut action: libc::sigaction = MaybeUninit::zeroed().assume_init();
            let handler: extern "C" fn(c_int, *mut libc::siginfo_t, *mut c_void) = crashed;
            action.sa_sigaction = handler as *const () as usize;
            // On the stack for signals, which each thread of the program has: the other one may have overflowed.
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            action.sa_mask = waiting();
            if libc::sigaction(*signal, ptr::null(), old.as_mut_ptr()) == 0 {
                let _ = before.set(old.assume_init());
                libc::sigaction(*signal, &raw const action, ptr::null_mut());
                let name = meaning.split_once(':').map_or(*meaning, |(name, _)| name);
                keep_for(*signal, name, UseAs::Crash);
            }
        }
    }
    // A file that became too large is an error of whoever writes it, also where code of a library made the limit lower.
    // SAFETY: nothing is called for an ignored signal.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Tells a crash in code of a library, and leaves it to what was there before.
extern "C" fn crashed(signal: c_int, info: *mut libc::siginfo_t, context: *mut c_void) {
    let Some(place) = CRASHES.iter().position(|(known, _)| *known == signal) else { return };
    let mut meaning = CRASHES[place].1;
    // SAFETY: the system lends what it knows of the signal; all that is called is safe in a signal handler.
    unsafe {
        let is_of_code = (*info).si_code > 0;
        let mut action: libc::sigaction = MaybeUninit::zeroed().assume_init();
        let top = registers(context).map(|(top, _)| top);
        match blame(top.unwrap_or_default()) {
            Blame::Call(owner, function) if is_new(ptr::from_ref(owner) as usize ^ function as usize) => {
                if signal == libc::SIGSEGV && is_of_code {
                    let distance = top.map(|top| top.abs_diff((*info).si_addr() as usize));
                    meaning = if distance.is_some_and(|far| far < NEAR) { OVERFLOW } else { meaning };
                }
                write(&["error: ", &owner.text, " crashed ", function.place(), ": ", meaning, "\n"]);
                action.sa_sigaction = libc::SIG_DFL;
            }
            Blame::Thread(library) if is_new(library.as_ptr() as usize) => {
                write(&["error: a thread of library `", library, "` crashed: ", meaning, "\n"]);
                action.sa_sigaction = libc::SIG_DFL;
            }
            Blame::Call(..) | Blame::Thread(_) => action.sa_sigaction = libc::SIG_DFL,
            Blame::Nobody => match registers(context).and_then(|(_, code)| library_at(code)) {
                Some(library) => {
                    write(&["error: code of library `", library, "` crashed: ", meaning, "\n"]);
                    action.sa_sigaction = libc::SIG_DFL;
                }
                None => {
                    if is_of_code || Origin::of(info).is_of_this_process() {
                        tell_of_program(meaning);
                    }
                    action = BEFORE[place].get().copied().unwrap_or(action);
                }
            },
        }
        if is_program() {
            hardware::stop();
            hardware::let_show();
        }
        libc::sigaction(signal, &raw const action, ptr::null_mut());
        // A fault of the code happens again when it goes on; what was sent has to be sent again.
        if !is_of_code {
            libc::raise(signal);
        }
    }
}

/// True if code with this number is not what has crashed first. Those who stop all hardware before the end call the
/// functions for it once more, where one of them crashed.
fn is_new(code: usize) -> bool {
    static FIRST: AtomicUsize = AtomicUsize::new(0);
    FIRST.compare_exchange(0, code, Ordering::SeqCst, Ordering::SeqCst).map_or_else(|first| first != code, |_| true)
}

/// Tells a crash of the program itself, which finds out what code of a library did before: to its memory, or to the
/// limits of the process. Part by part: the stack for signals of a thread of the program has no room for a line.
#[cold]
#[inline(never)]
fn tell_of_program(meaning: &str) {
    if is_program() && libraries().next().is_some() {
        let write = |part: &str| {
            crate::output::write_error(part.as_bytes());
        };
        write("error: the program crashed, maybe since code of library `");
        for_each_library(write);
        ["` damaged or limited its memory: ", meaning, "\n"].into_iter().for_each(write);
    }
}

/// The top of the stack at the time of the signal, and the address of the code that ran.
///
/// # Safety
/// It is the context that the system gave to a signal handler.
unsafe fn registers(context: *mut c_void) -> Option<(usize, usize)> {
    let context = context.cast::<libc::ucontext_t>();
    // SAFETY: as the caller promises.
    unsafe {
        #[cfg(target_arch = "x86_64")]
        return context.as_ref().map(|context| {
            let register = |number: c_int| context.uc_mcontext.gregs[number as usize] as usize;
            (register(libc::REG_RSP), register(libc::REG_RIP))
        });
        #[cfg(target_arch = "aarch64")]
        return context.as_ref().map(|context| (context.uc_mcontext.sp as usize, context.uc_mcontext.pc as usize));
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        return context.as_ref().and(None);
    }
}
