use saoms_api::{Cause, Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, Saved, record};

use crate::grid::Block;
use crate::hardware::Action;
use crate::messages::{IMMOVABLE, POSITION, Position};
use crate::robot::actions::Outcome;
use crate::robot::memory::lasting::lasting;
use crate::robot::{RobotKnowledge, Variables};

use super::leg::Urgency;
use super::traffic::Claim;
use super::waiting::Waiting;

/// Drives the wheels on the way to the robot's goal, and announces the block that it wants next.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.PathFollowerMS",
    knowledge = RobotKnowledge,
    senses(
        "busy", "hasLuggage", "reachingCharge", "inCharge", "stopAPeriod", "critical", "job", "mustCharge", "relieved",
        "offersHelp", "handling", "lasts", "positions"
    ),
    effects("drive", "next", "wanted", "readyToGoUnderCharge", "reachingCharge")
)]
pub struct SafePathFollower {
    said: Option<Position>,
    waiting: Waiting,
    #[publishes(POSITION)]
    positions: Publisher<Position>,
}

/// State of the robot on its way.
#[derive(Clone, Copy, Debug)]
pub enum SafePathSymptom {
    /// The robot handles luggage, or cannot move.
    Bound {
        /// Position of the robot.
        block: Block,
    },
    /// The robot is on the way.
    OnTheWay {
        /// Block from which it continues.
        at: Block,
        /// Goal of the robot.
        goal: Block,
    },
    /// The robot is at its goal, or has none.
    There {
        /// Position of the robot.
        block: Block,
    },
}

/// Decision about the next move.
#[derive(Clone, Copy, Debug)]
pub enum SafePathDecision {
    /// Stay, without making way.
    Hold,
    /// Enter a free block.
    Go(Block),
    /// Stay for now, and announce the block that the robot wants.
    Stay,
    /// Go on with the move to the next block, and announce the block that the robot wants after it.
    MoveOn(Block),
}

impl Recordable for SafePathSymptom {
    fn record(&self) -> Record {
        match *self {
            SafePathSymptom::Bound { block } => record!(cannot_leave_block: "cannot leave {block} now", block),
            SafePathSymptom::OnTheWay { at, goal } => {
                record!(on_the_way_from: "is at {at} on its way to {goal}", at, goal)
            }
            SafePathSymptom::There { block } => record!(rests: "rests at {block}", block),
        }
    }
}

impl Recordable for SafePathDecision {
    fn record(&self) -> Record {
        match *self {
            SafePathDecision::Hold => record!(holds_block: "keeps its block"),
            SafePathDecision::Go(block) => record!(moves: "moves to {block}", block),
            SafePathDecision::Stay => record!(stays: "stays for now"),
            SafePathDecision::MoveOn(block) => record!(moves_on: "is still moving to {block}", block),
        }
    }
}

lasting! {
    SafePathFollower as PathMemory { said: Option<Position>, waiting: Waiting }
}

impl Loop for SafePathFollower {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafePathSymptom;
    type Decision = SafePathDecision;

