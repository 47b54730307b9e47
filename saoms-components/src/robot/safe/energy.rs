//! Whether the battery lasts.

use saoms_api::{Failure, Level};

use crate::grid::Block;
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
    /// How often the robot had to turn to its charger during the present job.
    returns: u32,
}

impl Default for Energy {
    fn default() -> Energy {
        Energy { must_charge: false, stranded: false, pace: Pace::default(), reserve: RESERVE, returns: 0 }
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
            if charging && !knowledge.variables.in_charge {
                body.context.info(format_args!("charges (battery {} %)", knowledge.battery));
            }
            if charging {
                knowledge.battery.charge();
            } else if knowledge.variables.in_charge {
                body.context.info(format_args!("is fully charged"));
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
    pub(super) fn watch(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        let knowledge = &mut *body.knowledge;
        if knowledge.is_at_charger() {
            if self.must_charge && self.may_leave(knowledge) {
                self.must_charge = false;
            }
            return Ok(());
        }
        let left = knowledge.battery.executions_left();
        if knowledge.battery.is_empty() && !self.stranded {
            self.stranded = true;
            // Others go around it from now on.
            body.topics.say_robot(body.context, knowledge, true)?;
            body.context.count("stranded", 1);
            body.context
                .log(Level::Error, format_args!("is stranded at {}: its battery is empty", knowledge.block));
        } else if !self.must_charge && !self.goes_on(knowledge, left) {
            self.must_charge = true;
            self.returns = self.returns.saturating_add(1);
            let (name, battery) = (&knowledge.name, &knowledge.battery);
            body.context.console(format_args!("{name} has low battery and is going under charge..."));
            body.context.info(format_args!("has low battery ({battery} %): goes to charge"));
        }
        Ok(())
    }

    /// Whether the robot need not turn to its charger yet: enough is left to do so later, or to finish its job before.
    fn goes_on(&self, knowledge: &mut Knowledge, left: u32) -> bool {
        if left >= self.home(knowledge, knowledge.next).saturating_add(self.reserve) {
            return true;
        }
        let Some(job) = knowledge.job.filter(|_| knowledge.variables.busy) else { return false };
        let rest = self.job(knowledge, &job, knowledge.variables.has_luggage);
        left >= rest.saturating_add((self.reserve / 2).max(LEAST_RESERVE))
    }

    /// Whether the battery lasts for collecting or depositing here, and for the way to the charger.
    pub(super) fn may_handle(&self, knowledge: &mut Knowledge) -> bool {
        let home = self.home(knowledge, knowledge.next).saturating_add(LEAST_RESERVE);
        knowledge.battery.executions_left() >= home.saturating_add(self.pace.handling)
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
        let back = knowledge.routes.between(next, knowledge.charge_block);
        let first = self.pace.job(way, 1).saturating_add(self.pace.job(back, 0));
        let spare = knowledge.battery.executions_left().saturating_sub(first);
        // Who turned back in vain dares more the next time.
        let reserve = (spare / 4 * 3).min(self.usual_reserve(knowledge));
        let reserve = reserve.checked_shr(self.returns).unwrap_or(0);
        self.reserve = reserve.max(self.least_reserve(back));
    }

    /// Without a job nothing speaks against the usual reserve.
    pub(super) fn is_free(&mut self, knowledge: &Knowledge) {
        self.reserve = self.usual_reserve(knowledge);
        self.returns = 0;
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

    /// Whether a full battery lasts for each half of a job, from the charger and back.
    fn is_within(&self, knowledge: &mut Knowledge, job: &Job, full: u32) -> bool {
        [job.from, job.to].into_iter().all(|block| {
            let way = knowledge.routes.between(block, knowledge.charge_block);
            let round = way.saturating_mul(2).saturating_mul(self.pace.moving);
            round.saturating_add(self.pace.handling).saturating_add(self.least_reserve(way)) <= full
        })
    }

    /// What is kept back at least where so many moves lead to the charger.
    fn least_reserve(&self, way: u32) -> u32 {
        LEAST_RESERVE.saturating_add(way.saturating_mul(self.pace.moving) / 3)
    }

    /// Executions from a block to the charger.
    fn home(&self, knowledge: &mut Knowledge, from: Block) -> u32 {
        self.pace.job(knowledge.routes.between(from, knowledge.charge_block), 0)
    }
}
