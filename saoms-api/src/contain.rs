//! For hosts: the code of components, kept apart from that of the host: its panics are failures.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::mem;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;

use crate::Failure;

thread_local! {
    /// Whether this thread is inside component code, where a panic is a failure of the component and not of the program.
    static CAPTURING: Cell<bool> = const { Cell::new(false) };
    /// Where the last captured panic happened.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs component code. A panic becomes a failure with its message and place and, after [`install_hook`], writes nothing to standard
/// error.
///
/// # Errors
/// The code panicked.
///
/// What the code has left half changed is only seen by itself: a component that panicked is never called again.
#[inline]
pub fn contained<T>(code: impl FnOnce() -> T) -> Result<T, Failure> {
    // Looked up once: in a library that takes a call.
    CAPTURING.with(|capturing| {
        let outer = capturing.replace(true);
        let result = panic::catch_unwind(AssertUnwindSafe(code)).map_err(describe);
        capturing.set(outer);
        result
    })
}

#[cold]
fn describe(payload: Box<dyn Any + Send>) -> Failure {
    let message = payload
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| payload.downcast_ref::<&str>().copied())
        .unwrap_or("panicked without a message");
    let failure = match PLACE.take() {
        Some(place) => Failure::new(format!("panicked at {place}: {message}")),
        None => Failure::new(format!("panicked: {message}")),
    };
    // Dropping it can panic, too; what that leaves is not dropped.
    if let Err(again) = panic::catch_unwind(AssertUnwindSafe(|| drop(payload))) {
        mem::forget(again);
        PLACE.take();
    }
    failure
}

/// Makes panics inside [`contained`] silent, once in the life of the process. All others go to the hook that was there before.
pub fn install_hook() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info: &PanicHookInfo<'_>| {
            if CAPTURING.get() {
                PLACE.set(info.location().map(ToString::to_string));
            } else {
                before(info);
            }
        }));
    });
}