    fn initialize(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        knowledge.polling.moves = true;
        if let Some(zones) = &mut knowledge.zones {
            zones.positions = Some(context.publish(&POSITION)?);
        }
        if context.goes_on() || knowledge.waits_to_enter() {
            // They know more than this loop yet does, or the robot is not on the floor.
            return Ok(());
        }
        // All robots have to know which blocks are held before the first one moves.
        self.say(context, knowledge.position())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.hardware.is_moving() {
            knowledge.polled = knowledge.poll(context)?;
            // Where the robot goes next has a reason of its own.
            context.because(Cause::default());
            if let Some((_, Outcome::Failed)) = knowledge.polled {
                // The wanted block is adjacent to the block that the robot did not reach.
                knowledge.traffic.stay(knowledge.next);
            }
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<SafePathSymptom>, Failure> {
        let block = knowledge.block;
        if knowledge.is_bound() {
            let said = self.said.as_ref().is_some_and(|said| {
                (said.block, said.next, said.wanted, said.priority) == (block, block, block, IMMOVABLE)
            });
            return Ok((!said).then_some(SafePathSymptom::Bound { block }));
        }
        knowledge.set_leg(context.now());
        knowledge.aim_in_zones();
        if self.rests(knowledge) {
            self.waiting.end(context);
            return Ok(None);
        }
        if knowledge.leg.urgency >= Urgency::Energy {
            context.because(knowledge.energy.turned);
        }
        Ok(Some(match knowledge.leg.goal {
            Some(goal) if knowledge.leg.urgency != Urgency::None => {
                SafePathSymptom::OnTheWay { at: knowledge.next, goal }
            }
            _ => SafePathSymptom::There { block },
        }))
    }

    fn plan(
        &mut self,
        symptom: SafePathSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafePathDecision>, Failure> {
        if let SafePathSymptom::Bound { .. } = symptom {
            return Ok(Some(SafePathDecision::Hold));
        }
        let from = knowledge.next;
        let wanted = match &knowledge.zones {
            Some(zones) => zones.next(),
            None => knowledge.traffic.wanted(from),
        };
        let wanted = wanted.filter(|_| !knowledge.variables.stop_a_period);
        Ok(Some(match wanted {
            _ if knowledge.block != from => SafePathDecision::MoveOn(from),
            Some(wanted) => SafePathDecision::Go(wanted),
            None => SafePathDecision::Stay,
        }))
    }

    fn execute(
        &mut self,
        decision: SafePathDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        if !knowledge.is_bound() {
            let variables = knowledge.homeward();
            (knowledge.variables.ready_to_go_under_charge, knowledge.variables.reaching_charge) = variables;
            knowledge.said_homeward = knowledge.must_charge || knowledge.relieved;
        }
        let goes_on = match decision {
            SafePathDecision::Hold => {
                self.waiting.end(context);
                knowledge.next = knowledge.block;
                knowledge.traffic.stay(knowledge.next);
                let position = Position { priority: IMMOVABLE, ..knowledge.position() };
                return self.say_if_news(context, position);
            }
            SafePathDecision::Go(to) => go(knowledge, context, to)?,
            SafePathDecision::Stay | SafePathDecision::MoveOn(_) => false,
        };
        knowledge.energy.pace().note_way(knowledge.leg.urgency != Urgency::None, goes_on);
        let position = want(knowledge, context);
        if position.wanted != position.next {
            knowledge.show_move(context, position.wanted);
        }
        self.waiting.note(knowledge, context);
        self.say_if_news(context, position)
    }

    fn shutdown(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        // The robot stays where it is, and no other robot gets past it.
        knowledge.next = knowledge.block;
        self.say_if_news(context, Position { priority: IMMOVABLE, ..knowledge.position() })
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}

impl SafePathFollower {
    /// True if the robot is at its goal, in no other robot's way, and the others know it: then there is nothing to
    /// decide.
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
        let makes_way = match &knowledge.zones {
            Some(zones) => zones.next().is_some(),
            None => knowledge.traffic.inherited(own, at) != own,
        };
        if !holds && makes_way {
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

    /// Announces position and next block, unless the other robots know them.
    fn say_if_news(&mut self, context: &mut Context<'_>, position: Position) -> Result<(), Failure> {
        if self.said.as_ref() == Some(&position) { Ok(()) } else { self.say(context, position) }
    }
}

/// Enters the block that was wanted in an earlier execution and is free now.
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

/// Chooses the block that the robot wants from now on.
fn want(knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Position {
    let at = knowledge.next;
    let stays = knowledge.job_here().is_some() || knowledge.holds_charger();
    let (wanted, priority) = if stays {
        knowledge.traffic.stay(at);
        (at, IMMOVABLE)
    } else {
        let own = knowledge.leg.priority(knowledge.number);
        if let Some(zones) = &knowledge.zones {
            // Right of way is the matter of zones.
            let wanted = zones.next().filter(|block| *block != at).unwrap_or(at);
            let wanted = if wanted.distance(at) == 1 { wanted } else { at };
            knowledge.traffic.follow_grant(wanted);
            return Position { wanted, priority: own, ..knowledge.position() };
        }
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
    /// True if the robot handles luggage, cannot move any more, even if its hardware cannot be reached to be told, or
    /// may not. One that is stopped on the way to a block holds both blocks until its hardware says where it is.
    pub(super) fn is_bound(&self) -> bool {
        let is_stopped = (self.stopped || self.trouble.is_some()) && !self.hardware.is_moving();
        self.hardware.is_handling() || self.variables.critical || is_stopped
    }
}
