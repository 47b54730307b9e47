//! What libraries of plugins can do to the process, told by name: a crash, an end, code that does not return.

mod crash;
mod hang;

use std::process;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) use hang::waited_for;

use crate::output::{eprint, keep_from_libraries};

/// True once the program ends by itself, and not because code of a library ended it.
static ENDS: AtomicBool = AtomicBool::new(false);

/// Watches over code of libraries from now on. Asked before the first is loaded.
pub(crate) fn install() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        crash::install();
        keep_from_libraries();
        if let Err(error) = hang::watch() {
            eprint(&format!("warning: nobody watches for code that does not return: {error}\n"));
        }
    });
}

/// Says that the program ends by itself.
pub(crate) fn ends_by_itself() {
    ENDS.store(true, Ordering::SeqCst);
}

/// Ends the process.
pub(crate) fn exit(code: i32) -> ! {
    ends_by_itself();
    process::exit(code)
}
