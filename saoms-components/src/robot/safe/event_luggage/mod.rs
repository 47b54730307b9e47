//! Luggage that waits for a robot, and how robots part it among them.

mod records;

use saoms_api::{Cause, Context, Failure, Level, Loop, LoopClass, Publisher, Subscription};

use crate::grid::{Block, UNREACHABLE};
use crate::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use crate::robot::{Job, Request, RobotKnowledge};

use super::energy::Means;
use super::patience::{Attempt, Idle};

pub(super) use records::{EventLuggageDecision, EventLuggageSymptom, Hindrance};

/// A request that waits for so many executions counts as one block closer, so that none waits for ever.
const PATIENCE: u64 = 4;

/// Decides which luggage this robot brings.
///
/// A free robot takes an interest in one request and says so, from where it is. It takes the job in an execution in which no interest of
/// another robot is known; where there are several, all but the closest take theirs back and the closest waits for that. Of two robots
/// at least one hears of the other's interest before it decides, so no luggage is taken twice, however late messages are.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.EventLuggageMS",
    knowledge = RobotKnowledge,
    senses("block", "battery", "asleep"),
    effects("job", "busy", "transporter"),
    publishes(EVENT_LUGGAGE),
    subscribes(EVENT_LUGGAGE)
)]
pub struct EventLuggageMS {
    /// From where the robot said that it is interested.
    said_at: Block,
    /// Why: what it decides about that luggage next follows from this.
    said: Cause,
    /// Whether it warned that some luggage is out of its reach.
    warned: bool,
    /// How often other ways had become necessary when it looked at its way, and to where that led.
    seen: (u32, Option<Block>),
    attempt: Attempt,
    idle: Idle,
    luggage: Publisher<EventLuggage>,
    luggage_heard: Subscription<EventLuggage>,
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
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<EventLuggageSymptom>, Failure> {
        if let Some(symptom) = self.look_at_way(knowledge) {
            return Ok(Some(symptom));
        }
        if let Some((job, to)) = knowledge.strives_in_vain() {
            let carries = knowledge.variables.has_luggage;
            return Ok(Some(EventLuggageSymptom::TooFar { job, to, carries }));
        }
        let in_vain = self.look_at_idleness(knowledge, context);
        if knowledge.hooks.running().is_none()
            && let Some(symptom) = self.look_at_time(knowledge)
        {
            return Ok(Some(symptom));
        }
        let variables = &knowledge.variables;
        if variables.busy || variables.critical || knowledge.hooks.running().is_some() {
            return Ok(None);
        }
        if knowledge.variables.transporter {
            context.because(self.said);
            return Ok(self.look_at_claimed(knowledge));
        }
        if in_vain.is_some() {
            return Ok(in_vain);
        }
        if knowledge.variables.asleep || knowledge.energy.must_charge() || knowledge.relieved {
            return Ok(judge(knowledge));
        }
        if knowledge.offers_help {
            return Ok(None);
        }
        knowledge.keep_usual_reserve();
        let Some((symptom, cause)) = look_for_luggage(knowledge, context) else { return Ok(None) };
        context.because(cause);
        Ok(Some(symptom))
    }

