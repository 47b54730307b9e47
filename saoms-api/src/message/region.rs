use std::ops::RangeInclusive;

/// A region of blocks, from one corner to the other, both included: the part of a map whose messages a subscription
/// receives. See [`Context::set_region`](crate::Context::set_region).
///
/// ```
/// use saoms_api::Region;
///
/// let near = Region::around((5, 5), 2);
/// assert!(near.contains((3, 7)) && !near.contains((2, 5)));
/// assert_eq!(near, Region::new(3..=7, 3..=7));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    least: (i32, i32),
    most: (i32, i32),
}

impl Region {
    /// The blocks of these columns and rows; none where a range is empty.
    pub fn new(columns: RangeInclusive<i32>, rows: RangeInclusive<i32>) -> Region {
        Region { least: (*columns.start(), *rows.start()), most: (*columns.end(), *rows.end()) }
    }

    /// The blocks that are at most so many columns and rows from a block.
    pub fn around((x, y): (i32, i32), distance: u32) -> Region {
        let (before, behind) =
            (|from: i32| from.saturating_sub_unsigned(distance), |from: i32| from.saturating_add_unsigned(distance));
        Region { least: (before(x), before(y)), most: (behind(x), behind(y)) }
    }

    /// True if the block is in it.
    pub fn contains(&self, (x, y): (i32, i32)) -> bool {
        (self.least.0..=self.most.0).contains(&x) && (self.least.1..=self.most.1).contains(&y)
    }

    /// The corner with the least column and row.
    pub fn least(&self) -> (i32, i32) {
        self.least
    }

    /// The corner with the greatest column and row.
    pub fn most(&self) -> (i32, i32) {
        self.most
    }
}

/// The message of a state topic that is not in the region of a subscription any more: its block left the region, or the
/// region moved on. See [`Context::departed`](crate::Context::departed).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Departed {
    /// The sender's index in the running fleet, as in [`Header::sender`](crate::Header::sender).
    pub sender: u32,
    /// The [key](crate::Message::key) of the message; 0 where it has none.
    pub key: u64,
}
