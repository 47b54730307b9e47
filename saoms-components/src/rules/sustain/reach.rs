//! Rule: luggage is farther away than any full battery lasts.

use std::collections::HashMap;

use saoms_api::Finding;
use saoms_api::rule::Severity;

use super::Range;
use super::missed::Missed;
use super::pairs::out_of_one_reach;
use crate::grid::{Block, Map};
use crate::rules::budget::Budget;
use crate::rules::map::{LuggageLine, WorldMap};

/// Finding for luggage of a line that no robot can bring, or for a part of it.
pub(super) fn out_of_reach(
    area: &WorldMap,
    ranges: &[Range],
    missed: &Missed,
    piece: &LuggageLine,
    ways: &mut Ways<'_>,
) -> Option<Finding> {
    let (from, to) = (&piece.from, &piece.to);
    let of_spot = [(from, "from"), (to, "to")].into_iter().find_map(|(spot, verb)| {
        let (cut, all, first) = missed.count(area, spot.value, &mut ways.budget)?;
        let (nearest, robot) = ways.nearest(ranges, first)?;
        let most = ranges[robot].most();
        let where_to = match spot.value.block() {
            Some(block) => format!("{block}: it is "),
            None => format!("{cut} of the {all} free blocks here: {first} is "),
        };
        let message = format!(
            "no robot can bring luggage {verb} {where_to}{nearest} moves from the nearest charger; a full battery \
             allows {most}, there and back"
        );
        let severity = if cut == all { Severity::Error } else { Severity::Warning };
        Some(Finding::new(piece.place(spot), message).severity(severity).help(help(&ranges[robot])))
    });
    of_spot.or_else(|| out_of_one_reach(area, ranges, piece, ways))
}

fn help(range: &Range) -> String {
    let less = match range.physical {
        Some(name) => format!("reduce `{name}`"),
        None => "reduce `discharge`, which counts for each execution, or `moveTime` and `handlingTime`, which say how \
            many executions a move and handling take; with `dischargePerBlock` and `chargePerSecond` the energy does \
            not depend on these times"
            .to_owned(),
    };
    format!("put a charger closer to this block, or let robots use less energy on the way: {less}")
}

/// Number of moves between blocks.
pub(super) struct Ways<'m> {
    map: &'m Map,
    /// Blocks from which ways are needed, sorted.
    starts: Vec<Block>,
    /// The same blocks as blocked blocks of a map, for faster lookup.
    marked: Map,
    /// Number of moves to a block from each start.
    known: HashMap<Block, Vec<u32>>,
    left: usize,
    budget: Budget,
    /// The same for counts, which make a message more precise: they take nothing from what finds faults.
    spare: (usize, Budget),
    /// Index of the robot that reached the last block.
    reached: usize,
}

/// Maximum number of blocks that are searched for all luggage together: a check must not take longer than the run.
pub(super) const SEARCHED: usize = 20_000_000;

/// Maximum number of distances that are kept.
const KEPT: usize = 250_000;

/// Cost of looking up the distance from a charger, in searched blocks.
const LOOK: usize = 5;

/// Distance of blocks without a way.
const NO_WAY: u32 = u32::MAX;

