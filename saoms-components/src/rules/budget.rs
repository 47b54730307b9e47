//! Budget of rules over fleets.

/// Number of comparisons that a rule may make when it compares robots with each line of a scenario, or rows of blocks
/// with each area. The time of a check must grow linearly with its files, not with their square.
#[derive(Debug)]
pub(super) struct Budget {
    left: usize,
}

/// Budget of a rule for the whole fleet. It takes some tenths of a second.
const MOST: usize = 50_000_000;

impl Default for Budget {
    fn default() -> Budget {
        Budget { left: MOST }
    }
}

impl Budget {
    /// True if the budget allows `count` more comparisons, which it then counts.
    pub(super) fn admit(&mut self, count: usize) -> bool {
        let left = self.left.checked_sub(count);
        self.left = left.unwrap_or(0);
        left.is_some()
    }
}
