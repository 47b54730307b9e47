use std::sync::atomic::Ordering;

use super::engine::{Engine, RunPhase};
use super::slot::SlotState;
use super::sys;
use crate::assemble::ChangePlan;
use crate::journal::Journal;
use crate::observe::Occurrence;
use crate::report::{
    ComponentReport, LatenessSummary, MessageCounts, Outcome, RunReport, RunStatus, Sections, Votes,
};

/// Causes of the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EndCause {
    /// All voters see no work left.
    Done,
    /// The time given for the run is over.
    Elapsed,
    /// A stop was requested.
    Interrupted,
    /// No component is left that could go on.
    Lost,
    /// No component is scheduled, and in virtual time none ever will be.
    Idle,
}

impl Engine {
    /// Begins the end of the run: every component that is alive is asked to end early and will shut down.
    pub(super) fn begin_stop(&mut self, cause: EndCause, now: u64) {
        if self.phase != RunPhase::Running {
            return;
        }
        self.phase = RunPhase::Stopping;
        self.cause = Some(cause);
        self.ended = (now, sys::monotonic());
        self.queue.clear();
        self.injections.clear();
        self.roles.work.clear();
        self.wake = true;
        for slot in &mut self.slots {
            slot.queued = false;
            slot.cancelled.store(true, Ordering::Relaxed);
        }
        // The end of a run is the change to a fleet without components.
        let members: Vec<_> = self.slots.iter().map(|slot| slot.is_member().then_some(&*slot.spec)).collect();
        self.ending =
            ChangePlan::between(&members, &[]).remove.into_iter().map(|number| number as u32).collect();
    }

    /// Ends the run after a fault of the engine itself.
    pub(super) fn break_down(&mut self) {
        self.phase = RunPhase::Ended;
        self.reasons.push("a fault of the program itself, told on standard error, ended the run".to_owned());
    }

    /// The next component that has to shut down. A component whose code runs follows when the code returns.
    pub(super) fn next_to_end(&mut self) -> Option<u32> {
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
    pub(super) fn abandon(&mut self, only: Option<u32>, why: &str, now: u64) {
        for index in 0..self.slots.len() as u32 {
            let slot = &mut self.slots[index as usize];
            let stuck = slot.body.is_none() && slot.state != SlotState::Abandoned;
            if stuck && only.is_none_or(|only| only == index) {
                slot.state = SlotState::Abandoned;
                self.reasons.push(format!("component `{}` {why}", slot.name));
                self.came_back();
                self.tell(now, index, Occurrence::Abandoned);
            }
        }
    }

    /// The report of a run that has ended.
    pub(super) fn report(&self, sections: &Sections) -> RunReport {
        RunReport {
            seed: self.seed,
            time_s: self.ended.0 as f64 / 1e9,
            periods: self.slots.iter().map(|slot| slot.statistics.executions).sum(),
            sections: sections.to_json(),
            components: self.components(),
            journal: self.journal(),
            votes: self.votes_report(),
            outcome: self.outcome(),
            trace_hash: self.trace.as_ref().map(super::trace::Trace::digits),
        }
    }

    fn journal(&self) -> Journal {
        let rings = self.slots.iter().filter(|slot| slot.joined).map(|slot| (&slot.name, &slot.journal));
        let mut journal = Journal::of_rings(rings, &self.outside);
        journal.lost = self.lost_records;
        journal
    }

    fn components(&self) -> Vec<ComponentReport> {
        // All components that ever joined the fleet.
        let joined = self.slots.iter().filter(|slot| slot.joined);
        joined
            .map(|slot| {
                let (spec, statistics) = (&slot.spec, &slot.statistics);
                ComponentReport {
                    name: spec.path.clone(),
                    id: spec.task.as_ref().map(|task| task.id.clone()),
                    class: spec.class.name().to_owned(),
                    executions: statistics.executions,
                    missed: statistics.missed,
                    late_us: if self.real { statistics.late.summary() } else { LatenessSummary::default() },
                    deadline_misses: statistics.deadline_misses,
                    slow: statistics.slow,
                    restarts: slot.restarts,
                    replaced: slot.statistics.replaced,
                    failures: statistics.failures,
                    dropped: statistics.dropped,
                    messages: MessageCounts { sent: statistics.sent, received: statistics.received },
                }
            })
            .collect()
    }

    fn votes_report(&self) -> Votes {
        let open = self.slots.iter().filter(|slot| slot.vote == Some(saoms_api::Work::Open));
        Votes { done: self.votes.done as u64, open: open.map(|slot| slot.name.to_string()).collect() }
    }

    fn outcome(&self) -> Outcome {
        let mut reasons = self.reasons.clone();
        let status = match self.cause {
            Some(EndCause::Interrupted) => RunStatus::Interrupted,
            _ if !reasons.is_empty() => RunStatus::Failed,
            Some(EndCause::Elapsed) => RunStatus::Elapsed,
            Some(EndCause::Idle) => {
                reasons
                    .push("no component is scheduled, and in virtual time nothing else happens".to_owned());
                RunStatus::Done
            }
            Some(EndCause::Done | EndCause::Lost) | None => RunStatus::Done,
        };
        Outcome { status, reasons }
    }
}
