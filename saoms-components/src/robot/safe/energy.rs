//! Energy management: decides if the battery lasts.

use std::time::Duration;

use saoms_api::{Cause, Field};

use crate::grid::{Block, UNREACHABLE};
use crate::robot::lists::WAY_CLOSED;
use crate::robot::{Job, RobotKnowledge, Variables};

use super::leg::Urgency;
use super::pace::Pace;

/// Number of moves that are reserved for waiting and making way on the way to the charger, if the battery allows it.
/// With less than 12, robots in the simulated fleets of the tests sometimes ran out of battery.
pub(crate) const RESERVE: u32 = 14;

/// Number of late answers of zones for which energy is reserved.
const LATE_ANSWERS: u32 = 2;

/// Maximum number of executions that zones take to answer where all messages arrive at once.
const USUAL_LATENCY: u32 = 2;

/// Minimum reserve, in executions.
const LEAST_RESERVE: u32 = 2;

/// Number of returns to the charger during one job after which a robot checks if the job is possible at all.
const IN_VAIN: u32 = 3;

/// Number of ways to the charger after which most of a delay is forgotten.
const DELAY_MEMORY: u32 = 8;

/// Number of moves beyond the reserve that the battery has to last before a charging robot makes way for others.
const YIELD_FROM: u32 = 3;

/// State of a robot's energy management.
#[derive(Debug, Default, Clone, Field)]
pub(crate) struct Energy {
    /// Cause of the return to the charger; what happens on the way follows from it.
    pub(super) turned: Cause,
    pace: Pace,
    /// Number of returns to the charger during the current job.
    returns: u32,
    /// True if the present return is counted.
    counted: bool,
    /// Luggage for whose job the reserve was set.
    set_out_for: Option<u32>,
    /// True if the robot was free when this execution began.
    was_free: bool,
    /// Number of executions that the battery has to last for the luggage that it handed back to a master; 0 for none.
    pub(super) lacks: u32,
    /// True if its charger gave nothing not long ago.
    pub(super) gives_nothing: bool,
    /// True if it charges at another charger than its own for now.
    pub(super) borrows: bool,
    /// How it gets on with the way to its charger.
    homeward: Homeward,
    /// Number of executions by which its ways to the charger took longer than without other robots: the longest one,
    /// and less with each further way.
    delay: u32,
    /// Number of executions of the way to its charger without other robots.
    home_alone: u32,
}

/// The way of a robot that has to charge.
#[derive(Debug, Default, Clone, Field)]
struct Homeward {
    charger: Block,
    /// The least number of moves to it so far.
    least: u32,
    /// Number of executions since then.
    held_up: u32,
    /// Number of executions so far, and those of the whole way without other robots.
    taken: u32,
    alone: u32,
}

impl Homeward {
    /// Notes the number of moves that are left in this execution, and of executions without other robots.
    fn note(&mut self, charger: Block, moves: u32, alone: u32) {
        if self.taken == 0 {
            self.alone = alone;
        }
        self.taken = self.taken.saturating_add(1);
        if self.charger != charger || moves < self.least || self.taken == 1 {
            (self.charger, self.least, self.held_up) = (charger, moves, 0);
        } else {
            self.held_up = self.held_up.saturating_add(1);
        }
    }
}

/// Result of comparing the battery with a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feasibility {
    /// The battery lasts, or a full one does with a stop at the charger in between.
    Enough,
    /// The battery has to last for this number of executions.
    Needs(u32),
    /// No way leads to the job until a robot that has failed has started again.
    Later,
    /// No way leads to the job, or no full battery lasts.
    Never,
}

impl Energy {
    /// Counts a return to the charger.
    fn note_return(&mut self, must_charge: bool) {
        if must_charge && !self.counted {
            self.returns = self.returns.saturating_add(1);
        }
        self.counted = must_charge;
    }

    /// The way to the charger is over.
    fn end_way_home(&mut self, arrived: bool) {
        let Homeward { taken, alone, .. } = std::mem::take(&mut self.homeward);
        if arrived && taken > 0 {
            self.delay = (self.delay - self.delay.div_ceil(DELAY_MEMORY)).max(taken.saturating_sub(alone));
        }
    }

