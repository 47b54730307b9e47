//! Whether the battery lasts.

use crate::grid::{Block, UNREACHABLE};
use crate::hardware::{Action, ActionKind};
use crate::robot::actions::Outcome;
use crate::robot::{Body, Job, Knowledge};

/// Executions that are kept back for waiting, whatever the distance.
const RESERVE: u32 = 6;

/// For so many moves to the charger one more execution is kept back.
const RESERVE_SHARE: u32 = 4;

/// A robot in charge makes way for others when its battery lasts for so many executions.
const YIELD_FROM: u32 = 15;

/// A robot's eye on its battery.
#[derive(Debug)]
pub(super) struct Energy {
    must_charge: bool,
    stranded: bool,
    /// The most executions that a move took so far.
    pace: u32,
    /// The most executions that collecting or depositing took so far.
    handling: u32,
    /// The executions of the running action.
    running: u32,
}

impl Default for Energy {
    fn default() -> Energy {
        Energy { must_charge: false, stranded: false, pace: 1, handling: 1, running: 0 }
    }
}

/// What the battery allows of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Means {
    /// The battery lasts, or a full one does with a stop at the charger in between.
    Enough,
    /// It has to last for so many executions.
    Needs(u32),
    /// No way leads there, or no full battery lasts.
    Never,
}

impl Energy {
    /// Whether the robot has to go to its charger now, or to stay there.
    pub(super) fn must_charge(&self) -> bool {
        self.must_charge || self.stranded
    }

    /// Whether the robot stopped because its battery is empty.
    pub(super) fn is_stranded(&self) -> bool {
        self.stranded
    }

    /// Whether a robot at its charger has too little to make way for others.
    pub(super) fn holds_charger(&self, knowledge: &Knowledge) -> bool {
        let wanted = YIELD_FROM.min(knowledge.battery.executions_when_full() / 2);
        knowledge.is_at_charger() && knowledge.battery.executions_left() < wanted
    }

    /// Takes what an execution needs, or gives what it gains.
    pub(super) fn use_battery(&mut self, body: &mut Body<'_, '_>) {
        let knowledge = &mut *body.knowledge;
        if knowledge.is_at_charger() {
            let charging = !knowledge.battery.is_full();
            if charging {
                knowledge.battery.charge();
                if knowledge.battery.is_full() {
                    body.context.info(format_args!("is fully charged"));
                }
            }
            knowledge.variables.in_charge = charging;
        } else {
            knowledge.variables.in_charge = false;
            knowledge.battery.drain();
        }
    }

    /// Learns how many executions the hardware takes.
    pub(super) fn note_pace(&mut self, polled: Option<(Action, Outcome)>) {
        let Some((action, outcome)) = polled else { return self.running = 0 };
        self.running += 1;
        let longest = if action.kind == ActionKind::Move { &mut self.pace } else { &mut self.handling };
        *longest = (*longest).max(self.running);
        if matches!(outcome, Outcome::Done | Outcome::Failed) {
            self.running = 0;
        }
    }

    /// Decides whether to charge, and whether it is too late for that.
    pub(super) fn watch(&mut self, body: &mut Body<'_, '_>) {
        let knowledge = &mut *body.knowledge;
        if knowledge.is_at_charger() {
            if self.must_charge && self.may_leave(knowledge) {
                self.must_charge = false;
            }
            return;
        }
        let battery = &knowledge.battery;
        if battery.is_empty() && !self.stranded {
            self.stranded = true;
            body.context.count("stranded", 1);
            body.context.log(
                saoms_api::Level::Error,
                format_args!("is stranded at {}: its battery is empty", knowledge.block),
            );
        } else if !self.must_charge && battery.executions_left() <= self.home(knowledge, knowledge.next) {
            self.must_charge = true;
            let name = &knowledge.name;
            body.context.console(format_args!("{name} has low battery and is going under charge..."));
            body.context.info(format_args!("has low battery ({battery} %): goes to charge"));
        }
    }

    /// What the battery allows of a job that starts here and now.
    pub(super) fn means(&self, knowledge: &mut Knowledge, job: &Job) -> Means {
        let battery = &knowledge.battery;
        let (left, full) = (battery.executions_left(), battery.executions_when_full());
        let needs = self.job_from(knowledge, knowledge.next, job, false);
        if needs == UNREACHABLE {
            Means::Never
        } else if needs <= left || (left == full && self.in_two_charges(knowledge, job, full)) {
            Means::Enough
        } else if needs <= full || self.in_two_charges(knowledge, job, full) {
            Means::Needs(needs.min(full))
        } else {
            Means::Never
        }
    }

    /// Whether a charged robot can go on: what is left suffices for the rest of its job, or more is not to be had.
    fn may_leave(&self, knowledge: &mut Knowledge) -> bool {
        let Some(job) = knowledge.job.filter(|_| knowledge.variables.busy) else { return true };
        let has_luggage = knowledge.variables.has_luggage;
        let needs = self.job_from(knowledge, knowledge.next, &job, has_luggage);
        knowledge.battery.is_full() || knowledge.battery.executions_left() >= needs
    }

    /// Executions for the rest of a job and the way to the charger.
    fn job_from(&self, knowledge: &mut Knowledge, start: Block, job: &Job, has_luggage: bool) -> u32 {
        let (way, handling) = if has_luggage {
            (knowledge.routes.between(start, job.to), self.handling)
        } else {
            let first = knowledge.routes.between(start, job.from);
            (first.saturating_add(knowledge.routes.between(job.from, job.to)), 2 * self.handling)
        };
        let moves = way.saturating_mul(self.pace).saturating_add(handling);
        moves.saturating_add(self.home(knowledge, job.to))
    }

    /// Whether each half of the job starts and ends at the charger with one full battery.
    fn in_two_charges(&self, knowledge: &Knowledge, job: &Job, full: u32) -> bool {
        [job.from, job.to].into_iter().all(|block| {
            let way = knowledge.routes.to_charger(block, knowledge.charge_block);
            let there = way.saturating_mul(self.pace).saturating_add(self.handling);
            there.saturating_add(self.home(knowledge, block)) <= full
        })
    }

    /// Executions from a block to the charger, with a reserve for waiting.
    fn home(&self, knowledge: &Knowledge, from: Block) -> u32 {
        let way = knowledge.routes.to_charger(from, knowledge.charge_block);
        let reserve = RESERVE.saturating_add(way / RESERVE_SHARE);
        way.saturating_add(reserve).saturating_mul(self.pace)
    }
}
