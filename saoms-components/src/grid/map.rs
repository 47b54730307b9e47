use std::ops::Range;

use super::Block;

/// A rectangular map of free and blocked blocks, with (0,0) as its first corner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Map {
    width: u32,
    height: u32,
    /// One bit a block, row by row; empty while no block is blocked, since each robot has a map.
    blocked: Vec<u64>,
    /// Number of blocked blocks.
    count: usize,
}

impl Map {
    /// Maximum length of a side. The costs of a square map of this size take 128 MB.
    pub const LONGEST: u32 = 8192;

    /// A map without blocked blocks. Sides longer than [`LONGEST`](Map::LONGEST) are cut.
    pub fn new(width: u32, height: u32) -> Map {
        let (width, height) = (width.min(Map::LONGEST), height.min(Map::LONGEST));
        Map { width, height, blocked: Vec::new(), count: 0 }
    }

    /// Number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Number of blocks, including blocked ones.
    pub fn size(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Index of a block, row by row; `None` outside the map.
    #[inline]
    pub fn place(&self, block: Block) -> Option<usize> {
        let (x, y) = (u32::try_from(block.x).ok()?, u32::try_from(block.y).ok()?);
        (x < self.width && y < self.height).then(|| y as usize * self.width as usize + x as usize)
    }

    /// The block with this index; the inverse of [`place`](Map::place).
    #[expect(clippy::cast_possible_wrap, reason = "both are below `LONGEST`")]
    pub fn block(&self, place: usize) -> Block {
        let width = self.width as usize;
        Block::new((place % width) as i32, (place / width) as i32)
    }

    /// True if the block is on the map.
    pub fn contains(&self, block: Block) -> bool {
        self.place(block).is_some()
    }

    /// True if a robot can be on the block: it is on the map, and not blocked.
    #[inline]
    pub fn is_free(&self, block: Block) -> bool {
        self.place(block).is_some_and(|place| self.word(place / 64) & (1 << (place % 64)) == 0)
    }

    #[inline]
    fn word(&self, at: usize) -> u64 {
        self.blocked.get(at).copied().unwrap_or(0)
    }

    /// True if no block is blocked.
    pub fn is_open(&self) -> bool {
        self.count == 0
    }

    /// Free blocks of a row within a range of columns, as maximal ranges without a blocked block. It takes one step for
    /// each range and for each 64 blocks.
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
        // Outside the map no block is free.
        let end = if row < self.height { start + columns.end.min(self.width) as usize } else { start };
        std::iter::from_fn(move || {
            let first = self.next(place, end, false)?;
            place = self.next(first, end, true).unwrap_or(end);
            Some((first - start) as u32..(place - start) as u32)
        })
    }

    /// The first blocked or free block in a range of indices.
    fn next(&self, mut place: usize, end: usize, is_blocked: bool) -> Option<usize> {
        let flipped = if is_blocked { 0 } else { u64::MAX };
        while place < end {
            let rest = (self.word(place / 64) ^ flipped) >> (place % 64);
            if rest != 0 {
                return Some(place + rest.trailing_zeros() as usize).filter(|found| *found < end);
            }
            place = (place / 64 + 1) * 64;
        }
        None
    }

    /// Blocks a block; `false` if it is outside the map.
    pub fn set_blocked(&mut self, block: Block) -> bool {
        let Some(place) = self.place(block) else { return false };
        if self.blocked.is_empty() {
            self.blocked = vec![0; self.words_needed()];
        }
        let (word, bit) = (&mut self.blocked[place / 64], 1 << (place % 64));
        if *word & bit == 0 {
            *word |= bit;
            self.count += 1;
        }
        true
    }

    /// Bits of the blocked blocks, row by row, as sent in messages.
    pub fn words(&self) -> Vec<u64> {
        if self.is_open() { vec![0; self.words_needed()] } else { self.blocked.clone() }
    }

    fn words_needed(&self) -> usize {
        self.size().div_ceil(64)
    }

    /// A map from its sides and the [`words`](Map::words) of another map; `None` if they do not fit, or if the map has
    /// no block.
    pub fn from_words(width: u32, height: u32, blocked: Vec<u64>) -> Option<Map> {
        let size = width as usize * height as usize;
        let fits = size > 0 && width <= Map::LONGEST && height <= Map::LONGEST && blocked.len() == size.div_ceil(64);
        let count = blocked.iter().map(|word| word.count_ones() as usize).sum();
        let blocked = if count == 0 { Vec::new() } else { blocked };
        fits.then_some(Map { width, height, blocked, count })
    }
}
