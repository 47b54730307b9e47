use saoms_api::Message;

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
