//! Chargers that cannot keep the fleet going.
//!
//! What is told is certain: the bounds are those of a robot that meets nobody, takes the shortest way, and charges as often as it can.

use std::collections::{HashMap, VecDeque};

use saoms_api::{Code, Finding, FleetRule, FleetView, Severity};

use super::map::{Area, Luggage, area, luggage};
use super::robots::{Known, may_be_others, robots};
use crate::environment::Spot;
use crate::grid::{Block, Map};
use crate::robot::{Battery, Policy};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5006",
        name: "unsustainable",
        meaning: "The chargers cannot keep the fleet going: too many robots share one, or luggage is farther off than any full battery lasts.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    check,
};

/// In charge a robot gains in an execution what five others take, so that a charger keeps it and five more going.
const ROBOTS_A_CHARGER: usize = 6;

/// How many blocks are searched at most, for all luggage together: a check must not take longer than the run.
const SEARCHED: usize = 20_000_000;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let mut findings = crowded(fleet, &robots);
    let Some(area) = area(fleet) else { return findings };
    // The classic rules drive on with an empty battery, and of other robots and loops nothing is known.
    let is_known = |robot: &Known| {
        let loops = &fleet.components()[robot.index].loops;
        robot.properties.policy == Policy::Safe && loops.iter().all(|name| name.starts_with("saoms."))
    };
    if robots.is_empty() || !robots.iter().all(is_known) || may_be_others(fleet) {
        return findings;
    }
    let ranges: Vec<Range> = robots.iter().map(|robot| Range::of(fleet, &area, robot)).collect();
    let mut ways = Ways { map: &area.map, known: HashMap::new(), left: SEARCHED };
    for piece in luggage(fleet) {
        findings.extend(out_of_reach(&area, &ranges, &piece, &mut ways));
    }
    findings
}

/// Chargers that more robots share than it can keep going.
fn crowded(fleet: &FleetView<'_>, robots: &[Known]) -> Vec<Finding> {
    let mut sharing: HashMap<(Option<usize>, Block), Vec<&Known>> = HashMap::new();
    for robot in robots.iter().filter(|robot| robot.properties.discharge > 0.0) {
        sharing.entry((robot.world, robot.charger)).or_default().push(robot);
    }
    let mut crowded: Vec<_> = sharing.into_iter().filter(|(_, all)| all.len() > ROBOTS_A_CHARGER).collect();
    crowded.sort_unstable_by_key(|(_, all)| all[0].index);
    let findings = crowded.into_iter().map(|((_, charger), all)| {
        let count = all.len();
        let message = format!(
            "{count} robots share the charger at {charger}, and it can keep {ROBOTS_A_CHARGER} of them going"
        );
        let help = format!("such a fleet needs at least {} chargers", count.div_ceil(ROBOTS_A_CHARGER));
        let place = all[ROBOTS_A_CHARGER].charger_place(fleet);
        Finding::new(place, message).severity(Severity::Warning).help(help)
    });
    findings.collect()
}

/// How far a robot gets.
struct Range {
    charger: Block,
    /// Executions that a full battery lasts.
    full: u32,
    /// Executions that a move takes at least.
    a_move: u32,
}

impl Range {
    fn of(fleet: &FleetView<'_>, area: &Area, robot: &Known) -> Range {
        let full = Battery::new(100.0, robot.properties.discharge).executions_when_full();
        let period = fleet.components()[robot.index].period.unwrap_or_default().as_nanos().max(1);
        let a_move = u32::try_from(area.properties.move_time.as_nanos() / period).unwrap_or(u32::MAX).max(1);
        Range { charger: robot.charger, full, a_move }
    }

    /// Whether it may get there and back. It may charge between collecting and depositing, so that it never has to do more at once.
    fn reaches(&self, moves: u32) -> bool {
        moves.saturating_mul(2).saturating_mul(self.a_move).saturating_sub(1) <= self.full
    }
}

fn out_of_reach(area: &Area, ranges: &[Range], piece: &Luggage, ways: &mut Ways<'_>) -> Option<Finding> {
    let most = ranges.iter().map(|range| range.full / 2 / range.a_move).max().unwrap_or(0);
    for spot in [&piece.from, &piece.to] {
        for block in farthest(area, spot.value) {
            let mut nearest = None;
            let mut is_reached = false;
            for range in ranges {
                // What no way leads to is told by another rule.
                let Some(moves) = ways.moves(range.charger, block)? else { continue };
                is_reached |= range.reaches(moves);
                nearest = Some(nearest.map_or(moves, |nearest: u32| nearest.min(moves)));
            }
            let Some(nearest) = nearest.filter(|_| !is_reached) else { continue };
            let is_one = spot.value.block().is_some();
            let message = format!(
                "no robot can bring luggage {} {block}: {nearest} moves from the nearest charger, and a full battery lasts for about {most} and back",
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
struct Ways<'m> {
    map: &'m Map,
    /// The moves to a block from all others, row by row.
    known: HashMap<Block, Vec<u32>>,
    left: usize,
}

/// No way leads there.
const NO_WAY: u32 = u32::MAX;

impl Ways<'_> {
    /// The outer `None` says that too much was searched already, the inner one that no way leads there.
    fn moves(&mut self, from: Block, to: Block) -> Option<Option<u32>> {
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
