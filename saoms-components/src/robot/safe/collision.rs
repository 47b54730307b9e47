use saoms_api::{Context, Failure, Field, Loop, LoopClass, Record, Recordable, Saved, Time, record};

use crate::grid::Block;
use crate::precedence::{Conflict, Precedence};
use crate::robot::RobotKnowledge;
use crate::robot::memory::lasting::lasting;
use crate::robot::zone_client::InTheWay;

/// Lets the robot enter the block that it wants only once no other robot holds or wants it.
///
/// `Traffic` decides about the right of way; in a site with zones, the zone says for which robot it has to wait.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.CollisionMS",
    knowledge = RobotKnowledge,
    senses("next", "wanted", "positions"),
    effects("stopAPeriod")
)]
pub struct SafeCollision {
    /// What the robot waits for.
    waits: Option<Wait>,
}

/// A block, and the robot that holds or wants it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
struct Wait {
    block: Block,
    robot: u32,
}

/// State of the block that the robot wants.
#[derive(Clone, Copy, Debug)]
pub enum SafeCollisionSymptom {
    /// Another robot holds or wants it.
    Taken {
        /// The block.
        block: Block,
        /// The other robot.
        robot: u32,
    },
    /// The block is free now.
    Clear,
}

/// Right of way.
#[derive(Clone, Copy, Debug)]
pub enum SafeCollisionDecision {
    /// Wait for the other robot.
    Wait(Block, u32),
    /// Go on.
    GoOn,
}

impl Recordable for SafeCollisionSymptom {
    fn record(&self) -> Record {
        match *self {
            SafeCollisionSymptom::Taken { block, robot } => {
                record!(block_taken: "robot {robot} holds or wants {block}", robot, block)
            }
            SafeCollisionSymptom::Clear => record!(way_clear: "no robot is in its way any more"),
        }
    }
}

impl Recordable for SafeCollisionDecision {
    fn record(&self) -> Record {
        match *self {
            SafeCollisionDecision::Wait(_, robot) => record!(waits_for_robot: "waits for robot {robot}", robot),
            SafeCollisionDecision::GoOn => record!(goes_on: "continues"),
        }
    }
}

lasting! {
    SafeCollision as CollisionMemory { waits: Option<Wait> }
}

impl Loop for SafeCollision {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafeCollisionSymptom;
    type Decision = SafeCollisionDecision;

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<SafeCollisionSymptom>, Failure> {
        let RobotKnowledge { traffic, next, zones, .. } = &*knowledge;
        let taken = match zones {
            Some(zones) => zones.in_the_way().map(|InTheWay { block, robot }| Wait { block, robot }),
            None => traffic.wanted(*next).and_then(|block| Some(Wait { block, robot: traffic.in_the_way(block)? })),
        };
        let conflict = taken.map(|wait| knowledge.conflict_about(wait, context.now()));
        knowledge.note_conflict(conflict);
        if taken == self.waits {
            return Ok(None);
        }
        Ok(Some(match taken {
            Some(Wait { block, robot }) => SafeCollisionSymptom::Taken { block, robot },
            None => SafeCollisionSymptom::Clear,
        }))
    }

    fn plan(
        &mut self,
        symptom: SafeCollisionSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafeCollisionDecision>, Failure> {
        Ok(Some(match symptom {
            SafeCollisionSymptom::Taken { block, robot } => SafeCollisionDecision::Wait(block, robot),
            SafeCollisionSymptom::Clear => SafeCollisionDecision::GoOn,
        }))
    }

    fn execute(
        &mut self,
        decision: SafeCollisionDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let avoided = matches!(decision, SafeCollisionDecision::Wait(..)) && self.waits.is_none();
        if avoided {
            let name = &knowledge.name;
            context.console(format_args!("{name}: RISK OF COLLISION DETECTED AND AVOIDED!"));
        }
        self.waits = match decision {
            SafeCollisionDecision::Wait(block, robot) => Some(Wait { block, robot }),
            SafeCollisionDecision::GoOn => None,
        };
        knowledge.variables.stop_a_period = self.waits.is_some();
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}

impl RobotKnowledge {
    /// Which robot goes first of this one and the one that it waits for, and why: by the rules of `Traffic`, or by
    /// those of the zone, which says why itself.
    fn conflict_about(&self, Wait { block, robot }: Wait, since: Time) -> Conflict {
        let (first, rule, lent_by) = if self.zones.is_some() {
            (robot, Precedence::Zone, 0)
        } else {
            let own = self.traffic.inherited(self.leg.priority(self.number), self.next);
            self.traffic.precedence((block, robot), (self.number, self.next, own), &self.routes)
        };
        Conflict { block, waits_for: robot, first, rule, lent_by, since }
    }
}
