use saoms_api::{Context, Failure, Loop, LoopClass, Record, Recordable, Subscription, record};

use crate::grid::Block;
use crate::messages::{POSITION, Position};
use crate::robot::RobotKnowledge;

/// Stops for a period when another robot announced the same next block and has the lower number (listing 6.11).
#[derive(Debug, Default, LoopClass)]
#[looping(name = "saoms.classic.CollisionMS", senses("next"), effects("stopAPeriod"))]
pub struct CollisionMS {
    positions: Subscription<Position>,
}

/// Another robot announced the same next block.
#[derive(Clone, Copy, Debug)]
pub struct CollisionSymptom {
    /// The lowest number of such a robot.
    pub robot: u32,
    /// The block.
    pub block: Block,
}

/// Who goes first.
#[derive(Clone, Copy, Debug)]
pub enum CollisionDecision {
    /// The other robot.
    Stop(CollisionSymptom),
    /// This one.
    GoOn,
}

impl Recordable for CollisionSymptom {
    fn record(&self) -> Record {
        let CollisionSymptom { robot, block } = *self;
        record!("robot {robot} goes to {block}, too", robot, block)
    }
}

impl Recordable for CollisionDecision {
    fn record(&self) -> Record {
        match *self {
            CollisionDecision::Stop(CollisionSymptom { robot, .. }) => {
                record!("stops for a period: robot {robot} has the lower number", robot)
            }
            CollisionDecision::GoOn => record!("goes on: it has the lower number"),
        }
    }
}

impl Loop for CollisionMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = CollisionSymptom;
    type Decision = CollisionDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(CollisionMS::default())
    }

    fn initialize(
        &mut self,
        _knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.positions = context.subscribe(&POSITION)?;
        Ok(())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        knowledge.lists.peers.hear(context.receive(&self.positions));
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<CollisionSymptom>, Failure> {
        if !knowledge.variables.busy {
            return Ok(None);
        }
        let block = knowledge.next;
        let same = knowledge.lists.peers.heard().filter(|peer| peer.next == block);
        Ok(same.map(|peer| peer.robot).min().map(|robot| CollisionSymptom { robot, block }))
    }

    fn plan(
        &mut self,
        symptom: CollisionSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<CollisionDecision>, Failure> {
        let stops = symptom.robot < knowledge.number;
        Ok(Some(if stops { CollisionDecision::Stop(symptom) } else { CollisionDecision::GoOn }))
    }

    fn execute(
        &mut self,
        decision: CollisionDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let name = &knowledge.name;
        context.console(format_args!("{name}: RISK OF COLLISION DETECTED AND AVOIDED!"));
        knowledge.variables.stop_a_period = false;
        if let CollisionDecision::Stop(CollisionSymptom { robot, block }) = decision {
            knowledge.variables.stop_a_period = true;
            context.info(format_args!("waits: robot {robot} goes to {block} first"));
        }
        Ok(())
    }
}
