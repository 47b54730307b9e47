//! The messages of this program on a state topic whose messages have a place: which cells of a grid they concern.
//!
//! A message concerns the cell of its block, and the one that it leaves: that of the message before it of the same
//! component and key. It is put under the keys of both, so that who reads one of them hears that it has left.

use std::collections::{BTreeSet, HashMap};

use super::wire::{CellChange, InCell};
use crate::bus::Cell;

/// Cells that a sign of life names, at most: readers of others ask.
const MOST_CHANGES: usize = 512;

/// The cells in which messages of a topic are.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// The number of the last message that concerned a cell, of those that some reader may not know.
    last: HashMap<Cell, u64>,
    /// The same, by number.
    changes: BTreeSet<(u64, Cell)>,
    /// Changes up to this number are in signs of life no more: their readers have all they concern.
    since: u64,
}

impl Cells {
    /// Notes a message, and the cells that it and the one before it are in. Gives the cells that it concerns.
    pub(super) fn note(&mut self, number: u64, before: Option<Cell>, cell: Option<Cell>) -> Vec<InCell> {
        let left = before.filter(|before| Some(*before) != cell);
        let both = [(cell, false), (left, true)].into_iter().filter_map(|(cell, has_left)| Some((cell?, has_left)));
        let note = |((x, y), has_left)| {
            // Nothing that concerned a cell which is not known came later.
            let earlier = self.last.insert((x, y), number).unwrap_or(self.since);
            self.changes.remove(&(earlier, (x, y)));
            self.changes.insert((number, (x, y)));
            InCell { x, y, before: earlier, has_left }
        };
        both.map(note).collect()
    }

    /// Readers have all that concerns their cells, up to this number.
    pub(super) fn forget(&mut self, number: u64) {
        self.since = self.since.max(number);
        let later = self.changes.split_off(&(self.since.saturating_add(1), (i32::MIN, i32::MIN)));
        for (_, cell) in std::mem::replace(&mut self.changes, later) {
            self.last.remove(&cell);
        }
        while self.changes.len() > MOST_CHANGES {
            let Some((number, cell)) = self.changes.pop_first() else { return };
            self.last.remove(&cell);
            self.since = number;
        }
    }

    /// What a sign of life says: up to which number nothing is named, and the cells that changed since.
    pub(super) fn news(&self) -> (u64, Vec<CellChange>) {
        let change = |(last, (x, y)): &(u64, Cell)| CellChange { x: *x, y: *y, last: *last };
        (self.since, self.changes.iter().map(change).collect())
    }
}
