//! A crash in code of a library: one line says in whose, before the system ends the process as it does without it. An
//! end of the process by such code is a failure, whatever it says.

use std::ffi::{c_int, c_void};
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use saoms_api::host::present::{here, is_of_program, library_at};

use super::ENDS;
use crate::Exit;

/// The signals of a crash, with what they mean.
const CRASHES: [(c_int, &str); 7] = [
    (libc::SIGSEGV, "SIGSEGV: it accessed memory that is not its own"),
    (libc::SIGBUS, "SIGBUS: it accessed memory that does not exist"),
    (libc::SIGILL, "SIGILL: it executed an invalid instruction, as `__builtin_trap` does"),
    (libc::SIGFPE, "SIGFPE: a division by zero"),
    (libc::SIGABRT, "SIGABRT: it called `abort`"),
    (libc::SIGTRAP, "SIGTRAP: it executed a breakpoint"),
    (libc::SIGSYS, "SIGSYS: it called the system as it must not"),
];

const OVERFLOW: &str = "SIGSEGV: its stack overflowed";

/// How far from the top of a stack an access may be that overflows it.
const NEAR: usize = 1 << 20;

/// What was done about these signals before: the standard library of Rust tells overflows of its own stacks.
static BEFORE: [OnceLock<libc::sigaction>; CRASHES.len()] = [const { OnceLock::new() }; CRASHES.len()];

pub(super) fn install() {
    for ((signal, _), before) in CRASHES.iter().zip(&BEFORE) {
        let mut old = MaybeUninit::<libc::sigaction>::uninit();
        // SAFETY: all zeros are an action; what is called then is safe in a signal handler.
        unsafe {
            let mut action: libc::sigaction = MaybeUninit::zeroed().assume_init();
            let handler: extern "C" fn(c_int, *mut libc::siginfo_t, *mut c_void) = crashed;
            action.sa_sigaction = handler as *const () as usize;
            // On the stack for signals, which each thread of the program has: the other one may have overflowed.
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            libc::sigemptyset(&raw mut action.sa_mask);
            if libc::sigaction(*signal, ptr::null(), old.as_mut_ptr()) == 0 {
                let _ = before.set(old.assume_init());
                libc::sigaction(*signal, &raw const action, ptr::null_mut());
            }
        }
    }
    // A file that became too large is an error of whoever writes it, also where code of a library made the limit lower.
    // SAFETY: nothing is called for an ignored signal.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
    // SAFETY: the function takes and gives nothing, and may run at the end of the process.
    unsafe { libc::atexit(ended) };
}

/// Tells a crash in code of a library, and leaves it to what was there before.
extern "C" fn crashed(signal: c_int, info: *mut libc::siginfo_t, context: *mut c_void) {
    let Some(place) = CRASHES.iter().position(|(known, _)| *known == signal) else { return };
    let mut meaning = CRASHES[place].1;
    // SAFETY: the system lends what it knows of the signal; all that is called is safe in a signal handler.
    unsafe {
        let is_of_code = (*info).si_code > 0;
        let mut action: libc::sigaction = MaybeUninit::zeroed().assume_init();
        match here() {
            Some((owner, function)) => {
                if signal == libc::SIGSEGV && is_of_code {
                    let distance = stack_pointer(context).map(|top| top.abs_diff((*info).si_addr() as usize));
                    meaning = if distance.is_some_and(|far| far < NEAR) { OVERFLOW } else { meaning };
                }
                write(&["error: ", &owner.text, " crashed in ", function.name(), ": ", meaning, "\n"]);
                action.sa_sigaction = libc::SIG_DFL;
            }
            None => match library_above(stack_pointer(context).unwrap_or_default()) {
                Some(library) => {
                    write(&["error: a thread of library `", library, "` crashed: ", meaning, "\n"]);
                    action.sa_sigaction = libc::SIG_DFL;
                }
                None => action = BEFORE[place].get().copied().unwrap_or(action),
            },
        }
        libc::sigaction(signal, &raw const action, ptr::null_mut());
        // A fault of the code happens again when it goes on; what was sent has to be sent again.
        if !is_of_code {
            libc::raise(signal);
        }
    }
}

/// The library whose code a thread that it made runs, found by the addresses on its stack, from this one on.
fn library_above(top: usize) -> Option<&'static str> {
    // On a thread of the program they may be left from a call that has returned.
    if is_of_program() {
        return None;
    }
    let mut words = [0_usize; 2048];
    let own = libc::iovec { iov_base: words.as_mut_ptr().cast(), iov_len: size_of_val(&words) };
    // Page by page: what lies behind the end of the stack is not copied.
    let page = 4096;
    let mut parts = [libc::iovec { iov_base: ptr::null_mut(), iov_len: 0 }; 5];
    let mut at = top & !(size_of::<usize>() - 1);
    for part in &mut parts {
        *part = libc::iovec { iov_base: at as *mut c_void, iov_len: page - at % page };
        at += part.iov_len;
    }
    // SAFETY: the system copies what can be read into the words, and says how much that was.
    let copied =
        unsafe { libc::process_vm_readv(libc::getpid(), &raw const own, 1, parts.as_ptr(), parts.len() as u64, 0) };
    let count = usize::try_from(copied).unwrap_or_default() / size_of::<usize>();
    words[..count].iter().find_map(|word| library_at(*word))
}

/// The top of the stack at the time of the signal.
///
/// # Safety
/// It is the context that the system gave to a signal handler.
unsafe fn stack_pointer(context: *mut c_void) -> Option<usize> {
    let context = context.cast::<libc::ucontext_t>();
    // SAFETY: as the caller promises.
    unsafe {
        #[cfg(target_arch = "x86_64")]
        return context.as_ref().map(|context| context.uc_mcontext.gregs[libc::REG_RSP as usize] as usize);
        #[cfg(target_arch = "aarch64")]
        return context.as_ref().map(|context| context.uc_mcontext.sp as usize);
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        return context.as_ref().and(None);
    }
}

/// Called at the end of the process: if the program did not end it, code of a library did.
extern "C" fn ended() {
    let top = 0_u8;
    if ENDS.load(Ordering::SeqCst) {
        return;
    }
    match here() {
        Some((owner, function)) => {
            write(&["error: ", &owner.text, " ended the whole process, by `exit` in ", function.name(), "\n"]);
        }
        None => {
            let top = ptr::from_ref(&top) as usize;
            match library_above(top) {
                Some(library) => {
                    write(&["error: a thread of library `", library, "` ended the whole process, by `exit`\n"]);
                }
                None => write(&["error: a thread of a library ended the whole process, by `exit`\n"]),
            }
        }
    }
    // SAFETY: nothing runs after it.
    unsafe { libc::_exit(Exit::Failed as c_int) }
}

/// Writes a line to standard error at once, without a lock or memory.
fn write(parts: &[&str]) {
    let mut line = [0; 1024];
    let mut length = 0;
    for byte in parts.iter().flat_map(|part| part.bytes()).take(line.len()) {
        line[length] = byte;
        length += 1;
    }
    // SAFETY: the line is readable. Where it cannot be written, nobody is left to be told.
    unsafe { libc::write(libc::STDERR_FILENO, line.as_ptr().cast(), length) };
}
