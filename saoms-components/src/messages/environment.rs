//! Messages of the environment to the fleet: luggage, exceptional events and faults.

use std::fmt;

use saoms_api::{Field, Message, Time, Topic};

use super::job_name;
use crate::grid::{Block, Map};
use crate::validation::{MessageValidator, Problem, Sender, Validate, of_robot};

/// Events of any kind from the environment.
///
/// Published by the environment, or anyone; read by the master of the environment and the world.
pub const ENVIRONMENT: Topic<EnvironmentEvent> = Topic::event("ETOPIC");

/// Events outside the fleet: new luggage, exceptional events and faults, one or several at once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct EnvironmentEvent {
    /// Requests to bring luggage.
    pub luggage: Vec<EventLuggage>,
    /// Landings and take-offs.
    pub exceptional: Vec<ExceptionalEvent>,
    /// Faults of robots.
    pub faults: Vec<Fault>,
}

impl From<EventLuggage> for EnvironmentEvent {
    fn from(luggage: EventLuggage) -> EnvironmentEvent {
        EnvironmentEvent { luggage: vec![luggage], ..EnvironmentEvent::default() }
    }
}

impl From<ExceptionalEvent> for EnvironmentEvent {
    fn from(event: ExceptionalEvent) -> EnvironmentEvent {
        EnvironmentEvent { exceptional: vec![event], ..EnvironmentEvent::default() }
    }
}

impl From<Fault> for EnvironmentEvent {
    fn from(fault: Fault) -> EnvironmentEvent {
        EnvironmentEvent { faults: vec![fault], ..EnvironmentEvent::default() }
    }
}

/// Requests to bring luggage, and the robots' responses.
///
/// Published by the master of the environment and robots; read by robots, the master of the environment, the
/// environment and the world.
pub const EVENT_LUGGAGE: Topic<EventLuggage> = Topic::event("ELMSTOPIC");

/// Stages of an [`EventLuggage`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum LuggageStage {
    /// The luggage waits for a robot.
    #[default]
    Request,
    /// The robot is interested and reports its position.
    Interest,
    /// The robot takes its interest back: another robot is closer.
    Release,
    /// The robot brings the luggage; no other robot has to.
    Taken,
    /// The robot has brought the luggage to its destination.
    Delivered,
    /// The robot can never bring the luggage.
    Refused,
    /// No robot can bring the luggage; it is no open work any more.
    GivenUp,
}

/// A request to bring luggage from one block to another, or the response of a robot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(
    place = "from",
    speaker(
        "robot",
        unless(stage = "REQUEST"),
        instead = "for new luggage publish a request; to free luggage that the robot has taken, send `breakdown` or `gone`"
    )
)]
pub struct EventLuggage {
    /// Number of the robot that responds; in a request 0, or the number of the only robot that it is for.
    pub robot: u32,
    /// Number of the luggage.
    pub luggage: u32,
    /// Request, or kind of response.
    pub stage: LuggageStage,
    /// Block where the luggage is collected.
    pub from: Block,
    /// Block where the luggage is deposited.
    pub to: Block,
    /// Position of the robot that responds; without meaning in a request.
    pub block: Block,
}

impl EventLuggage {
    /// A request.
    pub const fn request(luggage: u32, from: Block, to: Block) -> EventLuggage {
        EventLuggage { robot: 0, luggage, stage: LuggageStage::Request, from, to, block: from }
    }

    /// The same request again, for a robot that started later.
    pub fn again_for(self, robot: u32) -> EventLuggage {
        EventLuggage { robot, ..self }
    }

    /// True if the message is a request for all robots, or for this one.
    pub fn is_request_for(&self, robot: u32) -> bool {
        self.stage == LuggageStage::Request && (self.robot == 0 || self.robot == robot)
    }

    /// A report that no robot can bring the luggage of a request.
    pub const fn given_up(luggage: u32, from: Block, to: Block) -> EventLuggage {
        EventLuggage { stage: LuggageStage::GivenUp, ..EventLuggage::request(luggage, from, to) }
    }
}

impl fmt::Display for EventLuggage {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Luggage to bring from {} to {}", self.from, self.to)
    }
}

impl Validate for EventLuggage {
    const WHAT: &'static str = "a message";
    const SPOKEN_ON: Option<Topic<EventLuggage>> = Some(EVENT_LUGGAGE);

    fn about(&self) -> String {
        format!("{} from {} to {}", job_name(self.luggage), self.from, self.to)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        let EventLuggage { robot, from, to, block, .. } = *self;
        match self.stage {
            LuggageStage::Request => {
                if robot != 0 {
                    validator.check_known(robot)?;
                }
                match Problem::of_request(&EventLuggage { robot: 0, ..self.clone() }, area) {
                    // Luggage that is known can be at its destination: on a robot that broke there.
                    Err(Problem::There { .. })
                        if robot != 0 || validator.is_speaker(sender) || validator.is_requester(sender) =>
                    {
                        Ok(())
                    }
                    Ok(()) => {
                        validator.note_requester(sender);
                        Ok(())
                    }
                    judged => judged,
                }
            }
            // The component that requested luggage gives it up without a robot's number, even if the request was
            // impossible.
            LuggageStage::GivenUp if robot == 0 => Ok(()),
            LuggageStage::Interest
            | LuggageStage::Release
            | LuggageStage::Taken
            | LuggageStage::Delivered
            | LuggageStage::Refused
            | LuggageStage::GivenUp => {
                for block in [from, to, block] {
                    Problem::of_block(block, area)?;
                }
                validator.check_known_speaker(robot, sender)
            }
        }
    }
}

