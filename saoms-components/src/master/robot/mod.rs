//! The master of the robots: how many of them have to be awake.

mod awake_asleep;
mod crew;
mod robot_list;

use saoms_api::{Class, Component, Context, Failure, Loops, Properties};

use crate::console::Timestamp;

pub use awake_asleep::AwakeAsleepMS;
pub use crew::{MasterRobotKnowledge, Shift};
pub use robot_list::RobotListMS;

/// What a composite says about the master of the robots.
#[derive(Clone, Debug, Properties)]
pub struct MasterRobotProperties {
    /// For how many expected pieces of luggage one robot is awaked.
    #[property(default = 2, range = 1..)]
    pub(crate) pieces_per_robot: u32,
    /// After how many of the master's periods as many robots as it awaked are sent under charge again.
    #[property(default = 50, range = 1..)]
    pub(crate) counter: u32,
}

/// Awakes robots when luggage is expected, and sends as many under charge again after a while.
///
/// It knows from what the robots say which of them are asleep. The one with the most charge is awaked first, the one with the least is
/// sent under charge first; where they are equal, the lower number is the first to be awaked and the last to be sent away.
#[derive(Debug, Class)]
#[class(
    name = "saoms.MasterRobot",
    periodic,
    knowledge = MasterRobotKnowledge,
    loops(RobotListMS, AwakeAsleepMS),
    also("unibg.saoms.MasterRobotManagingSystem")
)]
pub struct MasterRobot {
    knowledge: MasterRobotKnowledge,
    loops: Loops,
}

impl Component for MasterRobot {
    type Properties = MasterRobotProperties;

    fn new(properties: MasterRobotProperties) -> Result<Self, Failure> {
        let knowledge = MasterRobotKnowledge::new(properties.pieces_per_robot, properties.counter);
        Ok(MasterRobot { knowledge, loops: Loops::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops = context.loops()?;
        let now = Timestamp::now(context);
        context.console(format_args!("MasterRobotManagingSystem starts at {now}"));
        self.loops.initialize(&mut self.knowledge, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.monitor(&mut self.knowledge, context)?;
        self.loops.adapt(&mut self.knowledge, context)
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.shutdown(&mut self.knowledge, context)
    }
}
