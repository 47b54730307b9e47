//! The nodes that faults name.

use std::collections::HashSet;

use smol_str::SmolStr;

use crate::check::component::ComponentCheck;
use crate::check::fleet::{Fleet, Member};

/// The nodes that faults name: those of the fleet, or, in one without, the programs that its composites would run as
/// beside each other, as far as they have components on a network.
#[derive(Debug)]
pub(crate) struct FaultNodes {
    /// The programs that are on a network.
    programs: HashSet<SmolStr>,
}

impl FaultNodes {
    pub(crate) fn of(fleet: &Fleet<'_>, checks: &[ComponentCheck<'_>]) -> FaultNodes {
        let has_url = |check: &ComponentCheck<'_>| check.task.as_ref().is_some_and(|task| task.url.is_some());
        let on_network = fleet.members.iter().zip(checks).filter(|(_, check)| has_url(check));
        FaultNodes { programs: on_network.map(|(member, _)| member.program.clone()).collect() }
    }

    /// The node of a component; empty for one that no fault names by a node.
    pub(crate) fn of_member(&self, member: &Member<'_>) -> SmolStr {
        match member.node.is_empty() {
            true => self.programs.get(&member.program).cloned().unwrap_or_default(),
            false => member.node.clone(),
        }
    }
}
