//! Dead ends of a map: robots in one cannot get past each other, so who comes out goes first.

use std::collections::HashMap;

use crate::grid::{Block, Map};

/// For each block of a dead end, the block beside it over which alone robots leave it.
#[derive(Debug, Default)]
pub(super) struct DeadEnds {
    outs: HashMap<Block, Block>,
}

impl DeadEnds {
    /// The dead ends of a map: what is left over when blocks with one free neighbour are taken away, again and again.
    pub(super) fn of(map: &Map) -> DeadEnds {
        let mut outs: HashMap<Block, Block> = HashMap::new();
        if map.is_open() {
            return DeadEnds { outs };
        }
        let mut open: Vec<Block> =
            (0..map.size()).map(|place| map.block(place)).filter(|block| map.is_free(*block)).collect();
        while let Some(block) = open.pop() {
            let mut others =
                block.neighbours().into_iter().filter(|beside| map.is_free(*beside) && !outs.contains_key(beside));
            if let (Some(out), None, false) = (others.next(), others.next(), outs.contains_key(&block)) {
                outs.insert(block, out);
                open.push(out);
            }
        }
        DeadEnds { outs }
    }

    /// The block over which robots leave this one of a dead end.
    pub(super) fn out(&self, block: Block) -> Option<Block> {
        self.outs.get(&block).copied()
    }

    /// True if a block is this one of a dead end, or behind it.
    pub(super) fn is_behind(&self, block: Block, door: Block) -> bool {
        let mut ways = std::iter::successors(Some(block), |block| self.out(*block));
        self.outs.contains_key(&door) && ways.any(|block| block == door)
    }

    /// The blocks of dead ends on the way out from a block, with that one.
    pub(super) fn way_out(&self, from: Block) -> Vec<Block> {
        let way = std::iter::successors(Some(from), |block| self.out(*block));
        way.filter(|block| self.outs.contains_key(block)).collect()
    }

    /// The first block on the way out from a block that is also on another way out.
    pub(super) fn meeting(&self, from: Block, other: &[Block]) -> Option<Block> {
        std::iter::successors(Some(from), |block| self.out(*block)).find(|block| other.contains(block))
    }

    /// The block of a dead end that a robot enters on its way to a goal, from where it is or from beside the mouth.
    pub(super) fn door(&self, from: Block, goal: Block) -> Option<Block> {
        let mut ways = std::iter::successors(Some(goal), |block| self.out(*block));
        let next = ways.find(|block| self.out(*block) == Some(from));
        next.or_else(|| {
            let (door, mouth) = self.mouth(goal)?;
            (from.distance(mouth) == 1 && !self.is_behind(from, door)).then_some(door)
        })
    }

    /// The block of a dead end for which a robot that enters this block heads: that block, or the one behind the mouth
    /// of the dead end with its goal, if this is the mouth.
    pub(super) fn door_behind(&self, from: Block, block: Block, goal: Block) -> Option<Block> {
        if self.out(block) == Some(from) {
            return Some(block);
        }
        self.mouth(goal).filter(|(door, mouth)| *mouth == block && !self.is_behind(from, *door)).map(|(door, _)| door)
    }

    /// The first block of the whole dead end with a goal, and the block before it, where there are ways around.
    fn mouth(&self, goal: Block) -> Option<(Block, Block)> {
        let door =
            std::iter::successors(Some(goal), |block| self.out(*block).filter(|out| self.outs.contains_key(out)));
        let door = door.last()?;
        Some((door, self.out(door)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dead_end_has_one_way_out() {
        let dead_ends = DeadEnds::of(&Map::read("@@...\n@@.@.\n.....\n..@@@\n..@@@").unwrap());
        let out = |x: i32, y: i32| dead_ends.out(Block::new(x, y)).map(|out| (out.x, out.y));
        assert_eq!([out(0, 4), out(2, 2), out(3, 2), out(2, 0)], [None; 4], "there are ways around");
        let dead_ends = DeadEnds::of(&Map::read(".....\n.@@@@\n....@\n.@..@\n@@@@@").unwrap());
        let out = |x: i32, y: i32| dead_ends.out(Block::new(x, y)).map(|out| (out.x, out.y));
        assert_eq!([out(4, 0), out(0, 0), out(0, 3)], [Some((3, 0)), Some((0, 1)), Some((0, 2))]);
        assert_eq!([out(1, 2), out(2, 2)], [Some((2, 2)), None]);
        let [end, bay, door, hall] = [(4, 0), (0, 3), (0, 2), (3, 3)].map(|(x, y)| Block::new(x, y));
        assert!(dead_ends.is_behind(end, door) && dead_ends.is_behind(door, door));
        assert!(!dead_ends.is_behind(hall, door) && !dead_ends.is_behind(end, bay) && !dead_ends.is_behind(end, hall));
        let meeting = |from: Block, other: Block| dead_ends.meeting(from, &dead_ends.way_out(other));
        assert_eq!([meeting(end, bay), meeting(hall, bay)], [Some(door), None]);
        assert_eq!(meeting(end, Block::new(1, 0)), Some(Block::new(1, 0)));
        assert_eq!(dead_ends.door(Block::new(1, 2), end), Some(door));
        assert_eq!(dead_ends.door(door, bay), Some(bay));
        assert_eq!(dead_ends.door(bay, end), None, "it goes out first");
        assert_eq!(dead_ends.door(hall, bay), None, "it is elsewhere");
    }

    #[test]
    fn a_corridor_has_dead_ends_at_both_sides() {
        let dead_ends = DeadEnds::of(&Map::read("@@@@@\n.....\n@@@@@").unwrap());
        let outs: Vec<Option<i32>> = (0..5).map(|x| dead_ends.out(Block::new(x, 1)).map(|out| out.x)).collect();
        assert_eq!(outs.iter().flatten().count(), 4, "one block is left: {outs:?}");
    }
}
