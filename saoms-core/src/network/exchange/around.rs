//! The messages of another program on a state topic of which this program reads some cells.
//!
//! It hears a part of the numbers. Each message says the number of the one before it in its cell, and signs of life
//! name the cells that changed: so a program knows of which cells it lacks something, and asks for their states
//! (*looks*). It looks also when it begins to read a cell.

use std::collections::{BTreeMap, BTreeSet};

use super::wire::{CellChange, InCell};
use super::{LATENESS, LONGEST_WAIT};
use crate::bus::Cell;

/// Messages in a cell that came before an earlier one, at most: beyond that, the program looks.
const MOST_LATER: usize = 1_024;
/// Cells in one look, at most.
const MOST_LOOKED: usize = 256;

/// What is known of a cell.
#[derive(Debug)]
struct CellState {
    /// The number of the first look whose answer counts: those before it were made before the cell was read.
    since: u64,
    /// True if there was one.
    is_known: bool,
    /// All that concerns the cell up to this number is here.
    has: u64,
    /// The number of the last message that is known to concern it.
    last: u64,
    /// Messages that came before an earlier one: the number before each, with its own.
    later: BTreeMap<u64, u64>,
}

impl CellState {
    fn lacks(&self) -> bool {
        !self.is_known || self.has < self.last
    }

    fn reach(&mut self, number: u64) {
        self.has = self.has.max(number);
        while let Some(entry) = self.later.first_entry().filter(|entry| *entry.key() <= self.has) {
            self.has = self.has.max(entry.remove());
        }
    }
}

/// The cells of a topic that are read of a program.
#[derive(Debug, Default)]
pub(super) struct ReadCells {
    cells: BTreeMap<Cell, CellState>,
    /// All messages before this number that concern the cells are here.
    pub(super) next: u64,
    /// The number of the last message in the newest sign of life.
    heard: u64,
    /// When cells are looked at (again), and how often they were without an answer.
    pub(super) look_at: Option<u64>,
    looks: u32,
}

impl ReadCells {
    /// Begins to read cells: answers to looks from this number on count for each.
    pub(super) fn new(cells: impl Iterator<Item = (Cell, u64)>) -> ReadCells {
        let mut read = ReadCells { next: 1, ..ReadCells::default() };
        cells.for_each(|(cell, since)| read.add(cell, since));
        read
    }

    /// Reads a cell, too.
    pub(super) fn add(&mut self, cell: Cell, since: u64) {
        let state = CellState { since, is_known: false, has: 0, last: 0, later: BTreeMap::new() };
        self.cells.insert(cell, state);
        (self.look_at, self.looks) = (Some(0), 0);
    }

    /// Reads a cell no more.
    pub(super) fn remove(&mut self, cell: Cell) {
        self.cells.remove(&cell);
    }

    /// Notes a message that concerns a cell.
    pub(super) fn take(&mut self, number: u64, InCell { x, y, before, .. }: InCell) {
        let Some(state) = self.cells.get_mut(&(x, y)) else { return };
        state.last = state.last.max(number);
        if before <= state.has {
            state.reach(number);
        } else if before < number && state.later.len() < MOST_LATER {
            state.later.insert(before, number);
        }
    }

    /// Notes what a sign of life says: the last number, and the cells that changed after another one.
    pub(super) fn hear(&mut self, last: u64, since: u64, changes: &[CellChange]) {
        for CellChange { x, y, last } in changes {
            if let Some(state) = self.cells.get_mut(&(*x, *y)) {
                state.last = state.last.max(*last);
            }
        }
        // What concerned them before is named no more.
        self.cells.values_mut().filter(|state| state.has < since).for_each(|state| state.is_known = false);
        self.heard = self.heard.max(last);
    }

    /// Notes that what concerns a cell is here, up to a number: the answer to a look.
    pub(super) fn see(&mut self, cell: Cell, look: u64, last: u64) {
        if let Some(state) = self.cells.get_mut(&cell).filter(|state| state.since <= look) {
            state.is_known = true;
            state.reach(last);
            (self.looks, self.look_at) = (0, None);
        }
    }

    /// Looks again, soon, at cells of which something that has left them came after the last look: its sender does not
    /// know that it has to say where it went.
    pub(super) fn doubt(&mut self, cells: &BTreeSet<Cell>, now: u64) {
        for cell in cells {
            if let Some(state) = self.cells.get_mut(cell) {
                state.is_known = false;
                self.look_at.get_or_insert(now + LATENESS);
            }
        }
    }

    /// True if all that concerns a cell is here, up to this number and beyond.
    pub(super) fn has_all(&self, cell: Cell, number: u64) -> bool {
        self.cells.get(&cell).is_some_and(|state| state.is_known && number <= state.has)
    }

    /// Notes that nothing is missing, or looks soon.
    pub(super) fn settle(&mut self, now: u64) {
        let lacks = |state: &CellState| state.lacks();
        if self.cells.values().any(lacks) {
            let is_late = self.cells.values().all(|state| state.is_known);
            self.look_at.get_or_insert(if is_late { now + LATENESS } else { now });
            return;
        }
        (self.look_at, self.looks) = (None, 0);
        if self.next <= self.heard {
            self.next = self.heard + 1;
            self.cells.values_mut().for_each(|state| state.reach(self.heard));
        }
    }

    /// The cells to look at now.
    pub(super) fn look(&mut self, now: u64) -> Vec<Cell> {
        let lacking = self.cells.iter().filter(|(_, state)| state.lacks()).map(|(cell, _)| *cell);
        let lacking: Vec<Cell> = lacking.take(MOST_LOOKED).collect();
        let wait = ((4 * LATENESS) << self.looks.min(10)).min(LONGEST_WAIT);
        self.look_at = (!lacking.is_empty()).then_some(now + wait);
        self.looks += 1;
        lacking
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_from_before_a_cell_was_read_does_not_count() {
        let mut read = ReadCells::new([((0, 0), 5)].into_iter());
        read.hear(100, 99, &[]);
        read.see((0, 0), 4, 50);
        read.settle(0);
        assert_eq!((read.look(0), read.next), (vec![(0, 0)], 1));
        read.see((0, 0), 5, 100);
        read.settle(0);
        assert_eq!((read.look(0), read.next), (Vec::new(), 101));
    }

    #[test]
    fn a_message_after_one_that_is_missing_lets_the_program_look_unless_that_comes_late() {
        let change = |before| InCell { x: 0, y: 0, before, has_left: false };
        let mut read = ReadCells::new([((0, 0), 1)].into_iter());
        read.see((0, 0), 1, 10);
        read.take(14, change(12));
        read.settle(7);
        assert_eq!(read.look_at, Some(7 + LATENESS));
        read.take(12, change(9));
        read.settle(8);
        assert_eq!(read.look_at, None);
        read.take(20, change(16));
        read.settle(9);
        assert_eq!(read.look(9 + LATENESS), [(0, 0)]);
    }
}
