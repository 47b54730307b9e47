//! Budgets for the search of the name that was meant.

use crate::limits::{Budget, CANDIDATES};

/// Lists that are not longer are searched in any case.
const FEW: usize = 100;

/// Counter of the right names that are compared with wrong ones: where nearly all names are wrong, every search goes
/// through all right ones, and the time of a check must grow linearly with its files.
#[derive(Debug)]
pub(crate) struct Candidates(Budget);

impl Default for Candidates {
    fn default() -> Self {
        Self(Budget::of(CANDIDATES))
    }
}

impl Candidates {
    /// True if a list of so many names is searched; they are counted then.
    pub(crate) fn admit(&mut self, count: usize) -> bool {
        count <= FEW || self.0.spend(count as u64)
    }

    /// The length of a list up to which it is searched: the rest need not be counted.
    pub(crate) fn most_to_count(&self) -> usize {
        usize::try_from(self.0.left()).unwrap_or(usize::MAX).max(FEW) + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_searched_so_often_that_they_have_a_million_names_together() {
        let mut candidates = Candidates::default();
        let admitted = (0..10_000).filter(|_| candidates.admit(1000)).count();
        assert_eq!(admitted as u64, CANDIDATES / 1000);
        assert!(!candidates.admit(FEW + 1) && candidates.admit(FEW), "short ones always");
        assert_eq!(candidates.most_to_count(), FEW + 1);
    }
}
