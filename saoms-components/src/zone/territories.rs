use crate::grid::Block;
use crate::messages::Territory;

/// The zones that a robot knows, and former ones.
///
/// Where borders change, a block gets another zone, in a higher term. What a robot has told that zone counts from then
/// on: it takes no grant of an earlier one for the block any more, also if messages of that come late, and if its
/// present zone is not known.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Territories {
    /// By their numbers. No two of them share a block.
    known: Vec<Territory>,
    /// Former ones, of which some blocks are in no known one.
    former: Vec<Territory>,
}

impl Territories {
    /// The same zones as earlier ones.
    pub(crate) fn with(known: Vec<Territory>, former: Vec<Territory>) -> Territories {
        Territories { known, former }
    }

    /// The present zones, as far as they are known, by their numbers.
    pub(crate) fn known(&self) -> &[Territory] {
        &self.known
    }

    pub(crate) fn former(&self) -> &[Territory] {
        &self.former
    }

    /// The zone of a block.
    pub(crate) fn of(&self, block: Block) -> Option<&Territory> {
        self.known.iter().find(|territory| territory.contains(block))
    }

    /// Takes in the territory of a zone. False if that says nothing new, or the zone was the one of a block earlier
    /// than another one that the robot has heard of.
    pub(crate) fn hear(&mut self, territory: &Territory) -> bool {
        let concerns = |other: &Territory| other.zone == territory.zone || other.shares(territory) > 0;
        let is_newer = |other: &Territory| other.term >= territory.term && concerns(other);
        if self.known.iter().chain(&self.former).any(is_newer) {
            return false;
        }
        self.former.extend(self.known.extract_if(.., |other| concerns(other)));
        let place = self.known.partition_point(|other| other.zone < territory.zone);
        self.known.insert(place, territory.clone());
        let Territories { known, former } = self;
        former.retain(|former| known.iter().map(|other| former.shares(other)).sum::<u64>() < former.shares(former));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zone(zone: u32, term: u64, x: i32, width: u32) -> Territory {
        Territory { zone, term, corner: Block::new(x, 0), width, height: 4 }
    }

    fn numbers(territories: &[Territory]) -> Vec<(u32, u64)> {
        territories.iter().map(|one| (one.zone, one.term)).collect()
    }

    #[test]
    fn a_zone_with_a_block_of_another_one_takes_its_place() {
        let mut all = Territories::default();
        assert!(all.hear(&zone(1, 1, 0, 10)));
        assert!(!all.hear(&zone(1, 1, 0, 10)));
        assert!(all.hear(&zone(2, 2, 6, 4)));
        assert_eq!((numbers(all.known()), numbers(all.former())), (vec![(2, 2)], vec![(1, 1)]));
        // Nobody knows whose block that is until the zone there has spoken.
        assert_eq!(all.of(Block::new(0, 0)), None);
        assert!(all.hear(&zone(1, 2, 0, 6)));
        assert_eq!((numbers(all.known()), numbers(all.former())), (vec![(1, 2), (2, 2)], vec![]));
        assert_eq!(all.of(Block::new(6, 3)).map(|zone| zone.zone), Some(2));
    }

    #[test]
    fn a_former_zone_is_not_heard_late() {
        let mut all = Territories::default();
        all.hear(&zone(2, 3, 6, 4));
        assert!(!all.hear(&zone(1, 1, 0, 10)), "of before a border that is known");
        // The zone leaves some of its blocks to one that is not known yet.
        assert!(all.hear(&zone(2, 5, 8, 2)));
        assert_eq!(numbers(all.former()), [(2, 3)]);
        assert!(!all.hear(&zone(1, 1, 0, 8)), "of before the border before that");
        assert!(all.hear(&zone(3, 1, 0, 6)), "its blocks were in no other zone");
        assert!(all.hear(&zone(4, 5, 6, 2)));
        assert_eq!(numbers(all.former()), []);
    }
}
