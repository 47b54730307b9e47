//! The master of the robots, which decides how many of them are awake.

mod awake_asleep;
mod knowledge;
mod memory;
mod robot_list;
mod work;

use saoms_api::{Class, Component, Context, Failure, Loops, Properties, ReportValue, Saved, Subscription};

use crate::console::Timestamp;
use crate::messages::{
    ENVIRONMENT, EVENT_LUGGAGE, EnvironmentEvent, EventLuggage, FAULT, Fault, ROBOT_LIST, RobotList,
};

pub use awake_asleep::MasterAwakeAsleep;
use memory::MasterRobotMemory;

pub use knowledge::{MasterRobotKnowledge, Shift};
pub use robot_list::MasterRobotList;

/// Properties of the master of the robots.
#[derive(Clone, Debug, Properties)]
pub struct MasterRobotProperties {
    /// Number of expected pieces of luggage for which one robot is woken.
    #[property(default = 2, range = 1..)]
    pub(crate) pieces_per_robot: u32,
    /// Number of the master's periods after which as many robots as it woke are sent to charge again, unless there is
    /// work for them (robots of the policy `classic`: in any case).
    #[property(default = 50, range = 1..)]
    pub(crate) counter: u32,
}

/// Wakes robots when luggage is expected or waits for long, and sends as many to charge again after a while.
///
/// The robots report which of them are asleep. The one with the highest battery level is woken first, less 1 % for each
/// block to luggage that waits; the one with the lowest is sent to charge first. Of robots with equal levels the lowest
/// number is woken first and sent last. While luggage waits or is expected, nobody is sent to charge who could bring it
/// sooner, or brings some. Where robots are of the policy `classic`, the counter alone decides, as in the manual.
#[derive(Debug, Class)]
#[class(
    name = "saoms.MasterRobot",
    periodic,
    saves,
    knowledge = MasterRobotKnowledge,
    loops(MasterRobotList, MasterAwakeAsleep),
    also("unibg.saoms.MasterRobotManagingSystem")
)]
pub struct MasterRobot {
    knowledge: MasterRobotKnowledge,
    loops: Loops,
    #[subscribes(ROBOT_LIST)]
    robots: Subscription<RobotList>,
    #[subscribes(FAULT)]
    faults: Subscription<Fault>,
    #[subscribes(ENVIRONMENT)]
    events: Subscription<EnvironmentEvent>,
    #[subscribes(EVENT_LUGGAGE)]
    luggage: Subscription<EventLuggage>,
}

impl Component for MasterRobot {
    type Properties = MasterRobotProperties;

    fn new(properties: MasterRobotProperties) -> Result<Self, Failure> {
        let knowledge = MasterRobotKnowledge::new(properties.pieces_per_robot, properties.counter);
        Ok(MasterRobot {
            knowledge,
            loops: Loops::default(),
            robots: Subscription::default(),
            faults: Subscription::default(),
            events: Subscription::default(),
            luggage: Subscription::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops = context.loops()?;
        let now = Timestamp::now(context);
        context.console(format_args!("MasterRobotManagingSystem starts at {now}"));
        self.loops.initialize(&mut self.knowledge, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.knowledge.hear_robots(self.robots, self.faults, context);
        self.knowledge.hear_luggage(self.events, self.luggage, context);
        self.loops.monitor(&mut self.knowledge, context)?;
        self.loops.adapt(&mut self.knowledge, context)
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.shutdown(&mut self.knowledge, context)
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        let loops = self.loops.save(&self.knowledge)?;
        Ok(Saved::of(&self.knowledge.memory(loops)))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(memory) = saved.read::<MasterRobotMemory>()? else { return Ok(()) };
        let loops = self.knowledge.restore(memory);
        self.loops.restore(&mut self.knowledge, &loops)
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        ReportValue::named([
            ("robots", ReportValue::from(self.knowledge.robots)),
            ("asleep", self.knowledge.asleep.into()),
            ("on_shift", self.knowledge.on_shift.into()),
        ])
    }

    fn waits_for(&self) -> Option<String> {
        (self.knowledge.on_shift == 0).then(|| "landings and take-offs".to_owned())
    }
}
