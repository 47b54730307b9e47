//! A bound on the work of rules over fleets.

/// How many things a rule looks at that it looks at again and again, robots for each line of a scenario or rows of blocks for each area: a check
/// must take time that grows with its files, and not with their square.
#[derive(Debug)]
pub(super) struct Looks {
    left: usize,
}

/// What a rule has for all of a fleet. It takes it tenths of a second.
const MOST: usize = 50_000_000;

impl Default for Looks {
    fn default() -> Looks {
        Looks { left: MOST }
    }
}

impl Looks {
    /// Whether so many more may be looked at; they are counted then.
    pub(super) fn admit(&mut self, count: usize) -> bool {
        let left = self.left.checked_sub(count);
        self.left = left.unwrap_or(0);
        left.is_some()
    }
}
