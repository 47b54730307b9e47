//! Luggage that is farther off than any full battery lasts.

use std::collections::{HashMap, VecDeque};

use saoms_api::{Finding, Severity};

use super::Range;
use crate::environment::Spot;
use crate::grid::{Block, Map};
use crate::rules::map::{Area, Luggage};

pub(super) fn out_of_reach(
    area: &Area,
    ranges: &[Range],
    piece: &Luggage,
    ways: &mut Ways<'_>,
) -> Option<Finding> {
    for spot in [&piece.from, &piece.to] {
        for block in farthest(area, spot.value) {
            let mut nearest = None;
            let mut is_reached = false;
            // Of thousands of robots, the one that reached the last piece, or one that is written behind it, as a rule reaches this one.
            let (before, behind) = ranges.split_at(ways.reached.min(ranges.len()));
            for (place, range) in behind.iter().chain(before).enumerate() {
                // What no way leads to is told by another rule.
                let Some(moves) = ways.moves(range.charger, block)? else { continue };
                is_reached = range.reaches(moves);
                if is_reached {
                    ways.reached = (ways.reached + place) % ranges.len();
                    break;
                }
                nearest = Some(nearest.map_or(moves, |nearest: u32| nearest.min(moves)));
            }
            let Some(nearest) = nearest.filter(|_| !is_reached) else { continue };
            let is_one = spot.value.block().is_some();
            let most = ranges.iter().map(Range::most).max().unwrap_or(0);
            let message = format!(
                "no robot can bring luggage {} {block}: {nearest} moves from the nearest charger, and a full battery lasts for {most} and back",
                if spot.bytes == piece.from.bytes { "from" } else { "to" }
            );
            let severity = if is_one { Severity::Error } else { Severity::Warning };
            let help = "put a charger closer to it, or let the robots need less than they do (`discharge`)";
            return Some(Finding::new(piece.place(spot), message).severity(severity).help(help));
        }
    }
    None
}

/// The blocks to look at: the one, or the corners of many as far as they are free.
fn farthest(area: &Area, spot: Spot) -> Vec<Block> {
    let Some((first, last)) = spot.corners(Some(&area.map)) else { return Vec::new() };
    let corners = [first, last, Block::new(first.x, last.y), Block::new(last.x, first.y)];
    let mut corners: Vec<Block> = corners.into_iter().filter(|block| area.map.is_free(*block)).collect();
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// How many moves lead from one block to another.
pub(super) struct Ways<'m> {
    map: &'m Map,
    /// The moves to a block from all others, row by row.
    known: HashMap<Block, Vec<u32>>,
    left: usize,
    /// The robot that reached the last block.
    reached: usize,
}

/// How many blocks are searched at most, for all luggage together: a check must not take longer than the run.
const SEARCHED: usize = 20_000_000;

/// No way leads there.
const NO_WAY: u32 = u32::MAX;

impl<'m> Ways<'m> {
    pub(super) fn on(map: &'m Map) -> Ways<'m> {
        Ways { map, known: HashMap::new(), left: SEARCHED, reached: 0 }
    }

    /// The outer `None` says that too much was searched already, the inner one that no way leads there.
    pub(super) fn moves(&mut self, from: Block, to: Block) -> Option<Option<u32>> {
        let (Some(place), true) = (self.map.place(from), self.map.is_free(to)) else { return Some(None) };
        if self.map.is_open() {
            return Some(Some(from.distance(to)));
        }
        if !self.known.contains_key(&to) {
            self.left = self.left.checked_sub(self.map.size())?;
            self.known.insert(to, moves_to(self.map, to));
        }
        Some(self.known.get(&to)?.get(place).copied().filter(|moves| *moves != NO_WAY))
    }
}

/// The moves to a block from all others, row by row.
fn moves_to(map: &Map, to: Block) -> Vec<u32> {
    let mut moves = vec![NO_WAY; map.size()];
    let mut open = VecDeque::from([to]);
    if let Some(place) = map.place(to) {
        moves[place] = 0;
    }
    while let Some(block) = open.pop_front() {
        let Some(here) = map.place(block).map(|place| moves[place]) else { continue };
        for beside in block.neighbours().into_iter().filter(|beside| map.is_free(*beside)) {
            if let Some(place) = map.place(beside).filter(|place| moves[*place] == NO_WAY) {
                moves[place] = here + 1;
                open.push_back(beside);
            }
        }
    }
    moves
}
