use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Saved, record};

use crate::messages::{ROBOT_LIST, RobotList};
use crate::robot::RobotKnowledge;
use crate::robot::memory::lasting::lasting;

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
    known: u32,
}

lasting! {
    ClassicRobotList as RobotListMemory { known: u32 }
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
        let robots = u32::try_from(knowledge.lists.active.len()).unwrap_or(u32::MAX);
        let changed = std::mem::replace(&mut self.known, robots) != robots;
        Ok(changed.then(|| {
            record!(
                other_robots_known: "knows {count} other {count:robot|robots}",
                count = robots
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

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}
