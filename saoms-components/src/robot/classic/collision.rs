use saoms_api::{Context, Failure, Loop, LoopClass, Record, Recordable, Subscription, record};

use crate::grid::Block;
use crate::messages::{POSITION, Position};
use crate::robot::RobotKnowledge;

/// Stops for a period when another robot announced the same next block and has the lower number (listing 6.11).
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.CollisionMS",
    knowledge = RobotKnowledge,
    senses("busy", "next"),
    effects("stopAPeriod"),
    subscribes(POSITION)
)]
pub struct CollisionMS {
    positions: Subscription<Position>,
}

/// What the announced blocks say.
#[derive(Clone, Copy, Debug)]
pub enum CollisionSymptom {
    /// Another robot announced the same next block.
    Risk {
        /// The lowest number of such a robot.
        robot: u32,
        /// The block.
        block: Block,
    },
    /// Nobody does any more.
    Over,
}

/// Who goes first.
#[derive(Clone, Copy, Debug)]
pub enum CollisionDecision {
    /// The other robot.
    Stop {
        /// Its number.
        robot: u32,
        /// Where it goes.
        block: Block,
    },
    /// This one.
    GoOn,
    /// Nobody has to wait any more.
    GoOnAgain,
}

impl Recordable for CollisionSymptom {
    fn record(&self) -> Record {
        match *self {
            CollisionSymptom::Risk { robot, block } => {
                record!("robot {robot} goes to {block}, too", robot, block)
            }
            CollisionSymptom::Over => record!("no other robot goes there any more"),
        }
    }
}

impl Recordable for CollisionDecision {
    fn record(&self) -> Record {
        match *self {
            CollisionDecision::Stop { robot, .. } => {
                record!("stops for a period: robot {robot} has the lower number", robot)
            }
            CollisionDecision::GoOn => record!("goes on: it has the lower number"),
            CollisionDecision::GoOnAgain => record!("goes on"),
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
        knowledge.hear_positions(self.positions, context);
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<CollisionSymptom>, Failure> {
        let block = knowledge.next;
        let same = knowledge.lists.peers.heard().filter(|peer| peer.next == block);
        let risk = same.map(|peer| peer.robot).min().filter(|_| knowledge.variables.busy);
        let over = knowledge.variables.stop_a_period.then_some(CollisionSymptom::Over);
        Ok(risk.map(|robot| CollisionSymptom::Risk { robot, block }).or(over))
    }

    fn plan(
        &mut self,
        symptom: CollisionSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<CollisionDecision>, Failure> {
        Ok(Some(match symptom {
            CollisionSymptom::Risk { robot, block } if robot < knowledge.number => {
                CollisionDecision::Stop { robot, block }
            }
            CollisionSymptom::Risk { .. } => CollisionDecision::GoOn,
            CollisionSymptom::Over => CollisionDecision::GoOnAgain,
        }))
    }

    fn execute(
        &mut self,
        decision: CollisionDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        if !matches!(decision, CollisionDecision::GoOnAgain) {
            let name = &knowledge.name;
            context.console(format_args!("{name}: RISK OF COLLISION DETECTED AND AVOIDED!"));
        }
        knowledge.variables.stop_a_period = matches!(decision, CollisionDecision::Stop { .. });
        if let CollisionDecision::Stop { robot, block } = decision {
            context.info(format_args!("waits: robot {robot} goes to {block} first"));
        }
        Ok(())
    }
}