    /// Number of executions that a move takes.
    pub(super) fn executions_of_move(&self) -> u32 {
        self.pace.moving
    }

    /// Number of executions for which a robot that has to charge has not come closer to its charger, beyond those of
    /// two moves.
    pub(super) fn held_up(&self) -> u32 {
        self.homeward.held_up.saturating_sub(2 * self.pace.moving)
    }

    /// True if collecting or depositing takes time.
    pub(super) fn handles_long(&self) -> bool {
        self.pace.handling > 1
    }

    /// Measured speed of the robot.
    pub(in crate::robot) fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
}

impl RobotKnowledge {
    /// Sends the robot to its charger.
    pub(super) fn turn_back(&mut self) {
        self.must_charge = true;
        self.energy.note_return(true);
    }

    /// Lets the robot leave its charger.
    pub(super) fn may_go(&mut self) {
        self.must_charge = false;
        self.energy.note_return(false);
    }

    /// Looks at the battery before the loops decide.
    pub(in crate::robot) fn measure_energy(&mut self) {
        if self.trouble.is_none() {
            self.energy.pace.note_action(self.polled);
        }
        if self.is_at_charger() {
            // What a loop asked for is done.
            self.said_homeward = self.variables.ready_to_go_under_charge;
        }
        self.asked_to_charge = self.is_asked_home();
        self.lasts = self.executions_left();
        let way = self.routes.between(self.next, self.charge_block);
        self.way_home = self.home_along(way);
        self.energy.home_alone = self.energy.pace.job_alone(way, 0);
        if self.must_charge && !self.is_at_charger() {
            let alone = self.energy.pace.job_alone(way, 0);
            self.energy.homeward.note(self.charge_block, way, alone);
        } else {
            self.energy.end_way_home(self.is_at_charger());
        }
        self.energy.was_free = self.takes_jobs();
    }

    /// Follows what the loops decided about the robot's jobs and its battery, whichever loops it has.
    pub(in crate::robot) fn follow_decisions(&mut self) {
        self.energy.note_return(self.must_charge);
        match self.job {
            Some(job) if self.energy.set_out_for != Some(job.luggage) => self.set_out(&job),
            Some(_) => {}
            None => {
                self.energy.set_out_for = None;
                if self.energy.was_free && self.takes_jobs() {
                    self.keep_usual_reserve();
                }
            }
        }
        if !self.is_bound() {
            self.energy.pace.note_end(self.leg_now().1 != Urgency::None);
        }
    }

    /// True if it is awake, without a job, and free to take one.
    fn takes_jobs(&self) -> bool {
        let Variables { asleep, critical, .. } = self.variables;
        let works = self.hardware.running().is_some();
        self.is_free() && self.job.is_none() && !(asleep || critical || self.must_charge || self.relieved || works)
    }

    /// Number of executions that the battery lasts.
    pub(in crate::robot) fn executions_left(&self) -> u32 {
        self.battery.executions_left(self.period(), self.energy.pace.moving)
    }

    /// Number of executions that a full battery lasts.
    pub(super) fn executions_when_full(&self) -> u32 {
        self.battery.executions_when_full(self.period(), self.energy.pace.moving)
    }

    fn period(&self) -> Duration {
        Duration::from_micros(self.period)
    }

    /// True if a robot at its charger, or about to arrive there, has too little energy to make way for others, or
    /// shares it with others that can wait.
    pub(super) fn holds_charger(&self) -> bool {
        // One that promised to make way before it arrives would leave without any gain, and come back, and so on.
        if self.next != self.charge_block {
            return false;
        }
        let wanted = self.least_usual_reserve().saturating_add(self.energy.pace.job(YIELD_FROM, 0));
        self.executions_left() < wanted.min(self.executions_when_full()) || self.keeps_shared_charger()
    }

    /// True if three quarters of the battery are full.
    pub(super) fn is_well_charged(&self) -> bool {
        self.battery.is_full() || self.executions_left() >= self.executions_when_full() / 4 * 3
    }

