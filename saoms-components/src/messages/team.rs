//! Messages of the team: robots that are awake, able, or need help.

use std::fmt;

use saoms_api::{Field, Message, Time, Topic};

use crate::grid::{Block, Map};
use crate::robot::{Job, Policy};
use crate::validation::{LONGEST_PERIOD, MessageValidator, Problem, Sender, Validate, of_robot};

/// Commands to robots to wake or to sleep.
///
/// Published by the master of the robots and robots; read by robots.
pub const ROBOT_STATE: Topic<RobotState> = Topic::event("RMSTOPIC");

/// A command to a robot to wake or to sleep.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct RobotState {
    /// Number of the robot.
    pub robot: u32,
    /// True if the robot has to wake, `false` if it has to charge and sleep.
    pub awake: bool,
    /// In an emergency, number of the robot that it substitutes; 0 otherwise.
    pub emulate: u32,
}

impl Validate for RobotState {
    const WHAT: &'static str = "a call";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        validator.check_known(self.robot)?;
        if self.emulate == 0 { Ok(()) } else { validator.check_known(self.emulate) }
    }
}

/// State of each robot, the newest message of each.
///
/// Published by robots; read by robots and the master of the robots.
pub const ROBOT_LIST: Topic<RobotList> = Topic::state("RLMSTOPIC");

/// Battery level in percent below which a robot is not woken, since it would soon have to charge again; the same as for
/// the manual's robots.
const LOW: f64 = 35.0;

/// State of a robot.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(
    key = "robot",
    place = "block",
    speaker("robot", instead = "if the robot was removed from the floor, send `gone`; when it is back, `start` it")
)]
pub struct RobotList {
    /// Number of the robot.
    pub robot: u32,
    /// True if the robot works; `false` when it ends.
    pub active: bool,
    /// Battery level in percent.
    pub battery: f64,
    /// True if the robot is charging.
    pub in_charge: bool,
    /// True if the robot takes no jobs until it is woken.
    pub asleep: bool,
    /// Block of the robot's charger, which other robots avoid.
    pub charger: Block,
    /// Period of the robot in microseconds.
    pub period: u64,
    /// Position of the robot when it published this.
    pub block: Block,
    /// Rules by which the robot acts.
    pub policy: Policy,
    /// When the robot began to work, since it was started last, if it says so. One that somebody took off the floor
    /// is back if that was later.
    pub began: Option<Time>,
}

impl RobotList {
    /// True if the robot is asleep, and charged enough to work when it is woken.
    pub fn can_be_woken(&self) -> bool {
        self.asleep && self.can_work()
    }

    /// True if the robot is charged enough to work.
    pub fn can_work(&self) -> bool {
        self.active && self.battery > LOW
    }

    /// True if the battery is empty and the robot is not at a charger.
    pub fn is_out_of_battery(&self) -> bool {
        self.battery <= 0.0 && !self.in_charge
    }
}

impl fmt::Display for RobotList {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Robot{} is active", self.robot)
    }
}

impl Validate for RobotList {
    const WHAT: &'static str = "the state";
    const SPOKEN_ON: Option<Topic<RobotList>> = Some(ROBOT_LIST);

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        if !(0.0..=100.0).contains(&self.battery) {
            return Err(Problem::Battery { percent: self.battery });
        }
        if self.period > LONGEST_PERIOD {
            return Err(Problem::Period { micros: self.period });
        }
        for block in [self.charger, self.block] {
            Problem::of_block(block, area)?;
        }
        validator.check_speaker(self.robot, sender)?;
        validator.expect_introductions();
        Ok(())
    }
}

/// Requests for help, and the responses of healers.
///
/// Published by robots and the master of the environment; read by both.
pub const CRITICAL_SITUATION: Topic<CriticalSituation> = Topic::event("CSMSTOPIC");

/// Activity of a robot when it became critical.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum CriticalKind {
    /// The robot carries luggage. The healer collects it from the robot's block and delivers it. Kind 1 of the manual.
    #[default]
    CarriesLuggage,
    /// The robot was on its way to collect luggage. The healer takes over the whole job. Kind 2.
    OnTheWay,
    /// The robot had no job. A substitute is woken. Kind 3.
    Idle,
}

/// Stages of a [`CriticalSituation`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum CriticalStage {
    /// A robot needs help.
    #[default]
    Request,
    /// The healer offers to help and reports its position.
    Intention,
    /// The healer takes its offer back: another robot is closer.
    Release,
    /// The healer helps.
    Taken,
    /// The healer was woken as a substitute for the robot.
    StandsIn,
}

/// A request for help by a robot that cannot go on, or the response of a healer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(
    speaker(
        "critical",
        only(stage = "REQUEST"),
        instead = "send `breakdown` or `gone`: then other robots can take the robot's job"
    ),
    speaker("healer", unless(stage = "REQUEST"), instead = "to make a robot help, wake it with a message on RMSTOPIC")
)]
pub struct CriticalSituation {
    /// Number of the robot that needs help.
    pub critical: u32,
    /// Position of that robot.
    pub block: Block,
    /// Number of its luggage; 0 if it has none.
    pub luggage: u32,
    /// Block where its luggage was to be collected.
    pub from: Block,
    /// Destination of its luggage.
    pub to: Block,
    /// Activity of that robot.
    pub kind: CriticalKind,
    /// Request, or kind of response.
    pub stage: CriticalStage,
    /// Number of the robot that responds; in a request 0, or the number of the only robot that it is for.
    pub healer: u32,
    /// Position of the healer; without meaning in a request.
    pub healer_block: Block,
}

impl CriticalSituation {
    /// The job that the healer takes over: the luggage that the robot carries, from its block, or the luggage that it
    /// was to collect.
    pub fn job(&self) -> Option<Job> {
        let from = match self.kind {
            CriticalKind::CarriesLuggage => self.block,
            CriticalKind::OnTheWay => self.from,
            CriticalKind::Idle => return None,
        };
        Some(Job { luggage: self.luggage, from, to: self.to })
    }
}

impl CriticalSituation {
    /// The same request again, for a robot that started later.
    pub fn again_for(self, robot: u32) -> CriticalSituation {
        CriticalSituation { healer: robot, ..self }
    }

    /// True if the message is a request for one robot alone.
    pub fn is_again(&self) -> bool {
        self.stage == CriticalStage::Request && self.healer != 0
    }
}

impl fmt::Display for CriticalSituation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Robot{} in {} needs help", self.critical, self.block)
    }
}

impl Validate for CriticalSituation {
    const WHAT: &'static str = "the critical situation";
    const SPOKEN_ON: Option<Topic<CriticalSituation>> = Some(CRITICAL_SITUATION);

    fn about(&self) -> String {
        of_robot(self.critical)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        validator.check_known(self.critical)?;
        if self.stage != CriticalStage::Request {
            Problem::of_block(self.healer_block, area)?;
            return validator.check_known_speaker(self.healer, sender);
        }
        Problem::of_block(self.block, area)?;
        for block in self.job().into_iter().flat_map(|job| [job.from, job.to]) {
            Problem::of_block(block, area)?;
        }
        // The master asks again for a robot that started later.
        if self.healer != 0 {
            return validator.check_known(self.healer);
        }
        // A healer that breaks asks again for the robot that it wanted to help.
        if validator.is_speaker(sender) {
            return Ok(());
        }
        validator.check_speaker(self.critical, sender)
    }
}
