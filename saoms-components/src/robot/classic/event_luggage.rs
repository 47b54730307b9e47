use std::cmp::Reverse;

use saoms_api::{
    Cause, Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, Subscription, record,
};

use crate::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use crate::robot::{Job, Request, RobotKnowledge};

/// Decides which robot brings which luggage (listings 6.5 and 6.9).
///
/// A robot takes an interest in the oldest request; in its next execution, when the others' responses are known, the closest robot goes.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.EventLuggageMS",
    knowledge = RobotKnowledge,
    senses("block", "inCharge", "readyToGoUnderCharge"),
    effects("busy", "transporter", "job"),
    publishes(EVENT_LUGGAGE),
    subscribes(EVENT_LUGGAGE)
)]
pub struct EventLuggageMS {
    luggage: Publisher<EventLuggage>,
    luggage_heard: Subscription<EventLuggage>,
    /// Why it took an interest: what it decides about that luggage next follows from this.
    said: Cause,
}

/// What there is to decide.
#[derive(Clone, Copy, Debug)]
pub enum EventLuggageSymptom {
    /// This is the oldest luggage that waits.
    Waiting(Job),
    /// The robot is interested, and no other robot is closer.
    Closest(Job),
    /// Another robot is closer, or took it.
    Beaten,
}

/// What to do.
#[derive(Clone, Copy, Debug)]
pub enum EventLuggageDecision {
    /// Take an interest.
    TakeInterest,
    /// Bring it.
    Take(Job),
    /// Be free again.
    Forget,
}

impl Recordable for EventLuggageSymptom {
    fn record(&self) -> Record {
        match *self {
            EventLuggageSymptom::Waiting(Job { luggage, from, .. }) => {
                record!("luggage {luggage} waits at {from}", luggage, from)
            }
            EventLuggageSymptom::Closest(Job { luggage, .. }) => {
                record!("no other robot that is interested in luggage {luggage} is closer", luggage)
            }
            EventLuggageSymptom::Beaten => record!("another robot is closer to the luggage"),
        }
    }
}

impl Recordable for EventLuggageDecision {
    fn record(&self) -> Record {
        match *self {
            EventLuggageDecision::TakeInterest => record!("would bring it"),
            EventLuggageDecision::Take(Job { luggage, from, to }) => {
                record!("brings luggage {luggage} from {from} to {to}", luggage, from, to)
            }
            EventLuggageDecision::Forget => record!("is free again"),
        }
    }
}

impl Loop for EventLuggageMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = EventLuggageSymptom;
    type Decision = EventLuggageDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(EventLuggageMS::default())
    }

    fn initialize(
        &mut self,
        _knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.luggage = context.publish(&EVENT_LUGGAGE)?;
        self.luggage_heard = context.subscribe(&EVENT_LUGGAGE)?;
        Ok(())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        knowledge.hear_luggage(self.luggage_heard, context);
        if knowledge.hooks.has_entered() {
            knowledge.lists.requests.drop_contested();
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<EventLuggageSymptom>, Failure> {
        let variables = &knowledge.variables;
        if variables.busy || variables.in_charge || variables.healer || variables.critical {
            return Ok(None);
        }
        // Others dropped what it took an interest in, so that it decides about that whatever happened since.
        if variables.transporter {
            context.because(self.said);
            let request = knowledge.lists.requests.claimed();
            let closest = request.filter(|request| is_closest(knowledge, request));
            let symptom = closest.map(|request| EventLuggageSymptom::Closest(request.job));
            return Ok(symptom.or(Some(EventLuggageSymptom::Beaten)));
        }
        if variables.ready_to_go_under_charge {
            return Ok(None);
        }
        let Some(request) = knowledge.lists.requests.open().first() else { return Ok(None) };
        context.because(request.cause);
        Ok(Some(EventLuggageSymptom::Waiting(request.job)))
    }

    fn plan(
        &mut self,
        symptom: EventLuggageSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<EventLuggageDecision>, Failure> {
        Ok(Some(match symptom {
            EventLuggageSymptom::Waiting(_) => EventLuggageDecision::TakeInterest,
            EventLuggageSymptom::Closest(job) => EventLuggageDecision::Take(job),
            EventLuggageSymptom::Beaten => EventLuggageDecision::Forget,
        }))
    }

    fn execute(
        &mut self,
        decision: EventLuggageDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let (job, stage) = match decision {
            EventLuggageDecision::TakeInterest => {
                let Some(request) = knowledge.lists.requests.claim(0) else { return Ok(()) };
                let job = request.job;
                knowledge.variables.transporter = true;
                self.said = context.cause();
                let name = &knowledge.name;
                context.console(format_args!("{name} is bringing luggage from {} to {}", job.from, job.to));
                (job, LuggageStage::Interest)
            }
            EventLuggageDecision::Take(job) => {
                knowledge.lists.requests.settle();
                knowledge.variables.busy = true;
                knowledge.job = Some(job);
                context.info(format_args!("takes luggage {} from {} to {}", job.luggage, job.from, job.to));
                (job, LuggageStage::Taken)
            }
            EventLuggageDecision::Forget => {
                knowledge.lists.requests.settle();
                knowledge.variables.transporter = false;
                return Ok(());
            }
        };
        context.send(&self.luggage, job.response(knowledge.number, knowledge.block, stage))
    }
}

/// By straight-line distance; at the same distance the lower number is the closest.
fn is_closest(knowledge: &RobotKnowledge, request: &Request) -> bool {
    let from = request.job.from;
    let mine = (knowledge.block.straight_squared(from), knowledge.number);
    let best =
        request.rivals.iter().max_by_key(|rival| Reverse((rival.block.straight_squared(from), rival.robot)));
    best.is_none_or(|rival| mine < (rival.block.straight_squared(from), rival.robot))
}