    /// True if the robot is well charged, and its battery lasts for luggage that waits for it alone to be charged.
    pub(super) fn has_enough(&self) -> bool {
        let left = self.executions_left();
        let requests = self.lists.requests.open().iter().filter(|request| request.needs != WAY_CLOSED);
        let waiting = requests.map(|request| request.needs).min().unwrap_or(0);
        self.battery.is_full() || self.is_well_charged() && left >= waiting && left >= self.energy.lacks
    }

    /// True if the robot need not return to its charger yet: the battery lasts to do so later, or to finish its job
    /// before.
    pub(super) fn goes_on(&mut self) -> bool {
        if !self.variables.busy && (self.battery.percent() <= self.charge_at || self.asked_to_charge) {
            return false;
        }
        let left = self.executions_left();
        let reserve = self.reserve;
        // What it is about to do here takes from the reserve, too.
        let stands = self.next == self.block && self.hardware.running().is_none();
        let is_there = stands && self.destination().is_some_and(|to| self.reaches(to, self.block));
        let handling = if is_there && self.energy.handles_long() { self.handling_takes() } else { 0 };
        if left >= self.home(self.next).saturating_add(reserve).saturating_add(handling) {
            return true;
        }
        let Some(job) = self.job.filter(|_| self.variables.busy) else { return false };
        let rest = self.executions_for(&job, self.variables.has_luggage);
        left >= rest.saturating_add((reserve / 2).max(LEAST_RESERVE))
    }

    /// True if the battery lasts for collecting or depositing here, and for the way to the charger.
    pub(super) fn may_handle(&mut self) -> bool {
        let home = self.home(self.next).saturating_add(LEAST_RESERVE);
        self.executions_left() >= home.saturating_add(self.handling_takes())
    }

    /// Number of executions of driving that collecting or depositing takes from the battery.
    fn handling_takes(&self) -> u32 {
        self.battery.as_driving(self.energy.pace.handling, self.period(), self.energy.pace.moving)
    }

    /// Compares the battery with a job that starts here and now.
    pub(super) fn means(&mut self, job: &Job) -> Feasibility {
        if self.loaded {
            return Feasibility::Never;
        }
        let (left, full) = (self.executions_left(), self.executions_when_full());
        let usual = self.executions_for(job, false).saturating_add(self.usual_reserve());
        if usual <= left {
            return Feasibility::Enough;
        }
        // A full battery lasts once zones answer soon again.
        let is_late = self.latency() > USUAL_LATENCY && usual > full;
        match (self.is_within(job, full), left == full) {
            (false, _) if self.may_open_for(job) => Feasibility::Later,
            (false, _) => Feasibility::Never,
            (true, true) if !is_late => Feasibility::Enough,
            (true, _) => Feasibility::Needs(usual.min(full)),
        }
    }

    /// True if no path leads to a job, or from where it begins to where it ends.
    pub(super) fn is_cut_off_from(&mut self, job: &Job) -> bool {
        self.moves(self.next, job, false) == UNREACHABLE
    }

    /// True if a way leads to a job, through it and to the charger once robots that have failed have started again.
    fn may_open_for(&mut self, job: &Job) -> bool {
        let stops = self.stops_of(job);
        let ends = [job.from, job.to];
        let blocks = if stops.is_empty() { &ends[..] } else { &stops[..] };
        let ways: Vec<Block> = [&[self.next], blocks, &[self.charge_block]].concat();
        let mut is_closed = false;
        ways.windows(2).all(|way| {
            let is_open = self.routes.between(way[0], way[1]) != UNREACHABLE;
            is_closed |= !is_open;
            is_open || self.routes.may_open(way[0], way[1])
        }) && is_closed
    }

    /// Number of moves from a block through the whole job, or to the end of one whose luggage is on board.
    fn moves(&mut self, start: Block, job: &Job, has_luggage: bool) -> u32 {
        let stops = self.stops_of(job);
        let ends = [job.from, job.to];
        let ways: &[Block] = match has_luggage {
            _ if !stops.is_empty() => &stops,
            true => &ends[1..],
            false => &ends,
        };
        let mut at = start;
        let legs = ways.iter().map(|to| self.routes.between(std::mem::replace(&mut at, *to), *to));
        legs.fold(0, u32::saturating_add)
    }

