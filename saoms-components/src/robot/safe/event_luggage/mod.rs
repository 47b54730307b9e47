//! Distribution of luggage among the robots.

mod assigned;
mod records;

use saoms_api::{Cause, Context, Failure, Field, Level, Loop, LoopClass, Publisher, Saved, Work, info};

use crate::grid::{Block, UNREACHABLE};
use crate::messages::{ASSIGNMENT, EVENT_LUGGAGE, EventLuggage, FIRST_VISIT, LuggageStage, is_visit, job_name};
use crate::robot::lists::WAY_CLOSED;
use crate::robot::memory::lasting::lasting;
use crate::robot::{ASSISTANCE, Job, JobEnd, Request, RobotKnowledge};

use super::energy::Feasibility;
use super::patience::{Attempt, Idle};

use assigned::{decide_about_assigned, look_at_assignment};

pub(super) use records::{Hindrance, SafeLuggageDecision, SafeLuggageSymptom};

/// Number of moves in whose time a request gains one block of distance, so that no request waits for ever.
const PATIENCE: u64 = 4;

/// Number of executions for which a robot waits for the word of a master, which may have failed.
const AWAITED: u32 = 300;

/// Decides which luggage this robot brings.
///
/// A free robot takes an interest in one request and announces that with its position. It takes the job in an execution
/// in which it knows no interest of another robot. If several robots are interested, all but the closest take their
/// interest back, and the closest waits for that. Of two robots at least one hears of the other's interest before it
/// decides, so no luggage is taken twice, however late messages are.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.EventLuggageMS",
    knowledge = RobotKnowledge,
    senses(
        "block", "battery", "asleep", "requests", "lasts", "mustCharge", "relieved", "offersHelp", "moving",
        "handling", "loaded", "charging"
    ),
    effects("job", "busy", "transporter", "hasLuggage", "healer", "relieved", "loaded", "untold", "reserve")
)]
pub struct SafeEventLuggage {
    /// Position of the robot when it announced its interest.
    said_at: Block,
    /// Cause of the interest; its next decision about that luggage follows from it.
    said: Cause,
    /// True if it has warned that some luggage is out of its reach.
    warned: bool,
    /// The last check of its way.
    seen: SeenWay,
    /// True if the robot was at its charger in the last execution.
    was_at_charger: bool,
    attempt: Attempt,
    idle: Idle,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
}

/// Number of changes of the ways at a check, and the goal of the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
struct SeenWay {
    changes: u32,
    goal: Option<Block>,
}

lasting! {
    SafeEventLuggage as LuggageMemory { said_at: Block, said: Cause, warned: bool, seen: SeenWay, was_at_charger: bool, attempt: Attempt, idle: Idle }
}

