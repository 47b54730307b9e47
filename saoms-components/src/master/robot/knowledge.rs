use std::cmp::Ordering;
use std::collections::BTreeMap;

use saoms_api::host::cdr::{DecodeError, Reader, Writer};
use saoms_api::host::declaration::ConstText;
use saoms_api::{Cause, Context, Extras, Field, Knowledge, Subscription, Time};

use super::work::Work;
use crate::gone::Gone;
use crate::messages::{EnvironmentEvent, EventLuggage, Fault, RobotList};
use crate::robot::Policy;
use crate::validation::MessageValidator;

/// Knowledge of the master of the robots: the active robots, and the shifts for which more of them are needed.
#[derive(Debug, Knowledge)]
#[knowledge(name = "saoms.MasterRobot")]
pub struct MasterRobotKnowledge {
    /// Number of expected pieces of luggage for which one robot is woken.
    #[entry]
    pub pieces_per_robot: u32,
    /// Number of periods after which the robots of a shift are sent to charge again.
    #[entry]
    pub counter: u32,
    /// Number of robots.
    #[entry]
    pub robots: u32,
    /// Number of sleeping robots.
    #[entry]
    pub asleep: u32,
    /// Number of robots that were woken for luggage that is still expected.
    #[entry]
    pub on_shift: u32,
    /// The active robots, by number, as they announced themselves.
    #[entry]
    pub(super) active: ActiveRobots,
    /// Robots that were woken (`true`) or sent to charge and have not reacted yet.
    pub(super) called: BTreeMap<u32, bool>,
    /// The shifts, in the order in which they were woken.
    pub shifts: Vec<Shift>,
    /// Number of robots whose shift is over, and that are awake because there is work for them.
    pub(super) due: u32,
    /// Open and announced luggage.
    pub(super) work: Work,
    /// Number of active robots of the policy `classic`.
    classic: u32,
    /// Checks what robots say.
    pub(super) validator: MessageValidator,
    /// Robots that are off the floor.
    pub(super) gone: Gone,
    #[extras]
    extras: Extras,
}

/// Robots that were woken for the same luggage: the manual's `MRcounter`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub struct Shift {
    /// Number of robots.
    pub robots: u32,
    /// Number of the master's periods for which they are still needed.
    pub left: u32,
    /// Cause of the shift.
    pub cause: Cause,
}

/// The active robots, by number. As an entry it is a list of their messages.
#[derive(Debug, Default)]
pub(super) struct ActiveRobots(pub(super) BTreeMap<u32, RobotList>);

impl Field for ActiveRobots {
    const TYPE: ConstText = <Vec<RobotList> as Field>::TYPE;
    const LEAST_SIZE: usize = <Vec<RobotList> as Field>::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        let all: Vec<RobotList> = self.0.values().cloned().collect();
        all.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let all = Vec::<RobotList>::read(reader)?;
        Ok(ActiveRobots(all.into_iter().map(|robot| (robot.robot, robot)).collect()))
    }
}

impl MasterRobotKnowledge {
    /// Initial knowledge, without any robot.
    pub fn new(pieces_per_robot: u32, counter: u32) -> MasterRobotKnowledge {
        MasterRobotKnowledge {
            pieces_per_robot,
            counter,
            robots: 0,
            asleep: 0,
            on_shift: 0,
            active: ActiveRobots::default(),
            called: BTreeMap::new(),
            shifts: Vec::new(),
            due: 0,
            work: Work::default(),
            classic: 0,
            validator: MessageValidator::default(),
            gone: Gone::default(),
            extras: Extras::default(),
        }
    }

    /// Handles what robots said about themselves. All loops rely on it, so that the master hears it by itself.
    pub(super) fn hear_robots(
        &mut self,
        robots: Subscription<RobotList>,
        faults: Subscription<Fault>,
        context: &mut Context<'_>,
    ) {
        for (header, fault) in context.receive(&faults).with_headers() {
            if fault.silences() && self.validator.accepts(fault, header, None, context) {
                self.gone.note(fault, header);
                self.hear(&RobotList { robot: fault.robot, active: false, ..RobotList::default() });
            }
        }
        for (header, robot) in context.receive(&robots).with_headers() {
            if self.validator.accepts(robot, header, None, context) && self.gone.hears(robot, header) {
                self.hear(robot);
            }
        }
    }

    /// Handles what is said about luggage.
    pub(super) fn hear_luggage(
        &mut self,
        events: Subscription<EnvironmentEvent>,
        luggage: Subscription<EventLuggage>,
        context: &mut Context<'_>,
    ) {
        let now = context.now();
        for (header, event) in context.receive(&events).with_headers() {
            self.work.hear_events(event, now, header.cause);
        }
        for (header, said) in context.receive(&luggage).with_headers() {
            // Those who act on it report what is wrong.
            if self.validator.judge(said, header, None, context).is_ok() {
                self.work.hear_luggage(said, now, header.cause);
            }
        }
    }

    /// Handles a report of a robot about itself.
    pub fn hear(&mut self, robot: &RobotList) {
        let number = robot.robot;
        let before = match robot.active {
            true => self.active.0.insert(number, robot.clone()),
            false => self.active.0.remove(&number),
        };
        let change = |number: u32, is_one: fn(&RobotList) -> bool| {
            let now = u32::from(robot.active && is_one(robot));
            (number + now).saturating_sub(before.as_ref().map_or(0, |before| u32::from(is_one(before))))
        };
        self.asleep = change(self.asleep, |robot| robot.asleep);
        self.classic = change(self.classic, |robot| robot.policy == Policy::Classic);
        if !robot.active {
            self.work.forget(number);
        }
        let done = |awake: &bool| !robot.active || *awake != robot.asleep;
        if self.called.get(&number).is_some_and(done) {
            self.called.remove(&number);
        }
        self.robots = count(self.active.0.len());
    }

