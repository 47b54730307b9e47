//! For hosts: the code of components, kept apart from that of the host: its panics are failures.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;
use std::{mem, ptr};

use crate::Failure;

thread_local! {
    /// True while this thread runs component code, where a panic is a failure of the component and not of the program.
    static CAPTURING: Cell<bool> = const { Cell::new(false) };
    /// Place of the last captured panic in the source.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs component code. A panic becomes a failure with its message and place and, after [`install_hook`], writes
/// nothing to standard error.
///
/// # Errors
/// The code panicked.
///
/// State that the code leaves half changed is never seen: a component that panicked is never called again.
#[inline]
pub fn contained<T>(code: impl FnOnce() -> T) -> Result<T, Failure> {
    contained_or(code, Err, Ok)
}

/// The same with another result than `Result<T, Failure>`, which is large to be moved about on the path of each
/// execution.
#[inline]
pub(crate) fn contained_or<T, R>(
    code: impl FnOnce() -> T,
    otherwise: impl FnOnce(Failure) -> R,
    well: impl FnOnce(T) -> R,
) -> R {
    // Looked up once: in a library that takes a call. It stays where it is for as long as the thread lives.
    let capturing: *const Cell<bool> = CAPTURING.with(ptr::from_ref);
    // SAFETY: the place is this thread's, which is running.
    let capturing = unsafe { &*capturing };
    let outer = capturing.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(code));
    capturing.set(outer);
    match result {
        Ok(value) => well(value),
        Err(payload) => otherwise(describe(payload)),
    }
}

/// Goes on with a panic that was caught at the boundary to a library, as if the library's code were linked in: what
/// contains that contains this. The failure is passed on unchanged.
#[cold]
pub(crate) fn resume(failure: Failure) -> ! {
    panic::resume_unwind(Box::new(failure))
}

#[cold]
fn describe(payload: Box<dyn Any + Send>) -> Failure {
    let payload = match payload.downcast::<Failure>() {
        Ok(failure) => return *failure,
        Err(payload) => payload,
    };
    let message = payload
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| payload.downcast_ref::<&str>().copied())
        .unwrap_or("panicked without a message");
    let failure = match PLACE.take() {
        Some(place) => Failure::new(format!("panicked at {place}: {message}")),
        None => Failure::new(format!("panicked: {message}")),
    };
    discard(payload);
    failure
}

/// Drops what a panic left. That can panic, too; what that leaves is not dropped.
#[cold]
pub(crate) fn discard(payload: Box<dyn Any + Send>) {
    let outer = CAPTURING.replace(true);
    if let Err(again) = panic::catch_unwind(AssertUnwindSafe(|| drop(payload))) {
        mem::forget(again);
        PLACE.take();
    }
    CAPTURING.set(outer);
}

/// Makes panics inside [`contained`] silent, once in the life of the process. All others go to the hook that was there
/// before.
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
