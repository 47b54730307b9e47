//! Whose code runs on a thread, and lines about it that a signal handler can write.

use std::ffi::{CStr, c_int, c_void};
use std::sync::atomic::{AtomicI32, Ordering};

use saoms_api::host::present::{Function, Owner, here, is_of_program, libraries, library_at};

use super::thread_end;

/// The process of the program: in another one, that code of a library forked, nobody is to be told.
static PROCESS: AtomicI32 = AtomicI32::new(0);

/// Notes which process the program is.
pub(super) fn keep_process() {
    // SAFETY: the call takes no pointers and never fails.
    PROCESS.store(unsafe { libc::getpid() }, Ordering::SeqCst);
}

/// True in the process of the program, once that was noted.
pub(super) fn is_program() -> bool {
    // SAFETY: the call takes no pointers and never fails.
    PROCESS.load(Ordering::SeqCst) == unsafe { libc::getpid() }
}

/// The code that a thread runs.
pub(super) enum Blame {
    /// A function of a component, or what else is called.
    Call(&'static Owner, Function),
    /// A thread that a library made.
    Thread(&'static str),
    /// The program, or nobody knows.
    Nobody,
}

/// Whose code the present thread runs, the top of whose stack is there. A signal handler may ask.
pub(super) fn blame(top: usize) -> Blame {
    let destructor = || thread_end::present().map(|owner| (owner, Function::ThreadEnd));
    match here().or_else(destructor) {
        Some((owner, function)) => Blame::Call(owner, function),
        // On a thread of the program addresses may be left from a call that has returned.
        None if is_of_program() => Blame::Nobody,
        None => library_above(top).map_or(Blame::Nobody, Blame::Thread),
    }
}

/// The bytes of a stack in which addresses of libraries are looked for, and of one look: a stack for signals is small.
const LOOKED_AT: usize = 1 << 14;
const LOOK: usize = 512;

/// The library of the first address on a stack, from this one on, that leads into code of one.
pub(super) fn library_above(top: usize) -> Option<&'static str> {
    let start = top & !(LOOK - 1);
    (start..start.saturating_add(LOOKED_AT)).step_by(LOOK).find_map(|from| {
        let mut words = [0_usize; LOOK / size_of::<usize>()];
        let own = libc::iovec { iov_base: words.as_mut_ptr().cast(), iov_len: LOOK };
        let other = libc::iovec { iov_base: from as *mut c_void, iov_len: LOOK };
        // SAFETY: the system copies what can be read into the words, and nothing behind the end of the stack.
        let copied = unsafe { libc::process_vm_readv(libc::getpid(), &raw const own, 1, &raw const other, 1, 0) };
        let count = usize::try_from(copied).unwrap_or_default() / size_of::<usize>();
        let first = top.saturating_sub(from) / size_of::<usize>();
        words.get(first..count)?.iter().find_map(|word| library_at(*word))
    })
}

/// A line for standard error, which a signal handler can make: without a lock, memory, or more of the stack than it is.
struct Line {
    bytes: [u8; 1024],
    length: usize,
}

impl Line {
    const fn new() -> Line {
        Line { bytes: [0; 1024], length: 0 }
    }

    fn add(&mut self, text: &str) {
        let Some(room) = self.bytes.get_mut(self.length..) else { return };
        let count = text.len().min(room.len());
        room[..count].copy_from_slice(&text.as_bytes()[..count]);
        self.length += count;
    }

    fn write(&self) {
        crate::output::write_error(&self.bytes[..self.length]);
    }
}

/// Bytes of a line that names of libraries may take.
const OF_LIBRARIES: usize = 768;

/// Writes a line to standard error at once, without a lock or memory.
pub(super) fn write(parts: &[&str]) {
    let mut line = Line::new();
    for part in parts {
        line.add(part);
    }
    line.write();
}

/// Writes a line about code of any of the libraries, in the same way.
pub(super) fn write_of_libraries(before: &str, after: &[&str]) {
    let mut line = Line::new();
    line.add(before);
    line.add("code of library `");
    for_each_library(|part| {
        if line.length + part.len() <= OF_LIBRARIES {
            line.add(part);
        }
    });
    line.add("` ");
    for part in after {
        line.add(part);
    }
    line.write();
}

/// Says the libraries whose code runs here, with what stands between two of them. A signal handler may ask.
pub(super) fn for_each_library(mut say: impl FnMut(&str)) {
    let mut before = "";
    for library in libraries() {
        if library != before {
            if !before.is_empty() {
                say("` or `");
            }
            say(library);
        }
        before = library;
    }
}

/// Ends the process at once, whatever stands before `_exit`.
pub(super) fn leave(code: c_int) -> ! {
    loop {
        // SAFETY: nothing runs after it.
        unsafe { libc::syscall(libc::SYS_exit_group, code) };
    }
}

/// The function of this name behind that of the program; null if there is none.
pub(super) fn next(name: &CStr) -> *mut c_void {
    // SAFETY: the name ends with a zero.
    unsafe { libc::dlsym(libc::RTLD_NEXT, name.as_ptr()) }
}
