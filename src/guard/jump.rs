//! `longjmp` out of a call into a library: to a call that has returned, or over functions of the program. Neither can
//! go on: the program would never give back what it held.
//!
//! `setjmp` and `longjmp` are defined here, as `exit` is in [`end`](super::end). Each `setjmp` notes in which call it
//! was, and `longjmp` compares that with the present one. Stacks that a library made itself are left alone: code on
//! them may go on in another call, as coroutines do.

use std::arch::naked_asm;
use std::cell::Cell;
use std::ffi::{c_int, c_void};
use std::mem::{MaybeUninit, transmute};
use std::ops::Range;
use std::ptr;
use std::sync::atomic::{AtomicU64, Ordering};

use saoms_api::host::present::call_number;

use super::ENDS;
use super::blame::{is_program, leave};
use super::end::end_after;
use super::real::Real;
use crate::Exit;

/// How many places are known at a time. A place that others displaced is not checked.
const KNOWN: usize = 1024;

/// A place, and the call in which it was set. Without a lock: threads and signal handlers set places.
struct Place {
    /// The address of the `jmp_buf`, combined with the number: one that does not fit the other is of two writers.
    mixed: AtomicU64,
    number: AtomicU64,
}

static PLACES: [Place; KNOWN] = [const { Place { mixed: AtomicU64::new(0), number: AtomicU64::new(0) } }; KNOWN];

impl Place {
    fn of(buffer: usize) -> &'static Place {
        // The size of a `jmp_buf` is 200 bytes.
        &PLACES[buffer / 64 % KNOWN]
    }

    fn set(&self, buffer: usize, number: u64) {
        self.number.store(number, Ordering::Relaxed);
        self.mixed.store(buffer as u64 ^ number, Ordering::Relaxed);
    }

    /// The call in which it was set, if that is known.
    fn number(&self, buffer: usize) -> Option<u64> {
        let number = self.number.load(Ordering::Relaxed);
        (self.mixed.load(Ordering::Relaxed) ^ number == buffer as u64).then_some(number)
    }
}

static SETJMP: Real = Real::of(c"setjmp");
static SETJMP_ALONE: Real = Real::of(c"_setjmp");
static SIGSETJMP: Real = Real::of(c"__sigsetjmp");
static LONGJMP: Real = Real::of(c"longjmp");
static LONGJMP_CHECKED: Real = Real::of(c"__longjmp_chk");

/// Looks up what is of the system, before a signal handler needs it.
pub(super) fn prepare() {
    for real in [&SETJMP, &SETJMP_ALONE, &SIGSETJMP, &LONGJMP, &LONGJMP_CHECKED] {
        real.get();
    }
}

/// The stack of the present thread.
fn own_stack() -> Range<usize> {
    thread_local! {
        static STACK: Cell<Option<(usize, usize)>> = const { Cell::new(None) };
    }
    let (start, size) = STACK.get().unwrap_or_else(|| {
        let mut about = MaybeUninit::<libc::pthread_attr_t>::uninit();
        let (mut start, mut size) = (ptr::null_mut(), 0);
        // SAFETY: the attributes are read once the system has written them, and are given back.
        unsafe {
            if libc::pthread_getattr_np(libc::pthread_self(), about.as_mut_ptr()) == 0 {
                libc::pthread_attr_getstack(about.as_ptr(), &raw mut start, &raw mut size);
                libc::pthread_attr_destroy(about.as_mut_ptr());
            }
        }
        STACK.set(Some((start as usize, size)));
        (start as usize, size)
    });
    start..start + size
}

/// Notes a place that code on this stack sets, and gives the function of the system that sets it.
fn note(buffer: usize, stack: usize, real: &Real) -> *mut c_void {
    // What is on another stack stays in no call.
    let (key, number) = if own_stack().contains(&stack) { (buffer, call_number()) } else { (0, 0) };
    Place::of(buffer).set(key, number);
    let real = real.get();
    if real.is_null() {
        leave(Exit::Failed as c_int);
    }
    real
}

extern "C" fn note_setjmp(buffer: usize, stack: usize) -> *mut c_void {
    note(buffer, stack, &SETJMP)
}

extern "C" fn note_setjmp_alone(buffer: usize, stack: usize) -> *mut c_void {
    note(buffer, stack, &SETJMP_ALONE)
}

extern "C" fn note_sigsetjmp(buffer: usize, stack: usize) -> *mut c_void {
    note(buffer, stack, &SIGSETJMP)
}

/// A function that sets a place: it has the address noted, and goes on in that of the system, which returns to its
/// caller with the stack and the registers as they are here.
macro_rules! setting {
    ($($name:ident $note:ident)*) => {
        $(
            #[unsafe(no_mangle)]
            #[unsafe(naked)]
            unsafe extern "C" fn $name() {
                naked_asm!(
                    "push rdi",
                    "push rsi",
                    "mov rsi, rsp",
                    "sub rsp, 8",
                    "call {note}",
                    "add rsp, 8",
                    "pop rsi",
                    "pop rdi",
                    "jmp rax",
                    note = sym $note,
                )
            }
        )*
    };
}

setting! {
    setjmp note_setjmp
    _setjmp note_setjmp_alone
    __sigsetjmp note_sigsetjmp
}

/// Jumps to a place, unless it was set in another call.
///
/// # Safety
/// As that of the system.
unsafe fn jump(buffer: *mut c_void, value: c_int, by: &str, real: &Real) -> ! {
    let set = Place::of(buffer as usize).number(buffer as usize);
    if set.is_some_and(|number| number != call_number()) && is_program() && !ENDS.load(Ordering::SeqCst) {
        end_after(" jumped out of its call, by `", by, ": it may only jump within one call");
    }
    let real = real.get();
    if real.is_null() {
        leave(Exit::Failed as c_int);
    }
    // SAFETY: the system's function has this type; the rest is as the caller promises.
    unsafe { transmute::<*mut c_void, unsafe extern "C" fn(*mut c_void, c_int) -> !>(real)(buffer, value) }
}

macro_rules! jumping {
    ($($name:ident $by:literal $real:ident)*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name(buffer: *mut c_void, value: c_int) -> ! {
                // SAFETY: as the caller promises.
                unsafe { jump(buffer, value, $by, &$real) }
            }
        )*
    };
}

jumping! {
    longjmp "longjmp" LONGJMP
    _longjmp "longjmp" LONGJMP
    siglongjmp "siglongjmp" LONGJMP
    __longjmp_chk "longjmp" LONGJMP_CHECKED
}
