use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, record};

use crate::grid::Block;
use crate::hardware::{Action, ActionKind};
use crate::messages::{
    CRITICAL_SITUATION, CriticalKind, CriticalSituation, EVENT_LUGGAGE, EventLuggage, POSITION, Position,
};
use crate::robot::RobotKnowledge;
use crate::robot::actions::Outcome;

/// Follows the path to a destination step by step, and collects and deposits there (listing 6.6).
///
/// What was announced in the last execution is driven now, and the next block is announced.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.PathFollowerMS",
    knowledge = RobotKnowledge,
    senses("chargeBlock", "readyToGoUnderCharge", "busy"),
    effects("block", "next", "job", "busy", "transporter", "hasLuggage", "reachingCharge", "inCharge"),
    publishes(POSITION, EVENT_LUGGAGE, CRITICAL_SITUATION)
)]
pub struct PathFollowerMS {
    luggage: Publisher<EventLuggage>,
    positions: Publisher<Position>,
    situations: Publisher<CriticalSituation>,
}

/// How the robot stands on its path.
#[derive(Clone, Copy, Debug)]
pub enum PathSymptom {
    /// It may not go on in this period.
    Stopped,
    /// The hardware is at work.
    Working,
    /// It is where luggage is, or has to go.
    AtDestination(Block),
    /// It is on the way to a destination.
    OnTheWay {
        /// Where.
        to: Block,
        /// Whether a move ended in this execution.
        moved: bool,
    },
    /// It is on the way to its charger.
    ToCharger {
        /// Where.
        to: Block,
        /// Whether a move ended in this execution.
        moved: bool,
    },
}

/// What to do.
#[derive(Clone, Copy, Debug)]
pub enum PathDecision {
    /// Stand still for this period.
    Stop,
    /// Say again where it goes.
    Announce,
    /// Work the gripper.
    Handle(Action),
    /// Go on to a destination.
    Go {
        /// Where.
        to: Block,
        /// Whether a move ended in this execution.
        moved: bool,
    },
    /// Go on to the charger.
    GoCharging {
        /// Where.
        to: Block,
        /// Whether a move ended in this execution.
        moved: bool,
    },
}

impl Recordable for PathSymptom {
    fn record(&self) -> Record {
        match *self {
            PathSymptom::Stopped => record!("has to stop for this period"),
            PathSymptom::Working => record!("is still at work"),
            PathSymptom::AtDestination(block) => record!("is at its destination {block}", block),
            PathSymptom::OnTheWay { to, .. } => record!("is on the way to {to}", to),
            PathSymptom::ToCharger { to, .. } => record!("is on the way to its charger at {to}", to),
        }
    }
}

