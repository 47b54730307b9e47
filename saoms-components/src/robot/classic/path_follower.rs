use saoms_api::{Cause, Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, info, record};

use crate::grid::Block;
use crate::hardware::{Action, ActionKind};
use crate::messages::{
    CRITICAL_SITUATION, CriticalKind, CriticalSituation, EVENT_LUGGAGE, EventLuggage, POSITION, Position,
};
use crate::robot::RobotKnowledge;
use crate::robot::actions::Outcome;

/// Follows the path to a destination step by step, and collects and deposits there (listing 6.6).
///
/// Each execution enters the block that the last one announced, and announces the next block.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.PathFollowerMS",
    knowledge = RobotKnowledge,
    senses("chargeBlock", "readyToGoUnderCharge", "busy", "job", "moving", "handling"),
    effects(
        "drive", "grip", "next", "untold", "busy", "reachingCharge", "readyToGoUnderCharge", "inCharge", "asleep",
        "relieved"
    )
)]
pub struct ClassicPathFollower {
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(POSITION)]
    positions: Publisher<Position>,
    #[publishes(CRITICAL_SITUATION)]
    situations: Publisher<CriticalSituation>,
}

/// State of the robot on its path.
#[derive(Clone, Copy, Debug)]
pub enum ClassicPathSymptom {
    /// The robot has to stop for this period.
    Stopped,
    /// The hardware is running an action.
    Working,
    /// The robot is at a block where its luggage is, or has to go.
    AtDestination(Block),
    /// The robot is on the way to a destination.
    OnTheWay {
        /// Destination.
        to: Block,
        /// True if a move ended in this execution.
        moved: bool,
    },
    /// The robot is on the way to its charger.
    ToCharger {
        /// Block of the charger.
        to: Block,
        /// True if a move ended in this execution.
        moved: bool,
    },
}

/// Reaction to the state on the path.
#[derive(Clone, Copy, Debug)]
pub enum ClassicPathDecision {
    /// Stand still for this period.
    Stop,
    /// Announce the next block again.
    Announce,
    /// Use the gripper.
    Handle(Action),
    /// Go on to a destination.
    Go {
        /// Destination.
        to: Block,
        /// True if a move ended in this execution.
        moved: bool,
    },
    /// Go on to the charger.
    GoCharging {
        /// Block of the charger.
        to: Block,
        /// True if a move ended in this execution.
        moved: bool,
    },
}

impl Recordable for ClassicPathSymptom {
    fn record(&self) -> Record {
        match *self {
            ClassicPathSymptom::Stopped => record!(has_to_wait: "has to wait for this period"),
            ClassicPathSymptom::Working => record!(action_running: "has not finished its last action"),
            ClassicPathSymptom::AtDestination(block) => record!(at_destination: "is at its destination {block}", block),
            ClassicPathSymptom::OnTheWay { to, .. } => record!(on_the_way: "is on its way to {to}", to),
            ClassicPathSymptom::ToCharger { to, .. } => {
                record!(on_the_way_to_charger: "is on its way to its charger at {to}", to)
            }
        }
    }
}

impl Recordable for ClassicPathDecision {
    fn record(&self) -> Record {
        match *self {
            ClassicPathDecision::Stop => record!(waits: "waits"),
            ClassicPathDecision::Announce => record!(repeats_position: "announces its next block again"),
            ClassicPathDecision::Handle(Action { kind: ActionKind::Collect, luggage, .. }) => {
                record!(collects_luggage: "collects luggage {luggage}", luggage)
            }
            ClassicPathDecision::Handle(Action { luggage, .. }) => {
                record!(deposits_luggage: "deposits luggage {luggage}", luggage)
            }
            ClassicPathDecision::Go { .. } | ClassicPathDecision::GoCharging { .. } => record!(goes_on: "continues"),
        }
    }
}

impl Loop for ClassicPathFollower {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = ClassicPathSymptom;
    type Decision = ClassicPathDecision;

