use std::sync::atomic::Ordering;
use std::sync::{Arc, Weak};
use std::thread;
use std::time::Duration;

use saoms_api::Level;

use crate::observe::Occurrence;
use crate::schedule::engine::Engine;
use crate::schedule::engine::slot::NEVER;
use crate::schedule::settings::ClockKind;
use crate::schedule::shared::Shared;

/// Least and greatest time between two looks.
const LOOK: (Duration, Duration) = (Duration::from_millis(5), Duration::from_millis(250));
/// Time without a return after which hardware is stopped: two periods, but not less than this, or this without a
/// period.
const LEAST: u64 = 50_000_000;
const WITHOUT_PERIOD: u64 = 1_000_000_000;

/// Begins to watch a fleet in real time for code that does not return although hardware moves. In virtual time the
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
        let text = format!("hardware of components that hang is not stopped: the system gives no thread: {error}");
        fleet.note(Level::Warning, text);
    }
}

/// Stops the hardware of components that hang; the time until the next look, or `None` after the end of the run.
fn look(fleet: &Weak<Shared>) -> Option<Duration> {
    let fleet = fleet.upgrade()?;
    if fleet.ended.load(Ordering::Acquire) {
        return None;
    }
    let now = fleet.clock.now_without_pause();
    let mut engine = fleet.lock();
    let mut shortest = NEVER;
    for place in 0..engine.with_hardware.len() {
        let index = engine.with_hardware[place];
        let allowed = engine.allowed_time(index);
        shortest = shortest.min(allowed);
        engine.stop_if_hanging(index, allowed, now);
    }
    fleet.release(engine);
    Some(Duration::from_nanos(shortest / 4).clamp(LOOK.0, LOOK.1))
}

impl Engine {
    /// Time within which the code of a component has to return, or its hardware is stopped.
    fn allowed_time(&self, index: u32) -> u64 {
        match self.slots[index as usize].policy.period {
            0 => WITHOUT_PERIOD,
            period => period.saturating_mul(2).max(LEAST),
        }
    }

    fn stop_if_hanging(&mut self, index: u32, allowed: u64, now: u64) {
        let slot = &mut self.slots[index as usize];
        let since = slot.out_since;
        if slot.body.is_some() || now.saturating_sub(since) < allowed || slot.hangs_since == since {
            return;
        }
        slot.hangs_since = since;
        self.emit(now, index, Occurrence::Hangs { time: Duration::from_nanos(now - since) });
        self.stops.request_of(index);
        self.stop_its_hardware(index);
    }
}