/// Events that change the number of robots that are needed.
///
/// Published by the master of the environment; read by the master of the robots.
pub const EXCEPTIONAL_EVENT: Topic<ExceptionalEvent> = Topic::event("EETOPIC").optional();

/// Kinds of exceptional events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum ExceptionalKind {
    /// An airplane landed.
    #[default]
    Landing,
    /// An airplane is about to take off.
    Takeoff,
}

/// An event that brings more luggage than usual.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct ExceptionalEvent {
    /// Landing or take-off.
    pub kind: ExceptionalKind,
    /// Number of pieces of luggage that are expected.
    pub pieces: u32,
}

impl fmt::Display for ExceptionalEvent {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            ExceptionalKind::Landing => "LANDING",
            ExceptionalKind::Takeoff => "TAKEOFF",
        };
        write!(formatter, "{kind} with {} expected pieces of luggage", self.pieces)
    }
}

/// Faults of robots.
///
/// Published by the master of the environment; read by robots.
pub const FAULT: Topic<Fault> = Topic::event("FAULTTOPIC");

/// Kinds of faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum FaultKind {
    /// The robot can neither move nor handle luggage any more.
    #[default]
    Breakdown,
    /// Somebody took the robot off the floor. It holds no block any more, and says nothing until it is started again.
    Gone,
    /// The component of the robot has failed for good. The robot stays where it is, and says nothing until it is
    /// started again.
    Failed,
    /// The component of the robot has failed, and starts again without what it knew. Until it says so it is as one that
    /// has failed for good.
    Restarting,
}

/// A fault of a robot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Fault {
    /// Number of the robot.
    pub robot: u32,
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Time of a failure, or of the event where that a robot is off the floor is said again.
    pub since: Option<Time>,
    /// Block where a robot that failed is, where a world knows it.
    pub block: Option<Block>,
}

impl Fault {
    /// The breakdown of a robot.
    pub const fn breakdown(robot: u32) -> Fault {
        Fault { robot, kind: FaultKind::Breakdown, since: None, block: None }
    }

    /// True if this is the breakdown of that robot.
    pub fn breaks(&self, robot: u32) -> bool {
        self.kind == FaultKind::Breakdown && self.robot == robot
    }

    /// The question about all robots that are out, to a world.
    pub const fn any() -> Fault {
        Fault::gone(0)
    }

    /// True if this is the question about all robots that are out.
    pub fn is_any(&self) -> bool {
        *self == Fault::any()
    }

    /// The robot is off the floor.
    pub const fn gone(robot: u32) -> Fault {
        Fault { robot, kind: FaultKind::Gone, since: None, block: None }
    }

    /// The component of a robot has failed, and starts again without what it knew, or not at all.
    pub const fn failure(robot: u32, since: Time, restarts: bool) -> Fault {
        let kind = if restarts { FaultKind::Restarting } else { FaultKind::Failed };
        Fault { robot, kind, since: Some(since), block: None }
    }

    /// True if the robot does nothing any more without having said so: it is off the floor, or its component failed.
    pub fn silences(&self) -> bool {
        self.kind != FaultKind::Breakdown
    }

    /// True if its component failed.
    pub fn is_failure(&self) -> bool {
        matches!(self.kind, FaultKind::Failed | FaultKind::Restarting)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            FaultKind::Breakdown => write!(formatter, "robot {} breaks down", self.robot),
            FaultKind::Gone if self.is_any() => formatter.write_str("any robot is out"),
            FaultKind::Gone => write!(formatter, "robot {} is gone", self.robot),
            FaultKind::Failed => write!(formatter, "robot {} has failed", self.robot),
            FaultKind::Restarting => write!(formatter, "robot {} has failed and starts again", self.robot),
        }
    }
}

impl Validate for Fault {
    const WHAT: &'static str = "a fault";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        validator.check_known(self.robot)
    }
}

/// What robots that are gone, or whose component failed, left behind.
///
/// Published by the world; read by the master of the environment, the environment and zones.
pub const REMOVAL: Topic<Removal> = Topic::event("REMOVALTOPIC").optional();

/// Robots that are gone, or whose component failed, and of which no world has said yet what they left behind: the
/// answer, or the news of the robot, was lost. A master or a zone that begins asks about all of them, with robot 0.
///
/// Published by the master of the environment and zones; read by the world.
pub const REMOVAL_ASKED: Topic<Fault> = Topic::event("REMOVALASKEDTOPIC").optional();

/// A robot that is off the floor or has failed, and where its luggage is now.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Removal {
    /// Number of the robot.
    pub robot: u32,
    /// What happened to it; none for one that has begun anew and works.
    pub kind: Option<FaultKind>,
    /// Time from which on it is out: an answer about an earlier time says nothing of where it is now.
    pub since: Time,
    /// Block where it was; none in a world that does not know the robot.
    pub block: Option<Block>,
    /// Numbers of the pieces that it carried, which are on that block.
    pub luggage: Vec<u32>,
    /// Numbers of those that it carried and for which that block is the destination.
    pub delivered: Vec<u32>,
}

impl Removal {
    /// What happened to the robot, with its block where the world knows that; `None` if it works.
    pub fn fault(&self) -> Option<Fault> {
        let Removal { robot, kind, since, block, .. } = *self;
        Some(Fault { robot, kind: kind?, since: Some(since), block })
    }
}

impl Validate for Removal {
    const WHAT: &'static str = "the removal";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        self.block.map_or(Ok(()), |block| Problem::of_block(block, area))?;
        validator.check_known(self.robot)
    }
}