    fn initialize(&mut self, knowledge: &mut RobotKnowledge, _context: &mut Context<'_>) -> Result<(), Failure> {
        (knowledge.polling.moves, knowledge.polling.handling) = (true, true);
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<ClassicPathSymptom>, Failure> {
        if knowledge.shut_down {
            return Ok(None);
        }
        if knowledge.variables.stop_a_period {
            return Ok(Some(ClassicPathSymptom::Stopped));
        }
        let polled = knowledge.poll(context)?;
        knowledge.report_outcome(self.luggage, context)?;
        // Where the robot goes next has a reason of its own.
        context.because(Cause::default());
        match polled {
            Some((_, outcome)) if outcome.is_open() => return Ok(Some(ClassicPathSymptom::Working)),
            Some((Action { kind: ActionKind::Collect | ActionKind::Deposit, .. }, _)) => return Ok(None),
            Some(_) | None => {}
        }
        let moved = polled.is_some();
        let stands = knowledge.next == knowledge.block && !moved;
        Ok(match knowledge.destination() {
            Some(to) if stands && knowledge.block == to => Some(ClassicPathSymptom::AtDestination(to)),
            Some(to) => Some(ClassicPathSymptom::OnTheWay { to, moved }),
            None if knowledge.variables.ready_to_go_under_charge => {
                Some(ClassicPathSymptom::ToCharger { to: knowledge.charge_block, moved })
            }
            None => None,
        })
    }

    fn plan(
        &mut self,
        symptom: ClassicPathSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<ClassicPathDecision>, Failure> {
        Ok(match symptom {
            ClassicPathSymptom::Stopped => Some(ClassicPathDecision::Stop),
            ClassicPathSymptom::Working => (knowledge.next != knowledge.block).then_some(ClassicPathDecision::Announce),
            ClassicPathSymptom::AtDestination(block) => knowledge.job.map(|job| {
                let has_luggage = knowledge.variables.has_luggage;
                let action = if has_luggage { Action::deposit } else { Action::collect };
                ClassicPathDecision::Handle(action(job.luggage, block))
            }),
            ClassicPathSymptom::OnTheWay { to, moved } => Some(ClassicPathDecision::Go { to, moved }),
            ClassicPathSymptom::ToCharger { to, moved } => Some(ClassicPathDecision::GoCharging { to, moved }),
        })
    }

    fn execute(
        &mut self,
        decision: ClassicPathDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            ClassicPathDecision::Stop | ClassicPathDecision::Announce => {}
            ClassicPathDecision::Handle(action) => {
                knowledge.begin(context, action)?;
                return knowledge.report_outcome(self.luggage, context);
            }
            ClassicPathDecision::Go { to, moved } => {
                if reach(knowledge, context, to, Block::step_x_first, moved)? {
                    let name = &knowledge.name;
                    context.console(format_args!("{name} says: I've arrived to destination."));
                }
            }
            ClassicPathDecision::GoCharging { to, moved } => {
                if go_charging(knowledge, context, to, moved)? {
                    return self.ask_for_substitute(knowledge, context);
                }
            }
        }
        context.send(&self.positions, knowledge.position())
    }
}

impl ClassicPathFollower {
    /// Asks for a substitute for a charging robot, unless it was sent to charge.
    fn ask_for_substitute(&self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
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
    info!(context, "starts charging (battery {} %)", knowledge.battery);
    let variables = &mut knowledge.variables;
    (variables.reaching_charge, variables.ready_to_go_under_charge) = (false, false);
    (variables.in_charge, variables.asleep, variables.busy) = (true, true, true);
    Ok(true)
}

/// Moves to the announced block and announces the next one; `true` once the robot is at its destination.
fn reach(
    knowledge: &mut RobotKnowledge,
    context: &mut Context<'_>,
    to: Block,
    step: fn(Block, Block) -> Block,
    moved: bool,
) -> Result<bool, Failure> {
    let next = knowledge.next;
    if next != knowledge.block && !moved && knowledge.begin(context, Action::move_to(next))? != Outcome::Done {
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
