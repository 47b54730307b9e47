use saoms_api::{Message, Topic};

use crate::grid::Map;
use crate::validation::{MessageValidator, Problem, Validate, of_robot};

/// Commands to robots to wake or to sleep.
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

    fn validate(&self, _sender: u32, validator: &mut MessageValidator, _area: Option<&Map>) -> Result<(), Problem> {
        validator.check_known(self.robot)?;
        if self.emulate == 0 { Ok(()) } else { validator.check_known(self.emulate) }
    }
}
