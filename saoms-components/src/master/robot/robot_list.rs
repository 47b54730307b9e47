use saoms_api::{Context, Failure, Loop, LoopClass, Record, Subscription, record};

use crate::messages::{ROBOT_LIST, RobotList};
use crate::validation::MessageValidator;

use super::MasterRobotKnowledge;

/// Keeps the list of active and sleeping robots.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.master.RobotListMS",
    knowledge = MasterRobotKnowledge,
    effects("robots", "asleep"),
    subscribes(ROBOT_LIST)
)]
pub struct MasterRobotList {
    validator: MessageValidator,
    robots: Subscription<RobotList>,
    known: u32,
}

impl Loop for MasterRobotList {
    type Properties = ();
    type Knowledge = MasterRobotKnowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(MasterRobotList::default())
    }

    fn initialize(&mut self, _knowledge: &mut MasterRobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.robots = context.subscribe(&ROBOT_LIST)?;
        Ok(())
    }

    fn monitor(&mut self, knowledge: &mut MasterRobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, robot) in context.receive(&self.robots).with_headers() {
            if self.validator.accepts(robot, header, None, context) {
                knowledge.hear(robot);
            }
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut MasterRobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        let robots = knowledge.robots;
        if std::mem::replace(&mut self.known, robots) == robots {
            return Ok(None);
        }
        context.report("robots.active", i64::from(robots));
        Ok(Some(record!(
            robots_known: "knows {count} {count:robot|robots}, {asleep} asleep",
            count = robots,
            asleep = knowledge.asleep
        )))
    }

    fn plan(
        &mut self,
        _symptom: Record,
        _knowledge: &mut MasterRobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        Ok(None)
    }

    fn execute(
        &mut self,
        _decision: Record,
        _knowledge: &mut MasterRobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        Ok(())
    }
}
