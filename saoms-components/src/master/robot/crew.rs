use std::cmp::Ordering;
use std::collections::BTreeMap;

use saoms_api::{Cause, Extras, Knowledge};

use crate::messages::RobotList;

/// What the master of the robots knows: who there is, and for how long more of them are needed.
#[derive(Debug, Knowledge)]
#[knowledge(name = "saoms.MasterRobot")]
pub struct MasterRobotKnowledge {
    /// For how many expected pieces of luggage one robot is awaked.
    #[entry]
    pub pieces_per_robot: u32,
    /// After how many periods as many robots are sent under charge again.
    #[entry]
    pub counter: u32,
    /// How many robots there are.
    #[entry]
    pub robots: u32,
    /// How many of them are asleep.
    #[entry]
    pub asleep: u32,
    /// How many it awaked for luggage that is still expected.
    #[entry]
    pub on_shift: u32,
    /// Those that are active, by number.
    crew: BTreeMap<u32, RobotList>,
    /// Who was awaked (`true`) or sent under charge and has not done so yet.
    called: BTreeMap<u32, bool>,
    /// What was awaked together, in the order of awaking.
    pub shifts: Vec<Shift>,
    #[extras]
    extras: Extras,
}

/// Robots that were awaked for the same luggage: the manual's `MRcounter`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shift {
    /// How many.
    pub robots: u32,
    /// For how many periods of the master they are still needed.
    pub left: u32,
    /// Why it was started.
    pub cause: Cause,
}

impl MasterRobotKnowledge {
    /// What a master knows that has heard of nobody.
    pub fn new(pieces_per_robot: u32, counter: u32) -> MasterRobotKnowledge {
        MasterRobotKnowledge {
            pieces_per_robot,
            counter,
            robots: 0,
            asleep: 0,
            on_shift: 0,
            crew: BTreeMap::new(),
            called: BTreeMap::new(),
            shifts: Vec::new(),
            extras: Extras::default(),
        }
    }

    /// Takes in what a robot says about itself.
    pub fn hear(&mut self, robot: &RobotList) {
        let number = robot.robot;
        if robot.active {
            self.crew.insert(number, robot.clone());
        } else {
            self.crew.remove(&number);
        }
        let done = |awake: &bool| !robot.active || *awake != robot.asleep;
        if self.called.get(&number).is_some_and(done) {
            self.called.remove(&number);
        }
        self.robots = count(self.crew.len());
        self.asleep = count(self.crew.values().filter(|robot| robot.asleep).count());
    }

    /// Those that are active, by number.
    pub fn crew(&self) -> impl Iterator<Item = &RobotList> + Clone {
        self.crew.values()
    }

    /// The robot to awake next: the one with the most charge, then the one with the lowest number.
    pub fn next_to_awake(&self) -> Option<u32> {
        self.callable(RobotList::can_be_awaked).max_by(|one, other| by_right(one, other)).map(|one| one.robot)
    }

    /// The robot to send under charge next: the one with the least charge, then the one with the highest number.
    pub fn next_to_charge(&self) -> Option<u32> {
        let works = |robot: &RobotList| !robot.asleep && !robot.in_charge && !robot.is_out_of_battery();
        self.callable(works).min_by(|one, other| by_right(one, other)).map(|one| one.robot)
    }

    fn callable(&self, which: fn(&RobotList) -> bool) -> impl Iterator<Item = &RobotList> {
        self.crew().filter(move |robot| which(robot) && !self.called.contains_key(&robot.robot))
    }

    /// Notes that a robot is called to be awake, or to go under charge.
    pub fn note_call(&mut self, robot: u32, awake: bool) {
        self.called.insert(robot, awake);
    }

    /// Counts a period down, and ends the shifts that are over; how many robots those had, and why they were there.
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

    /// Starts a shift of so many robots.
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

/// Who is awaked first: by battery, then the lower number.
fn by_right(one: &RobotList, other: &RobotList) -> Ordering {
    one.battery.total_cmp(&other.battery).then(other.robot.cmp(&one.robot))
}

fn count(robots: usize) -> u32 {
    u32::try_from(robots).unwrap_or(u32::MAX)
}