impl<'m> Ways<'m> {
    /// Ways from these blocks.
    pub(super) fn on(map: &'m Map, starts: impl Iterator<Item = Block>) -> Ways<'m> {
        let mut starts: Vec<Block> = starts.filter(|block| map.contains(*block)).collect();
        starts.sort_unstable();
        starts.dedup();
        let mut marked = Map::new(map.width(), map.height());
        if !map.is_open() {
            starts.iter().for_each(|block| _ = marked.set_blocked(*block));
        }
        let known = HashMap::new();
        let (left, budget, spare) = (SEARCHED, Budget::default(), (SEARCHED, Budget::default()));
        Ways { map, starts, marked, known, left, budget, spare, reached: 0 }
    }

    /// Counts something within the budget for counts.
    pub(super) fn count<T>(&mut self, count: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        self.exchange_budgets();
        let counted = count(self);
        self.exchange_budgets();
        counted
    }

    fn exchange_budgets(&mut self) {
        std::mem::swap(&mut self.left, &mut self.spare.0);
        std::mem::swap(&mut self.budget, &mut self.spare.1);
    }

    /// Number of moves from the charger of a robot; the outer `None` means that the budget is used up.
    pub(super) fn moves_of(&mut self, range: &Range, block: Block) -> Option<Option<u32>> {
        if self.budget.admit(LOOK) { self.moves(range.charger, block) } else { None }
    }

    /// Number of moves from the nearest charger, with the place of its robot; of two as near, the one whose robot gets
    /// farther. `None` if the budget is used up, or no way leads there.
    fn nearest(&mut self, ranges: &[Range], block: Block) -> Option<(u32, usize)> {
        let mut nearest: Option<(u32, usize)> = None;
        for (place, range) in ranges.iter().enumerate() {
            let Some(moves) = self.moves_of(range, block)? else { continue };
            let is_better =
                |(least, best): (u32, usize)| moves < least || moves == least && range.full > ranges[best].full;
            if nearest.is_none_or(is_better) {
                nearest = Some((moves, place));
            }
        }
        nearest
    }

    /// True if a robot can go from its charger to both blocks and back from each, or no way leads there, which another
    /// rule reports; `None` if the budget is used up.
    pub(super) fn is_brought(&mut self, ranges: &[Range], from: Block, to: Block) -> Option<bool> {
        // Usually the robot that brought the last piece, or one after it in the document, brings this one.
        let (before, behind) = ranges.split_at(self.reached.min(ranges.len()));
        let mut is_connected = false;
        for (place, range) in behind.iter().chain(before).enumerate() {
            let (Some(there), Some(on)) = (self.moves_of(range, from)?, self.moves(range.charger, to)?) else {
                continue;
            };
            is_connected = true;
            if range.reaches(there) && range.reaches(on) {
                self.reached = (self.reached + place) % ranges.len();
                return Some(true);
            }
        }
        Some(!is_connected)
    }

    /// Number of moves from a start. The outer `None` means that the budget is used up, the inner one that no way leads
    /// there.
    pub(super) fn moves(&mut self, from: Block, to: Block) -> Option<Option<u32>> {
        if self.map.is_open() {
            return Some((self.map.contains(from) && self.map.contains(to)).then(|| from.distance(to)));
        }
        let (Ok(start), true) = (self.starts.binary_search(&from), self.map.is_free(to)) else {
            return Some(None);
        };
        if !self.known.contains_key(&to) {
            self.left = self.left.checked_sub(self.map.size())?;
            if (self.known.len() + 1) * self.starts.len() > KEPT {
                self.known.clear();
            }
            self.known.insert(to, self.moves_to(to));
        }
        Some(self.known.get(&to)?.get(start).copied().filter(|moves| *moves != NO_WAY))
    }

    /// Number of moves to a block from each start. For blocks in between only one bit is kept, since a large map has
    /// few starts.
    fn moves_to(&self, to: Block) -> Vec<u32> {
        let mut moves = vec![NO_WAY; self.starts.len()];
        let mut unreached = self.map.clone();
        unreached.set_blocked(to);
        let (mut open, mut next, mut count) = (vec![to], Vec::new(), 0);
        let mut left = self.starts.iter().filter(|start| self.map.is_free(**start)).count();
        while !open.is_empty() && left > 0 {
            for block in open.drain(..) {
                if !self.marked.is_free(block)
                    && let Ok(start) = self.starts.binary_search(&block)
                {
                    moves[start] = count;
                    left -= 1;
                }
                for beside in block.neighbours() {
                    if unreached.is_free(beside) {
                        unreached.set_blocked(beside);
                        next.push(beside);
                    }
                }
            }
            std::mem::swap(&mut open, &mut next);
            count += 1;
        }
        moves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_lead_around_walls() {
        let map = Map::read("..@..\n.@@..\n.....\n..@@@\n..@..").unwrap();
        let block = Block::new;
        let starts = [block(0, 0), block(3, 0), block(4, 4), block(2, 0), block(9, 9)];
        let mut ways = Ways::on(&map, starts.into_iter());
        let asked = [
            ((0, 0), (0, 0), Some(0)),
            ((0, 0), (3, 0), Some(7)),
            ((3, 0), (0, 0), Some(7)),
            ((0, 0), (4, 1), Some(7)),
            // To no block, from no block, and from outside.
            ((4, 4), (0, 0), None),
            ((2, 0), (1, 0), None),
            ((1, 0), (2, 0), None),
            ((9, 9), (0, 0), None),
        ];
        for ((x, y), (to_x, to_y), moves) in asked {
            assert_eq!(ways.moves(block(x, y), block(to_x, to_y)), Some(moves), "({x},{y}) to ({to_x},{to_y})");
        }
    }
}