    fn plan(
        &mut self,
        symptom: EventLuggageSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<EventLuggageDecision>, Failure> {
        Ok(Some(match symptom {
            EventLuggageSymptom::Waiting { place, job, .. } => match knowledge.means(&job) {
                Means::Enough => EventLuggageDecision::TakeInterest { place, job },
                Means::Needs(needs) => EventLuggageDecision::Postpone { place, needs },
                Means::Never => EventLuggageDecision::Refuse { job, why: Hindrance::Battery },
            },
            EventLuggageSymptom::InVain(job) => EventLuggageDecision::Refuse { job, why: Hindrance::Others },
            EventLuggageSymptom::Alone(job) => EventLuggageDecision::Take(job),
            EventLuggageSymptom::Beaten { job, .. } => EventLuggageDecision::Release(job),
            EventLuggageSymptom::Gone => EventLuggageDecision::Forget,
            EventLuggageSymptom::CutOff { job, carries, .. } => leave(job, carries, Hindrance::NoWay),
            EventLuggageSymptom::TooFar { job, carries, .. } => leave(job, carries, Hindrance::Battery),
            EventLuggageSymptom::Stuck { job, carries, .. } => leave(job, carries, Hindrance::Others),
        }))
    }

    fn execute(
        &mut self,
        decision: EventLuggageDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let stage = match decision {
            EventLuggageDecision::TakeInterest { place, job } => {
                knowledge.lists.requests.claim(place);
                knowledge.variables.transporter = true;
                (self.said_at, self.said) = (knowledge.block, context.cause());
                let name = &knowledge.name;
                context.console(format_args!("{name} is bringing luggage from {} to {}", job.from, job.to));
                (job, LuggageStage::Interest)
            }
            EventLuggageDecision::Postpone { place, needs } => {
                knowledge.lists.requests.open_mut()[place].needs = needs;
                return Ok(());
            }
            EventLuggageDecision::Refuse { job, why } => {
                knowledge.lists.requests.refuse(job.luggage);
                if !knowledge.is_loaded {
                    self.warn(&job, why, knowledge, context);
                }
                (job, LuggageStage::Refused)
            }
            EventLuggageDecision::Take(job) => {
                knowledge.lists.requests.settle();
                knowledge.variables.busy = true;
                knowledge.job = Some(job);
                knowledge.set_out(&job);
                context.info(format_args!("takes luggage {} from {} to {}", job.luggage, job.from, job.to));
                (job, LuggageStage::Taken)
            }
            EventLuggageDecision::Release(job) => {
                knowledge.variables.transporter = false;
                knowledge.lists.requests.put_back();
                (job, LuggageStage::Release)
            }
            EventLuggageDecision::Forget => {
                knowledge.variables.transporter = false;
                return Ok(());
            }
            EventLuggageDecision::Return(job) => {
                knowledge.drop_job();
                knowledge.untold = Some((job, LuggageStage::Refused));
                return knowledge.tell(self.luggage, context);
            }
            EventLuggageDecision::GiveUp { job, why } => {
                knowledge.drop_job();
                // With that on board it is of no use, until somebody helps.
                (knowledge.relieved, knowledge.is_loaded) = (true, true);
                context.count("assistance", 1);
                let (Job { luggage, to, .. }, why) = (job, why.words());
                context.log(
                    Level::Error,
                    format_args!("cannot bring luggage {luggage} to {to} any more: {why}; needs assistance"),
                );
                (job, LuggageStage::GivenUp)
            }
        };
        let (job, stage) = stage;
        context.send(&self.luggage, job.response(knowledge.number, knowledge.block, stage))
    }
}

impl EventLuggageMS {
    /// Whether a way still leads to where the robot has to go, when that or something about the ways changed.
    fn look_at_way(&mut self, knowledge: &mut RobotKnowledge) -> Option<EventLuggageSymptom> {
        let seen = (knowledge.routes.changes(), knowledge.job.and(knowledge.destination()));
        let before = std::mem::replace(&mut self.seen, seen);
        if before == seen {
            return None;
        }
        if before.0 != seen.0 {
            knowledge.lists.requests.judge_again();
        }
        let (job, to) = (knowledge.job?, seen.1?);
        let reached = knowledge.routes.between(knowledge.next, to) != UNREACHABLE;
        let carries = knowledge.variables.has_luggage;
        (!reached).then_some(EventLuggageSymptom::CutOff { job, to, carries })
    }

    /// Whether the robot has been on its job for many times as long as it takes.
    fn look_at_time(&mut self, knowledge: &mut RobotKnowledge) -> Option<EventLuggageSymptom> {
        let job = knowledge.job;
        let longest = || job.map_or(u32::MAX, |job| knowledge.executions_from_charger(&job));
        let executions = self.attempt.note(job.map(|job| job.luggage), longest)?;
        Some(EventLuggageSymptom::Stuck { job: job?, executions, carries: knowledge.variables.has_luggage })
    }

