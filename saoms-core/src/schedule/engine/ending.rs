use std::sync::atomic::Ordering;

use saoms_api::host::present::present_code;

use super::slot::SlotState;
use super::{Engine, RunPhase};
use crate::assemble::ChangePlan;
use crate::observe::Occurrence;
use crate::schedule::os::sys;

/// Causes of the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EndCause {
    /// All voters see no work left.
    Done,
    /// The time given for the run is over.
    Elapsed,
    /// A stop was requested.
    Interrupted,
    /// An operator ended the run.
    Stopped,
    /// No component is left that can run.
    Lost,
    /// The fleet cannot go on; why is among the reasons of the outcome.
    Failed,
    /// Work is left, and nothing can happen any more.
    Standstill,
    /// No component is scheduled, and in virtual time none ever will be.
    Idle,
}

impl Engine {
    /// Begins the end of the run: every component that is alive is asked to end early and will shut down.
    pub(crate) fn begin_stop(&mut self, cause: EndCause, now: u64) {
        if self.phase != RunPhase::Running {
            return;
        }
        self.stops.request_all();
        self.end_memory();
        self.sampling.end();
        self.phase = RunPhase::Stopping;
        self.cause = Some(cause);
        self.ended = (now, sys::monotonic());
        self.queue.clear();
        if self.real {
            // Messages that waited for these leave the program.
            let commits = self.injections.take_commits();
            commits.into_iter().for_each(|(component, number)| self.commit(component, number, now));
        }
        self.injections.clear();
        self.end_orders();
        self.roles.work.clear();
        self.wake = true;
        for slot in &mut self.slots {
            slot.queued = false;
            slot.cancelled.store(true, Ordering::Relaxed);
        }
        // The end of a run is the change to a fleet without components.
        let members: Vec<_> = self.slots.iter().map(|slot| slot.is_member().then_some(&*slot.spec)).collect();
        self.ending = ChangePlan::between(&members, &[]).remove.into_iter().map(|number| number as u32).collect();
    }

    /// Ends the run after a fault of the engine itself.
    pub(crate) fn break_down(&mut self) {
        self.phase = RunPhase::Ended;
        self.reasons.push("an error of the program itself, reported on standard error, ended the run".to_owned());
    }

    /// The next component that has to shut down. A component whose code runs follows when the code returns.
    pub(crate) fn next_to_end(&mut self) -> Option<u32> {
        while let Some(index) = self.ending.pop_front() {
            let slot = &mut self.slots[index as usize];
            if slot.body.is_some() && slot.is_alive() {
                slot.state = SlotState::Leaving;
                return Some(index);
            }
        }
        None
    }

    /// Gives up the components whose code does not return. `why` completes "component X".
    pub(crate) fn abandon(&mut self, only: Option<u32>, why: &str, now: u64) {
        for index in 0..self.slots.len() as u32 {
            let slot = &mut self.slots[index as usize];
            let stuck = slot.body.is_none() && slot.state != SlotState::Abandoned;
            if stuck && only.is_none_or(|only| only == index) {
                slot.state = SlotState::Abandoned;
                let code = present_code(&slot.name).map(|code| format!(": {code} has not returned"));
                self.reasons.push(format!("component `{}` {why}{}", slot.name, code.unwrap_or_default()));
                self.note_return();
                self.emit(now, index, Occurrence::Abandoned);
                self.stops.request_of(index);
                self.stop_its_hardware(index);
                self.tell_outage(index, false, now);
            }
        }
    }
}
