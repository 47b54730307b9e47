use std::collections::BTreeMap;

use super::ledger::Ledger;
use super::maneuver::Maneuver;
use crate::grid::Block;

/// Number of executions for which a zone repeats to which block a robot has to make way over the edge.
///
/// Robots forget it sooner than they follow it in vain: one that is still there after that does not follow, as robots
/// of some classes, or cannot. A fleet that waits for one has to be quiet at last.
const REPEATED: u64 = 60;

/// Robots that have to make way over the edge of a zone, and since when they have not.
#[derive(Debug, Default)]
pub(super) struct Asides(BTreeMap<u32, Aside>);

#[derive(Debug)]
struct Aside {
    /// End of the robot's passage, and the block to which it has to go.
    from: Block,
    to: Block,
    /// The execution since which both are the same.
    since: u64,
}

impl Asides {
    /// Notes the robots of this execution. Gives those that have to hear it again: those that have not been there for
    /// long, and those of maneuvers, each move of which ends soon.
    pub(super) fn note(&mut self, ledger: &Ledger, maneuvers: &[Maneuver], execution: u64) -> Vec<u32> {
        let asides = ledger.members().iter().filter_map(|(robot, member)| {
            let (to, _) = member.aside?;
            Some((*robot, Aside { from: member.end(), to, since: execution }))
        });
        let mut before = std::mem::take(&mut self.0);
        self.0 = asides
            .map(|(robot, aside)| match before.remove(&robot) {
                Some(known) if (known.from, known.to) == (aside.from, aside.to) => (robot, known),
                _ => (robot, aside),
            })
            .collect();
        let is_in_maneuver =
            |robot: u32| maneuvers.iter().any(|maneuver| maneuver.robots().any(|other| other == robot));
        let is_due = |(robot, aside): &(&u32, &Aside)| execution - aside.since <= REPEATED || is_in_maneuver(**robot);
        self.0.iter().filter(is_due).map(|(robot, _)| *robot).collect()
    }
}
