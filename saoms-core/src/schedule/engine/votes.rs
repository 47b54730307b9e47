use saoms_api::Work;

use super::commit::LastCommits;
use super::ending::EndCause;
use super::trace::TraceStep;
use super::{Engine, RunPhase};
use crate::schedule::change::Leaving;

/// Counts of the votes about the work that is left.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VoteTally {
    pub(crate) voters: usize,
    pub(crate) done: usize,
}

/// Votes of a component in one execution or call.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ballot {
    /// True if work is left, `Some` if the component said so or the contrary; the newest word counts.
    left: Option<bool>,
    /// True if some work was given up.
    gave_up: bool,
}

impl Ballot {
    /// The last word of a component in an earlier program.
    pub(super) fn recalled(left: Option<bool>, gave_up: bool) -> Ballot {
        Ballot { left, gave_up }
    }

    /// True if its component said that no work is left.
    pub(crate) fn is_done(self) -> bool {
        self.left == Some(false)
    }

    pub(crate) fn mark(&mut self, work: Work) {
        match work {
            Work::Open => self.left = Some(true),
            Work::Done => self.left = Some(false),
            Work::GivenUp => self.gave_up = true,
        }
    }
}

impl Engine {
    /// Records a component's vote about the work that is left, and ends the run if none is left.
    pub(crate) fn vote(&mut self, index: u32, ballot: Ballot, now: u64) {
        self.note_vote(index, ballot, now);
        self.end_if_done(now);
    }

    /// Records a component's vote about the work that is left.
    pub(crate) fn note_vote(&mut self, index: u32, ballot: Ballot, now: u64) {
        let slot = &mut self.slots[index as usize];
        if ballot.gave_up && !std::mem::replace(&mut slot.gave_up, true) {
            self.note_differs(index, now);
            self.step(now, index, TraceStep::GaveUp);
        }
        let Some(left) = ballot.left else { return };
        let slot = &mut self.slots[index as usize];
        if slot.leaving != Leaving::Not {
            slot.leaving.note(left);
            // Of one that does not vote otherwise it is no word about the run.
            if slot.sees_work.is_none() {
                return;
            }
        }
        let before = self.slots[index as usize].sees_work.replace(left);
        if before == Some(left) {
            return;
        }
        self.note_differs(index, now);
        self.votes.voters += usize::from(before.is_none());
        match left {
            false => self.votes.done += 1,
            true => {
                self.votes.done -= usize::from(before.is_some());
                self.last_commits = LastCommits::None;
            }
        }
        self.step(now, index, TraceStep::Voted);
    }

    /// Ends the run if all voters see no work left, and none can come from outside.
    pub(crate) fn end_if_done(&mut self, now: u64) {
        if self.votes.voters > 0 && !self.sees_work() && self.networks.are_done() {
            self.begin_stop(EndCause::Done, now);
        }
    }

    /// True if a voter sees work left, or some may come from outside.
    pub(crate) fn sees_work(&mut self) -> bool {
        self.votes.done < self.votes.voters || !self.injections.are_over() || !self.commits_are_over()
    }

    /// Removes the vote of a component that does not take part any more.
    pub(crate) fn forget_vote(&mut self, index: u32, now: u64) {
        if self.phase != RunPhase::Running {
            return;
        }
        if let Some(left) = self.slots[index as usize].sees_work.take() {
            self.votes.voters -= 1;
            self.votes.done -= usize::from(!left);
            self.end_if_done(now);
        }
    }
}