    /// Blocks to visit for a job; none if it is luggage.
    fn stops_of(&self, job: &Job) -> Vec<Block> {
        match self.job {
            Some(own) if own.luggage == job.luggage => self.stops.clone(),
            _ => self.lists.requests.stops(job.luggage).to_vec(),
        }
    }

    /// Sets the reserve at the start of a job, or after charging. A robot that would arrive with too little energy
    /// charges between collecting and depositing.
    pub(super) fn set_out(&mut self, job: &Job) {
        let next = self.stops.first().copied().unwrap_or(if self.variables.has_luggage { job.to } else { job.from });
        let way = self.routes.between(self.next, next);
        let back = self.routes.between(next, self.charge_block);
        let first = self.energy.pace.job(way, 1).saturating_add(self.energy.pace.job(back, 0));
        let spare = self.executions_left().saturating_sub(first);
        if self.energy.set_out_for != Some(job.luggage) {
            self.energy.returns = 0;
        }
        // A robot that returned in vain uses a smaller reserve the next time.
        let reserve = (spare / 4 * 3).min(self.usual_reserve());
        let reserve = reserve.checked_shr(self.energy.returns).unwrap_or(0);
        self.reserve = reserve.max(self.least_reserve(back));
        self.energy.set_out_for = Some(job.luggage);
    }

    /// Resets the reserve to the usual one, for a robot without a job.
    pub(super) fn keep_usual_reserve(&mut self) {
        self.reserve = self.usual_reserve();
        self.energy.returns = 0;
    }

    /// True if a charged robot can continue: the battery lasts for the rest of its job, or is full.
    pub(super) fn may_leave(&mut self) -> bool {
        let Some(job) = self.job.filter(|_| self.variables.busy) else { return true };
        let needs = self.executions_for(&job, self.variables.has_luggage);
        let usual = needs.saturating_add(self.usual_reserve());
        let may = self.battery.is_full() || self.executions_left() >= usual;
        if may {
            self.set_out(&job);
        }
        may
    }

    /// Job and destination of a robot for whose job no battery lasts: it is at its charger with a full battery after
    /// several returns, and knows its speed by now.
    pub(super) fn strives_in_vain(&mut self) -> Option<(Job, Block)> {
        let (job, to) = (self.job?, self.destination()?);
        let charged = self.is_at_charger() && self.battery.is_full();
        if !charged || self.energy.returns < IN_VAIN {
            return None;
        }
        let full = self.executions_when_full();
        let rest = Job { from: to, ..job };
        (!self.is_within(&rest, full)).then_some((job, to))
    }

    /// Number of executions that another robot may take for one move.
    pub(super) fn tempo(&self) -> u32 {
        let slower = self.lists.slowest_period().checked_div(self.period).unwrap_or(1).max(1);
        self.energy.pace.moving.saturating_mul(u32::try_from(slower).unwrap_or(u32::MAX))
    }

    /// True if half of the reserve for the way to its charger is used up.
    pub(super) fn is_exhausted(&self) -> bool {
        self.urgency_of_charging() >= Urgency::Exhausted
    }

    /// How urgent the way to its charger is: a robot that can still wait lets others go first that cannot.
    pub(super) fn urgency_of_charging(&self) -> Urgency {
        let half = self.usual_reserve() / 2;
        if self.lasts <= self.energy.home_alone.saturating_add(half) {
            Urgency::NearlyEmpty
        } else if self.lasts <= self.way_home.saturating_add(half) {
            Urgency::Exhausted
        } else {
            Urgency::Energy
        }
    }

    pub(super) fn usual_reserve(&self) -> u32 {
        // Where robots crowd the ways to their chargers, each one has seen how much longer these can take.
        let delay = self.energy.delay.saturating_add(self.energy.delay / 4);
        self.least_usual_reserve().max(delay.min(self.executions_when_full() / 2))
    }

