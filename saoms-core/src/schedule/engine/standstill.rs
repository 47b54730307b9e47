//! Detection of a run in which nothing happens any more, although work is left.

use saoms_api::Time;
use saoms_lang::assembly::ComponentSpec;

use super::ending::EndCause;
use super::slot::{NEVER, Slot, SlotState};
use super::{Engine, Next};
use crate::observe::Occurrence;
use crate::report::{Standstill, Waiting};
use crate::schedule::component::body::Job;
use crate::schedule::settings::{Settings, nanos};

/// Time without an effect after which the standstill is told even if components may still act: one hour.
const LONG: u64 = 3_600_000_000_000;

/// State of the detection.
#[derive(Debug)]
pub(crate) struct StandstillDetector {
    /// Time of the last effect: a message, a record of the journal, a vote, or a change in the life of a component.
    last_effect: u64,
    /// The latest end of the faults that have begun and that end: what they hold up may go on then.
    faults_until: u64,
    /// Time without an effect after which components are asked; [`NEVER`] once a standstill was told.
    patience: u64,
    /// Since when it was quiet, and the patience, of the present round of questions, and the next component to ask.
    round: (u64, u64),
    next: usize,
    /// Number of components that were asked on worker threads in the present round, and have not answered.
    unanswered: usize,
    /// See [`Settings::quiet`], in nanoseconds.
    quiet: u64,
    /// See [`Settings::ends_at_standstill`].
    ends_with_limit: bool,
    /// The standstill that was told.
    pub(crate) told: Option<Standstill>,
}

impl StandstillDetector {
    pub(super) fn new(settings: &Settings) -> StandstillDetector {
        let quiet = nanos(settings.quiet);
        StandstillDetector {
            last_effect: 0,
            faults_until: 0,
            patience: quiet,
            round: (NEVER, 0),
            next: 0,
            unanswered: 0,
            quiet,
            ends_with_limit: settings.ends_at_standstill,
            told: None,
        }
    }

    /// Notes that something happened.
    #[inline]
    pub(crate) fn note_effect(&mut self, now: u64) {
        self.last_effect = now;
    }

    /// Notes a fault that ends at a time.
    pub(crate) fn note_fault(&mut self, until: u64) {
        self.faults_until = self.faults_until.max(until);
    }

    /// The time since which nothing has happened, and no fault was in the way.
    fn quiet_since(&self) -> u64 {
        self.last_effect.max(self.faults_until)
    }

    /// The earliest time at which there is something to ask or to tell, after all that there was at a time.
    pub(crate) fn next_look(&self, now: u64) -> u64 {
        let since = self.quiet_since();
        let quiet = since.saturating_add(self.patience);
        if now < quiet {
            return quiet;
        }
        // All were asked: only an effect begins another round, or an hour without one.
        let long = since.saturating_add(LONG);
        now.saturating_add(self.quiet).min(if now < long { long } else { NEVER })
    }

    #[inline]
    pub(crate) fn is_quiet(&self, now: u64) -> bool {
        now.saturating_sub(self.quiet_since()) >= self.patience
    }
}

impl Engine {
    /// The next component to ask what it waits for, while nothing happens. When all have answered, the standstill is
    /// told, or ends the run if nothing can happen any more. A component that runs on a worker thread is asked there.
    pub(crate) fn next_to_ask(&mut self, now: u64) -> Option<Next> {
        let has_voters = self.votes.voters > 0;
        if has_voters && self.votes.done == self.votes.voters {
            // No work is left: a fleet may be idle.
            return None;
        }
        let detector = &mut self.standstill;
        let since = detector.quiet_since();
        if detector.patience < LONG && now.saturating_sub(since) >= LONG {
            detector.patience = LONG;
        }
        let round = (since, detector.patience);
        if detector.round != round {
            detector.round = round;
            // Without a vote there is work to tell of only where a component waits to be started.
            let asks = has_voters || self.slots.iter().any(Slot::is_left_out);
            detector.next = if asks { 0 } else { self.slots.len() + 1 };
            detector.unanswered = 0;
            self.slots.iter_mut().for_each(|slot| slot.asked_to_wait = false);
        }
        while let Some(slot) = self.slots.get_mut(self.standstill.next) {
            let index = self.standstill.next as u32;
            self.standstill.next += 1;
            slot.waits_for = None;
            if slot.state != SlotState::Active || slot.held {
                continue;
            }
            if slot.isolation.active {
                slot.asked_to_wait = true;
                self.standstill.unanswered += 1;
                if !std::mem::replace(&mut slot.queued, true) {
                    self.roles.work.push_back(index);
                    return Some(Next::HandOver);
                }
            } else if slot.body.is_some() {
                return Some(Next::Run(index, Job::Ask));
            }
        }
        // After an hour, one whose code hangs is not waited for.
        let is_answered = self.standstill.unanswered == 0 || self.standstill.patience == LONG;
        if is_answered && self.standstill.next == self.slots.len() {
            // Once a round.
            self.standstill.next += 1;
            self.judge_standstill(now);
        }
        None
    }

