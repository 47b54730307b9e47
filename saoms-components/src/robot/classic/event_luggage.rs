use std::cmp::Reverse;

use saoms_api::{Cause, Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, Saved, info, record};

use crate::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use crate::robot::memory::lasting::lasting;
use crate::robot::{Job, Request, RobotKnowledge};

/// Decides which robot brings which luggage (listings 6.5 and 6.9).
///
/// A robot takes an interest in the oldest request. In its next execution it knows the others' interest: the closest
/// robot goes.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.EventLuggageMS",
    knowledge = RobotKnowledge,
    senses("block", "inCharge", "readyToGoUnderCharge", "requests"),
    effects("busy", "transporter", "job")
)]
pub struct ClassicEventLuggage {
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    /// Cause of its interest; its next decision about that luggage follows from it.
    said: Cause,
}

/// Luggage that a robot can decide about.
#[derive(Clone, Copy, Debug)]
pub enum ClassicLuggageSymptom {
    /// The oldest luggage that waits.
    Waiting(Job),
    /// The robot is interested, and no other robot is closer.
    Closest(Job),
    /// Another robot is closer, or took the luggage.
    Beaten,
}

/// Reaction to the state of luggage.
#[derive(Clone, Copy, Debug)]
pub enum ClassicLuggageDecision {
    /// Take an interest in it.
    TakeInterest,
    /// Bring it.
    Take(Job),
    /// Become free again.
    Forget,
}

impl Recordable for ClassicLuggageSymptom {
    fn record(&self) -> Record {
        match *self {
            ClassicLuggageSymptom::Waiting(Job { luggage, from, .. }) => {
                record!(oldest_luggage_waits: "luggage {luggage} waits at {from}", luggage, from)
            }
            ClassicLuggageSymptom::Closest(Job { luggage, .. }) => {
                record!(closest_to_luggage: "no other robot that offers to carry luggage {luggage} is closer", luggage)
            }
            ClassicLuggageSymptom::Beaten => {
                record!(other_robot_closer_to_luggage: "another robot is closer to the luggage")
            }
        }
    }
}

impl Recordable for ClassicLuggageDecision {
    fn record(&self) -> Record {
        match *self {
            ClassicLuggageDecision::TakeInterest => record!(offers_to_carry: "offers to carry it"),
            ClassicLuggageDecision::Take(Job { luggage, from, to }) => {
                record!(takes_luggage: "takes luggage {luggage} from {from} to {to}", luggage, from, to)
            }
            ClassicLuggageDecision::Forget => record!(is_free: "is free again"),
        }
    }
}

lasting! {
    ClassicEventLuggage as LuggageMemory { said: Cause }
}

impl Loop for ClassicEventLuggage {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = ClassicLuggageSymptom;
    type Decision = ClassicLuggageDecision;

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, _context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.hardware.has_entered() {
            knowledge.lists.requests.drop_contested();
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<ClassicLuggageSymptom>, Failure> {
        let variables = &knowledge.variables;
        if variables.busy || variables.in_charge || variables.healer || variables.critical {
            return Ok(None);
        }
        // Other robots dropped the luggage that this robot is interested in, so it has to decide about it in any case.
        if variables.transporter {
            context.because(self.said);
            let request = knowledge.lists.requests.claimed();
            let closest = request.filter(|request| is_closest(knowledge, request));
            let symptom = closest.map(|request| ClassicLuggageSymptom::Closest(request.job));
            return Ok(symptom.or(Some(ClassicLuggageSymptom::Beaten)));
        }
        if variables.ready_to_go_under_charge {
            return Ok(None);
        }
        let Some(request) = knowledge.lists.requests.open().first() else { return Ok(None) };
        context.because(request.cause);
        Ok(Some(ClassicLuggageSymptom::Waiting(request.job)))
    }

    fn plan(
        &mut self,
        symptom: ClassicLuggageSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<ClassicLuggageDecision>, Failure> {
        Ok(Some(match symptom {
            ClassicLuggageSymptom::Waiting(_) => ClassicLuggageDecision::TakeInterest,
            ClassicLuggageSymptom::Closest(job) => ClassicLuggageDecision::Take(job),
            ClassicLuggageSymptom::Beaten => ClassicLuggageDecision::Forget,
        }))
    }

    fn execute(
        &mut self,
        decision: ClassicLuggageDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let (job, stage) = match decision {
            ClassicLuggageDecision::TakeInterest => {
                let Some(request) = knowledge.lists.requests.claim(0) else { return Ok(()) };
                let job = request.job;
                knowledge.variables.transporter = true;
                self.said = context.cause();
                let name = &knowledge.name;
                context.console(format_args!("{name} is bringing luggage from {} to {}", job.from, job.to));
                (job, LuggageStage::Interest)
            }
            ClassicLuggageDecision::Take(job) => {
                knowledge.lists.requests.settle();
                knowledge.variables.busy = true;
                knowledge.job = Some(job);
                info!(context, "takes luggage {} from {} to {}", job.luggage, job.from, job.to);
                (job, LuggageStage::Taken)
            }
            ClassicLuggageDecision::Forget => {
                knowledge.lists.requests.settle();
                knowledge.variables.transporter = false;
                return Ok(());
            }
        };
        context.send(&self.luggage, job.response(knowledge.number, knowledge.block, stage))
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}

/// True if the robot is the closest by straight-line distance; of equally close robots the one with the lowest number
/// is.
fn is_closest(knowledge: &RobotKnowledge, request: &Request) -> bool {
    let from = request.job.from;
    let mine = (knowledge.block.straight_squared(from), knowledge.number);
    let best = request.rivals.iter().max_by_key(|rival| Reverse((rival.block.straight_squared(from), rival.robot)));
    best.is_none_or(|rival| mine < (rival.block.straight_squared(from), rival.robot))
}
