//! How many wires groups of replicas may come to.

use std::cell::Cell;

use super::report::Report;
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
    /// Whether there may be one more. That there are too many is reported, once.
    pub(super) fn take(&self, text: &Text, report: &mut Report<'_>) -> bool {
        let left = self.0.get();
        self.0.set(left.saturating_sub(1));
        if left == 1 {
            let message = format!("groups of replicas come to more than {MOST_ENDS} ends of wires");
            let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, text.location, message);
            report.push(one.help("each replica of a group that calls a group has a wire to each of that: is this what is meant?"));
        }
        left > 1
    }
}
