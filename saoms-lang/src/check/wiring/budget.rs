//! The budget of wires for groups of replicas.

use std::cell::Cell;

use super::uri::parts;
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes};
use crate::source::Text;

/// Ends of wires that groups of replicas may come to: a group that calls a group has as many as the product of both.
const MOST_ENDS: usize = 1_000_000;

/// The number of more there may be.
pub(crate) struct WireBudget(Cell<usize>);

impl Default for WireBudget {
    fn default() -> Self {
        Self(Cell::new(MOST_ENDS))
    }
}

impl WireBudget {
    /// True if there may be as many more as this target or source stands for. That there are too many is reported,
    /// once.
    pub(crate) fn take(&self, text: &Text, scope: usize, fleet: &Fleet<'_>, report: &mut Report<'_>) -> bool {
        let Some(group) = fleet.group(scope, parts(text).0) else { return true };
        let left = self.0.get();
        let (more, is_enough) = (left.saturating_sub(group.len()), left > group.len());
        self.0.set(more);
        if left > 0 && !is_enough {
            self.0.set(0);
            let message = format!("groups of replicas come to more than {MOST_ENDS} ends of wires");
            let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, text.location, message);
            report.push(
                one.help(
                    "each replica of a group that calls a group has a wire to each of that: is this what is meant?",
                ),
            );
        }
        is_enough
    }
}
