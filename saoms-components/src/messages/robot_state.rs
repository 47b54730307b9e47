use saoms_api::Message;

/// Wakes a robot, or sends it to sleep.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct RobotState {
    /// The number of the robot that it is for.
    pub robot: u32,
    /// Whether it has to be awake, or to go under charge and sleep.
    pub awake: bool,
    /// In an emergency, the number of the robot to stand in for; 0 otherwise.
    pub emulate: u32,
}
