//! Numbers that a component remembers for ever, in little space.

use saoms_api::Field;

/// A set of numbers as few ranges: those of luggage follow each other, so that a component saves in no time all that
/// there ever were.
#[derive(Clone, Debug, Default, PartialEq, Eq, Field)]
pub(crate) struct Numbers {
    /// In order, with gaps between them.
    ranges: Vec<NumberRange>,
}

/// Numbers without gaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
struct NumberRange {
    first: u32,
    last: u32,
}

impl Numbers {
    pub(crate) fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.ranges.iter().map(|range| (range.last - range.first) as usize + 1).sum()
    }

    pub(crate) fn contains(&self, number: u32) -> bool {
        let place = self.ranges.partition_point(|range| range.last < number);
        self.ranges.get(place).is_some_and(|range| range.first <= number)
    }

    /// Adds a number; false if it is there already.
    pub(crate) fn insert(&mut self, number: u32) -> bool {
        let place = self.ranges.partition_point(|range| range.last < number);
        let joins_next = self.ranges.get(place).is_some_and(|next| next.first <= number.saturating_add(1));
        if joins_next && self.ranges[place].first <= number {
            return false;
        }
        let before = place.checked_sub(1).filter(|before| self.ranges[*before].last + 1 == number);
        match (before, joins_next) {
            (Some(before), true) => {
                self.ranges[before].last = self.ranges[place].last;
                self.ranges.remove(place);
            }
            (Some(before), false) => self.ranges[before].last = number,
            (None, true) => self.ranges[place].first = number,
            (None, false) => self.ranges.insert(place, NumberRange { first: number, last: number }),
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use saoms_api::Chance;

    use super::*;

    #[test]
    fn it_is_a_set() {
        for seed in 0..200 {
            let (mut chance, mut numbers, mut expected) = (Chance::new(seed), Numbers::default(), BTreeSet::new());
            for _ in 0..60 {
                let number = chance.below(40) as u32 + if seed % 2 == 0 { 0 } else { u32::MAX - 39 };
                assert_eq!(numbers.insert(number), expected.insert(number));
                assert_eq!(numbers.len(), expected.len());
            }
            for number in (0..50).chain(u32::MAX - 50..=u32::MAX) {
                assert_eq!(numbers.contains(number), expected.contains(&number), "{number} in {numbers:?}");
            }
            assert!(numbers.ranges.windows(2).all(|pair| pair[0].last + 1 < pair[1].first), "{numbers:?}");
        }
        assert!(Numbers::default().is_empty());
    }

    #[test]
    fn numbers_that_follow_each_other_take_the_space_of_one() {
        let mut numbers = Numbers::default();
        assert!((1..=100_000).all(|number| numbers.insert(number)));
        assert_eq!(numbers.ranges.len(), 1);
    }
}
