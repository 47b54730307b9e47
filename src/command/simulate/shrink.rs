//! The faults of a failing run that are enough for it to fail.

use super::one::{SeedResult, Simulation};
use crate::command::run::faults::PlannedEvent;

/// The most runs for one seed.
const MOST_RUNS: usize = 80;

/// The events with which a seed violates the same invariant, as few as are found; `None` where there are none to leave
/// out.
///
/// Halves, quarters and so on are left out as long as the run fails without them. What is left draws the same random
/// values: each event has values of its own, and so has each fault.
pub(super) fn shrunk(simulation: &Simulation, failing: &SeedResult) -> Option<Vec<PlannedEvent>> {
    let invariant = &failing.violations.first()?.invariant;
    let mut events = simulation.events(failing.seed).ok().filter(|events| !events.is_empty())?;
    let mut runs = 0;
    let mut fails = |events: &[PlannedEvent]| {
        runs += 1;
        let result = simulation.run_with(failing.seed, events.to_vec());
        (runs <= MOST_RUNS).then(|| result.violations.iter().any(|one| one.invariant == *invariant))
    };
    if fails(&[]) == Some(true) {
        return Some(Vec::new());
    }
    let mut size = events.len().div_ceil(2);
    loop {
        let mut start = 0;
        while start < events.len() {
            let mut less = events.clone();
            less.drain(start..(start + size).min(events.len()));
            match fails(&less) {
                None => return Some(events),
                Some(true) => events = less,
                Some(false) => start += size,
            }
        }
        if size == 1 {
            return Some(events);
        }
        size = size.div_ceil(2);
    }
}
