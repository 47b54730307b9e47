//! The status of the fleet: components say what they do between their executions, when somebody asks.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::slot::{Slot, SlotState};
use super::{Engine, Next, RunPhase};
use crate::report::Sections;
use crate::schedule::component::body::Job;
use crate::status::{ComponentState, ComponentStatus, FleetPhase, FleetStatus, summaries};

/// Time for which answers count as new.
const FRESH: Duration = Duration::from_millis(100);

/// Questions to components about their status.
#[derive(Debug, Default)]
pub(crate) struct Questions {
    /// The next component to ask; beyond the last one, all were asked.
    next: usize,
    /// Number of components that were asked and have not answered.
    unanswered: usize,
    /// True if only samples are asked for, and no person wants to know.
    is_for_sample: bool,
    /// True once a component had no answer for a sample, or was not asked for it.
    is_incomplete: bool,
    /// When the present round of questions began, on the machine's clock.
    pub(crate) asked: Option<Instant>,
}

impl Questions {
    /// What components are asked.
    pub(crate) fn job(&self) -> Job {
        if self.is_for_sample { Job::Sample } else { Job::Describe }
    }

    /// Notes that a component had no answer for a sample, or was not asked: a person who asks hears more.
    pub(super) fn note_incomplete(&mut self) {
        self.is_incomplete = true;
    }
}

impl RunPhase {
    /// The phase as operators see it.
    pub(crate) fn shown(self) -> FleetPhase {
        match self {
            RunPhase::Starting => FleetPhase::Starting,
            RunPhase::Running => FleetPhase::Running,
            RunPhase::Stopping => FleetPhase::Ending,
            RunPhase::Ended => FleetPhase::Ended,
        }
    }
}

impl Engine {
    /// Begins a round of questions: components are asked when no execution is due.
    pub(crate) fn ask_all(&mut self) {
        self.ask(false);
    }

    /// The same for a sample. A person who asks at that time is answered.
    pub(super) fn ask_all_for_sample(&mut self) {
        let is_for_person = !self.questions.is_for_sample && !self.are_answered();
        self.ask(!is_for_person);
    }

    fn ask(&mut self, is_for_sample: bool) {
        let asked = Some(Instant::now());
        self.questions = Questions { is_for_sample, asked, ..Questions::default() };
        self.slots.iter_mut().for_each(|slot| slot.asked = false);
        self.wake |= self.roles.asleep_until != 0;
    }

    /// True if the last answers are so old that components are asked again.
    pub(crate) fn are_outdated(&self) -> bool {
        let Questions { is_for_sample, is_incomplete, asked, .. } = self.questions;
        // A sample keeps failures to itself.
        is_for_sample && (is_incomplete || !self.are_answered()) || asked.is_none_or(|asked| asked.elapsed() >= FRESH)
    }

    /// True if each component that can answer has done so.
    pub(crate) fn are_answered(&self) -> bool {
        self.questions.asked.is_none()
            || self.phase != RunPhase::Running
            || self.questions.next >= self.slots.len() && self.questions.unanswered == 0
    }

    /// The next component to ask. A component that runs on a worker thread is asked there.
    #[inline]
    pub(crate) fn next_question(&mut self) -> Option<Next> {
        if self.questions.asked.is_none() || self.questions.next >= self.slots.len() {
            return None;
        }
        self.ask_next()
    }

    #[cold]
    fn ask_next(&mut self) -> Option<Next> {
        while let Some(slot) = self.slots.get_mut(self.questions.next) {
            let index = self.questions.next as u32;
            self.questions.next += 1;
            if slot.state != SlotState::Active || slot.held {
                continue;
            }
            if self.questions.is_for_sample && slot.is_wanted == Some(false) {
                self.questions.note_incomplete();
                continue;
            }
            if slot.isolation.active {
                // At the end, what it said before has to do.
                if self.phase != RunPhase::Running {
                    continue;
                }
                slot.asked = true;
                self.questions.unanswered += 1;
                if !std::mem::replace(&mut slot.queued, true) {
                    self.roles.work.push_back(index);
                    return Some(Next::HandOver);
                }
            } else if slot.body.is_some() {
                slot.asked = true;
                self.questions.unanswered += 1;
                return Some(Next::Run(index, self.questions.job()));
            }
        }
        // Who waits for the last answer may wait for none.
        self.has_returned |= self.awaited > 0;
        None
    }

    /// Notes that a component has answered, or failed to.
    pub(crate) fn note_answer(&mut self, index: u32) {
        // One that was asked in an earlier round is not waited for.
        if std::mem::take(&mut self.slots[index as usize].asked) {
            self.questions.unanswered -= 1;
        }
    }

    /// Goes on with a component that has answered.
    pub(super) fn answered(&mut self, index: u32, now: u64) {
        let slot = &self.slots[index as usize];
        if slot.state == SlotState::Active && slot.entry == super::slot::NEVER && slot.policy.periodic {
            // It became due while it was asked.
            let when = slot.next_time().max(now);
            self.enqueue(index, when);
        }
        let slot = &mut self.slots[index as usize];
        if slot.asked_to_wait && slot.isolation.active && !std::mem::replace(&mut slot.queued, true) {
            // Its worker asks the other question next.
            self.roles.work.push_back(index);
        }
        self.resume(index, now);
    }

    /// A snapshot of the fleet at a time.
    pub(crate) fn status(&self, sections: &Sections, now: u64) -> FleetStatus {
        let members = self.slots.iter().filter(|slot| slot.is_member());
        self.status_with(sections, now, members.map(|slot| self.component_status(slot, now)).collect())
    }

    /// The same with these components.
    pub(super) fn status_with(&self, sections: &Sections, now: u64, components: Vec<ComponentStatus>) -> FleetStatus {
        FleetStatus {
            time_s: now as f64 / 1e9,
            phase: self.phase.shown(),
            paused: self.phase == RunPhase::Running && now >= self.hold,
            speed: self.pace.map(|pace| pace.factor),
            summaries: summaries(|path| sections.integer(path).unwrap_or(0)),
            components,
        }
    }

    pub(super) fn component_status(&self, slot: &Slot, now: u64) -> ComponentStatus {
        let described = slot.described.as_ref().filter(|_| slot.state == SlotState::Active).map(Arc::clone);
        let is_in_code = self.real && slot.body.is_none();
        ComponentStatus {
            report: self.component_report(slot),
            site: slot.spec.site.clone(),
            state: match slot.state {
                SlotState::Idle | SlotState::Removed => ComponentState::Idle,
                SlotState::Starting => ComponentState::Starting,
                SlotState::Active => ComponentState::Running,
                SlotState::Leaving => ComponentState::Leaving,
                SlotState::Failed => ComponentState::Failed,
                SlotState::Abandoned => ComponentState::Abandoned,
            },
            emergency_stop: slot.is_stopped(),
            period_ms: slot.policy.periodic.then_some(slot.policy.period as f64 / 1e6),
            in_code_s: is_in_code.then(|| now.saturating_sub(slot.out_since) as f64 / 1e9),
            waits_for: described.as_ref().and_then(|one| one.waits_for.clone()),
            values: described.as_ref().map(|one| Arc::clone(&one.values)).unwrap_or_default(),
            values_s: described.map(|one| one.at.as_secs_f64()),
        }
    }
}
