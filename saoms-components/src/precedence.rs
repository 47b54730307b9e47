//! Which of two robots goes first where they meet, and the rule that decides it, as operators and the dashboard see it.

use saoms_api::Time;

use crate::grid::Block;
use crate::messages::Priority;

/// Rule by which one of two robots goes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Precedence {
    /// It is on the block.
    #[default]
    There,
    /// It is on the block, and does not leave it now.
    Stays,
    /// It is on the block, and cannot move any more.
    Lost,
    /// It is on its way to the block.
    Moves,
    /// The zone has granted it the block before.
    Granted,
    /// Its zone decides, which says why.
    Zone,
    /// It comes out of a dead end.
    ComesOut,
    /// It has to reach its charger in time, and the other one has no way that is as urgent.
    Charger,
    /// It has a job, and the other one has none.
    Job,
    /// It has a way, and the other one has none.
    Way,
    /// Both ways are equally urgent, and its own is older.
    Older,
    /// Nothing else makes a difference, and it has the lower number.
    Number,
}

impl Precedence {
    /// Why the robot goes first, without its name.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Precedence::There => "is there",
            Precedence::Stays => "is there, and handles luggage, charges or cannot move",
            Precedence::Lost => "is there, and cannot move any more",
            Precedence::Moves => "moves there",
            Precedence::Granted => "was granted the block before",
            Precedence::Zone => "goes first by the decision of the zone",
            Precedence::ComesOut => "comes out of a dead end",
            Precedence::Charger => "has to reach its charger in time",
            Precedence::Job => "has a job",
            Precedence::Way => "is on its way",
            Precedence::Older => "has been on its way for longer",
            Precedence::Number => "has the lower number",
        }
    }

    /// The rule by which of two different priorities the higher one goes first.
    pub(crate) fn of_priorities(higher: Priority, lower: Priority) -> Precedence {
        match (higher.purpose() > lower.purpose(), higher.rank > lower.rank) {
            (true, _) if higher.is_for_charger() => Precedence::Charger,
            (true, _) if higher.is_for_work() => Precedence::Job,
            (true, _) => Precedence::Way,
            (false, true) => Precedence::Older,
            (false, false) => Precedence::Number,
        }
    }
}

/// A block that two robots want, for one of which the other one waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Conflict {
    /// The block.
    pub(crate) block: Block,
    /// Number of the robot for which the other one waits.
    pub(crate) waits_for: u32,
    /// Number of the robot that goes first: the one that waits, if it waits for the other one to give way.
    pub(crate) first: u32,
    /// Why that one goes first.
    pub(crate) rule: Precedence,
    /// Number of another robot for which that one makes way, and because of which it goes first; 0 for none.
    pub(crate) lent_by: u32,
    /// Since when it waits.
    pub(crate) since: Time,
}

impl Conflict {
    /// Why the robot goes first, in words.
    pub(crate) fn why(&self) -> String {
        let words = self.rule.words();
        match self.lent_by {
            0 => format!("it {words}"),
            other => format!("it makes way for robot {other}, which {words}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_priorities_the_rule_is_the_first_that_tells_them_apart() {
        let priority = |purpose: u64, age: u64, robot: u32| Priority { rank: purpose << 56 | age, robot };
        for (higher, lower, expected) in [
            (priority(3, 0, 9), priority(2, 5, 1), Precedence::Charger),
            (priority(5, 0, 9), priority(3, 5, 1), Precedence::Charger),
            (priority(2, 0, 9), priority(1, 5, 1), Precedence::Job),
            (priority(1, 0, 9), priority(0, 0, 1), Precedence::Way),
            (priority(2, 7, 9), priority(2, 5, 1), Precedence::Older),
            (priority(2, 5, 1), priority(2, 5, 9), Precedence::Number),
        ] {
            assert!(higher > lower, "{higher:?} {lower:?}");
            assert_eq!(Precedence::of_priorities(higher, lower), expected, "{higher:?} {lower:?}");
        }
    }
}
