//! Luggage and visits that are not done yet.

use saoms_api::{Context, Failure, Field, Time};

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
    /// The robots that took it, and did not leave it to another one.
    bearers: Vec<u32>,
    /// Execution in which it is published again, unless it was passed on until then: a master that failed may have lost
    /// it.
    again: u64,
    /// Number of executions from one publication to the next, which doubles.
    pause: u64,
    /// True if it was published again.
    repeated: bool,
    /// Time of its last request.
    requested: Time,
    /// True if a robot put it down elsewhere, and nobody has requested it from there yet.
    moved: bool,
}

/// Number of executions after which luggage that nobody passed on is published again.
const AGAIN: u64 = 50;

impl OpenJob {
    pub(super) fn new(stops: Vec<Block>, (is_visit, robot): (bool, u32), execution: u64) -> OpenJob {
        let (again, pause) = (execution + AGAIN, 2 * AGAIN);
        OpenJob {
            passed_on: false,
            stops,
            is_visit,
            robot,
            bearers: Vec::new(),
            again,
            pause,
            repeated: false,
            requested: Time::START,
            moved: false,
        }
    }

    /// Notes what was said about it, at this time. What a robot said before it was out, it does not do any more.
    pub(super) fn hear(&mut self, said: &EventLuggage, sent: Time, out: Option<Time>, execution: u64) {
        let is_over = out.is_some_and(|out| sent <= out);
        match said.stage {
            LuggageStage::Request if !self.moved || said.from == *self.stops.first().unwrap_or(&said.from) => {
                self.bearers.clear();
                (self.passed_on, self.moved) = (true, false);
                self.requested = self.requested.max(sent);
            }
            // Of where it was before.
            LuggageStage::Request => {}
            LuggageStage::Taken if is_over => {
                // It is late: the word that the robot is out came before, and a request after that, if there was one.
                if self.bearers.is_empty() && out.is_some_and(|out| self.requested <= out) {
                    self.leave(execution);
                }
            }
            LuggageStage::Taken => {
                self.passed_on |= !self.moved;
                if !self.bearers.contains(&said.robot) {
                    self.bearers.push(said.robot);
                }
            }
            LuggageStage::Interest => self.passed_on |= !self.moved,
            LuggageStage::Release | LuggageStage::Refused => self.bearers.retain(|bearer| *bearer != said.robot),
            LuggageStage::Delivered | LuggageStage::GivenUp => {}
        }
    }

    /// Nobody has it any more: it is published again unless somebody requests it soon.
    fn leave(&mut self, execution: u64) {
        self.passed_on = false;
        (self.again, self.pause) = (execution + AGAIN, 2 * AGAIN);
    }

    /// A robot is out, which has left luggage on its block: a master that does not know what that robot was to bring
    /// requests nothing.
    pub(super) fn hear_removal(&mut self, number: u32, removal: &Removal, execution: u64) {
        let carried = removal.luggage.contains(&number);
        let had = self.bearers.contains(&removal.robot);
        self.bearers.retain(|bearer| *bearer != removal.robot);
        // A master that knew of it may have been faster.
        let is_requested = self.requested > removal.since;
        if !is_requested && (carried || had && self.bearers.is_empty()) {
            self.leave(execution);
        }
        if let Some((from, block)) = self.stops.first_mut().zip(removal.block).filter(|_| carried) {
            self.moved |= !is_requested && *from != block;
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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    const FROM: Block = Block::new(8, 5);
    const BLOCK: Block = Block::new(6, 1);

    fn at(seconds: u64) -> Time {
        Time::START + Duration::from_secs(seconds)
    }

    fn said(stage: LuggageStage, robot: u32, from: Block) -> EventLuggage {
        EventLuggage { stage, robot, ..EventLuggage::request(1, from, Block::new(2, 1)) }
    }

    /// A piece that was requested, and then taken by these robots.
    fn taken_by(robots: &[u32]) -> OpenJob {
        let mut job = OpenJob::new(vec![FROM, Block::new(2, 1)], (false, 0), 0);
        job.hear(&said(LuggageStage::Request, 0, FROM), at(1), None, 10);
        robots.iter().for_each(|robot| job.hear(&said(LuggageStage::Taken, *robot, FROM), at(2), None, 20));
        job
    }

    fn removal(robot: u32, luggage: &[u32]) -> Removal {
        Removal { robot, since: at(5), block: Some(BLOCK), luggage: luggage.to_vec(), delivered: Vec::new() }
    }

    #[test]
    fn luggage_is_published_again_once_all_are_out_that_took_it_and_did_not_release_it() {
        let mut job = taken_by(&[6, 7]);
        job.hear(&said(LuggageStage::Release, 7, FROM), at(3), None, 30);
        assert!(job.passed_on);
        job.hear_removal(1, &removal(6, &[]), 50);
        assert!(!job.passed_on && job.again == 50 + AGAIN);
        let mut job = taken_by(&[6, 7]);
        job.hear_removal(1, &removal(6, &[]), 50);
        assert!(job.passed_on, "robot 7 brings it");
    }

    #[test]
    fn what_a_robot_took_before_it_was_out_is_left_even_if_that_is_heard_later() {
        let mut job = taken_by(&[]);
        job.hear_removal(1, &removal(6, &[]), 50);
        job.hear(&said(LuggageStage::Taken, 6, FROM), at(4), Some(at(5)), 51);
        assert!(!job.passed_on && job.bearers.is_empty());
        job.hear(&said(LuggageStage::Taken, 6, FROM), at(6), Some(at(5)), 60);
        assert_eq!((job.passed_on, job.bearers.as_slice()), (true, [6].as_slice()), "it is back");
    }

    #[test]
    fn only_a_request_from_where_it_lies_now_passes_on_what_was_carried_away() {
        let mut job = taken_by(&[6]);
        job.hear_removal(1, &removal(6, &[1]), 50);
        for stage in [LuggageStage::Interest, LuggageStage::Taken, LuggageStage::Release, LuggageStage::Request] {
            job.hear(&said(stage, 8, FROM), at(6), None, 60);
            assert!(!job.passed_on, "{stage:?} is of where it was");
        }
        job.hear(&said(LuggageStage::Request, 0, BLOCK), at(7), None, 70);
        assert!(job.passed_on && job.stops[0] == BLOCK);
    }

    #[test]
    fn a_master_that_knew_of_it_has_requested_it_already() {
        let mut job = taken_by(&[6]);
        job.hear(&said(LuggageStage::Request, 0, BLOCK), at(6), None, 49);
        job.hear_removal(1, &removal(6, &[1]), 50);
        assert!(job.passed_on && job.stops[0] == BLOCK);
    }
}
