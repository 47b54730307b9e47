//! Dead ends: who goes out goes first.
//!
//! A robot in a dead end has one way out. One that stands there and wants to go in cannot ask it to make way: it makes
//! way itself, whatever its priority, and the blocks outside are those of the robot that comes out. A robot that rests
//! in a dead end, and is asked for its block, leaves it in the same way, and does not come back before the other one
//! is in. Nor does one that wanted to go in take the block again that it left to one that comes out: it would come out
//! of a bay itself, with the same right, and the two would take turns there for ever.

use saoms_api::Field;

use crate::grid::Block;
use crate::robot::Routes;

/// Maximum number of blocks of a dead end.
const LARGEST: usize = 64;

/// Number of executions, times the tempo of other robots, for which a robot keeps out of a dead end that it left.
const KEEPS_OUT: u32 = 32;

/// A robot that leaves a block to another one: in a dead end, or before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub(super) struct Leaving {
    /// Block that the other robot wants.
    pub(super) block: Block,
    /// The other robot.
    pub(super) asker: u32,
    /// Number of executions that are left until it comes back all the same.
    pub(super) left: u32,
}

impl Leaving {
    pub(super) fn new(block: Block, asker: u32, tempo: u32) -> Leaving {
        Leaving { block, asker, left: KEEPS_OUT.saturating_mul(tempo.max(1)) }
    }
}

/// The neighbour over which alone a robot leaves a dead end; `None` where it is in none. A dead end has no way around
/// in it, so that two robots cannot get past each other. Where a map has no way around at all, the smaller side is one.
pub(super) fn way_out(at: Block, routes: &Routes) -> Option<Block> {
    let leads_out = |out: &Block| {
        let size = size_behind(at, *out, LARGEST, routes);
        size.is_some_and(|size| size_behind(*out, at, size, routes).is_none())
    };
    at.neighbours().into_iter().filter(|out| routes.is_free(*out)).find(leads_out)
}

/// Number of blocks that can be reached from a block without its neighbour `out`, each in one way; `None` if there are
/// more than `most`, or several ways.
fn size_behind(at: Block, out: Block, most: usize, routes: &Routes) -> Option<usize> {
    // Each block with the one from which it was reached.
    let mut reached = [(at, out); LARGEST];
    let (mut count, mut next) = (1, 0);
    while next < count {
        let (block, before) = reached[next];
        for beside in block.neighbours() {
            if beside == before || !routes.is_free(beside) {
                continue;
            }
            let is_known = beside == out || reached[..count].iter().any(|(known, _)| *known == beside);
            if is_known || count >= most {
                return None;
            }
            reached[count] = (beside, block);
            count += 1;
        }
        next += 1;
    }
    Some(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Map;

    #[test]
    fn a_dead_end_has_one_way_out() {
        let mut routes = Routes::default();
        routes.learn(Map::read("....@\n@@.@@\n..@..\n.....\n.....").unwrap(), Block::new(0, 4));
        let out = |x: i32, y: i32| way_out(Block::new(x, y), &routes).map(|out| (out.x, out.y));
        assert_eq!(out(2, 1), Some((2, 0)), "a block without another neighbour");
        routes.learn(Map::read("@.@\n@.@\n@.@\n...\n...").unwrap(), Block::new(0, 4));
        let out = |x: i32, y: i32| way_out(Block::new(x, y), &routes).map(|out| (out.x, out.y));
        assert_eq!((out(1, 0), out(1, 1), out(1, 2)), (Some((1, 1)), Some((1, 2)), Some((1, 3))));
        assert_eq!((out(1, 3), out(0, 3), out(1, 4)), (None, None, None), "robots get past each other there");
        // A corridor alone has an end at each side.
        routes.learn(Map::read(".....").unwrap(), Block::new(0, 0));
        let out = |x: i32| way_out(Block::new(x, 0), &routes).map(|out| out.x);
        assert_eq!((out(0), out(2), out(4)), (Some(1), None, Some(3)));
        // A map without a way around is a dead end up to its middle.
        routes.learn(Map::read("..@..\n@.@.@\n.....\n@@.@@\n@@.@@").unwrap(), Block::new(0, 0));
        let out = |x: i32, y: i32| way_out(Block::new(x, y), &routes).map(|out| (out.x, out.y));
        assert_eq!([out(0, 0), out(1, 0), out(1, 1)], [Some((1, 0)), Some((1, 1)), Some((1, 2))]);
        assert_eq!([out(1, 2), out(2, 3), out(2, 2)], [Some((2, 2)), Some((2, 2)), None]);
    }
}
