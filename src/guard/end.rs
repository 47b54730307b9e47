//! The end of the process, or of a thread of the program, by code of a library: a failure, whatever exit code it gives.
//!
//! `exit`, `_exit`, `_Exit`, `quick_exit`, `daemon`, `pthread_exit` and `pthread_cancel` are defined here, where the
//! linker finds them before those of the system when it binds a library. What calls the system itself (`exit_group`)
//! cannot be seen.

use std::ffi::{c_int, c_void};
use std::mem::transmute;
use std::ptr;
use std::sync::atomic::Ordering;

use saoms_api::host::present;

use super::ENDS;
use super::blame::{Blame, blame, is_program, leave, library_above, next, write};
use super::hardware;
use crate::Exit;

pub(super) fn install() {
    // SAFETY: the functions take and give nothing, and may run at the end of the process and after `fork`.
    unsafe {
        libc::atexit(exited);
        libc::pthread_atfork(None, None, Some(forked));
    }
}

/// Ends the process, and says whose code did so by which function, unless it is the program itself or a child.
fn end(code: c_int, by: &str) -> ! {
    if ENDS.load(Ordering::SeqCst) || !is_program() {
        leave(code);
    }
    end_after(" ended the whole process, by `", by, "")
}

/// Ends the process after what code of a library did by a function, and says whose it is.
pub(super) fn end_after(did: &str, by: &str, why: &str) -> ! {
    let top = 0_u8;
    let top = ptr::from_ref(&top) as usize;
    match blame(top) {
        Blame::Call(owner, function) => {
            write(&["error: ", &owner.text, did, by, "` ", function.place(), why, "\n"]);
        }
        Blame::Thread(library) => write(&["error: a thread of library `", library, "`", did, by, "`", why, "\n"]),
        // Code that a thread of the program calls by itself, such as the destructor of a key.
        Blame::Nobody => match library_above(top) {
            Some(library) => write(&["error: code of library `", library, "`", did, by, "`", why, "\n"]),
            None => write(&["error: code of a library", did, by, "`", why, "\n"]),
        },
    }
    hardware::stop();
    hardware::let_show();
    leave(Exit::Failed as c_int)
}

/// Called at the end of the process by `exit`, which a child of `fork` may call.
extern "C" fn exited() {
    if !ENDS.load(Ordering::SeqCst) && is_program() {
        end(Exit::Failed as c_int, "exit");
    }
}

/// Ends the process before what libraries have for its end runs, which could undo what stops hardware.
#[unsafe(no_mangle)]
extern "C" fn exit(code: c_int) -> ! {
    if !ENDS.load(Ordering::SeqCst) && is_program() {
        end(code, "exit");
    }
    let next = next(c"exit");
    if next.is_null() {
        leave(code);
    }
    // SAFETY: the system's function of this name has this type.
    unsafe { transmute::<*mut c_void, extern "C" fn(c_int) -> !>(next)(code) }
}

#[unsafe(no_mangle)]
extern "C" fn _exit(code: c_int) -> ! {
    end(code, "_exit")
}

#[unsafe(no_mangle)]
extern "C" fn _Exit(code: c_int) -> ! {
    end(code, "_Exit")
}

#[unsafe(no_mangle)]
extern "C" fn quick_exit(code: c_int) -> ! {
    end(code, "quick_exit")
}

/// It would end the process in favour of a child that has none of its threads, with exit code 0.
#[unsafe(no_mangle)]
extern "C" fn daemon(keeps_folder: c_int, keeps_descriptors: c_int) -> c_int {
    if !ENDS.load(Ordering::SeqCst) && is_program() {
        end(Exit::Failed as c_int, "daemon");
    }
    let next = next(c"daemon");
    if next.is_null() {
        return -1;
    }
    // SAFETY: the system's function of this name has this type.
    unsafe { transmute::<*mut c_void, extern "C" fn(c_int, c_int) -> c_int>(next)(keeps_folder, keeps_descriptors) }
}

/// A thread of the program that ended in the middle of a call would hold up all others.
#[unsafe(no_mangle)]
extern "C" fn pthread_exit(value: *mut c_void) -> ! {
    if is_program() && present::here().is_some() {
        end(Exit::Failed as c_int, "pthread_exit");
    }
    let next = next(c"pthread_exit");
    if next.is_null() {
        end(Exit::Failed as c_int, "pthread_exit");
    }
    // SAFETY: the system's function of this name has this type, and ends the thread with the value.
    unsafe { transmute::<*mut c_void, unsafe extern "C" fn(*mut c_void) -> !>(next)(value) }
}

/// So would one that is cancelled, and the process would end without a word.
#[unsafe(no_mangle)]
extern "C" fn pthread_cancel(thread: libc::pthread_t) -> c_int {
    // SAFETY: the call takes no pointers and never fails.
    if is_program() && present::here().is_some() && thread == unsafe { libc::pthread_self() } {
        end(Exit::Failed as c_int, "pthread_cancel");
    }
    let next = next(c"pthread_cancel");
    if next.is_null() {
        return libc::ENOSYS;
    }
    // SAFETY: the system's function of this name has this type.
    unsafe { transmute::<*mut c_void, extern "C" fn(libc::pthread_t) -> c_int>(next)(thread) }
}

/// Called after `fork` in the child, which may call `exec` or `_exit`, but never return to the program.
extern "C" fn forked() {
    present::forked(|owner, function| {
        write(&[
            "error: ",
            &owner.text,
            " forked the program ",
            function.place(),
            ", and the child returned: it ends here; it may only call `exec` or `_exit`\n",
        ]);
        leave(Exit::Failed as c_int)
    });
}
