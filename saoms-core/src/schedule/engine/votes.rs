use saoms_api::Work;

use super::ending::EndCause;
use super::trace::TraceStep;
use super::{Engine, RunPhase};

/// Counts of the votes about the work that is left.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VoteTally {
    pub(crate) voters: usize,
    pub(crate) done: usize,
}

impl Engine {
    /// Records a component's vote about the work that is left, and ends the run if none is left.
    pub(crate) fn vote(&mut self, index: u32, vote: Work, now: u64) {
        self.note_vote(index, vote, now);
        self.end_if_done(now);
    }

    /// Records a component's vote about the work that is left.
    pub(crate) fn note_vote(&mut self, index: u32, vote: Work, now: u64) {
        let before = self.slots[index as usize].vote.replace(vote);
        if before == Some(vote) {
            return;
        }
        self.votes.voters += usize::from(before.is_none());
        match vote {
            Work::Done => self.votes.done += 1,
            Work::Open => self.votes.done -= usize::from(before.is_some()),
        }
        self.step(now, index, TraceStep::Voted);
    }

    /// Ends the run if all voters see no work left, and none can come from outside.
    pub(crate) fn end_if_done(&mut self, now: u64) {
        if self.votes.voters > 0 && self.votes.done == self.votes.voters && self.injections.are_over() {
            self.begin_stop(EndCause::Done, now);
        }
    }

    /// Removes the vote of a component that does not take part any more.
    pub(crate) fn forget_vote(&mut self, index: u32, now: u64) {
        if self.phase != RunPhase::Running {
            return;
        }
        if let Some(vote) = self.slots[index as usize].vote.take() {
            self.votes.voters -= 1;
            self.votes.done -= usize::from(vote == Work::Done);
            self.end_if_done(now);
        }
    }
}
