use super::{Intake, Problem};
use crate::grid::Map;
use crate::hardware::Area;
use crate::messages::{
    CriticalSituation, CriticalStage, EventLuggage, Fault, LuggageStage, Position, RobotList, RobotState,
};

/// The longest period of a component, a day, in microseconds.
const LONGEST: u64 = 24 * 60 * 60 * 1_000_000;

/// A message that can be wrong.
///
/// Landings and take-offs are none: every number of pieces is possible.
pub(crate) trait Judged {
    /// What it is, for people.
    const WHAT: &'static str;

    /// Of which robot or luggage it is, for people.
    fn about(&self) -> String;

    /// What is wrong with it, if anything, as this component sent it.
    fn judge(&self, sender: u32, intake: &mut Intake, area: Option<&Map>) -> Result<(), Problem>;
}

fn of_robot(robot: u32) -> String {
    format!("robot {robot}")
}

impl Judged for RobotList {
    const WHAT: &'static str = "the state";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn judge(&self, sender: u32, intake: &mut Intake, area: Option<&Map>) -> Result<(), Problem> {
        if !(0.0..=100.0).contains(&self.battery) {
            return Err(Problem::Battery { percent: self.battery });
        }
        if self.period > LONGEST {
            return Err(Problem::Period { micros: self.period });
        }
        Problem::of_block(self.charger, area)?;
        intake.check_speaker(self.robot, sender)?;
        intake.introduced = true;
        Ok(())
    }
}

impl Judged for Position {
    const WHAT: &'static str = "the position";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    /// A robot says where it is before it says anything else, so nothing speaks against one that nobody knows: its block is kept free.
    fn judge(&self, sender: u32, intake: &mut Intake, area: Option<&Map>) -> Result<(), Problem> {
        let Position { block, next, wanted, .. } = *self;
        for block in [block, next, wanted] {
            Problem::of_block(block, area)?;
        }
        for (from, to) in [(block, next), (next, wanted)] {
            if from.distance(to) > 1 {
                return Err(Problem::Jump { from, to });
            }
        }
        intake.check_speaker(self.robot, sender)
    }
}

impl Judged for EventLuggage {
    const WHAT: &'static str = "a message";

    fn about(&self) -> String {
        format!("luggage {} from {} to {}", self.luggage, self.from, self.to)
    }

    fn judge(&self, sender: u32, intake: &mut Intake, area: Option<&Map>) -> Result<(), Problem> {
        let EventLuggage { robot, from, to, block, .. } = *self;
        match self.stage {
            LuggageStage::Request => Problem::of_request(self, area),
            // Whoever asked for it gives it up in nobody's name, also where it cannot be.
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
                intake.check_known_speaker(robot, sender)
            }
        }
    }
}

impl Judged for CriticalSituation {
    const WHAT: &'static str = "the critical situation";

    fn about(&self) -> String {
        of_robot(self.critical)
    }

    fn judge(&self, sender: u32, intake: &mut Intake, area: Option<&Map>) -> Result<(), Problem> {
        intake.check_known(self.critical)?;
        if self.stage != CriticalStage::Request {
            Problem::of_block(self.healer_block, area)?;
            return intake.check_known_speaker(self.healer, sender);
        }
        Problem::of_block(self.block, area)?;
        for block in self.job().into_iter().flat_map(|job| [job.from, job.to]) {
            Problem::of_block(block, area)?;
        }
        // A healer that breaks asks again for the robot that it would have healed.
        if intake.speakers.iter().any(|(_, speaker)| *speaker == sender) {
            return Ok(());
        }
        intake.check_speaker(self.critical, sender)
    }
}

impl Judged for RobotState {
    const WHAT: &'static str = "a call";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn judge(&self, _sender: u32, intake: &mut Intake, _area: Option<&Map>) -> Result<(), Problem> {
        intake.check_known(self.robot)?;
        if self.emulate == 0 { Ok(()) } else { intake.check_known(self.emulate) }
    }
}

impl Judged for Fault {
    const WHAT: &'static str = "a fault";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn judge(&self, _sender: u32, intake: &mut Intake, _area: Option<&Map>) -> Result<(), Problem> {
        intake.check_known(self.robot)
    }
}

impl Judged for Area {
    const WHAT: &'static str = "an area";

    fn about(&self) -> String {
        format!("{} x {} blocks", self.width, self.height)
    }

    fn judge(&self, _sender: u32, _intake: &mut Intake, _area: Option<&Map>) -> Result<(), Problem> {
        let Area { width, height, .. } = *self;
        match Option::<Map>::from(self.clone()) {
            Some(_) => Ok(()),
            None => Err(Problem::Area { width, height }),
        }
    }
}
