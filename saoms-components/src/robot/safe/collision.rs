use saoms_api::{Context, Failure, Loop, LoopClass, Record, Recordable, Subscription, record};

use crate::grid::Block;
use crate::messages::{IMMOVABLE, POSITION, Position};
use crate::robot::RobotKnowledge;

/// Lets the robot enter the block that it wants only once nobody else holds or wants it.
///
/// The right of way is that of `Traffic`.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.CollisionMS",
    knowledge = RobotKnowledge,
    senses("next"),
    effects("stopAPeriod"),
    subscribes(POSITION)
)]
pub struct CollisionMS {
    positions: Subscription<Position>,
    /// For which block and robot the robot waits.
    waits: Option<(Block, u32)>,
}

/// How the block stands that the robot wants.
#[derive(Clone, Copy, Debug)]
pub enum CollisionSymptom {
    /// Another robot holds it, or wants it.
    Taken {
        /// The block.
        block: Block,
        /// The other robot.
        robot: u32,
    },
    /// It is free now.
    Clear,
}

/// Whether to go on.
#[derive(Clone, Copy, Debug)]
pub enum CollisionDecision {
    /// Wait for the other robot.
    Wait(Block, u32),
    /// Go on.
    GoOn,
}

impl Recordable for CollisionSymptom {
    fn record(&self) -> Record {
        match *self {
            CollisionSymptom::Taken { block, robot } => {
                record!("robot {robot} holds or wants {block}", robot, block)
            }
            CollisionSymptom::Clear => record!("nobody is in its way any more"),
        }
    }
}

impl Recordable for CollisionDecision {
    fn record(&self) -> Record {
        match *self {
            CollisionDecision::Wait(_, robot) => record!("waits for robot {robot}", robot),
            CollisionDecision::GoOn => record!("goes on"),
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
        knowledge.learn_obstacles();
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<CollisionSymptom>, Failure> {
        let RobotKnowledge { traffic, lists, next, .. } = knowledge;
        traffic.look(&lists.peers, *next);
        let taken = traffic.wanted(*next).and_then(|block| Some((block, traffic.in_the_way(block)?)));
        if taken == self.waits {
            return Ok(None);
        }
        Ok(Some(match taken {
            Some((block, robot)) => CollisionSymptom::Taken { block, robot },
            None => CollisionSymptom::Clear,
        }))
    }

    fn plan(
        &mut self,
        symptom: CollisionSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<CollisionDecision>, Failure> {
        Ok(Some(match symptom {
            CollisionSymptom::Taken { block, robot } => CollisionDecision::Wait(block, robot),
            CollisionSymptom::Clear => CollisionDecision::GoOn,
        }))
    }

    fn execute(
        &mut self,
        decision: CollisionDecision,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.waits = match decision {
            CollisionDecision::Wait(block, robot) => Some((block, robot)),
            CollisionDecision::GoOn => None,
        };
        knowledge.variables.stop_a_period = self.waits.is_some();
        Ok(())
    }
}

impl RobotKnowledge {
    /// Takes in where robots are that cannot move any more.
    fn learn_obstacles(&mut self) {
        let RobotKnowledge { lists, routes, .. } = self;
        lists.lost.retain(|robot| {
            let peer = lists.peers.get(*robot).filter(|peer| peer.priority == IMMOVABLE);
            if let Some(peer) = peer {
                routes.learn_obstacle(*robot, peer.block);
            }
            peer.is_none()
        });
    }
}
