use std::sync::atomic::Ordering;
use std::sync::{Arc, Weak};
use std::thread;
use std::time::Duration;

use saoms_api::Level;
use saoms_api::host::present::present_library;

use crate::observe::Occurrence;
use crate::schedule::component::library::library_of;
use crate::schedule::engine::Engine;
use crate::schedule::engine::slot::{NEVER, SlotState};
use crate::schedule::settings::ClockKind;
use crate::schedule::shared::Shared;

/// Least and greatest time between two looks.
const LOOK: (Duration, Duration) = (Duration::from_millis(5), Duration::from_millis(250));
/// Time without a return after which hardware is stopped: two periods, but not less than this, or this without a
/// period.
const LEAST: u64 = 50_000_000;
const WITHOUT_PERIOD: u64 = 1_000_000_000;
/// Least time without a return after which a component without hardware hangs.
const WITHOUT_HARDWARE: u64 = 5_000_000_000;

/// Begins to watch a fleet in real time for code that does not return: hardware may move meanwhile. In virtual time the
/// watchdog of virtual time does so.
pub(super) fn watch(fleet: &Arc<Shared>) {
    if fleet.settings.clock == ClockKind::Virtual {
        return;
    }
    let weak = Arc::downgrade(fleet);
    let watch = move || {
        while let Some(pause) = look(&weak) {
            thread::sleep(pause);
        }
    };
    if let Err(error) = thread::Builder::new().name("saoms-hardware".to_owned()).spawn(watch) {
        let text =
            format!("hardware of components that hang is not stopped: the system cannot create a thread: {error}");
        fleet.note(Level::Warning, text);
    }
}

/// Tells which components hang, and stops their hardware; the time until the next look, or `None` after the end of the
/// run.
fn look(fleet: &Weak<Shared>) -> Option<Duration> {
    let fleet = fleet.upgrade()?;
    if fleet.ended.load(Ordering::Acquire) {
        return None;
    }
    let mut engine = fleet.lock();
    // Under the lock: at the end of a pause this clock goes back.
    let now = fleet.clock.now_without_pause();
    let mut shortest = NEVER;
    for index in 0..engine.slots.len() as u32 {
        let stops = engine.with_hardware.contains(&index);
        let allowed = engine.allowed_time(index, stops);
        shortest = if stops { shortest.min(allowed) } else { shortest };
        engine.look_at(index, allowed, stops, now);
    }
    fleet.release(engine);
    Some(Duration::from_nanos(shortest / 4).clamp(LOOK.0, LOOK.1))
}

impl Engine {
    /// Time within which the code of a component has to return.
    fn allowed_time(&self, index: u32, stops: bool) -> u64 {
        match self.slots[index as usize].policy.period {
            period if !stops => period.saturating_mul(10).max(WITHOUT_HARDWARE),
            0 => WITHOUT_PERIOD,
            period => period.saturating_mul(2).max(LEAST),
        }
    }

    /// Tells that a component hangs, or does no longer, and stops its hardware when it does.
    fn look_at(&mut self, index: u32, allowed: u64, stops: bool, now: u64) {
        let slot = &mut self.slots[index as usize];
        let (since, hung) = (slot.out_since, slot.hangs_since);
        let is_out =
            slot.body.is_none() && matches!(slot.state, SlotState::Starting | SlotState::Active | SlotState::Leaving);
        if hung != NEVER && !(is_out && hung == since) {
            slot.hangs_since = NEVER;
            self.emit(now, index, Occurrence::Returned);
            return;
        }
        if !is_out || now.saturating_sub(since) < allowed || hung == since {
            return;
        }
        slot.hangs_since = since;
        let library = present_library(&slot.name).map(str::to_owned).or_else(|| library_of(&slot.spec, ""));
        self.emit(now, index, Occurrence::Hangs { time: Duration::from_nanos(now - since), stops, library });
        if stops {
            self.stops.request_of(index);
            self.stop_its_hardware(index);
        }
    }
}
