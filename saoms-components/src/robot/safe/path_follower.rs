use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, record};

use crate::grid::Block;
use crate::hardware::Action;
use crate::messages::{IMMOVABLE, POSITION, Position};
use crate::robot::actions::Outcome;
use crate::robot::{RobotKnowledge, Variables};

use super::leg::Urgency;
use super::traffic::Claim;

/// A robot tells that it waits when it does so for so many executions.
const TELLING_WAIT: u32 = 3;

/// Drives the wheels along the way to where the robot has to be, and says which block it wants next.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.PathFollowerMS",
    knowledge = RobotKnowledge,
    senses("busy", "hasLuggage", "reachingCharge", "inCharge", "stopAPeriod", "critical"),
    effects("block", "next", "readyToGoUnderCharge", "reachingCharge"),
    publishes(POSITION)
)]
pub struct PathFollowerMS {
    said: Option<Position>,
    positions: Publisher<Position>,
}

/// How the robot stands on its way.
#[derive(Clone, Copy, Debug)]
pub enum PathSymptom {
    /// It works with luggage, or cannot move.
    Bound {
        /// Where.
        block: Block,
    },
    /// It is on the way.
    OnTheWay {
        /// From where it goes on.
        at: Block,
        /// Where it has to be.
        goal: Block,
    },
    /// It is where it has to be, or has no place to be.
    There {
        /// Where.
        block: Block,
    },
}

/// What to do with the wheels.
#[derive(Clone, Copy, Debug)]
pub enum PathDecision {
    /// Stay whoever comes.
    Hold,
    /// Go to a block that is clear.
    Go(Block),
    /// Stay for now, and say what the robot wants.
    Stay,
}

impl Recordable for PathSymptom {
    fn record(&self) -> Record {
        match *self {
            PathSymptom::Bound { block } => record!("is bound to {block}", block),
            PathSymptom::OnTheWay { at, goal } => record!("is at {at} on its way to {goal}", at, goal),
            PathSymptom::There { block } => record!("rests at {block}", block),
        }
    }
}

impl Recordable for PathDecision {
    fn record(&self) -> Record {
        match *self {
            PathDecision::Hold => record!("lets nobody pass"),
            PathDecision::Go(block) => record!("moves to {block}", block),
            PathDecision::Stay => record!("stays for now"),
        }
    }
}

