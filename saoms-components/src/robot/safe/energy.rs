//! Whether the battery lasts.

use crate::grid::{Block, UNREACHABLE};
use crate::robot::{Body, Job, Knowledge};

use super::pace::Pace;

/// Moves that are kept back for waiting and making way on the way to the charger, where the battery allows. Simulated fleets of the
/// tests strand robots now and then with less than 12.
const RESERVE: u32 = 14;

/// Executions that are always kept back.
const LEAST_RESERVE: u32 = 2;

/// A robot in charge makes way for others when its battery lasts for so many executions.
const YIELD_FROM: u32 = 15;

/// A robot's eye on its battery.
#[derive(Debug)]
pub(super) struct Energy {
    must_charge: bool,
    stranded: bool,
    pace: Pace,
    /// Executions that are kept back now: less than usual on a way that takes nearly the whole battery.
    reserve: u32,
}

impl Default for Energy {
    fn default() -> Energy {
        Energy { must_charge: false, stranded: false, pace: Pace::default(), reserve: RESERVE }
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

    /// What the robot learns about its speed.
    pub(super) fn pace(&mut self) -> &mut Pace {
        &mut self.pace
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
        let left = knowledge.battery.executions_left();
        if knowledge.battery.is_empty() && !self.stranded {
            self.stranded = true;
            body.context.count("stranded", 1);
            body.context.log(
                saoms_api::Level::Error,
                format_args!("is stranded at {}: its battery is empty", knowledge.block),
            );
        } else if !self.must_charge
            && left < self.home(knowledge, knowledge.next).saturating_add(self.reserve)
        {
            self.must_charge = true;
            let (name, battery) = (&knowledge.name, &knowledge.battery);
            body.context.console(format_args!("{name} has low battery and is going under charge..."));
            body.context.info(format_args!("has low battery ({battery} %): goes to charge"));
        }
    }

    /// What the battery allows of a job that starts here and now.
    pub(super) fn means(&self, knowledge: &mut Knowledge, job: &Job) -> Means {
        let (left, full) = (knowledge.battery.executions_left(), knowledge.battery.executions_when_full());
        let usual = self.job(knowledge, job, false).saturating_add(self.usual_reserve(knowledge));
        if usual <= left {
            return Means::Enough;
        }
        match (self.is_within(knowledge, job, full), left == full) {
            (false, _) => Means::Never,
            (true, true) => Means::Enough,
            (true, false) => Means::Needs(usual.min(full)),
        }
    }

    /// Starts a job, or goes on with it after charging: decides what to keep back. A robot that would come too low charges between collecting
    /// and depositing.
    pub(super) fn set_out(&mut self, knowledge: &mut Knowledge, job: &Job) {
        let next = if knowledge.variables.has_luggage { job.to } else { job.from };
        let way = knowledge.routes.between(knowledge.next, next);
        let first = self.pace.job(way, 1).saturating_add(self.home(knowledge, next));
        let spare = knowledge.battery.executions_left().saturating_sub(first);
        self.reserve = (spare / 4 * 3).clamp(LEAST_RESERVE, self.usual_reserve(knowledge));
    }

    /// Without a job nothing speaks against the usual reserve.
    pub(super) fn is_free(&mut self, knowledge: &Knowledge) {
        self.reserve = self.usual_reserve(knowledge);
    }

    /// Whether a charged robot can go on: what is left suffices for the rest of its job, or more is not to be had.
    fn may_leave(&mut self, knowledge: &mut Knowledge) -> bool {
        let Some(job) = knowledge.job.filter(|_| knowledge.variables.busy) else { return true };
        let needs = self.job(knowledge, &job, knowledge.variables.has_luggage);
        let usual = needs.saturating_add(self.usual_reserve(knowledge));
        let may = knowledge.battery.is_full() || knowledge.battery.executions_left() >= usual;
        if may {
            self.set_out(knowledge, &job);
        }
        may
    }

    /// How many executions another robot may take for one move.
    pub(super) fn tempo(&self, knowledge: &Knowledge) -> u32 {
        let slower = knowledge.lists.slowest_period().checked_div(knowledge.period).unwrap_or(1).max(1);
        self.pace.moving.saturating_mul(u32::try_from(slower).unwrap_or(u32::MAX))
    }

    fn usual_reserve(&self, knowledge: &Knowledge) -> u32 {
        let full = knowledge.battery.executions_when_full();
        RESERVE.saturating_mul(self.tempo(knowledge)).max(full / 4).min(full / 3)
    }

    /// Executions for the rest of a job from here, and the way to the charger.
    fn job(&self, knowledge: &mut Knowledge, job: &Job, has_luggage: bool) -> u32 {
        let start = knowledge.next;
        let executions = if has_luggage {
            self.pace.job(knowledge.routes.between(start, job.to), 1)
        } else {
            let way = knowledge.routes.between(start, job.from);
            self.pace.job(way.saturating_add(knowledge.routes.between(job.from, job.to)), 2)
        };
        executions.saturating_add(self.home(knowledge, job.to))
    }

    /// Whether a full battery lasts for the whole job, or for each half from the charger and back, where nothing is in the way.
    fn is_within(&self, knowledge: &mut Knowledge, job: &Job, full: u32) -> bool {
        let Pace { moving, handling, .. } = self.pace;
        let limit = full.saturating_sub(LEAST_RESERVE);
        let executions =
            |moves: u32, handlings: u32| moves.saturating_mul(moving).saturating_add(handlings * handling);
        let charger = knowledge.charge_block;
        let [out, back] = [job.from, job.to].map(|block| knowledge.routes.to_charger(block, charger));
        let across = knowledge.routes.between(job.from, job.to);
        let whole = out.saturating_add(across).saturating_add(back);
        let half = |way: u32| executions(way.saturating_mul(2), 1) <= limit;
        executions(whole, 2) <= limit || (across != UNREACHABLE && half(out) && half(back))
    }

    /// Executions from a block to the charger.
    fn home(&self, knowledge: &mut Knowledge, from: Block) -> u32 {
        self.pace.job(knowledge.routes.to_charger(from, knowledge.charge_block), 0)
    }
}
