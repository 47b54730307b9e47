use super::{MessageValidator, Problem};
use crate::grid::Map;
use crate::hardware::Area;
use crate::messages::{
    CriticalSituation, CriticalStage, EventLuggage, Fault, LuggageStage, Position, RobotList, RobotState,
};

/// Maximum period of a component, a day, in microseconds.
const LONGEST: u64 = 24 * 60 * 60 * 1_000_000;

/// A message that can be wrong.
///
/// Landings and take-offs are not checked: every number of pieces is possible.
pub(crate) trait Validate {
    /// Name of the message for people.
    const WHAT: &'static str;

    /// The robot or luggage that the message is about, for people.
    fn about(&self) -> String;

    /// Checks the message of this sender.
    fn validate(
        &self,
        sender: u32,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem>;
}

fn of_robot(robot: u32) -> String {
    format!("robot {robot}")
}

impl Validate for RobotList {
    const WHAT: &'static str = "the state";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        sender: u32,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        if !(0.0..=100.0).contains(&self.battery) {
            return Err(Problem::Battery { percent: self.battery });
        }
        if self.period > LONGEST {
            return Err(Problem::Period { micros: self.period });
        }
        Problem::of_block(self.charger, area)?;
        validator.check_speaker(self.robot, sender)?;
        validator.introduced = true;
        Ok(())
    }
}

impl Validate for Position {
    const WHAT: &'static str = "the position";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    /// The first message about an unknown robot is accepted: a robot sends its position before anything else, and its
    /// block is kept free.
    fn validate(
        &self,
        sender: u32,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        let Position { block, next, wanted, .. } = *self;
        for block in [block, next, wanted] {
            Problem::of_block(block, area)?;
        }
        for (from, to) in [(block, next), (next, wanted)] {
            if from.distance(to) > 1 {
                return Err(Problem::Jump { from, to });
            }
        }
        validator.check_speaker(self.robot, sender)
    }
}

impl Validate for EventLuggage {
    const WHAT: &'static str = "a message";

    fn about(&self) -> String {
        format!("luggage {} from {} to {}", self.luggage, self.from, self.to)
    }

    fn validate(
        &self,
        sender: u32,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        let EventLuggage { robot, from, to, block, .. } = *self;
        match self.stage {
            LuggageStage::Request => Problem::of_request(self, area),
            // The component that requested luggage gives it up in nobody's name, even if the request was impossible.
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

impl Validate for CriticalSituation {
    const WHAT: &'static str = "the critical situation";

    fn about(&self) -> String {
        of_robot(self.critical)
    }

    fn validate(
        &self,
        sender: u32,
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
        // A healer that breaks asks again for the robot that it wanted to help.
        if validator.speakers.iter().any(|(_, speaker)| *speaker == sender) {
            return Ok(());
        }
        validator.check_speaker(self.critical, sender)
    }
}

impl Validate for RobotState {
    const WHAT: &'static str = "a call";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        _sender: u32,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        validator.check_known(self.robot)?;
        if self.emulate == 0 { Ok(()) } else { validator.check_known(self.emulate) }
    }
}

impl Validate for Fault {
    const WHAT: &'static str = "a fault";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        _sender: u32,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        validator.check_known(self.robot)
    }
}

impl Validate for Area {
    const WHAT: &'static str = "an area";

    fn about(&self) -> String {
        format!("{} x {} blocks", self.width, self.height)
    }

    fn validate(
        &self,
        _sender: u32,
        _intake: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        let Area { width, height, .. } = *self;
        match Option::<Map>::from(self.clone()) {
            Some(_) => Ok(()),
            None => Err(Problem::Area { width, height }),
        }
    }
}