impl Loop for SafeEventLuggage {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafeLuggageSymptom;
    type Decision = SafeLuggageDecision;

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<SafeLuggageSymptom>, Failure> {
        let is_at_charger = knowledge.is_at_charger();
        if !std::mem::replace(&mut self.was_at_charger, is_at_charger) && is_at_charger {
            // What they need was found out elsewhere on the way, for each at another block.
            knowledge.lists.requests.consider_again();
        }
        if let Some(symptom) = self.look_at_way(knowledge) {
            return Ok(Some(symptom));
        }
        if let Some((job, to)) = knowledge.strives_in_vain() {
            let carries = knowledge.variables.has_luggage;
            return Ok(Some(SafeLuggageSymptom::TooFar { job, to, carries }));
        }
        let in_vain = self.look_at_idleness(knowledge, context);
        if let Some((symptom, cause)) = look_at_assignment(knowledge) {
            context.because(cause);
            return Ok(Some(symptom));
        }
        if knowledge.hardware.running().is_none()
            && let Some(symptom) = self.look_at_time(knowledge)
        {
            return Ok(Some(symptom));
        }
        let variables = &knowledge.variables;
        if variables.busy || variables.critical || knowledge.hardware.running().is_some() {
            return Ok(None);
        }
        if knowledge.variables.transporter {
            context.because(self.said);
            return Ok(self.look_at_claimed(knowledge));
        }
        if knowledge.stopped {
            // It keeps what it has, and what waits is for others.
            return Ok(None);
        }
        if in_vain.is_some() {
            return Ok(in_vain);
        }
        if knowledge.variables.asleep || knowledge.must_charge || knowledge.relieved {
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
        symptom: SafeLuggageSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafeLuggageDecision>, Failure> {
        Ok(Some(match symptom {
            SafeLuggageSymptom::Waiting { place, job, .. } => match knowledge.means(&job) {
                Feasibility::Enough if knowledge.lists.requests.open()[place].reserved => {
                    SafeLuggageDecision::Visit { place, job }
                }
                Feasibility::Enough => SafeLuggageDecision::TakeInterest { place, job },
                Feasibility::Needs(needs) => SafeLuggageDecision::Postpone { place, needs },
                Feasibility::Later => SafeLuggageDecision::AwaitWay { place },
                Feasibility::Never => {
                    let why = if knowledge.is_cut_off_from(&job) { Hindrance::NoWay } else { Hindrance::Battery };
                    SafeLuggageDecision::Refuse { job, why }
                }
            },
            SafeLuggageSymptom::Assigned { job, is_free: false } | SafeLuggageSymptom::Withdrawn(job) => {
                SafeLuggageDecision::HandBack(job)
            }
            SafeLuggageSymptom::Assigned { job, is_free: true } => decide_about_assigned(job, knowledge),
            SafeLuggageSymptom::InVain(job) => SafeLuggageDecision::Refuse { job, why: Hindrance::Others },
            SafeLuggageSymptom::Alone(job) => SafeLuggageDecision::Take(job),
            SafeLuggageSymptom::Beaten { job, .. } => SafeLuggageDecision::Release(job),
            SafeLuggageSymptom::Gone => SafeLuggageDecision::Forget,
            SafeLuggageSymptom::CutOff { job, carries, .. } => leave(job, carries, Hindrance::NoWay),
            SafeLuggageSymptom::TooFar { job, carries, .. } => leave(job, carries, Hindrance::Battery),
            SafeLuggageSymptom::Stuck { job, carries, .. } => leave(job, carries, Hindrance::Others),
        }))
    }

    fn execute(
        &mut self,
        decision: SafeLuggageDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        if let SafeLuggageDecision::Visit { place, .. } = decision {
            knowledge.lists.requests.claim(place);
        }
        let stage = match decision {
            SafeLuggageDecision::TakeInterest { place, job } => {
                knowledge.lists.requests.claim(place);
                knowledge.variables.transporter = true;
                (self.said_at, self.said) = (knowledge.block, context.cause());
                let name = &knowledge.name;
                context.console(format_args!("{name} is bringing luggage from {} to {}", job.from, job.to));
                (job, LuggageStage::Interest)
            }
            SafeLuggageDecision::Postpone { place, needs } => {
                knowledge.lists.requests.open_mut()[place].needs = needs;
                return Ok(());
            }
            SafeLuggageDecision::AwaitWay { place } => {
                knowledge.lists.requests.open_mut()[place].needs = WAY_CLOSED;
                return Ok(());
            }
            SafeLuggageDecision::Refuse { job, why } => {
                knowledge.lists.requests.refuse(job.luggage, Some(job.from));
                if !knowledge.loaded {
                    self.warn(&job, why, knowledge, context);
                }
                (job, LuggageStage::Refused)
            }
            SafeLuggageDecision::Take(job) | SafeLuggageDecision::Visit { job, .. } => {
                knowledge.lists.requests.settle();
                if let Some(left) = knowledge.job {
                    let left = left.response(knowledge.number, knowledge.block, LuggageStage::Release);
                    context.send(&self.luggage, left)?;
                }
                knowledge.stops = knowledge.lists.requests.stops(job.luggage).to_vec();
                knowledge.visits = !knowledge.stops.is_empty();
                knowledge.take(job, context.now());
                // Before it says that it takes it: a program that is stopped between the two has no job for ever.
                knowledge.renew_lease(context)?;
                // A world lets one robot collect luggage; of a visit only a master knows who does it.
                let has_master = || context.publishers(&ASSIGNMENT).iter().any(|master| master.has_begun);
                let asks = knowledge.visits && !knowledge.is_assigned && has_master();
                knowledge.awaits_master = if asks { AWAITED } else { 0 };
                knowledge.set_out(&job);
                match knowledge.visits {
                    true => info!(context, "goes to {} for visit {}", job.from, job.luggage - FIRST_VISIT),
                    false => info!(context, "takes luggage {} from {} to {}", job.luggage, job.from, job.to),
                }
                (job, LuggageStage::Taken)
            }
            SafeLuggageDecision::HandBack(job) => {
                if knowledge.job.is_some_and(|own| own.luggage == job.luggage) {
                    knowledge.drop_job();
                }
                (job, LuggageStage::Release)
            }
            SafeLuggageDecision::Release(job) => {
                knowledge.variables.transporter = false;
                knowledge.lists.requests.put_back();
                (job, LuggageStage::Release)
            }
            SafeLuggageDecision::Forget => {
                knowledge.variables.transporter = false;
                return Ok(());
            }
            SafeLuggageDecision::Return(job) => {
                knowledge.drop_job();
                knowledge.untold = Some(JobEnd { job, stage: LuggageStage::Refused });
                return knowledge.report_outcome(self.luggage, context);
            }
            SafeLuggageDecision::GiveUp { job, why } => {
                knowledge.drop_job();
                // A loaded robot is of no use until another one helps.
                (knowledge.relieved, knowledge.loaded) = (true, true);
                context.count("assistance", 1);
                context.vote(Work::GivenUp);
                let (Job { luggage, to, .. }, why) = (job, why.words());
                context.alert(
                    ASSISTANCE,
                    luggage,
                    format_args!("cannot carry luggage {luggage} to {to} any more: {why}; needs assistance"),
                );
                (job, LuggageStage::GivenUp)
            }
        };
        let (job, stage) = stage;
        context.send(&self.luggage, job.response(knowledge.number, knowledge.block, stage))
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}

impl SafeEventLuggage {
    /// Checks that a way still leads to the robot's goal, when the goal or the ways changed.
    fn look_at_way(&mut self, knowledge: &mut RobotKnowledge) -> Option<SafeLuggageSymptom> {
        let seen = SeenWay { changes: knowledge.routes.changes(), goal: knowledge.job.and(knowledge.destination()) };
        let before = std::mem::replace(&mut self.seen, seen);
        if before == seen {
            return None;
        }
        if before.changes != seen.changes {
            knowledge.lists.requests.judge_again();
            knowledge.lists.helps.judge_again();
        }
        let (job, to) = (knowledge.job?, seen.goal?);
        let next = knowledge.next;
        let reached = knowledge.routes.between(next, to) != UNREACHABLE || knowledge.routes.may_open(next, to);
        let carries = knowledge.variables.has_luggage;
        (!reached).then_some(SafeLuggageSymptom::CutOff { job, to, carries })
    }

    /// Checks that the robot has not been on its job for many times as long as the job takes.
    fn look_at_time(&mut self, knowledge: &mut RobotKnowledge) -> Option<SafeLuggageSymptom> {
        if knowledge.charging || knowledge.is_cut_off() {
            return None;
        }
        let job = knowledge.job;
        let longest = || job.map_or(u32::MAX, |job| knowledge.executions_from_charger(&job));
        let executions = self.attempt.note(job.map(|job| job.luggage), longest)?;
        Some(SafeLuggageSymptom::Stuck { job: job?, executions, carries: knowledge.variables.has_luggage })
    }

    /// Luggage that waits in vain for this robot.
    fn look_at_idleness(&mut self, knowledge: &RobotKnowledge, context: &Context<'_>) -> Option<SafeLuggageSymptom> {
        let requests = &knowledge.lists.requests;
        let waits = !requests.open().is_empty() || requests.claimed().is_some();
        self.idle.note(waits && knowledge.job.is_none() && !knowledge.variables.asleep);
        let oldest = requests.open().first()?;
        self.idle
            .is_in_vain(oldest.since, knowledge.energy.executions_of_move(), context)
            .then_some(SafeLuggageSymptom::InVain(oldest.job))
    }

    /// State of the luggage that this robot is interested in; `None` while it waits for others to take their interest
    /// back.
    fn look_at_claimed(&self, knowledge: &RobotKnowledge) -> Option<SafeLuggageSymptom> {
        let Some(request) = knowledge.lists.requests.claimed() else {
            return Some(SafeLuggageSymptom::Gone);
        };
        let job = request.job;
        if knowledge.must_charge || knowledge.lists.is_doubted {
            return Some(SafeLuggageSymptom::Beaten { job, by: None });
        }
        let by = closer_rival(request, self.said_at, knowledge.number);
        if by.is_some() {
            return Some(SafeLuggageSymptom::Beaten { job, by });
        }
        request.rivals.is_empty().then_some(SafeLuggageSymptom::Alone(job))
    }

    fn warn(&mut self, job: &Job, why: Hindrance, knowledge: &RobotKnowledge, context: &mut Context<'_>) {
        let level = if std::mem::replace(&mut self.warned, true) { Level::Debug } else { Level::Warning };
        let Job { luggage, from, to } = *job;
        let full = knowledge.executions_when_full();
        let does = if is_visit(luggage) { "do" } else { "carry" };
        let what = format_args!("cannot {does} {} from {from} to {to}", job_name(luggage));
        match why {
            Hindrance::Others => context.log(level, format_args!("{what}: {}", why.words())),
            Hindrance::NoWay => {
                context.log(level, format_args!("{what}: blocked blocks or broken robots leave no path there"))
            }
            Hindrance::Battery => context.log(
                level,
                format_args!("{what}: no path there and back fits into the {full} executions of a full battery"),
            ),
        }
    }
}

/// Decision about a job that cannot be finished.
fn leave(job: Job, carries: bool, why: Hindrance) -> SafeLuggageDecision {
    if carries { SafeLuggageDecision::GiveUp { job, why } } else { SafeLuggageDecision::Return(job) }
}

/// The next request that is out of this robot's reach, while it takes no jobs: others may have to know that no robot
/// can bring it.
fn judge(knowledge: &mut RobotKnowledge) -> Option<SafeLuggageSymptom> {
    if knowledge.energy.borrows {
        // What is out of reach from here may be within reach of its own charger.
        return None;
    }
    let requests = knowledge.lists.requests.open_mut();
    let place = requests.iter().position(|request| !request.judged && request.is_known())?;
    requests[place].judged = true;
    let job = requests[place].job;
    let distance = knowledge.block.distance(job.from);
    let never = knowledge.means(&job) == Feasibility::Never;
    never.then_some(SafeLuggageSymptom::Waiting { place, job, distance })
}

/// The request that suits this robot best, and its cause.
fn look_for_luggage(knowledge: &RobotKnowledge, context: &Context<'_>) -> Option<(SafeLuggageSymptom, Cause)> {
    let moving = u128::from(knowledge.energy.executions_of_move());
    // In nanoseconds: which of two requests is better depends on neither the moment nor the period.
    let for_a_block = (context.period().as_nanos() * moving).max(1) * u128::from(PATIENCE);
    let for_a_block = i128::try_from(for_a_block).unwrap_or(i128::MAX);
    let now = context.now();
    let (block, number) = (knowledge.block, knowledge.number);
    let left = knowledge.executions_left();
    let score = |request: &Request| {
        let waited = i128::try_from(now.since(request.since).as_nanos()).unwrap_or(i128::MAX);
        i128::from(block.distance(request.job.from)).saturating_mul(for_a_block).saturating_sub(waited)
    };
    let suits = |request: &Request| request.needs <= left && closer_rival(request, block, number).is_none();
    let requests = || knowledge.lists.requests.open().iter().enumerate();
    // What is for this robot alone is done in the order of the requests.
    let own = requests()
        .find(|(_, request)| request.reserved && request.is_known())
        .filter(|(_, request)| request.needs <= left);
    let others = || requests().filter(|(_, request)| !request.reserved && request.is_known() && suits(request));
    let best = own.or_else(|| others().min_by_key(|(_, request)| score(request)));
    best.map(|(place, request)| {
        let distance = block.distance(request.job.from);
        (SafeLuggageSymptom::Waiting { place, job: request.job, distance }, request.cause)
    })
}

/// A robot that is interested and closer; of equally close robots the one with the lower number is.
fn closer_rival(request: &Request, block: Block, number: u32) -> Option<u32> {
    let from = request.job.from;
    let mine = (block.distance(from), number);
    let closer = |rival: &&crate::robot::Rival| (rival.block.distance(from), rival.robot) < mine;
    request.rivals.iter().find(closer).map(|rival| rival.robot)
}
