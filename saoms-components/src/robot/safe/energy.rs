//! Whether the battery lasts.

use crate::grid::Block;
use crate::robot::{Job, RobotKnowledge};

use super::pace::Pace;

/// Moves that are kept back for waiting and making way on the way to the charger, where the battery allows. Simulated fleets of the
/// tests strand robots now and then with less than 12.
const RESERVE: u32 = 14;

/// Executions that are always kept back.
const LEAST_RESERVE: u32 = 2;

/// A robot that turned back so often during one job asks itself whether it can be done at all.
const IN_VAIN: u32 = 3;

/// A robot in charge makes way for others when its battery lasts for so many moves beyond the reserve.
const YIELD_FROM: u32 = 3;

/// What a robot found out about its battery.
#[derive(Debug)]
pub(crate) struct Energy {
    must_charge: bool,
    pace: Pace,
    /// Executions that are kept back now: less than usual on a way that takes nearly the whole battery.
    reserve: u32,
    /// How often the robot had to turn to its charger during the present job.
    returns: u32,
}

impl Default for Energy {
    fn default() -> Energy {
        Energy { must_charge: false, pace: Pace::default(), reserve: RESERVE, returns: 0 }
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
        self.must_charge
    }

    /// The robot goes to its charger.
    pub(super) fn turn_back(&mut self) {
        self.must_charge = true;
        self.returns = self.returns.saturating_add(1);
    }

    /// The robot may leave its charger.
    pub(super) fn may_go(&mut self) {
        self.must_charge = false;
    }

    /// What the robot learns about its speed.
    pub(super) fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
}

impl RobotKnowledge {
    /// Whether a robot at its charger has too little to make way for others.
    pub(super) fn holds_charger(&self) -> bool {
        if !self.is_at_charger() {
            return false;
        }
        let wanted = self.usual_reserve().saturating_add(self.energy.pace.job(YIELD_FROM, 0));
        self.battery.executions_left() < wanted.min(self.battery.executions_when_full())
    }

    /// Whether the robot need not turn to its charger yet: enough is left to do so later, or to finish its job before.
    pub(super) fn goes_on(&mut self) -> bool {
        if !self.variables.busy && self.battery.percent() <= self.charge_at {
            return false;
        }
        let left = self.battery.executions_left();
        let reserve = self.energy.reserve;
        if left >= self.home(self.next).saturating_add(reserve) {
            return true;
        }
        let Some(job) = self.job.filter(|_| self.variables.busy) else { return false };
        let rest = self.executions_for(&job, self.variables.has_luggage);
        left >= rest.saturating_add((reserve / 2).max(LEAST_RESERVE))
    }

    /// Whether the battery lasts for collecting or depositing here, and for the way to the charger.
    pub(super) fn may_handle(&mut self) -> bool {
        let home = self.home(self.next).saturating_add(LEAST_RESERVE);
        self.battery.executions_left() >= home.saturating_add(self.energy.pace.handling)
    }

    /// What the battery allows of a job that starts here and now.
    pub(super) fn means(&mut self, job: &Job) -> Means {
        if self.is_loaded {
            return Means::Never;
        }
        let (left, full) = (self.battery.executions_left(), self.battery.executions_when_full());
        let usual = self.executions_for(job, false).saturating_add(self.usual_reserve());
        if usual <= left {
            return Means::Enough;
        }
        match (self.is_within(job, full), left == full) {
            (false, _) => Means::Never,
            (true, true) => Means::Enough,
            (true, false) => Means::Needs(usual.min(full)),
        }
    }

    /// Starts a job, or goes on with it after charging: decides what to keep back. A robot that would come too low charges between collecting
    /// and depositing.
    pub(super) fn set_out(&mut self, job: &Job) {
        let next = if self.variables.has_luggage { job.to } else { job.from };
        let way = self.routes.between(self.next, next);
        let back = self.routes.between(next, self.charge_block);
        let first = self.energy.pace.job(way, 1).saturating_add(self.energy.pace.job(back, 0));
        let spare = self.battery.executions_left().saturating_sub(first);
        // Who turned back in vain dares more the next time.
        let reserve = (spare / 4 * 3).min(self.usual_reserve());
        let reserve = reserve.checked_shr(self.energy.returns).unwrap_or(0);
        self.energy.reserve = reserve.max(self.least_reserve(back));
    }

    /// Without a job nothing speaks against the usual reserve.
    pub(super) fn keep_usual_reserve(&mut self) {
        self.energy.reserve = self.usual_reserve();
        self.energy.returns = 0;
    }

