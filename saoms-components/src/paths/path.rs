use std::sync::Arc;

use crate::grid::Block;

/// A robot as the picture shows it.
#[derive(Clone, Debug)]
pub(super) struct Robot {
    /// The path of its component in the composite.
    pub(super) name: Arc<str>,
    pub(super) path: Option<Path>,
    pub(super) charger: Option<Block>,
    pub(super) delivered: Pieces,
    /// True if its last message said that its battery is empty.
    pub(super) empty: bool,
}

impl Robot {
    pub(super) fn new(name: &Arc<str>) -> Robot {
        Robot { name: Arc::clone(name), path: None, charger: None, delivered: Pieces::default(), empty: false }
    }
}

/// The path of a robot, straight leg by straight leg.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) start: Block,
    pub(super) now: Block,
    /// Blocks that it moved.
    pub(super) moves: u64,
    pub(super) legs: Vec<Leg>,
}

/// A straight way from one block to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Leg {
    pub(super) from: Block,
    pub(super) to: Block,
    /// Nothing was heard from the blocks between.
    pub(super) jump: bool,
}

impl Leg {
    /// True if it leads along a row.
    pub(super) fn is_level(&self) -> bool {
        self.from.y == self.to.y
    }

    /// True if its column or row counts up.
    pub(super) fn is_forward(&self) -> bool {
        (self.from.x, self.from.y) <= (self.to.x, self.to.y)
    }

    fn direction(&self) -> (i32, i32) {
        direction(self.from, self.to)
    }
}

fn direction(from: Block, to: Block) -> (i32, i32) {
    (to.x.cmp(&from.x) as i32, to.y.cmp(&from.y) as i32)
}

impl Path {
    pub(super) fn new(start: Block) -> Path {
        Path { start, now: start, moves: 0, legs: Vec::new() }
    }

    /// The robot is on this block now. Returns how many legs that adds.
    pub(super) fn go(&mut self, block: Block) -> usize {
        let from = std::mem::replace(&mut self.now, block);
        if from == block {
            return 0;
        }
        let distance = from.distance(block);
        self.moves += u64::from(distance);
        let jump = distance > 1;
        match self.legs.last_mut() {
            Some(leg) if !jump && !leg.jump && leg.to == from && leg.direction() == direction(from, block) => {
                leg.to = block;
                0
            }
            _ => {
                self.legs.push(Leg { from, to: block, jump });
                1
            }
        }
    }
}

/// Luggage: how many pieces, and the numbers of the first.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    pub(super) count: usize,
    first: Vec<u32>,
}

impl Pieces {
    /// The most numbers that are kept.
    const KEPT: usize = 8;

    pub(super) fn add(&mut self, luggage: u32) {
        self.count += 1;
        if self.first.len() < Pieces::KEPT {
            self.first.push(luggage);
        }
    }

    /// Adds other pieces.
    pub(super) fn absorb(&mut self, others: Pieces) {
        self.count += others.count;
        self.first.extend(others.first);
        self.first.truncate(Pieces::KEPT);
    }

    /// Their numbers where there are at most so many, otherwise `None`.
    pub(super) fn numbers(&self, most: usize) -> Option<String> {
        let all = self.count <= most && self.count == self.first.len();
        all.then(|| self.first.iter().map(u32::to_string).collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_way_is_one_leg_however_long() {
        let mut path = Path::new(Block::new(0, 0));
        let way = [(1, 0), (2, 0), (2, 0), (3, 0), (3, 1), (3, 0), (7, 0), (8, 0)];
        let added: usize = way.iter().map(|(x, y)| path.go(Block::new(*x, *y))).sum();
        let legs: Vec<String> =
            path.legs.iter().map(|leg| format!("{}{}{}", leg.from, if leg.jump { "~" } else { "-" }, leg.to)).collect();
        assert_eq!(legs, ["(0,0)-(3,0)", "(3,0)-(3,1)", "(3,1)-(3,0)", "(3,0)~(7,0)", "(7,0)-(8,0)"]);
        assert_eq!((added, path.moves), (5, 10));
    }

    #[test]
    fn pieces_are_named_while_they_are_few() {
        let mut pieces = Pieces::default();
        (1..=8).for_each(|luggage| pieces.add(luggage));
        assert_eq!(pieces.numbers(8).unwrap(), "1, 2, 3, 4, 5, 6, 7, 8");
        assert_eq!(pieces.numbers(7), None);
        pieces.add(9);
        assert_eq!((pieces.numbers(100), pieces.count), (None, 9));
    }
}
