//! Luggage that comes faster for ever than the robots can bring it and charge.
//!
//! All is counted in robots: how many of them an endless line of a scenario keeps busy. A robot spends a sixth of its time at its charger at least,
//! since it gains there in an execution what it needs in five.
//!
//! The *least* that a piece takes is certain: the shortest way from where the last piece went to where this one is, and to where it has to go, each
//! move and each handling in as many executions as the hardware needs. The *usual* adds what robots of the simulated fleets in the tests need
//! besides: settling who goes, the ways to and from the charger, and what they keep back of a full battery.

use std::time::Duration;

use saoms_api::Finding;
use saoms_api::rule::Severity;

use super::Range;
use super::reach::Ways;
use crate::environment::Spot;
use crate::grid::{Block, Map};
use crate::rules::looks::Looks;
use crate::rules::map::{Area, Luggage};

/// How many executions a robot off its charger goes on with what it gains in one there.
const CHARGE_FACTOR: f64 = 5.0;

/// Executions in which robots settle who brings a piece, and announce where they go.
const SETTLING: f64 = 4.0;

/// An endless line, and the seconds from one of its pieces to the next.
struct Line<'l> {
    luggage: &'l Luggage,
    every: f64,
}

/// Of the luggage that never ends, what is too much.
pub(super) fn overloaded(
    area: &Area,
    ranges: &[Range],
    luggage: &[Luggage],
    ways: &mut Ways<'_>,
) -> Option<Finding> {
    let lines = |pick: fn(Duration, Duration) -> f64| -> Vec<Line<'_>> {
        let endless = luggage.iter().filter_map(|luggage| Some((luggage, luggage.endless?)));
        endless.map(|(luggage, every)| Line { luggage, every: pick(every.least, every.most) }).collect()
    };
    let rarest = lines(|_, most| most.as_secs_f64());
    // Each line is held to each other one, and to each robot.
    let sides = (area.map.width() + area.map.height()) as usize;
    let looks = rarest.len().saturating_mul(sides).saturating_add(ranges.len());
    if !Looks::default().admit(rarest.len().saturating_mul(looks)) {
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
    let (there, are) = if ranges.len() == 1 { ("robot", "is") } else { ("robots", "are") };
    let pieces: f64 = usual.iter().map(|line| 60.0 / line.every).sum();
    let each = needed / pieces * 60.0;
    let message = format!(
        "luggage comes faster for ever than the fleet can bring it and charge: {} pieces a minute, each {how} {} s of a robot's time with its share of charging, keep {needed:.1} robots busy, and there {are} {} {there} with a charger",
        rounded(pieces),
        rounded(each),
        ranges.len(),
    );
    let longer = needed / robots(ranges);
    let help = format!(
        "have {count} robots with chargers of their own, or let pieces come {longer:.1} times as seldom; lines that end (`100 times`, `until 10min`) are worked off later"
    );
    Some(Finding::new(place, message).severity(severity).help(help))
}

fn robots(ranges: &[Range]) -> f64 {
    number(i64::try_from(ranges.len()).unwrap_or(i64::MAX))
}

/// A number for people: whole where it is large.
fn rounded(number: f64) -> String {
    if number >= 10.0 { format!("{number:.0}") } else { format!("{number:.1}") }
}

