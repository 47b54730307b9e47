//! Panics of libraries that no call of the program contains: on threads of their own, and in destructors of
//! thread-local variables. The library's copy of the standard library tells them, but not whose code it was.
//!
//! `_Unwind_RaiseException` is defined here, as `exit` is in [`end`](super::end): each panic begins there.

use std::arch::naked_asm;
use std::ffi::c_void;
use std::ptr;

use saoms_api::host::present::{Function, here};

use super::blame::{Blame, blame, is_program, leave, write};
use super::real::Real;
use crate::Exit;

/// The class of the exceptions that are panics of Rust.
const PANIC: u64 = u64::from_ne_bytes(*b"MOZ\0RUST");

static RAISE: Real = Real::of(c"_Unwind_RaiseException");

/// Looks up what is of the system, before a library can hang.
pub(super) fn prepare() {
    RAISE.get();
}

/// Tells a panic that nobody contains, and gives the function of the system that raises it.
extern "C" fn raised(exception: *const u64) -> *mut c_void {
    let top = 0_u8;
    // SAFETY: an exception begins with its class.
    if here().is_none() && is_program() && unsafe { exception.read() } == PANIC {
        match blame(ptr::from_ref(&top) as usize) {
            Blame::Call(owner, Function::ThreadEnd) => {
                write(&["warning: ", &owner.text, " panicked ", Function::ThreadEnd.place(), "\n"]);
            }
            Blame::Thread(library) => write(&["warning: a thread of library `", library, "` panicked\n"]),
            Blame::Call(..) | Blame::Nobody => {}
        }
    }
    let real = RAISE.get();
    if real.is_null() {
        leave(Exit::Failed as i32);
    }
    real
}

/// The system unwinds from the caller, so that the stack and the registers are as they are here.
#[unsafe(no_mangle)]
#[unsafe(naked)]
unsafe extern "C" fn _Unwind_RaiseException() {
    naked_asm!("push rdi", "call {raised}", "pop rdi", "jmp rax", raised = sym raised)
}
