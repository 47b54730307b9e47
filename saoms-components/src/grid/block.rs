use std::fmt;
use std::str::FromStr;

use saoms_api::{Field, Value};

/// A block of the area. Robots move from block to block, and luggage lies on blocks.
///
/// ```
/// use saoms_components::grid::Block;
///
/// let block: Block = "(3, 10)".parse().unwrap();
/// assert_eq!(block, Block::new(3, 10));
/// assert_eq!(block.to_string(), "(3,10)");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Field)]
#[field(pair)]
pub struct Block {
    /// The column, from 0.
    pub x: i32,
    /// The row, from 0.
    pub y: i32,
}

impl Block {
    /// The block in this column and row.
    pub const fn new(x: i32, y: i32) -> Block {
        Block { x, y }
    }

    /// Number of moves to another block if nothing is in the way.
    pub const fn distance(self, other: Block) -> u32 {
        self.x.abs_diff(other.x).saturating_add(self.y.abs_diff(other.y))
    }

    /// Square of the straight-line distance. It has the same order as the distance and is exact.
    pub fn straight_squared(self, other: Block) -> u128 {
        let (x, y) = (u128::from(self.x.abs_diff(other.x)), u128::from(self.y.abs_diff(other.y)));
        x * x + y * y
    }

    /// The four adjacent blocks: right, left, up, down.
    pub const fn neighbours(self) -> [Block; 4] {
        let Block { x, y } = self;
        [
            Block { x: x.saturating_add(1), y },
            Block { x: x.saturating_sub(1), y },
            Block { x, y: y.saturating_add(1) },
            Block { x, y: y.saturating_sub(1) },
        ]
    }

    /// The next block on the way to `to`, first along x, then along y.
    pub const fn step_x_first(self, to: Block) -> Block {
        if self.x != to.x { Block { x: toward(self.x, to.x), y: self.y } } else { self.step_y_first(to) }
    }

    /// The next block on the way to `to`, first along y, then along x.
    pub const fn step_y_first(self, to: Block) -> Block {
        if self.y != to.y {
            Block { x: self.x, y: toward(self.y, to.y) }
        } else {
            Block { x: toward(self.x, to.x), y: self.y }
        }
    }
}

const fn toward(from: i32, to: i32) -> i32 {
    if from < to {
        from + 1
    } else if from > to {
        from - 1
    } else {
        from
    }
}

impl From<Block> for Value {
    fn from(block: Block) -> Value {
        Value::Pair(block.x, block.y)
    }
}

impl fmt::Display for Block {
    /// `(3,10)`, as the console of the manual's figures writes it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "({},{})", self.x, self.y)
    }
}

impl FromStr for Block {
    type Err = String;

    /// Parses `(3,10)`; blanks are ignored.
    fn from_str(text: &str) -> Result<Block, String> {
        let expected = || format!("found `{}`, expected a block such as (3,10)", text.trim());
        let inner = text.trim().strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).ok_or_else(expected)?;
        let (x, y) = inner.split_once(',').ok_or_else(expected)?;
        let number = |text: &str| text.trim().parse().map_err(|_| expected());
        Ok(Block { x: number(x)?, y: number(y)? })
    }
}
