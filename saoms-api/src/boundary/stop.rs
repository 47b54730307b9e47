//! Functions that stop hardware, across the boundary.

use std::ffi::c_void;
use std::sync::Arc;
use std::time::Duration;

use saoms_abi::{Sink, Status, StopView};

use crate::host::contain::{contained, resume};
use crate::host::present::{Function, Owner, enter, here};
use crate::{Failure, StopFunction};

use super::guard::guarded;
use super::lease::call;
use super::null::given;

/// Lends a function of this side to the other, which gives it back with `release`.
pub(super) fn export(stop: StopFunction) -> StopView {
    let heartbeat = stop.has_heartbeat();
    StopView {
        size: size_of::<StopView>(),
        state: Box::into_raw(Box::new(stop)).cast(),
        stop: Some(stop_here),
        heartbeat: heartbeat.then_some(beat_here),
        release: Some(release_here),
    }
}

unsafe extern "C" fn stop_here(state: *mut c_void, error: Sink) -> Status {
    // SAFETY: the state is that of `export`, which threads may share; the sink's owner waits for this call.
    unsafe { guarded(error, || (*state.cast::<StopFunction>()).stop()) }
}

unsafe extern "C" fn beat_here(state: *mut c_void, period: u64, error: Sink) -> Status {
    // SAFETY: the state is that of `export`, which threads may share; the sink's owner waits for this call.
    unsafe {
        guarded(error, || {
            (*state.cast::<StopFunction>()).beat(Duration::from_nanos(period));
            Ok(())
        })
    }
}

unsafe extern "C" fn release_here(state: *mut c_void) {
    // SAFETY: the state is that of `export`, given back once. A panic says nothing that matters any more.
    let _ = contained(|| drop(unsafe { Box::from_raw(state.cast::<StopFunction>()) }));
}

/// A function of a library.
struct Imported {
    view: StopView,
    /// Whose code it is, for messages.
    owner: Option<&'static Owner>,
}

// SAFETY: the rules of the boundary say that the functions may be called from any thread at any time, until the state
// is released by the last owner.
unsafe impl Send for Imported {}
// SAFETY: as above.
unsafe impl Sync for Imported {}

impl Drop for Imported {
    fn drop(&mut self) {
        if let Some(release) = self.view.release {
            let _entered = self.owner.map(|owner| enter(owner, Function::Destroy));
            // SAFETY: the state is the library's own, given back once.
            unsafe { release(self.view.state) }
        }
    }
}

/// Takes over a function of a library whose code runs on this thread, with its state, which is freed after an error,
/// too.
///
/// # Errors
/// It is null or too short, or has no function to stop.
///
/// # Safety
/// The view is null or readable, and its functions keep the rules of the boundary.
pub(super) unsafe fn import(view: *const StopView) -> Result<StopFunction, Failure> {
    // SAFETY: as the caller promises; it begins with its size.
    let size = unsafe { *given(view.cast::<usize>(), "the function that stops the hardware")? };
    if size < size_of::<StopView>() {
        let least = size_of::<StopView>();
        return Err(Failure::new(format!(
            "the `SaomsStopView` has {size} bytes, expected at least {least}: set its member `size` to \
             `sizeof(SaomsStopView)`"
        )));
    }
    // SAFETY: the size says that all members are there.
    let view = unsafe { &*view };
    let imported = Arc::new(Imported { view: *view, owner: here().map(|(owner, _)| owner) });
    let Some(stop) = view.stop else {
        return Err(Failure::new("found null for the function that stops the hardware, expected a function"));
    };
    let of_beat = Arc::clone(&imported);
    let function = StopFunction::new(move || {
        let _entered = imported.owner.map(|owner| enter(owner, Function::Stop));
        // SAFETY: as the caller of `import` promised; the state lives as long as `imported`.
        call(|error| unsafe { stop(imported.view.state, error) })
    });
    Ok(match view.heartbeat {
        None => function,
        Some(beat) => function.with_heartbeat(move |period| {
            let _entered = of_beat.owner.map(|owner| enter(owner, Function::Heartbeat));
            let nanos = u64::try_from(period.as_nanos()).unwrap_or(u64::MAX);
            // SAFETY: as above.
            let beaten = call(|error| unsafe { beat(of_beat.view.state, nanos, error) });
            // What the function of a linked component could only tell by a panic, too.
            beaten.unwrap_or_else(|failure| resume(failure));
        }),
    })
}