    /// Luggage that waits in vain for this robot.
    fn look_at_idleness(
        &mut self,
        knowledge: &RobotKnowledge,
        context: &Context<'_>,
    ) -> Option<EventLuggageSymptom> {
        let requests = &knowledge.lists.requests;
        let waits = !requests.open().is_empty() || requests.claimed().is_some();
        self.idle.note(waits && knowledge.job.is_none() && !knowledge.variables.asleep);
        let oldest = requests.open().first()?;
        self.idle.is_in_vain(oldest.since, context).then_some(EventLuggageSymptom::InVain(oldest.job))
    }

    /// How what this robot is interested in stands; `None` while it waits for others to take their interest back.
    fn look_at_claimed(&self, knowledge: &RobotKnowledge) -> Option<EventLuggageSymptom> {
        let Some(request) = knowledge.lists.requests.claimed() else {
            return Some(EventLuggageSymptom::Gone);
        };
        let job = request.job;
        if knowledge.energy.must_charge() {
            return Some(EventLuggageSymptom::Beaten { job, by: None });
        }
        let by = closer_rival(request, self.said_at, knowledge.number);
        if by.is_some() {
            return Some(EventLuggageSymptom::Beaten { job, by });
        }
        request.rivals.is_empty().then_some(EventLuggageSymptom::Alone(job))
    }

    fn warn(&mut self, job: &Job, why: Hindrance, knowledge: &RobotKnowledge, context: &mut Context<'_>) {
        let level = if std::mem::replace(&mut self.warned, true) { Level::Debug } else { Level::Warning };
        let Job { luggage, from, to } = *job;
        let full = knowledge.battery.executions_when_full();
        let what = format_args!("cannot bring luggage {luggage} from {from} to {to}");
        match why {
            Hindrance::Others => context.log(level, format_args!("{what}: {}", why.words())),
            Hindrance::Battery | Hindrance::NoWay => context.log(
                level,
                format_args!(
                    "{what}: no way leads there and back within the {full} executions of a full battery"
                ),
            ),
        }
    }
}

/// What to do with a job that comes to nothing.
fn leave(job: Job, carries: bool, why: Hindrance) -> EventLuggageDecision {
    if carries { EventLuggageDecision::GiveUp { job, why } } else { EventLuggageDecision::Return(job) }
}

/// Whether the next request that a robot which takes none now did not think about yet is out of its reach: others may have to know that nobody
/// can.
fn judge(knowledge: &mut RobotKnowledge) -> Option<EventLuggageSymptom> {
    let requests = knowledge.lists.requests.open_mut();
    let place = requests.iter().position(|request| !request.judged)?;
    requests[place].judged = true;
    let job = requests[place].job;
    let distance = knowledge.block.distance(job.from);
    let never = knowledge.means(&job) == Means::Never;
    never.then_some(EventLuggageSymptom::Waiting { place, job, distance })
}

/// The request that suits this robot best, and what caused it.
fn look_for_luggage(
    knowledge: &RobotKnowledge,
    context: &Context<'_>,
) -> Option<(EventLuggageSymptom, Cause)> {
    let (now, period) = (context.now(), context.period().as_nanos().max(1));
    let (block, number) = (knowledge.block, knowledge.number);
    let left = knowledge.battery.executions_left();
    let score = |request: &Request| {
        let credit = now.since(request.since).as_nanos() / period / u128::from(PATIENCE);
        i128::from(block.distance(request.job.from)) - i128::try_from(credit).unwrap_or(i128::MAX)
    };
    let suits = |request: &Request| request.needs <= left && closer_rival(request, block, number).is_none();
    let requests = knowledge.lists.requests.open().iter().enumerate();
    let best = requests.filter(|(_, request)| suits(request)).min_by_key(|(_, request)| score(request));
    best.map(|(place, request)| {
        let distance = block.distance(request.job.from);
        (EventLuggageSymptom::Waiting { place, job: request.job, distance }, request.cause)
    })
}

/// A robot that is interested and closer; at the same distance the lower number is.
fn closer_rival(request: &Request, block: Block, number: u32) -> Option<u32> {
    let from = request.job.from;
    let mine = (block.distance(from), number);
    let closer = |rival: &&crate::robot::Rival| (rival.block.distance(from), rival.robot) < mine;
    request.rivals.iter().find(closer).map(|rival| rival.robot)
}
