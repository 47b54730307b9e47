//! Who brings which luggage.
//!
//! A free robot takes an interest in one request and says so, from where it is. It takes the job in an execution in which no interest of
//! another robot is known; where there are several, all but the closest take theirs back and the closest waits for that. Of two robots
//! at least one hears of the other's interest before it decides, so no luggage is taken twice, however late messages are.

use saoms_api::{Failure, Level};

use crate::grid::Block;
use crate::messages::LuggageStage;
use crate::robot::{Body, Request};

use super::energy::{Energy, Means};

/// A request that waits for so many executions counts as one block closer, so that none waits for ever.
const PATIENCE: u64 = 4;

/// A robot's interest in luggage.
#[derive(Debug, Default)]
pub(super) struct Jobs {
    /// From where the robot said that it is interested.
    said_at: Block,
    /// Whether it warned that some luggage is out of its reach.
    warned: bool,
}

impl Jobs {
    pub(super) fn manage(&mut self, body: &mut Body<'_, '_>, energy: &mut Energy) -> Result<(), Failure> {
        let variables = &body.knowledge.variables;
        if variables.busy {
            return Ok(());
        }
        if variables.transporter {
            self.decide(body, energy)
        } else if energy.must_charge() {
            Ok(())
        } else {
            energy.is_free(body.knowledge);
            self.take_interest(body, energy)
        }
    }

    fn take_interest(&mut self, body: &mut Body<'_, '_>, energy: &Energy) -> Result<(), Failure> {
        let (now, period) = (body.context.now(), body.context.period().as_nanos().max(1));
        let knowledge = &mut *body.knowledge;
        let (block, number) = (knowledge.block, knowledge.number);
        let left = knowledge.battery.executions_left();
        let score = |request: &Request| {
            let credit = now.since(request.since).as_nanos() / period / u128::from(PATIENCE);
            i128::from(block.distance(request.job.from)) - i128::try_from(credit).unwrap_or(i128::MAX)
        };
        let suits =
            |request: &&(usize, &Request)| request.1.needs <= left && !is_beaten(request.1, block, number);
        let requests = knowledge.lists.requests.open().iter().enumerate();
        let best = requests.filter(|request| suits(&request)).min_by_key(|(_, request)| score(request));
        let Some((place, job)) = best.map(|(place, request)| (place, request.job)) else { return Ok(()) };
        match energy.means(knowledge, &job) {
            Means::Enough => {}
            Means::Needs(executions) => {
                knowledge.lists.requests.open_mut()[place].needs = executions;
                return Ok(());
            }
            Means::Never => {
                knowledge.lists.requests.remove(place);
                let level =
                    if std::mem::replace(&mut self.warned, true) { Level::Debug } else { Level::Warning };
                let (luggage, from, to) = (job.luggage, job.from, job.to);
                let full = knowledge.battery.executions_when_full();
                body.context.log(
                    level,
                    format_args!(
                        "cannot bring luggage {luggage} from {from} to {to}: no way leads there and back within the {full} executions of a full battery"
                    ),
                );
                return Ok(());
            }
        }
        knowledge.lists.requests.claim(place);
        knowledge.variables.transporter = true;
        self.said_at = block;
        let name = &knowledge.name;
        body.context.console(format_args!("{name} is bringing luggage from {} to {}", job.from, job.to));
        body.respond(&job, LuggageStage::Interest)
    }

    fn decide(&mut self, body: &mut Body<'_, '_>, energy: &mut Energy) -> Result<(), Failure> {
        let knowledge = &mut *body.knowledge;
        let Some(request) = knowledge.lists.requests.claimed() else {
            // Another robot took it.
            knowledge.variables.transporter = false;
            return Ok(());
        };
        let job = request.job;
        let gives_up = energy.must_charge() || is_beaten(request, self.said_at, knowledge.number);
        if gives_up {
            knowledge.variables.transporter = false;
            knowledge.lists.requests.put_back();
            return body.respond(&job, LuggageStage::Release);
        }
        if !request.rivals.is_empty() {
            return Ok(());
        }
        knowledge.lists.requests.settle();
        knowledge.variables.busy = true;
        knowledge.job = Some(job);
        energy.set_out(knowledge, &job);
        body.context.info(format_args!("takes luggage {} from {} to {}", job.luggage, job.from, job.to));
        body.respond(&job, LuggageStage::Taken)
    }
}

/// Whether another robot that is interested is closer; at the same distance the lower number is.
fn is_beaten(request: &Request, block: Block, number: u32) -> bool {
    let from = request.job.from;
    let mine = (block.distance(from), number);
    request.rivals.iter().any(|rival| (rival.block.distance(from), rival.robot) < mine)
}
