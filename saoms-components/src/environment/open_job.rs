//! Luggage and visits that are not done yet.

use saoms_api::{Context, Failure, Field};

use super::{Environment, MAX_EVENTS};
use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage, Removal, VISIT, Visit};

/// Luggage or a visit that is published and not done yet.
#[derive(Clone, Debug, Field)]
pub(super) struct OpenJob {
    /// True if it was passed on to the robots.
    pub(super) passed_on: bool,
    /// Where it is collected and deposited, or the blocks to visit.
    stops: Vec<Block>,
    pub(super) is_visit: bool,
    /// The only robot that may do it; 0 for any.
    robot: u32,
    /// The robot that took it last; 0 if none has it.
    bearer: u32,
    /// Execution in which it is published again, unless it was passed on until then: a master that failed may have lost
    /// it.
    again: u64,
    /// Number of executions from one publication to the next, which doubles.
    pause: u64,
    /// True if it was published again.
    repeated: bool,
}

/// Number of executions after which luggage that nobody passed on is published again.
const AGAIN: u64 = 50;

impl OpenJob {
    pub(super) fn new(stops: Vec<Block>, (is_visit, robot): (bool, u32), execution: u64) -> OpenJob {
        let (again, pause) = (execution + AGAIN, 2 * AGAIN);
        OpenJob { passed_on: false, stops, is_visit, robot, bearer: 0, again, pause, repeated: false }
    }

    /// Notes what was said about it.
    pub(super) fn hear(&mut self, said: &EventLuggage) {
        self.passed_on = true;
        match said.stage {
            LuggageStage::Taken => self.bearer = said.robot,
            LuggageStage::Request => self.bearer = 0,
            _ => self.bearer = if self.bearer == said.robot { 0 } else { self.bearer },
        }
    }

    /// A robot is out, which has left luggage on its block: a master that does not know what that robot was to bring
    /// requests nothing.
    pub(super) fn hear_removal(&mut self, number: u32, removal: &Removal, execution: u64) {
        let carried = removal.luggage.contains(&number);
        if carried || self.bearer == removal.robot {
            (self.passed_on, self.bearer) = (false, 0);
            (self.again, self.pause) = (execution + AGAIN, 2 * AGAIN);
        }
        if let Some((from, block)) = self.stops.first_mut().zip(removal.block).filter(|_| carried) {
            *from = block;
        }
    }
}

impl Environment {
    /// Publishes luggage and visits again that nobody passed on.
    pub(super) fn publish_again(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let execution = context.execution();
        let is_due = |job: &OpenJob| !job.passed_on && job.again <= execution;
        // Masters pass visits on, too. Without one that was ever scheduled, nobody can have lost anything.
        if !self.open.values().any(is_due) || !context.publishers(&VISIT).iter().any(|master| master.has_begun) {
            return Ok(());
        }
        let due = self.open.iter_mut().filter(|(_, job)| is_due(job));
        for (number, job) in due.take(MAX_EVENTS) {
            job.again = execution + job.pause;
            job.pause = job.pause.saturating_mul(2);
            if !std::mem::replace(&mut job.repeated, true) && !job.is_visit {
                context.count("scenario.repeated", 1);
            }
            match (job.is_visit, job.stops.as_slice()) {
                (true, stops) => {
                    let visit = Visit { visit: *number, robot: job.robot, stops: stops.to_vec() };
                    context.send(&self.visits_asked, visit)?;
                }
                (false, [from, to]) => {
                    context.send(&self.events, EventLuggage::request(*number, *from, *to).into())?;
                }
                (false, _) => {}
            }
        }
        Ok(())
    }
}
