//! The work of the fleet, as the master of the robots hears of it.

use std::collections::BTreeMap;

use saoms_api::{Cause, Field, Time};

use crate::grid::Block;
use crate::messages::{EnvironmentEvent, EventLuggage, LuggageStage};
use crate::state::Numbers;

/// Luggage that waits, is carried, or is expected.
#[derive(Debug, Default)]
pub(super) struct Work {
    /// Numbers of all luggage so far.
    known: Numbers,
    /// Those of luggage that was delivered or given up.
    over: Numbers,
    /// Luggage that no robot has taken.
    waiting: BTreeMap<u32, Waiting>,
    /// The luggage that each robot brings, and the robot that brings each piece.
    jobs: BTreeMap<u32, u32>,
    bearers: BTreeMap<u32, u32>,
    /// Announced luggage that has not come yet.
    announced: Vec<Announced>,
}

/// The work, for a master that goes on.
#[derive(Clone, Debug, Field)]
pub(super) struct WorkMemory {
    known: Numbers,
    over: Numbers,
    waiting: Vec<Waiting>,
    jobs: Vec<RobotJob>,
    announced: Vec<Announced>,
}

#[derive(Clone, Copy, Debug, Field)]
struct Waiting {
    luggage: u32,
    from: Block,
    since: Time,
    cause: Cause,
}

#[derive(Clone, Copy, Debug, Field)]
struct RobotJob {
    robot: u32,
    luggage: u32,
}

#[derive(Clone, Copy, Debug, Field)]
struct Announced {
    pieces: u32,
    /// Number of the master's periods for which they are expected.
    left: u32,
}

impl Work {
    pub(super) fn memory(&self) -> WorkMemory {
        WorkMemory {
            known: self.known.clone(),
            over: self.over.clone(),
            waiting: self.waiting.values().copied().collect(),
            jobs: self.jobs.iter().map(|(&robot, &luggage)| RobotJob { robot, luggage }).collect(),
            announced: self.announced.clone(),
        }
    }

    pub(super) fn of(memory: WorkMemory) -> Work {
        Work {
            known: memory.known,
            over: memory.over,
            waiting: memory.waiting.into_iter().map(|waiting| (waiting.luggage, waiting)).collect(),
            jobs: memory.jobs.iter().map(|job| (job.robot, job.luggage)).collect(),
            bearers: memory.jobs.iter().map(|job| (job.luggage, job.robot)).collect(),
            announced: memory.announced,
        }
    }

    /// Luggage that comes later is expected for a number of the master's periods.
    pub(super) fn announce(&mut self, pieces: u32, periods: u32) {
        if pieces > 0 {
            self.announced.push(Announced { pieces, left: periods });
        }
    }

    /// Ends a period.
    pub(super) fn end_period(&mut self) {
        self.announced.iter_mut().for_each(|announced| announced.left = announced.left.saturating_sub(1));
        self.announced.retain(|announced| announced.left > 0);
    }

    /// Handles events of the environment.
    pub(super) fn hear_events(&mut self, event: &EnvironmentEvent, now: Time, cause: Cause) {
        event.luggage.iter().for_each(|request| self.add(request, now, cause));
    }

    /// Handles a message about luggage.
    pub(super) fn hear_luggage(&mut self, said: &EventLuggage, now: Time, cause: Cause) {
        let luggage = said.luggage;
        match said.stage {
            // The robot that had it left it to the others, or failed.
            LuggageStage::Request if said.robot == 0 && self.is_left(luggage) => {
                self.end(luggage);
                self.wait(said, now, cause);
            }
            LuggageStage::Request => self.add(said, now, cause),
            LuggageStage::Taken => {
                self.waiting.remove(&luggage);
                self.forget(said.robot);
                self.jobs.insert(said.robot, luggage);
                self.bearers.insert(luggage, said.robot);
            }
            LuggageStage::Delivered | LuggageStage::GivenUp => {
                self.over.insert(luggage);
                self.waiting.remove(&luggage);
                self.end(luggage);
            }
            LuggageStage::Release | LuggageStage::Refused => {
                if self.jobs.get(&said.robot) == Some(&luggage) {
                    self.end(luggage);
                    self.wait(said, now, cause);
                }
            }
            LuggageStage::Interest => {}
        }
    }

