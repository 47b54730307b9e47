use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, record};

use crate::messages::{ROBOT_LIST, RobotList};
use crate::robot::RobotKnowledge;

/// Announces in each execution that this robot is active.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.RobotListMS",
    knowledge = RobotKnowledge,
    senses("battery", "inCharge", "asleep", "robots")
)]
pub struct ClassicRobotList {
    #[publishes(ROBOT_LIST)]
    robots: Publisher<RobotList>,
    known: usize,
}

impl Loop for ClassicRobotList {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = Record;
    type Decision = Record;

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        if !knowledge.variables.critical {
            context.send(&self.robots, knowledge.robot(true))?;
        }
        let robots = knowledge.lists.active.len();
        let changed = std::mem::replace(&mut self.known, robots) != robots;
        Ok(changed.then(|| {
            record!(
                other_robots_known: "knows {count} other {count:robot|robots}",
                count = u32::try_from(robots).unwrap_or(u32::MAX)
            )
        }))
    }

    fn plan(
        &mut self,
        _symptom: Record,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        Ok(None)
    }

    fn execute(
        &mut self,
        _decision: Record,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        Ok(())
    }

    fn shutdown(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        context.send(&self.robots, knowledge.robot(false))
    }
}