    /// Whether a charged robot can go on: what is left suffices for the rest of its job, or more is not to be had.
    pub(super) fn may_leave(&mut self) -> bool {
        let Some(job) = self.job.filter(|_| self.variables.busy) else { return true };
        let needs = self.executions_for(&job, self.variables.has_luggage);
        let usual = needs.saturating_add(self.usual_reserve());
        let may = self.battery.is_full() || self.battery.executions_left() >= usual;
        if may {
            self.set_out(&job);
        }
        may
    }

    /// What the robot brings and where it has to go for that, if it is at its charger again with a full battery, turned back from there again and
    /// again, and knows its speed by now: no battery lasts for that.
    pub(super) fn strives_in_vain(&mut self) -> Option<(Job, Block)> {
        let (job, to) = (self.job?, self.destination()?);
        let charged = self.is_at_charger() && self.battery.is_full();
        if !charged || self.energy.returns < IN_VAIN {
            return None;
        }
        let full = self.battery.executions_when_full();
        let rest = Job { from: to, ..job };
        (!self.is_within(&rest, full)).then_some((job, to))
    }

    /// How many executions another robot may take for one move.
    pub(super) fn tempo(&self) -> u32 {
        let slower = self.lists.slowest_period().checked_div(self.period).unwrap_or(1).max(1);
        self.energy.pace.moving.saturating_mul(u32::try_from(slower).unwrap_or(u32::MAX))
    }

    fn usual_reserve(&self) -> u32 {
        let full = self.battery.executions_when_full();
        RESERVE.saturating_mul(self.tempo()).max(full / 4).min(full / 3)
    }

    /// Executions for the rest of a job from here, and the way to the charger.
    fn executions_for(&mut self, job: &Job, has_luggage: bool) -> u32 {
        let start = self.next;
        let executions = if has_luggage {
            self.energy.pace.job(self.routes.between(start, job.to), 1)
        } else {
            let way = self.routes.between(start, job.from);
            self.energy.pace.job(way.saturating_add(self.routes.between(job.from, job.to)), 2)
        };
        executions.saturating_add(self.home(job.to))
    }

    /// Executions for a whole job from the charger and back, where nobody is in the way.
    pub(super) fn executions_from_charger(&mut self, job: &Job) -> u32 {
        let ways = [(self.charge_block, job.from), (job.from, job.to), (job.to, self.charge_block)];
        let moves = ways.map(|(from, to)| self.routes.between(from, to));
        self.energy.pace.job_alone(moves.into_iter().fold(0, u32::saturating_add), 2)
    }

    /// Whether a full battery lasts for each half of a job, from the charger and back.
    fn is_within(&mut self, job: &Job, full: u32) -> bool {
        [job.from, job.to].into_iter().all(|block| {
            let way = self.routes.between(block, self.charge_block);
            is_within(way, self.energy.pace.moving, self.energy.pace.handling, full)
        })
    }

    /// What is kept back at least where so many moves lead to the charger.
    fn least_reserve(&self, way: u32) -> u32 {
        least_reserve(way, self.energy.pace.moving)
    }

    /// Executions from a block to the charger.
    pub(super) fn home(&mut self, from: Block) -> u32 {
        self.energy.pace.job(self.routes.between(from, self.charge_block), 0)
    }

    /// Whether the battery lasts for the way to another charger with the usual reserve, or is full.
    pub(super) fn lasts_to(&mut self, charger: Block) -> bool {
        let needs = self.home_to(charger).saturating_add(self.usual_reserve());
        self.battery.is_full() || self.battery.executions_left() >= needs
    }

    /// Executions from where the robot goes on to another charger.
    pub(super) fn home_to(&mut self, charger: Block) -> u32 {
        self.energy.pace.job(self.routes.between(self.next, charger), 0)
    }
}

/// Whether a full battery of so many executions lasts for so many moves from the charger, collecting or depositing there, and the way back, where
/// a move and handling luggage take these executions. A robot takes no job beyond that.
pub(crate) fn is_within(way: u32, moving: u32, handling: u32, full: u32) -> bool {
    let round = way.saturating_mul(2).saturating_mul(moving);
    round.saturating_add(handling).saturating_add(least_reserve(way, moving)) <= full
}

fn least_reserve(way: u32, moving: u32) -> u32 {
    LEAST_RESERVE.saturating_add(way.saturating_mul(moving) / 3)
}
