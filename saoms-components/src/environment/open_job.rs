//! Luggage and visits that are not done yet.

use saoms_api::{Context, Failure, Field, Header, Time};

use super::{Environment, MAX_EVENTS};
use crate::grid::Block;
use crate::messages::{CriticalSituation, CriticalStage, EventLuggage, LuggageStage, Removal, VISIT, Visit};
use crate::robot::Job;

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
    bearers: Vec<Bearer>,
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
    /// True if a robot put it down elsewhere, as a world said, or waits with it for help.
    placed: bool,
    /// True if a robot is out that had taken it, since the last request.
    lost_bearer: bool,
}

/// A robot that took a job, and when it said so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
struct Bearer {
    robot: u32,
    since: Time,
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
            placed: false,
            lost_bearer: false,
        }
    }

    /// Notes what was said about it, at this time, by a robot or a master. What the robot says may be over since a
    /// time.
    pub(super) fn hear(
        &mut self,
        said: &EventLuggage,
        (sent, by_robot): (Time, bool),
        over: Option<Time>,
        execution: u64,
    ) {
        let is_there = self.stops.first().is_none_or(|from| *from == said.from);
        match said.stage {
            // It did not find it where it was before, and asks the others to look there, too.
            LuggageStage::Request if self.placed && !is_there && by_robot => {
                self.bearers.retain(|bearer| bearer.since > sent);
                self.leave(execution);
            }
            LuggageStage::Request if !self.moved || is_there => {
                // Messages may overtake each other.
                self.bearers.retain(|bearer| bearer.since > sent);
                (self.passed_on, self.moved, self.lost_bearer) = (true, false, false);
                self.requested = self.requested.max(sent);
            }
            // Of where it was before.
            LuggageStage::Request => {}
            LuggageStage::Taken if over.is_some() => {
                // It is late: the word that the robot is out came before, and a request after that, if there was one.
                if self.bearers.is_empty() && over.is_some_and(|over| self.requested <= over) {
                    self.leave(execution);
                }
            }
            LuggageStage::Taken => {
                self.passed_on |= !self.moved;
                match self.bearers.iter_mut().find(|bearer| bearer.robot == said.robot) {
                    Some(bearer) => bearer.since = sent.max(bearer.since),
                    None => self.bearers.push(Bearer { robot: said.robot, since: sent }),
                }
            }
            LuggageStage::Interest => self.passed_on |= !self.moved,
            LuggageStage::Release | LuggageStage::Refused => {
                self.bearers.retain(|bearer| bearer.robot != said.robot || bearer.since > sent);
                if self.bearers.is_empty() && std::mem::take(&mut self.lost_bearer) {
                    self.leave(execution);
                }
            }
            LuggageStage::Delivered | LuggageStage::GivenUp => {}
        }
    }

    /// Nobody has it any more: it is published again unless somebody requests it soon.
    fn leave(&mut self, execution: u64) {
        self.passed_on = false;
        (self.again, self.pause) = (execution + AGAIN, 2 * AGAIN);
    }

    /// The robot does not have it any more; true if it had.
    fn remove(&mut self, robot: u32) -> bool {
        let before = self.bearers.len();
        self.bearers.retain(|bearer| bearer.robot != robot);
        self.bearers.len() < before
    }

    /// A robot that cannot go on asks for help with it, which lies there.
    fn hear_help(&mut self, critical: u32, block: Block, sent: Time) {
        self.bearers.retain(|bearer| bearer.robot != critical || bearer.since > sent);
        if let Some(from) = self.stops.first_mut() {
            self.placed |= *from != block;
            *from = block;
        }
    }

    /// The robot has taken another piece, of which this one does not hear.
    pub(super) fn lose(&mut self, robot: u32, execution: u64) {
        if self.remove(robot) && self.bearers.is_empty() {
            self.leave(execution);
        }
    }

    /// A robot is out, which has left luggage on its block: a master that does not know what that robot was to bring
    /// requests nothing.
    pub(super) fn hear_removal(&mut self, number: u32, removal: &Removal, execution: u64) {
        let carried = removal.luggage.contains(&number);
        let had = self.remove(removal.robot);
        self.lost_bearer |= had;
        // A master that knew of it may have been faster.
        let is_requested = self.requested > removal.since;
        if !is_requested && (carried || had && self.bearers.is_empty()) {
            self.leave(execution);
        }
        if let Some((from, block)) = self.stops.first_mut().zip(removal.block).filter(|_| carried) {
            self.moved |= !is_requested && *from != block;
            self.placed |= *from != block;
            *from = block;
        }
    }
}

/// What the environment knows of a robot.
#[derive(Clone, Copy, Debug, Default, Field)]
pub(super) struct KnownRobot {
    /// Time since when it is out: somebody took it off the floor, or its component failed.
    pub(super) out: Option<Time>,
    /// The last job that it took.
    took: Option<TakenJob>,
}

/// A piece or a visit that a robot took.
#[derive(Clone, Copy, Debug, Field)]
struct TakenJob {
    number: u32,
    at: Time,
}

impl Environment {
    /// Notes what a robot or a master says of luggage or a visit that is open.
    pub(super) fn hear_of_job(&mut self, said: &EventLuggage, header: Header, execution: u64) {
        let EventLuggage { luggage, robot, stage, .. } = *said;
        let sent = header.sent;
        let known = self.robots_known.entry(robot).or_default();
        let mut over = known.out.filter(|out| sent <= *out);
        if stage == LuggageStage::Taken {
            let other = known.took.filter(|took| took.number != luggage);
            if let Some(took) = other.filter(|took| sent < took.at) {
                over = over.max(Some(took.at));
            } else {
                known.took = Some(TakenJob { number: luggage, at: sent });
                // A robot brings one at a time.
                let lost = other.and_then(|took| self.open.get_mut(&took.number));
                lost.into_iter().for_each(|job| job.lose(robot, execution));
            }
        }
        let by_robot = self.validator.speaks(header.sender);
        self.open.entry(luggage).and_modify(|job| job.hear(said, (sent, by_robot), over, execution));
    }

