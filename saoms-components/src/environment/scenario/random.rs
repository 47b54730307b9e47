use std::time::Duration;

use saoms_api::Chance;

use crate::grid::{Block, Map};

/// A range from which a value is drawn with equal probability, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RandomRange<T> {
    /// Lower end.
    pub least: T,
    /// Upper end.
    pub most: T,
}

impl<T: Copy> RandomRange<T> {
    /// A range with only this value.
    pub const fn fixed(value: T) -> RandomRange<T> {
        RandomRange { least: value, most: value }
    }
}

impl RandomRange<Duration> {
    pub(crate) fn draw(&self, chance: &mut Chance) -> Duration {
        let nanos = |duration: Duration| u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        match self.least == self.most {
            true => self.least,
            false => Duration::from_nanos(chance.range(nanos(self.least)..=nanos(self.most))),
        }
    }
}

impl RandomRange<u32> {
    pub(crate) fn draw(&self, chance: &mut Chance) -> u32 {
        if self.least == self.most { self.least } else { chance.range(self.least..=self.most) }
    }
}

/// Block, or range of blocks, where luggage is or has to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spot {
    /// A free block of the rectangle between two corners.
    Between(Block, Block),
    /// Any free block of the area.
    Anywhere,
}

/// Number of random attempts before the free blocks are listed.
const ATTEMPTS: u32 = 32;

impl Spot {
    /// The rectangle between any two opposite corners.
    pub(crate) fn between(one: Block, other: Block) -> Spot {
        Spot::Between(
            Block::new(one.x.min(other.x), one.y.min(other.y)),
            Block::new(one.x.max(other.x), one.y.max(other.y)),
        )
    }

    /// The block, if the spot is a single block.
    pub(crate) fn block(self) -> Option<Block> {
        match self {
            Spot::Between(one, other) if one == other => Some(one),
            _ => None,
        }
    }

    /// The corners of the spot; `None` if they are those of an unknown area.
    pub(crate) fn corners(self, area: Option<&Map>) -> Option<(Block, Block)> {
        match (self, area) {
            (Spot::Between(first, last), _) => Some((first, last)),
            (Spot::Anywhere, Some(area)) => Some((Block::new(0, 0), area.block(area.size().checked_sub(1)?))),
            (Spot::Anywhere, None) => None,
        }
    }

    /// A block of the spot other than `not`, free if the area is known; `None` if there is none.
    pub(crate) fn draw(self, chance: &mut Chance, area: Option<&Map>, not: Option<Block>) -> Option<Block> {
        if let Some(block) = self.block() {
            // A single block is taken as written, even if it is impossible: the receiver reports it.
            return Some(block);
        }
        let (first, last) = self.corners(area)?;
        let fits = |block: &Block| Some(*block) != not && area.is_none_or(|area| area.is_free(*block));
        for _ in 0..ATTEMPTS {
            let block = Block::new(chance.range(first.x..=last.x), chance.range(first.y..=last.y));
            if fits(&block) {
                return Some(block);
            }
        }
        // Few blocks are free, or none.
        let free: Vec<Block> = blocks(first, last, area).filter(fits).collect();
        chance.pick(&free).copied()
    }
}

/// The blocks between two corners, without those outside the area.
fn blocks(first: Block, last: Block, area: Option<&Map>) -> impl Iterator<Item = Block> {
    let cut = |end: i32, side: fn(&Map) -> u32| {
        area.map_or(end, |area| end.min(i32::try_from(side(area)).unwrap_or(i32::MAX).saturating_sub(1)))
    };
    let (right, bottom) = (cut(last.x, Map::width), cut(last.y, Map::height));
    (first.y..=bottom).flat_map(move |y| (first.x..=right).map(move |x| Block::new(x, y)))
}
