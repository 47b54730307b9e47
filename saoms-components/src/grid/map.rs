use std::ops::Range;

use super::Block;

/// A rectangle of blocks, (0,0) in its first corner, some of them blocked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Map {
    width: u32,
    height: u32,
    /// One bit a block, row by row.
    blocked: Vec<u64>,
    /// How many are blocked.
    count: usize,
}

impl Map {
    /// The longest side of a map. Its square of blocks still fits into 128 MB of distances.
    pub const LONGEST: u32 = 8192;

    /// A map without blocked blocks. Sides beyond [`LONGEST`](Map::LONGEST) are cut.
    pub fn new(width: u32, height: u32) -> Map {
        let (width, height) = (width.min(Map::LONGEST), height.min(Map::LONGEST));
        Map { width, height, blocked: vec![0; (width as usize * height as usize).div_ceil(64)], count: 0 }
    }

    /// How many blocks wide it is.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// How many blocks high it is.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// How many blocks it has, blocked ones too.
    pub fn size(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The block's place when blocks are counted row by row; `None` outside the map.
    #[inline]
    pub fn place(&self, block: Block) -> Option<usize> {
        let (x, y) = (u32::try_from(block.x).ok()?, u32::try_from(block.y).ok()?);
        (x < self.width && y < self.height).then(|| y as usize * self.width as usize + x as usize)
    }

    /// The block at a place; the inverse of [`place`](Map::place).
    #[expect(clippy::cast_possible_wrap, reason = "both are below `LONGEST`")]
    pub fn block(&self, place: usize) -> Block {
        let width = self.width as usize;
        Block::new((place % width) as i32, (place / width) as i32)
    }

    /// Whether the block lies on the map.
    pub fn contains(&self, block: Block) -> bool {
        self.place(block).is_some()
    }

    /// Whether a robot can stand there: on the map, and not blocked.
    #[inline]
    pub fn is_free(&self, block: Block) -> bool {
        self.place(block).is_some_and(|place| self.blocked[place / 64] & (1 << (place % 64)) == 0)
    }

    /// Whether no block is blocked.
    pub fn is_open(&self) -> bool {
        self.count == 0
    }

    /// The free blocks in these columns of a row, as ranges of columns without a blocked block in them. It takes the time of the ranges and of
    /// a step for each 64 blocks.
    ///
    /// ```
    /// use saoms_components::grid::Map;
    ///
    /// let map = Map::read("..@...@").unwrap();
    /// assert_eq!(map.free_ranges(0, 1..5).collect::<Vec<_>>(), [1..2, 3..5]);
    /// ```
    pub fn free_ranges(&self, row: u32, columns: Range<u32>) -> impl Iterator<Item = Range<u32>> {
        let start = row as usize * self.width as usize;
        let mut place = start + columns.start as usize;
        // Outside of the map there is no free block.
        let end = if row < self.height { start + columns.end.min(self.width) as usize } else { start };
        std::iter::from_fn(move || {
            let first = self.next(place, end, false)?;
            place = self.next(first, end, true).unwrap_or(end);
            Some((first - start) as u32..(place - start) as u32)
        })
    }

    /// The first blocked, or free, block from a place on and before another.
    fn next(&self, mut place: usize, end: usize, is_blocked: bool) -> Option<usize> {
        let flipped = if is_blocked { 0 } else { u64::MAX };
        while place < end {
            let rest = (self.blocked[place / 64] ^ flipped) >> (place % 64);
            if rest != 0 {
                return Some(place + rest.trailing_zeros() as usize).filter(|found| *found < end);
            }
            place = (place / 64 + 1) * 64;
        }
        None
    }

    /// Blocks a block; `false` when it lies outside.
    pub fn set_blocked(&mut self, block: Block) -> bool {
        let Some(place) = self.place(block) else { return false };
        let (word, bit) = (&mut self.blocked[place / 64], 1 << (place % 64));
        if *word & bit == 0 {
            *word |= bit;
            self.count += 1;
        }
        true
    }

    /// The bits of the blocked blocks, row by row, as they travel in a message.
    pub fn words(&self) -> &[u64] {
        &self.blocked
    }

    /// A map from its sides and the [`words`](Map::words) of another; `None` when these do not fit, or there is no block.
    pub fn from_words(width: u32, height: u32, blocked: Vec<u64>) -> Option<Map> {
        let size = width as usize * height as usize;
        let fits =
            size > 0 && width <= Map::LONGEST && height <= Map::LONGEST && blocked.len() == size.div_ceil(64);
        let count = blocked.iter().map(|word| word.count_ones() as usize).sum();
        fits.then_some(Map { width, height, blocked, count })
    }
}