    /// Notes what robots say of a job with which one of them needs help.
    pub(super) fn hear_situation(&mut self, said: &CriticalSituation, header: Header, execution: u64) {
        let Some(Job { luggage, from, to }) = said.job() else { return };
        match said.stage {
            CriticalStage::Request => {
                let job = self.open.entry(luggage);
                job.and_modify(|job| job.hear_help(said.critical, from, header.sent));
            }
            CriticalStage::Taken => {
                let request = EventLuggage::request(luggage, from, to);
                let taken = EventLuggage { stage: LuggageStage::Taken, robot: said.healer, ..request };
                self.hear_of_job(&taken, header, execution);
            }
            CriticalStage::Intention | CriticalStage::Release | CriticalStage::StandsIn => {}
        }
    }

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
        job.hear(&said(LuggageStage::Request, 0, FROM), (at(1), false), None, 10);
        robots.iter().for_each(|robot| job.hear(&said(LuggageStage::Taken, *robot, FROM), (at(2), true), None, 20));
        job
    }

    fn removal(robot: u32, luggage: &[u32]) -> Removal {
        let luggage = luggage.to_vec();
        Removal { robot, since: at(5), block: Some(BLOCK), luggage, ..Removal::default() }
    }

    #[test]
    fn luggage_is_published_again_once_all_are_out_that_took_it_and_did_not_release_it() {
        let mut job = taken_by(&[6, 7]);
        job.hear(&said(LuggageStage::Release, 7, FROM), (at(3), true), None, 30);
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
        job.hear(&said(LuggageStage::Taken, 6, FROM), (at(4), true), Some(at(5)), 51);
        assert!(!job.passed_on && job.bearers.is_empty());
        job.hear(&said(LuggageStage::Taken, 6, FROM), (at(6), true), None, 60);
        assert_eq!((job.passed_on, job.bearers[0].robot), (true, 6), "it is back");
    }

    #[test]
    fn only_a_request_from_where_it_lies_now_passes_on_what_was_carried_away() {
        let mut job = taken_by(&[6]);
        job.hear_removal(1, &removal(6, &[1]), 50);
        for stage in [LuggageStage::Interest, LuggageStage::Taken, LuggageStage::Release, LuggageStage::Request] {
            job.hear(&said(stage, 8, FROM), (at(6), true), None, 60);
            assert!(!job.passed_on, "{stage:?} is of where it was");
        }
        job.hear(&said(LuggageStage::Request, 0, BLOCK), (at(7), false), None, 70);
        assert!(job.passed_on && job.stops[0] == BLOCK);
    }

    #[test]
    fn a_master_that_knew_of_it_has_requested_it_already() {
        let mut job = taken_by(&[6]);
        job.hear(&said(LuggageStage::Request, 0, BLOCK), (at(6), false), None, 49);
        job.hear_removal(1, &removal(6, &[1]), 50);
        assert!(job.passed_on && job.stops[0] == BLOCK);
    }

    #[test]
    fn a_robot_that_looked_where_it_was_before_does_not_pass_it_on() {
        let mut job = taken_by(&[6]);
        job.hear_removal(1, &removal(6, &[1]), 50);
        job.hear(&said(LuggageStage::Request, 0, BLOCK), (at(7), false), None, 70);
        job.hear(&said(LuggageStage::Request, 0, FROM), (at(8), true), None, 80);
        assert!(!job.passed_on && job.again == 80 + AGAIN && job.stops[0] == BLOCK);
        let mut job = taken_by(&[6]);
        job.hear(&said(LuggageStage::Request, 0, BLOCK), (at(8), true), None, 80);
        assert!(job.passed_on, "no world said that it is elsewhere");
    }

    #[test]
    fn a_request_that_is_heard_late_does_not_end_what_a_robot_took_since() {
        let mut job = taken_by(&[6]);
        job.hear(&said(LuggageStage::Request, 0, FROM), (at(1), false), None, 21);
        job.hear_removal(1, &removal(6, &[]), 50);
        assert!(!job.passed_on, "robot 6 had it");
    }

    #[test]
    fn a_robot_that_hands_it_back_after_another_one_is_out_leaves_it() {
        let mut job = taken_by(&[6, 7]);
        job.hear_removal(1, &removal(6, &[]), 50);
        job.hear(&said(LuggageStage::Release, 7, FROM), (at(6), true), None, 60);
        assert!(!job.passed_on, "no master may know of it");
        let mut job = taken_by(&[7]);
        job.hear(&said(LuggageStage::Release, 7, FROM), (at(6), true), None, 60);
        assert!(job.passed_on, "the master requests it");
    }

    #[test]
    fn luggage_of_a_robot_that_waits_for_help_lies_with_it() {
        let mut job = taken_by(&[6]);
        job.hear_help(6, BLOCK, at(3));
        job.hear(&said(LuggageStage::Taken, 7, BLOCK), (at(4), true), None, 40);
        job.hear_removal(1, &removal(7, &[]), 50);
        assert!(!job.passed_on && job.stops[0] == BLOCK, "its helper is out");
    }

    #[test]
    fn a_robot_brings_one_piece_at_a_time() {
        let mut job = taken_by(&[6, 7]);
        job.lose(7, 50);
        assert!(job.passed_on, "robot 6 brings it");
        job.lose(6, 60);
        assert!(!job.passed_on && job.again == 60 + AGAIN);
    }
}