    /// True if a robot has taken the luggage, whether or not it still has it.
    fn is_left(&self, luggage: u32) -> bool {
        self.known.contains(luggage) && !self.over.contains(luggage) && !self.waiting.contains_key(&luggage)
    }

    /// Ends the job with this luggage.
    fn end(&mut self, luggage: u32) {
        if let Some(robot) = self.bearers.remove(&luggage) {
            self.jobs.remove(&robot);
        }
    }

    fn add(&mut self, request: &EventLuggage, now: Time, cause: Cause) {
        if !self.known.insert(request.luggage) {
            return;
        }
        self.wait(request, now, cause);
        if let Some(first) = self.announced.first_mut() {
            first.pieces -= 1;
            self.announced.retain(|announced| announced.pieces > 0);
        }
    }

    fn wait(&mut self, said: &EventLuggage, since: Time, cause: Cause) {
        let EventLuggage { luggage, from, .. } = *said;
        self.waiting.insert(luggage, Waiting { luggage, from, since, cause });
    }

    /// Forgets the job of a robot that is not active any more: others look after it.
    pub(super) fn forget(&mut self, robot: u32) {
        if let Some(luggage) = self.jobs.remove(&robot) {
            self.bearers.remove(&luggage);
        }
    }

    /// True if the robot brings luggage.
    pub(super) fn has_job(&self, robot: u32) -> bool {
        self.jobs.contains_key(&robot)
    }

    /// Number of pieces that no robot has taken.
    pub(super) fn waiting(&self) -> u32 {
        count(self.waiting.len())
    }

    /// Number of pieces that are expected.
    pub(super) fn expected(&self) -> u32 {
        self.announced.iter().map(|announced| announced.pieces).sum()
    }

    /// Luggage that nobody has taken since `before`: the number of pieces, and the cause of the oldest.
    pub(super) fn neglected(&self, before: Time) -> Option<(u32, Cause)> {
        let old = || self.waiting.values().filter(|waiting| waiting.since <= before);
        let oldest = old().min_by_key(|waiting| waiting.since)?;
        Some((count(old().count()), oldest.cause))
    }

    /// Least number of moves from a block to luggage that waits.
    pub(super) fn distance(&self, from: Block) -> u32 {
        self.waiting.values().map(|waiting| waiting.from.distance(from)).min().unwrap_or(0)
    }
}

fn count(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(robot: u32, stage: LuggageStage) -> EventLuggage {
        EventLuggage { robot, stage, ..EventLuggage::request(7, Block::new(1, 1), Block::new(5, 5)) }
    }

    fn waiting_after(said: &[EventLuggage], failed: u32) -> u32 {
        let mut work = Work::default();
        for one in said {
            if one.stage == LuggageStage::Request {
                work.forget(failed);
            }
            work.hear_luggage(one, Time::START, Cause::default());
        }
        let kept = Work::of(work.memory());
        assert_eq!(kept.waiting(), work.waiting(), "it goes on with the same");
        work.waiting()
    }

    #[test]
    fn luggage_of_a_robot_that_failed_waits_again_until_it_is_over() {
        let [request, taken, delivered] = [LuggageStage::Request, LuggageStage::Taken, LuggageStage::Delivered];
        let by = |robot, stage| said(robot, stage);
        assert_eq!(waiting_after(&[by(0, request)], 2), 1);
        assert_eq!(waiting_after(&[by(0, request), by(2, taken)], 2), 0);
        assert_eq!(waiting_after(&[by(0, request), by(2, taken), by(0, request)], 2), 1, "its bearer failed");
        assert_eq!(waiting_after(&[by(0, request), by(2, taken), by(0, request)], 9), 1, "its bearer left it");
        assert_eq!(waiting_after(&[by(0, request), by(2, taken), by(3, request)], 2), 0, "for a robot that starts");
        let late = [by(0, request), by(2, taken), by(2, delivered), by(0, request)];
        assert_eq!(waiting_after(&late, 9), 0, "a request that is late");
    }
}
