use saoms_api::{Context, Failure, Loop, LoopClass, Record, Recordable, info, record};

use crate::grid::Block;
use crate::precedence::{Conflict, Precedence};
use crate::robot::RobotKnowledge;

/// Stops for a period if another robot announced the same next block and has the lower number (listing 6.11).
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.CollisionMS",
    knowledge = RobotKnowledge,
    senses("busy", "next", "positions"),
    effects("stopAPeriod")
)]
pub struct ClassicCollision;

/// State of the robot's next block.
#[derive(Clone, Copy, Debug)]
pub enum ClassicCollisionSymptom {
    /// Another robot announced the same next block.
    Risk {
        /// Lowest number of such a robot.
        robot: u32,
        /// The block.
        block: Block,
    },
    /// No other robot announces it any more.
    Over,
}

/// Right of way.
#[derive(Clone, Copy, Debug)]
pub enum ClassicCollisionDecision {
    /// The other robot goes first.
    Stop {
        /// Number of the other robot.
        robot: u32,
        /// Block that it enters.
        block: Block,
    },
    /// This robot goes first.
    GoOn,
    /// No robot has to wait any more.
    GoOnAgain,
}

impl Recordable for ClassicCollisionSymptom {
    fn record(&self) -> Record {
        match *self {
            ClassicCollisionSymptom::Risk { robot, block } => {
                record!(block_contested: "robot {robot} is about to enter {block}, too", robot, block)
            }
            ClassicCollisionSymptom::Over => record!(
                block_uncontested: "no other robot is about to enter the block any more"
            ),
        }
    }
}

impl Recordable for ClassicCollisionDecision {
    fn record(&self) -> Record {
        match *self {
            ClassicCollisionDecision::Stop { robot, .. } => {
                record!(waits_one_period: "waits one period: robot {robot} has the lower number", robot)
            }
            ClassicCollisionDecision::GoOn => record!(goes_first: "goes first: it has the lower number"),
            ClassicCollisionDecision::GoOnAgain => record!(goes_on: "continues"),
        }
    }
}

impl Loop for ClassicCollision {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = ClassicCollisionSymptom;
    type Decision = ClassicCollisionDecision;

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<ClassicCollisionSymptom>, Failure> {
        let block = knowledge.next;
        let same = knowledge.lists.peers.heard().filter(|peer| peer.next == block);
        let risk = same.map(|peer| peer.robot).min().filter(|_| knowledge.variables.busy);
        let over = knowledge.variables.stop_a_period.then_some(ClassicCollisionSymptom::Over);
        Ok(risk.map(|robot| ClassicCollisionSymptom::Risk { robot, block }).or(over))
    }

    fn plan(
        &mut self,
        symptom: ClassicCollisionSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<ClassicCollisionDecision>, Failure> {
        Ok(Some(match symptom {
            ClassicCollisionSymptom::Risk { robot, block } if robot < knowledge.number => {
                ClassicCollisionDecision::Stop { robot, block }
            }
            ClassicCollisionSymptom::Risk { .. } => ClassicCollisionDecision::GoOn,
            ClassicCollisionSymptom::Over => ClassicCollisionDecision::GoOnAgain,
        }))
    }

    fn execute(
        &mut self,
        decision: ClassicCollisionDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        if !matches!(decision, ClassicCollisionDecision::GoOnAgain) {
            let name = &knowledge.name;
            context.console(format_args!("{name}: RISK OF COLLISION DETECTED AND AVOIDED!"));
        }
        knowledge.variables.stop_a_period = matches!(decision, ClassicCollisionDecision::Stop { .. });
        let since = context.now();
        knowledge.note_conflict(match decision {
            ClassicCollisionDecision::Stop { robot, block } => {
                Some(Conflict { block, waits_for: robot, first: robot, rule: Precedence::Number, lent_by: 0, since })
            }
            ClassicCollisionDecision::GoOn | ClassicCollisionDecision::GoOnAgain => None,
        });
        if let ClassicCollisionDecision::Stop { robot, block } = decision {
            info!(context, "waits: robot {robot} enters {block} first");
        }
        Ok(())
    }
}