    /// Notes that a component has answered on its worker thread, or never will. After the last one, the timer judges.
    pub(crate) fn note_waiting(&mut self, index: u32) {
        if std::mem::take(&mut self.slots[index as usize].asked_to_wait) {
            self.standstill.unanswered -= 1;
            if self.standstill.unanswered == 0 {
                self.look_at = 0;
                self.wake |= self.roles.asleep_until != 0;
            }
        }
    }

    fn judge_standstill(&mut self, now: u64) {
        let since = self.standstill.quiet_since();
        // A fault that is still to come may be one that starts a component again.
        let nothing_comes = self.injections.are_over() && !self.injections.have_faults() && self.uncommitted == 0;
        let is_certain = nothing_comes && self.slots.iter().all(|slot| !slot.may_act(since));
        if !is_certain && self.standstill.patience < LONG {
            return;
        }
        let may_end = self.standstill.ends_with_limit || self.limit == NEVER;
        let ends = is_certain && may_end && !self.real && self.pause == NEVER;
        let standstill = self.standstill(self.standstill.last_effect, ends);
        self.standstill.patience = NEVER;
        match ends {
            // The outcome of the run tells it.
            true => self.begin_stop(EndCause::Standstill, now),
            false => self.note(now, Occurrence::Standstill(standstill.clone())),
        }
        self.standstill.told = Some(standstill);
    }

    /// What is known of a standstill: first who sees work left, then who does not run, then the others.
    fn standstill(&self, since: u64, ends: bool) -> Standstill {
        let mut waiting: Vec<(u8, Waiting)> = Vec::new();
        for slot in self.slots.iter().filter(|slot| slot.joined && slot.policy.periodic) {
            let rank = match slot.sees_work {
                Some(true) => 0,
                _ if slot.state == SlotState::Idle => 1,
                _ => 2,
            };
            let starts = slot.state == SlotState::Idle;
            if rank < 2 || slot.waits_for.is_some() {
                let (component, waits_for) = (slot.name.to_string(), slot.waits_for.clone());
                waiting.push((rank, Waiting { component, runs: !starts, waits_for }));
            }
        }
        waiting.sort_by_key(|(rank, _)| *rank);
        let waiting = waiting.into_iter().map(|(_, one)| one).collect();
        Standstill { since_s: Time::from_nanos(since).as_nanos() as f64 / 1e9, ends, waiting }
    }
}

impl Slot {
    /// True if the component executes once somebody schedules it.
    pub(crate) fn is_left_out(&self) -> bool {
        self.joined && self.policy.periodic && self.state == SlotState::Idle
    }

    /// True unless the component waits, and knows all that happened up to a time.
    fn may_act(&self, since: u64) -> bool {
        match self.state {
            SlotState::Active if !self.policy.periodic => false,
            SlotState::Active => {
                let is_up_to_date = self.last_due.is_some_and(|due| due > since);
                self.waits_for.is_none() || !is_up_to_date || self.until != NEVER || has_foreign_loops(&self.spec)
            }
            SlotState::Starting | SlotState::Leaving => true,
            SlotState::Idle | SlotState::Failed | SlotState::Abandoned | SlotState::Removed => false,
        }
    }
}

/// True if the component has loops of another library than its class: its class cannot speak for them.
fn has_foreign_loops(spec: &ComponentSpec) -> bool {
    spec.loops.iter().any(|one| one.class.origin() != spec.class.origin())
}