impl Recordable for PathDecision {
    fn record(&self) -> Record {
        match *self {
            PathDecision::Stop => record!("stands still"),
            PathDecision::Announce => record!("says again where it goes"),
            PathDecision::Handle(Action { kind: ActionKind::Collect, luggage, .. }) => {
                record!("collects luggage {luggage}", luggage)
            }
            PathDecision::Handle(Action { luggage, .. }) => record!("deposits luggage {luggage}", luggage),
            PathDecision::Go { .. } | PathDecision::GoCharging { .. } => record!("goes on"),
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
        _knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.luggage = context.publish(&EVENT_LUGGAGE)?;
        self.positions = context.publish(&POSITION)?;
        self.situations = context.publish(&CRITICAL_SITUATION)?;
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<PathSymptom>, Failure> {
        if knowledge.shut_down {
            return Ok(None);
        }
        if knowledge.variables.stop_a_period {
            return Ok(Some(PathSymptom::Stopped));
        }
        let polled = knowledge.poll(context)?;
        knowledge.tell(self.luggage, context)?;
        match polled {
            Some((_, outcome)) if outcome.is_open() => return Ok(Some(PathSymptom::Working)),
            Some((Action { kind: ActionKind::Collect | ActionKind::Deposit, .. }, _)) => return Ok(None),
            Some(_) | None => {}
        }
        let moved = polled.is_some();
        let stands = knowledge.next == knowledge.block && !moved;
        Ok(match knowledge.destination() {
            Some(to) if stands && knowledge.block == to => Some(PathSymptom::AtDestination(to)),
            Some(to) => Some(PathSymptom::OnTheWay { to, moved }),
            None if knowledge.variables.ready_to_go_under_charge => {
                Some(PathSymptom::ToCharger { to: knowledge.charge_block, moved })
            }
            None => None,
        })
    }

    fn plan(
        &mut self,
        symptom: PathSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<PathDecision>, Failure> {
        Ok(match symptom {
            PathSymptom::Stopped => Some(PathDecision::Stop),
            PathSymptom::Working => (knowledge.next != knowledge.block).then_some(PathDecision::Announce),
            PathSymptom::AtDestination(block) => knowledge.job.map(|job| {
                let has_luggage = knowledge.variables.has_luggage;
                let action = if has_luggage { Action::deposit } else { Action::collect };
                PathDecision::Handle(action(job.luggage, block))
            }),
            PathSymptom::OnTheWay { to, moved } => Some(PathDecision::Go { to, moved }),
            PathSymptom::ToCharger { to, moved } => Some(PathDecision::GoCharging { to, moved }),
        })
    }

    fn execute(
        &mut self,
        decision: PathDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            PathDecision::Stop | PathDecision::Announce => {}
            PathDecision::Handle(action) => {
                knowledge.begin(context, action)?;
                return knowledge.tell(self.luggage, context);
            }
            PathDecision::Go { to, moved } => {
                if reach(knowledge, context, to, Block::step_x_first, moved)? {
                    let name = &knowledge.name;
                    context.console(format_args!("{name} says: I've arrived to destination."));
                }
            }
            PathDecision::GoCharging { to, moved } => {
                if go_charging(knowledge, context, to, moved)? {
                    return self.ask_for_substitute(knowledge, context);
                }
            }
        }
        context.send(&self.positions, knowledge.position())
    }
}

impl PathFollowerMS {
    /// Somebody has to stand in for a robot in charge, unless it was sent there.
    fn ask_for_substitute(
        &self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        if std::mem::take(&mut knowledge.relieved) {
            return Ok(());
        }
        context.send(&self.situations, knowledge.situation(CriticalKind::Idle))
    }
}

/// Goes on to the charger; `true` once the robot is there.
fn go_charging(
    knowledge: &mut RobotKnowledge,
    context: &mut Context<'_>,
    charge_block: Block,
    moved: bool,
) -> Result<bool, Failure> {
    let name = &knowledge.name;
    context.console(format_args!("{name} has low battery and is going under charge..."));
    knowledge.variables.reaching_charge = true;
    if !reach(knowledge, context, charge_block, Block::step_y_first, moved)? {
        return Ok(false);
    }
    let name = &knowledge.name;
    context.console(format_args!("{name} says: I've arrived to charge position."));
    context.info(format_args!("charges (battery {} %)", knowledge.battery));
    let variables = &mut knowledge.variables;
    (variables.reaching_charge, variables.ready_to_go_under_charge) = (false, false);
    (variables.in_charge, variables.asleep, variables.busy) = (true, true, true);
    Ok(true)
}

/// Drives to the announced block and announces the next one; `true` once the robot is there.
fn reach(
    knowledge: &mut RobotKnowledge,
    context: &mut Context<'_>,
    to: Block,
    step: fn(Block, Block) -> Block,
    moved: bool,
) -> Result<bool, Failure> {
    let next = knowledge.next;
    if next != knowledge.block && !moved && knowledge.begin(context, Action::move_to(next))? != Outcome::Done
    {
        return Ok(false);
    }
    let block = knowledge.block;
    if block == to {
        return Ok(true);
    }
    let next = step(block, to);
    knowledge.show_move(context, next);
    knowledge.next = next;
    Ok(false)
}