    /// The reserve where no other robots have been in the way: one that charges does not keep others waiting for more.
    fn least_usual_reserve(&self) -> u32 {
        let full = self.executions_when_full();
        let usual = RESERVE.saturating_mul(self.tempo()).max(full / 4).min(full / 3);
        // Where zones answer late, robots that meet wait for them.
        usual.saturating_add(LATE_ANSWERS * self.latency().saturating_sub(USUAL_LATENCY))
    }

    /// Number of executions for the rest of a job from here, and the way to the charger.
    fn executions_for(&mut self, job: &Job, has_luggage: bool) -> u32 {
        let moves = self.moves(self.next, job, has_luggage);
        let executions = self.energy.pace.job(moves, if has_luggage { 1 } else { 2 });
        executions.saturating_add(self.home(job.to))
    }

    /// Number of executions for a whole job from the charger and back, without other robots in the way.
    pub(super) fn executions_from_charger(&mut self, job: &Job) -> u32 {
        let moves = self.moves(self.charge_block, job, false);
        let home = self.routes.between(job.to, self.charge_block);
        self.energy.pace.job_alone(moves.saturating_add(home), 2)
    }

    /// True if a full battery lasts for each half of a job, from the charger and back.
    fn is_within(&mut self, job: &Job, full: u32) -> bool {
        let stops = self.stops_of(job);
        [job.from, job.to].into_iter().chain(stops).all(|block| {
            let way = self.routes.between(block, self.charge_block);
            is_within(way, self.energy.pace.moving, self.energy.pace.handling, full)
        })
    }

    /// Minimum reserve for a way of `way` moves to the charger.
    fn least_reserve(&self, way: u32) -> u32 {
        least_reserve(way, self.energy.pace.moving)
    }

    /// Number of executions from a block to the charger.
    pub(super) fn home(&mut self, from: Block) -> u32 {
        let way = self.routes.between(from, self.charge_block);
        self.home_along(way)
    }

    /// Number of executions of a way to a charger, on which the robot first waits for grants.
    fn home_along(&self, way: u32) -> u32 {
        // One that is on the way home already has them.
        let has_grants = self.must_charge && self.zones.as_ref().is_some_and(|zones| zones.may_drive());
        // More than half of a full battery for waiting cannot be had: a robot that planned with it would never leave
        // its charger.
        let (waiting, alone) = (self.energy.pace.job(way, 0), self.energy.pace.job_alone(way, 0));
        let executions = waiting.min(alone.max(self.executions_when_full() / 2));
        executions.saturating_add(if way == 0 || has_grants { 0 } else { self.latency() })
    }

    /// Number of executions that zones take to answer; 0 where there are none.
    fn latency(&self) -> u32 {
        self.zones.as_ref().map_or(0, |zones| zones.latency())
    }

    /// True if the battery lasts for the way to another charger with the usual reserve, or is full. While zones answer
    /// late that reserve is large, and a full battery waits until they answer soon again.
    pub(super) fn lasts_to(&mut self, charger: Block) -> bool {
        let needs = self.home_to(charger).saturating_add(self.usual_reserve());
        let is_full = self.battery.is_full() && self.latency() <= USUAL_LATENCY;
        is_full || self.executions_left() >= needs
    }

    /// Number of executions from the robot's next block to another charger.
    pub(super) fn home_to(&mut self, charger: Block) -> u32 {
        let way = self.routes.between(self.next, charger);
        self.home_along(way)
    }
}

/// True if a full battery of `full` executions lasts for `way` moves from the charger, collecting or depositing there,
/// and the way back. `moving` and `handling` are the executions of a move and of handling luggage. A robot takes no job
/// beyond that.
pub(crate) fn is_within(way: u32, moving: u32, handling: u32, full: u32) -> bool {
    let round = way.saturating_mul(2).saturating_mul(moving);
    round.saturating_add(handling).saturating_add(least_reserve(way, moving)) <= full
}

fn least_reserve(way: u32, moving: u32) -> u32 {
    LEAST_RESERVE.saturating_add(way.saturating_mul(moving) / 3)
}