impl Loop for PathFollowerMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = PathSymptom;
    type Decision = PathDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(PathFollowerMS::default())
    }

    fn initialize(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.positions = context.publish(&POSITION)?;
        // Before anybody moves, everybody has to know which blocks are held.
        self.say(context, knowledge.position())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.hooks.is_moving() {
            knowledge.polled = knowledge.poll(context)?;
            if let Some((_, Outcome::Failed)) = knowledge.polled {
                // What it wanted is beside the block that it did not get to.
                knowledge.traffic.stay(knowledge.next);
            }
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<PathSymptom>, Failure> {
        let block = knowledge.block;
        if knowledge.is_bound() {
            let said = self.said.as_ref().is_some_and(|said| {
                (said.block, said.next, said.wanted, said.priority) == (block, block, block, IMMOVABLE)
            });
            return Ok((!said).then_some(PathSymptom::Bound { block }));
        }
        knowledge.set_leg(context.now());
        if self.rests(knowledge) {
            return Ok(None);
        }
        Ok(Some(match knowledge.leg.goal {
            Some(goal) if knowledge.leg.urgency != Urgency::None => {
                PathSymptom::OnTheWay { at: knowledge.next, goal }
            }
            _ => PathSymptom::There { block },
        }))
    }

    fn plan(
        &mut self,
        symptom: PathSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<PathDecision>, Failure> {
        if let PathSymptom::Bound { .. } = symptom {
            return Ok(Some(PathDecision::Hold));
        }
        let from = knowledge.next;
        let wanted = knowledge.traffic.wanted(from).filter(|_| !knowledge.variables.stop_a_period);
        Ok(Some(match wanted {
            Some(wanted) if knowledge.block == from => PathDecision::Go(wanted),
            _ => PathDecision::Stay,
        }))
    }

    fn execute(
        &mut self,
        decision: PathDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        if !knowledge.is_bound() {
            let variables = knowledge.homeward();
            (knowledge.variables.ready_to_go_under_charge, knowledge.variables.reaching_charge) = variables;
        }
        let goes_on = match decision {
            PathDecision::Hold => {
                knowledge.next = knowledge.block;
                knowledge.traffic.stay(knowledge.next);
                let position = Position { priority: IMMOVABLE, ..knowledge.position() };
                return self.say_if_news(context, position);
            }
            PathDecision::Go(to) => go(knowledge, context, to)?,
            PathDecision::Stay => false,
        };
        knowledge.energy.pace().note_way(knowledge.leg.urgency != Urgency::None, goes_on);
        let position = want(knowledge, context);
        if position.wanted != position.next {
            knowledge.show_move(context, position.wanted);
        }
        if knowledge.traffic.waited() == TELLING_WAIT {
            context.info(format_args!("waits at {} for others", position.next));
        }
        self.say_if_news(context, position)
    }

    fn shutdown(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        // The robot stays where it is, and nobody else gets past it.
        knowledge.next = knowledge.block;
        self.say_if_news(context, Position { priority: IMMOVABLE, ..knowledge.position() })
    }
}

impl PathFollowerMS {
    /// Whether the robot is where it wants to be, in nobody's way, and the others know it: then there is nothing to do.
    fn rests(&self, knowledge: &mut RobotKnowledge) -> bool {
        let at = knowledge.next;
        let Variables { ready_to_go_under_charge, reaching_charge, .. } = knowledge.variables;
        if (ready_to_go_under_charge, reaching_charge) != knowledge.homeward() {
            return false;
        }
        let on_the_way = knowledge.leg.urgency != Urgency::None || knowledge.block != at;
        if on_the_way || knowledge.traffic.wanted(at).is_some() {
            return false;
        }
        let own = knowledge.leg.priority(knowledge.number);
        let holds = knowledge.job_here().is_some() || knowledge.holds_charger();
        if !holds && knowledge.traffic.inherited(own, at) != own {
            return false;
        }
        let priority = if holds { IMMOVABLE } else { own };
        let rests = self.said == Some(Position { priority, ..knowledge.position() });
        if rests {
            knowledge.traffic.stay(at);
            knowledge.energy.pace().note_way(false, false);
        }
        rests
    }

    fn say(&mut self, context: &mut Context<'_>, position: Position) -> Result<(), Failure> {
        self.said = Some(position.clone());
        context.send(&self.positions, position)
    }

    /// Says where the robot is and goes, where the others do not know that already.
    fn say_if_news(&mut self, context: &mut Context<'_>, position: Position) -> Result<(), Failure> {
        if self.said.as_ref() == Some(&position) { Ok(()) } else { self.say(context, position) }
    }
}

/// Goes to the block that was wanted in an earlier execution and is clear now.
fn go(knowledge: &mut RobotKnowledge, context: &mut Context<'_>, to: Block) -> Result<bool, Failure> {
    let from = knowledge.next;
    let outcome = knowledge.begin(context, Action::move_to(to))?;
    let goes_on = matches!(outcome, Outcome::Done | Outcome::Running);
    if goes_on {
        knowledge.traffic.went(from);
        knowledge.traffic.look(&knowledge.lists.peers, to);
    }
    Ok(goes_on)
}

/// Decides which block to want from now on.
fn want(knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Position {
    let at = knowledge.next;
    let stays = knowledge.job_here().is_some() || knowledge.holds_charger();
    let (wanted, priority) = if stays {
        knowledge.traffic.stay(at);
        (at, IMMOVABLE)
    } else {
        let own = knowledge.leg.priority(knowledge.number);
        let priority = knowledge.traffic.inherited(own, at);
        let goal = knowledge.leg.goal;
        let y_first = goal == Some(knowledge.charge_block);
        let tempo = if knowledge.block == at { knowledge.tempo() } else { 0 };
        let claim = Claim { robot: knowledge.number, at, goal, y_first, priority, tempo };
        (knowledge.traffic.choose(&claim, own, &knowledge.routes, context.chance()), priority)
    };
    Position { wanted, priority, ..knowledge.position() }
}

impl RobotKnowledge {
    /// Whether the robot works with luggage, or cannot move any more.
    fn is_bound(&self) -> bool {
        self.hooks.is_handling() || self.variables.critical
    }
}
