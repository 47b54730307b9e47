//! Rule: luggage arrives permanently faster than the robots can bring it and charge.
//!
//! The unit is robots: the number of robots that an endless line of a scenario keeps busy. A robot spends a part of its
//! time at its charger: a sixth, where one execution there gains the energy of five.
//!
//! The *least* effort of a piece is certain: the shortest way from the destination of the last piece to this one, and
//! on to its destination, with the executions that the hardware needs for each move and each handling. The *usual*
//! effort adds what robots of the simulated fleets in the tests need besides: agreeing on the robot that goes, the ways
//! to and from the charger, and the reserve of the battery.

use std::time::Duration;

use saoms_api::Finding;
use saoms_api::rule::Severity;

use super::Range;
use super::reach::Ways;
use crate::environment::Spot;
use crate::grid::{Block, Map};
use crate::rules::budget::Budget;
use crate::rules::map::{LuggageLine, WorldMap};

/// Number of executions in which robots agree on the robot that brings a piece, and announce their moves.
const SETTLING: f64 = 4.0;

/// An endless line, and the seconds from one of its pieces to the next.
struct Line<'l> {
    luggage: &'l LuggageLine,
    every: f64,
}

/// Findings about endless luggage that is too much.
pub(super) fn overloaded(
    area: &WorldMap,
    ranges: &[Range],
    luggage: &[LuggageLine],
    ways: &mut Ways<'_>,
) -> Option<Finding> {
    let lines = |pick: fn(Duration, Duration) -> f64| -> Vec<Line<'_>> {
        let endless = luggage.iter().filter_map(|luggage| Some((luggage, luggage.endless?)));
        endless.map(|(luggage, every)| Line { luggage, every: pick(every.least, every.most) }).collect()
    };
    let rarest = lines(|_, most| most.as_secs_f64());
    // Each line is compared with each other line, and with each robot.
    let sides = (area.map.width() + area.map.height()) as usize;
    let budget = rarest.len().saturating_mul(sides).saturating_add(ranges.len());
    if !Budget::default().admit(rarest.len().saturating_mul(budget)) {
        return None;
    }
    let usual = lines(|least, most| f64::midpoint(least.as_secs_f64(), most.as_secs_f64()));
    let busiest = usual.iter().min_by(|one, other| one.every.total_cmp(&other.every))?;
    let place = busiest.luggage.whole();
    let chargers: Vec<Block> = ranges.iter().map(|range| range.charger).collect();
    let least = least_robots(&area.map, ranges, &chargers, &rarest, ways);
    let (needed, severity, how) = if least > robots(ranges) {
        (least, Severity::Error, "at least")
    } else {
        let share = usual_share(&area.map, ranges, &usual);
        if share <= 1.0 {
            return None;
        }
        (share * robots(ranges), Severity::Warning, "usually")
    };
    let count = needed.ceil();
    let there = if ranges.len() == 1 { "robot" } else { "robots" };
    let pieces: f64 = usual.iter().map(|line| 60.0 / line.every).sum();
    let each = needed / pieces * 60.0;
    let message = format!(
        "luggage comes faster than the fleet can deliver it: {} pieces per minute need {needed:.1} robots, since \
        each piece takes {how} {} s of a robot's time, charging included; the fleet has {} {there} with a charger",
        rounded(pieces),
        rounded(each),
        ranges.len(),
    );
    let longer = needed / robots(ranges);
    let help = format!(
        "use {count} robots, each with its own charger, or make the time between pieces {longer:.1} times as long; \
        if the line ends (`100 times`, `until 10min`), the robots can deliver the rest later"
    );
    Some(Finding::new(place, message).severity(severity).help(help))
}

fn robots(ranges: &[Range]) -> f64 {
    number(i64::try_from(ranges.len()).unwrap_or(i64::MAX))
}

/// A number for people: without decimals if it is large.
fn rounded(number: f64) -> String {
    if number >= 10.0 { format!("{number:.0}") } else { format!("{number:.1}") }
}