    /// The active robots, by number.
    pub fn active(&self) -> impl Iterator<Item = &RobotList> + Clone {
        self.active.0.values()
    }

    /// True if the robots wake and sleep by the counter alone, as the manual's do.
    pub(super) fn counts_alone(&self) -> bool {
        self.classic > 0
    }

    /// The robot to wake next, or to call back on its way to sleep: the one with the highest battery level, less 1 %
    /// for each block to the closest luggage that waits; then the one with the lowest number. One that still has a job
    /// comes last.
    pub fn next_to_awake(&self) -> Option<u32> {
        let far = if self.counts_alone() { |_: &Work, _: &RobotList| 0.0 } else { way_to_work };
        let right = |one: &RobotList| RobotList { battery: one.battery - far(&self.work, one), ..one.clone() };
        let all = self.callable(RobotList::can_be_woken).chain(self.on_the_way_to_sleep()).map(right);
        let has_job = |robot: &RobotList| self.work.has_job(robot.robot);
        all.max_by(|one, other| has_job(other).cmp(&has_job(one)).then(by_right(one, other))).map(|one| one.robot)
    }

    /// The robot to send to charge next: the one with the lowest battery level, then the one with the highest number.
    /// While there is other luggage, one that brings some stays, unless the counter alone decides.
    pub fn next_to_charge(&self) -> Option<u32> {
        let works = |robot: &RobotList| !robot.asleep && !robot.in_charge && !robot.is_out_of_battery();
        let has_work = !self.counts_alone() && self.needed_for_work() > 0;
        let stays = |robot: &&RobotList| has_work && self.work.has_job(robot.robot);
        let others = self.callable(works).filter(|robot| !stays(robot));
        others.min_by(|one, other| by_right(one, other)).map(|one| one.robot)
    }

    /// Number of pieces that wait or are announced.
    fn needed_for_work(&self) -> u32 {
        self.work.waiting().saturating_add(self.work.expected())
    }

    /// Number of robots that may be sent to charge: all that are awake, as long as no luggage waits or is announced, or
    /// those that are free beyond that luggage.
    pub(super) fn surplus(&self) -> u32 {
        let needed = self.needed_for_work();
        let awake = self.callable(|robot| !robot.asleep);
        let free = awake.filter(|robot| needed == 0 || !self.work.has_job(robot.robot)).count();
        count(free).saturating_sub(needed)
    }

    /// Number of robots that luggage needs that nobody has taken for the time of the counter, beyond those that are
    /// awake and free or on their way, and the cause of the oldest piece.
    pub(super) fn neglects(&self, before: Time) -> Option<(u32, u32, Cause)> {
        let (pieces, cause) = self.work.neglected(before)?;
        let comes = |robot: &&RobotList| match self.called.get(&robot.robot) {
            Some(is_woken) => *is_woken,
            None => !robot.asleep && !self.work.has_job(robot.robot),
        };
        let needed = pieces.div_ceil(self.pieces_per_robot).saturating_sub(count(self.active().filter(comes).count()));
        let sleepers = self.callable(RobotList::can_be_woken).count();
        let needed = needed.min(count(sleepers + self.on_the_way_to_sleep().count()));
        (needed > 0).then_some((pieces, needed, cause))
    }

    /// Robots that were sent to sleep and do not sleep yet, since they finish a job or drive to their chargers.
    fn on_the_way_to_sleep(&self) -> impl Iterator<Item = &RobotList> {
        let is_sent = |robot: &RobotList| self.called.get(&robot.robot) == Some(&false);
        let may = !self.counts_alone();
        self.active().filter(move |robot| may && is_sent(robot) && robot.can_work())
    }

    fn callable(&self, which: impl Fn(&RobotList) -> bool) -> impl Iterator<Item = &RobotList> {
        self.active().filter(move |robot| which(robot) && !self.called.contains_key(&robot.robot))
    }

    /// Records that a robot was called to wake or to charge. One that is called back before it sleeps has not to react.
    pub fn note_call(&mut self, robot: u32, awake: bool) {
        if !(awake && self.called.remove(&robot) == Some(false)) {
            self.called.insert(robot, awake);
        }
    }

    /// Counts a period down and ends the shifts that are over; returns their number of robots and their cause.
    pub fn end_shifts(&mut self) -> (u32, Cause) {
        let (mut ended, mut why) = (0, Cause::default());
        self.shifts.retain_mut(|shift| {
            shift.left = shift.left.saturating_sub(1);
            if shift.left == 0 {
                ended += shift.robots;
                why = shift.cause;
            }
            shift.left > 0
        });
        self.count_shifts();
        (ended, why)
    }

    /// Starts a shift.
    pub fn start_shift(&mut self, robots: u32, cause: Cause) {
        if robots > 0 {
            self.shifts.push(Shift { robots, left: self.counter, cause });
        }
        self.count_shifts();
    }

    fn count_shifts(&mut self) {
        self.on_shift = self.shifts.iter().map(|shift| shift.robots).sum();
    }
}

/// Order in which robots are woken: highest battery level first, then lowest number.
fn by_right(one: &RobotList, other: &RobotList) -> Ordering {
    one.battery.total_cmp(&other.battery).then(other.robot.cmp(&one.robot))
}

fn way_to_work(work: &Work, robot: &RobotList) -> f64 {
    f64::from(work.distance(robot.charger))
}

fn count(robots: usize) -> u32 {
    u32::try_from(robots).unwrap_or(u32::MAX)
}
