//! Measured speed of a robot.

use saoms_api::Field;

use crate::hardware::{Action, ActionKind};
use crate::robot::actions::Outcome;

/// Unit of waiting times: parts of an execution.
const PARTS: u32 = 16;

/// Weight of the newest move in the average: one part of this number.
const MEMORY: u32 = 8;

/// Number of executions that a robot's actions take, as measured so far.
#[derive(Debug, Clone, Field)]
pub(in crate::robot) struct Pace {
    /// Maximum number of executions of a move so far.
    pub(super) moving: u32,
    /// Maximum number of executions of collecting or depositing so far.
    pub(super) handling: u32,
    /// Number of executions of the running action.
    running: u32,
    /// Number of executions since the last move on the current way.
    since: u32,
    /// Average waiting time before a move, in parts of an execution.
    waiting: u32,
    /// True if the present execution is recorded.
    noted: bool,
}

impl Default for Pace {
    fn default() -> Pace {
        Pace { moving: 1, handling: 1, running: 0, since: 0, waiting: PARTS / 4, noted: false }
    }
}

impl Pace {
    /// Records the outcome of the running action in this execution.
    pub(super) fn note_action(&mut self, polled: Option<(Action, Outcome)>) {
        let Some((action, outcome)) = polled else { return self.running = 0 };
        self.running += 1;
        let longest = if action.kind == ActionKind::Move { &mut self.moving } else { &mut self.handling };
        *longest = (*longest).max(self.running);
        if matches!(outcome, Outcome::Done | Outcome::Failed) {
            self.running = 0;
        }
    }

    /// Records if the robot is on a way in this execution, and if it enters the next block.
    pub(in crate::robot) fn note_way(&mut self, on_the_way: bool, goes_on: bool) {
        self.noted = true;
        self.since = if on_the_way { self.since.saturating_add(1) } else { 0 };
        if goes_on {
            let waited = self.since.saturating_sub(self.moving).min(1000) * PARTS;
            self.waiting = (self.waiting * (MEMORY - 1) + waited) / MEMORY;
            self.since = 0;
        }
    }

    /// Ends an execution, in which no loop may have recorded the way.
    pub(super) fn note_end(&mut self, on_the_way: bool) {
        if !std::mem::take(&mut self.noted) {
            self.note_way(on_the_way, false);
            self.noted = false;
        }
    }

    /// Number of executions for moves and for collecting or depositing.
    pub(super) fn job(&self, moves: u32, handlings: u32) -> u32 {
        self.way(moves, self.waiting).saturating_add(handlings * self.handling)
    }

    /// The same for a robot that never waits.
    pub(super) fn job_alone(&self, moves: u32, handlings: u32) -> u32 {
        self.way(moves, 0).saturating_add(handlings * self.handling)
    }

    fn way(&self, moves: u32, waiting: u32) -> u32 {
        moves
            .saturating_mul(self.moving)
            .saturating_add((moves / PARTS).saturating_mul(waiting))
            .saturating_add((moves % PARTS * waiting).div_ceil(PARTS))
    }
}
