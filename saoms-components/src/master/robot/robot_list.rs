use saoms_api::{Context, Failure, Loop, LoopClass, Message, Record, Saved, record};

use super::MasterRobotKnowledge;

/// Tells how many robots are active, and how many of them sleep.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.master.RobotListMS",
    knowledge = MasterRobotKnowledge,
    senses("robots", "asleep")
)]
pub struct MasterRobotList {
    known: u32,
}

/// State of the loop.
#[derive(Clone, Copy, Debug, Message)]
struct Known {
    robots: u32,
}

impl Loop for MasterRobotList {
    type Properties = ();
    type Knowledge = MasterRobotKnowledge;
    type Symptom = Record;
    type Decision = Record;

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

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Known { robots: self.known }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.known = saved.read::<Known>()?.map_or(0, |known| known.robots);
        Ok(())
    }
}