/// How many robots the lines keep busy at least.
fn least_robots(
    map: &Map,
    ranges: &[Range],
    chargers: &[Block],
    lines: &[Line<'_>],
    ways: &mut Ways<'_>,
) -> f64 {
    let mut way = |from: Spot, to: Spot, apart: fn(Spot, Spot, &Map) -> f64| match (from.block(), to.block())
    {
        (Some(from), Some(to)) => f64::from(ways.moves(from, to).flatten().unwrap_or(from.distance(to))),
        _ => apart(from, to, map),
    };
    // Who brings luggage comes from where it brought the last one, or from its charger in between, which is farther.
    let mut approach = f64::INFINITY;
    for line in lines {
        for last in lines {
            approach = approach.min(way(last.luggage.to.value, line.luggage.from.value, apart));
        }
    }
    // What is drawn is as far as the average in the long run; around walls it is farther, and some blocks are not drawn.
    let carried = if map.is_open() { mean } else { apart };
    let mut busy = 0.0;
    for line in lines {
        let (from, to) = (line.luggage.from.value, line.luggage.to.value);
        let moves = way(from, to, carried) + approach;
        // At a charger handling takes no charge.
        let far = |spot: Spot| !chargers.iter().any(|charger| contains(spot, *charger, map));
        let handlings = f64::from(u8::from(far(from)) + u8::from(far(to)));
        let least = ranges.iter().map(|range| {
            // Handling that is over at once goes on in the same execution.
            let handling = if range.handling > 1 { f64::from(range.handling) } else { 0.0 };
            let driving = moves * f64::from(range.moving);
            let (whole, drained) = (driving + 2.0 * handling, driving + handlings * handling);
            let charging = if range.full == u32::MAX { 0.0 } else { drained / CHARGE_FACTOR };
            range.period * whole.max(drained + charging)
        });
        busy += least.fold(f64::INFINITY, f64::min) / line.every;
    }
    busy
}

/// Which share of their time the robots are usually busy; more than 1 where they cannot do it.
fn usual_share(map: &Map, ranges: &[Range], lines: &[Line<'_>]) -> f64 {
    let pieces: f64 = lines.iter().map(|line| 1.0 / line.every).sum();
    let average = |of: &dyn Fn(&Luggage) -> f64| -> f64 {
        lines.iter().map(|line| of(line.luggage) / line.every / pieces).sum()
    };
    let way = average(&|piece| mean(piece.from.value, piece.to.value, map));
    let approach = average(&|last| average(&|piece| mean(last.to.value, piece.from.value, map)));
    let done = ranges.iter().map(|range| {
        let charger = Spot::between(range.charger, range.charger);
        let homeward =
            average(&|piece| mean(charger, piece.from.value, map) + mean(piece.to.value, charger, map));
        1.0 / (range.period * range.usual_piece(way, approach, homeward))
    });
    pieces / done.sum::<f64>()
}

impl Range {
    /// Executions that a piece usually takes: moves to bring it, to come to it from the last one, and from and to the charger. Where much is to do, a
    /// robot charges for each piece, no more than it needs for that.
    fn usual_piece(&self, way: f64, approach: f64, homeward: f64) -> f64 {
        let (moving, settling) = (f64::from(self.moving), 2.0 * f64::from(self.handling) + SETTLING);
        if self.full == u32::MAX {
            return (way + approach) * moving + settling;
        }
        ((way + homeward) * moving + settling) * (1.0 + 1.0 / CHARGE_FACTOR)
    }
}

/// The first and the last column and row of a spot, as far as they are on the map.
fn sides(spot: Spot, map: &Map) -> [(i64, i64); 2] {
    let (first, last) = spot.corners(Some(map)).unwrap_or_default();
    let cut = |side: i32, length: u32| i64::from(side).min(i64::from(length) - 1);
    [
        (cut(first.x, map.width()), cut(last.x, map.width())),
        (cut(first.y, map.height()), cut(last.y, map.height())),
    ]
}

fn contains(spot: Spot, block: Block, map: &Map) -> bool {
    let inside = |(first, last): (i64, i64), at: i32| (first..=last).contains(&i64::from(at));
    let [columns, rows] = sides(spot, map);
    inside(columns, block.x) && inside(rows, block.y)
}

/// How many moves are between two spots at least.
fn apart(one: Spot, other: Spot, map: &Map) -> f64 {
    let gap =
        |((first, last), (start, end)): ((i64, i64), (i64, i64))| (start - last).max(first - end).max(0);
    sides(one, map).into_iter().zip(sides(other, map)).map(|sides| number(gap(sides))).sum()
}

/// How many moves are between blocks of two spots on average, walls aside.
fn mean(one: Spot, other: Spot, map: &Map) -> f64 {
    // To all from 0 to this one.
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