/// Minimum number of robots that the lines keep busy.
fn least_robots(map: &Map, ranges: &[Range], chargers: &[Block], lines: &[Line<'_>], ways: &mut Ways<'_>) -> f64 {
    let mut way = |from: Spot, to: Spot, apart: fn(Spot, Spot, &Map) -> f64| match (from.block(), to.block()) {
        (Some(from), Some(to)) => f64::from(ways.moves(from, to).flatten().unwrap_or(from.distance(to))),
        _ => apart(from, to, map),
    };
    // A robot comes from the destination of its last piece, or from its charger in between, which is farther.
    let mut approach = f64::INFINITY;
    for line in lines {
        for last in lines {
            approach = approach.min(way(last.luggage.to.value, line.luggage.from.value, apart));
        }
    }
    // On average, random blocks are as far as the mean distance. Walls make ways longer, and exclude some blocks.
    let carried = if map.is_open() { mean } else { apart };
    let mut busy = 0.0;
    for line in lines {
        let (from, to) = (line.luggage.from.value, line.luggage.to.value);
        let moves = way(from, to, carried) + approach;
        // Handling at a charger takes no energy.
        let far = |spot: Spot| !chargers.iter().any(|charger| contains(spot, *charger, map));
        let handlings = f64::from(u8::from(far(from)) + u8::from(far(to)));
        let least = ranges.iter().map(|range| {
            // A handling that is over at once continues in the same execution.
            let handling = if range.handling > 1 { f64::from(range.handling) } else { 0.0 };
            let driving = moves * f64::from(range.moving);
            let (whole, drained) = (driving + 2.0 * handling, driving + handlings * handling);
            let charging = range.charge_factor.map_or(0.0, |factor| drained / factor);
            range.period * whole.max(drained + charging)
        });
        busy += least.fold(f64::INFINITY, f64::min) / line.every;
    }
    busy
}

/// Usual share of the time in which the robots are busy; more than 1 if they cannot do the work.
fn usual_share(map: &Map, ranges: &[Range], lines: &[Line<'_>]) -> f64 {
    let pieces: f64 = lines.iter().map(|line| 1.0 / line.every).sum();
    let average = |of: &dyn Fn(&LuggageLine) -> f64| -> f64 {
        lines.iter().map(|line| of(line.luggage) / line.every / pieces).sum()
    };
    let way = average(&|piece| mean(piece.from.value, piece.to.value, map));
    let approach = average(&|last| average(&|piece| mean(last.to.value, piece.from.value, map)));
    let done = ranges.iter().map(|range| {
        let charger = Spot::between(range.charger, range.charger);
        let homeward = average(&|piece| mean(charger, piece.from.value, map) + mean(piece.to.value, charger, map));
        1.0 / (range.period * range.usual_piece(way, approach, homeward))
    });
    pieces / done.sum::<f64>()
}

impl Range {
    /// Usual number of executions of a piece: moves to bring it, to come to it from the last one, and from and to the
    /// charger. Under heavy load a robot charges for each piece, but no more than the piece needs.
    fn usual_piece(&self, way: f64, approach: f64, homeward: f64) -> f64 {
        let (moving, settling) = (f64::from(self.moving), 2.0 * f64::from(self.handling) + SETTLING);
        let Some(factor) = self.charge_factor else { return (way + approach) * moving + settling };
        ((way + homeward) * moving + settling) * (1.0 + 1.0 / factor)
    }
}

/// First and last column and row of a spot, as far as they are on the map.
fn sides(spot: Spot, map: &Map) -> [(i64, i64); 2] {
    let (first, last) = spot.corners(Some(map)).unwrap_or_default();
    let cut = |side: i32, length: u32| i64::from(side).min(i64::from(length) - 1);
    [(cut(first.x, map.width()), cut(last.x, map.width())), (cut(first.y, map.height()), cut(last.y, map.height()))]
}

fn contains(spot: Spot, block: Block, map: &Map) -> bool {
    let inside = |(first, last): (i64, i64), at: i32| (first..=last).contains(&i64::from(at));
    let [columns, rows] = sides(spot, map);
    inside(columns, block.x) && inside(rows, block.y)
}

/// Minimum number of moves between two spots.
fn apart(one: Spot, other: Spot, map: &Map) -> f64 {
    let gap = |((first, last), (start, end)): ((i64, i64), (i64, i64))| (start - last).max(first - end).max(0);
    sides(one, map).into_iter().zip(sides(other, map)).map(|sides| number(gap(sides))).sum()
}

/// Average number of moves between blocks of two spots, without walls.
fn mean(one: Spot, other: Spot, map: &Map) -> f64 {
    // Sum of the distances from 0 to each number up to this one.
    let up_to = |steps: i64| steps * (steps + 1) / 2;
    let between = |((first, last), (start, end)): ((i64, i64), (i64, i64))| {
        let sum: i64 = (first..=last)
            .map(|at| {
                let (below, above) = (at.clamp(start, end) - start, end - at.clamp(start, end));
                let beyond = (at - end).max(start - at).max(0);
                up_to(below) + up_to(above) + beyond * (end - start + 1)
            })
            .sum();
        number(sum) / number((last - first + 1) * (end - start + 1))
    };
    sides(one, map).into_iter().zip(sides(other, map)).map(between).sum()
}

#[expect(clippy::cast_precision_loss, reason = "at most the cube of the longest side of a map")]
fn number(number: i64) -> f64 {
    number as f64
}
