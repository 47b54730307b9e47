use saoms_api::{Class, Component, Context, Failure, Subscription};

use crate::console::{JavaList, Timestamp};
use crate::messages::{EXCEPTIONAL_EVENT, ExceptionalEvent, ROBOT_LIST, RobotList};
use crate::robot::Lists;

/// Keeps the list of the robots that are active.
#[derive(Debug, Class)]
#[class(
    name = "saoms.MasterRobot",
    periodic,
    subscribes(ROBOT_LIST, EXCEPTIONAL_EVENT),
    also("unibg.saoms.MasterRobotManagingSystem")
)]
pub struct MasterRobot {
    lists: Lists,
    robots: Subscription<RobotList>,
    exceptional: Subscription<ExceptionalEvent>,
}

/// The master is no robot, so its own number is nobody's.
const NOBODY: u32 = 0;

impl Component for MasterRobot {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(MasterRobot {
            lists: Lists::new(NOBODY),
            robots: Subscription::default(),
            exceptional: Subscription::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.robots = context.subscribe(&ROBOT_LIST)?;
        self.exceptional = context.subscribe(&EXCEPTIONAL_EVENT)?;
        let now = Timestamp::now(context);
        context.console(format_args!("MasterRobotManagingSystem starts at {now}"));
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let before = self.lists.active.len();
        for robot in context.receive(&self.robots) {
            self.lists.hear_robot(robot);
        }
        let active = &self.lists.active;
        if active.len() != before {
            context.report("robots.active", i64::try_from(active.len()).unwrap_or(i64::MAX));
        }
        for event in context.receive(&self.exceptional) {
            let charged = active.iter().filter(|robot| !robot.in_charge).count();
            context.info(format_args!(
                "{event}: {} robots are active, {charged} of them not in charge",
                active.len()
            ));
            let active = JavaList(active.iter());
            context.console(format_args!("MasterRobotManagingSystem updated active robot list: {active}"));
        }
        Ok(())
    }
}
