use std::fmt;

use saoms_api::{Field, Message, Topic};

use crate::grid::{Block, Map};
use crate::robot::Job;
use crate::validation::{MessageValidator, Problem, Validate, of_robot};

/// Requests for help, and the responses of healers.
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
    /// Number of the robot that responds; 0 in a request.
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

impl fmt::Display for CriticalSituation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Robot{} in {} needs help", self.critical, self.block)
    }
}

impl Validate for CriticalSituation {
    const WHAT: &'static str = "the critical situation";

    fn about(&self) -> String {
        of_robot(self.critical)
    }

    fn validate(&self, sender: u32, validator: &mut MessageValidator, area: Option<&Map>) -> Result<(), Problem> {
        validator.check_known(self.critical)?;
        if self.stage != CriticalStage::Request {
            Problem::of_block(self.healer_block, area)?;
            return validator.check_known_speaker(self.healer, sender);
        }
        Problem::of_block(self.block, area)?;
        for block in self.job().into_iter().flat_map(|job| [job.from, job.to]) {
            Problem::of_block(block, area)?;
        }
        // A healer that breaks asks again for the robot that it wanted to help.
        if validator.is_speaker(sender) {
            return Ok(());
        }
        validator.check_speaker(self.critical, sender)
    }
}
