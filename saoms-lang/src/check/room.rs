//! How many wires groups of replicas may come to.

use std::cell::Cell;

use super::fleet::Fleet;
use super::report::Report;
use super::target::parts;
use crate::diagnostic::{Diagnostic, codes};
use crate::source::Text;

/// Ends of wires that groups of replicas may come to: a group that calls a group has as many as the product of both.
const MOST_ENDS: usize = 1_000_000;

/// How many more there may be.
pub(super) struct Room(Cell<usize>);

impl Default for Room {
    fn default() -> Self {
        Self(Cell::new(MOST_ENDS))
    }
}

impl Room {
    /// Whether there may be as many more as this target or source stands for. That there are too many is reported, once.
    pub(super) fn take(&self, text: &Text, scope: usize, fleet: &Fleet<'_>, report: &mut Report<'_>) -> bool {
        let Some(group) = fleet.group(scope, parts(text).0) else { return true };
        let left = self.0.get();
        let (more, is_enough) = (left.saturating_sub(group.len()), left > group.len());
        self.0.set(more);
        if left > 0 && !is_enough {
            self.0.set(0);
            let message = format!("groups of replicas come to more than {MOST_ENDS} ends of wires");
            let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, text.location, message);
            report.push(one.help("each replica of a group that calls a group has a wire to each of that: is this what is meant?"));
        }
        is_enough
    }
}
