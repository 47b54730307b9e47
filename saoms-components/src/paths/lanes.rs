//! The lanes of legs: the legs that run side by side, and their order.
//!
//! All legs of a row or a column share its width. Legs that have a block in common get lanes of their own, by colouring
//! intervals greedily, which needs no more lanes than legs meet in one block. A turn joins two lanes at a right angle,
//! so that no path runs over another.

use std::collections::BTreeMap;

use super::path::Leg;

/// More lanes than a block can show.
const MOST: usize = 40;

/// The passes that share a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sharing {
    /// Nothing: each pass has its own.
    None,
    /// The passes of a robot in one direction.
    Direction,
    /// All passes of a robot.
    Robot,
}

/// The place of each leg in its row or column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lanes {
    /// For each robot and each of its legs, how many lanes right or below of the middle it is.
    pub(super) offsets: Vec<Vec<f64>>,
    /// The most lanes side by side.
    pub(super) most: usize,
}

/// A part of a lane: legs that share it.
struct Strip {
    robot: usize,
    first: i32,
    last: i32,
    legs: Vec<usize>,
    lane: usize,
}

/// Gives each leg of these robots a lane; `None` when more legs meet than can be distinguished.
pub(super) fn lanes(robots: &[&[Leg]], sharing: Sharing) -> Option<Lanes> {
    // By level or upright, and row or column; in it by robot and direction.
    let mut corridors: BTreeMap<(bool, i32), Vec<Strip>> = BTreeMap::new();
    for (robot, legs) in robots.iter().enumerate() {
        for (place, leg) in legs.iter().enumerate().filter(|(_, leg)| !leg.jump) {
            let across = if leg.is_level() { leg.from.y } else { leg.from.x };
            let (one, other) = if leg.is_level() { (leg.from.x, leg.to.x) } else { (leg.from.y, leg.to.y) };
            let (first, last) = (one.min(other), one.max(other));
            let strips = corridors.entry((leg.is_level(), across)).or_default();
            let joins = |strip: &Strip| {
                let is_same_way =
                    |known: &usize| sharing == Sharing::Robot || legs[*known].is_forward() == leg.is_forward();
                strip.robot == robot
                    && strip.legs.first().is_some_and(is_same_way)
                    && strip.first <= last
                    && first <= strip.last
            };
            match strips.iter().position(joins).filter(|_| sharing != Sharing::None) {
                Some(known) => join(strips, known, first, last, place, joins),
                None => strips.push(Strip { robot, first, last, legs: vec![place], lane: 0 }),
            }
        }
    }
    let mut offsets: Vec<Vec<f64>> = robots.iter().map(|legs| vec![0.0; legs.len()]).collect();
    let mut most = 0;
    for mut strips in corridors.into_values() {
        colour(&mut strips)?;
        for (strip, lanes) in strips.iter().zip(widths(&strips)) {
            most = most.max(lanes);
            for leg in &strip.legs {
                offsets[strip.robot][*leg] = strip.lane as f64 - (lanes as f64 - 1.0) / 2.0;
            }
        }
    }
    Some(Lanes { offsets, most })
}

/// Adds a leg to a strip, and to it all others that the longer one now touches.
fn join(strips: &mut Vec<Strip>, known: usize, first: i32, last: i32, leg: usize, joins: impl Fn(&Strip) -> bool) {
    strips[known].legs.push(leg);
    strips[known].first = strips[known].first.min(first);
    strips[known].last = strips[known].last.max(last);
    let mut place = known + 1;
    while place < strips.len() {
        if joins(&strips[place]) {
            let other = strips.remove(place);
            let strip = &mut strips[known];
            strip.legs.extend(other.legs);
            strip.first = strip.first.min(other.first);
            strip.last = strip.last.max(other.last);
        } else {
            place += 1;
        }
    }
}

/// Gives each strip the first lane that is free along it.
fn colour(strips: &mut [Strip]) -> Option<()> {
    let mut lanes: Vec<Vec<(i32, i32)>> = Vec::new();
    for strip in strips {
        let free = |lane: &Vec<(i32, i32)>| lane.iter().all(|(first, last)| strip.last < *first || *last < strip.first);
        strip.lane = lanes.iter().position(free).unwrap_or(lanes.len());
        if strip.lane == lanes.len() {
            lanes.push(Vec::new());
        }
        if lanes.len() > MOST {
            return None;
        }
        lanes[strip.lane].push((strip.first, strip.last));
    }
    Some(())
}

/// The number of lanes at each strip, and at those that it touches, and so on.
fn widths(strips: &[Strip]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..strips.len()).collect();
    order.sort_by_key(|place| strips[*place].first);
    let mut widths = vec![0; strips.len()];
    let mut rest = order.as_slice();
    while let Some(start) = rest.first() {
        let mut last = strips[*start].last;
        let mut lanes = 0;
        let mut end = 0;
        while let Some(strip) = rest.get(end).map(|place| &strips[*place]).filter(|strip| strip.first <= last) {
            last = last.max(strip.last);
            lanes = lanes.max(strip.lane + 1);
            end += 1;
        }
        let (together, after) = rest.split_at(end);
        for place in together {
            widths[*place] = lanes;
        }
        rest = after;
    }
    widths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Block;

    fn leg(from: (i32, i32), to: (i32, i32)) -> Leg {
        Leg { from: Block::new(from.0, from.1), to: Block::new(to.0, to.1), jump: false }
    }

    fn offsets(robots: &[&[Leg]], sharing: Sharing) -> Vec<Vec<f64>> {
        lanes(robots, sharing).unwrap().offsets
    }

    #[test]
    fn a_leg_of_its_own_runs_in_the_middle() {
        let legs = [leg((0, 0), (3, 0)), leg((3, 0), (3, 4)), leg((3, 4), (0, 4))];
        assert_eq!(offsets(&[&legs], Sharing::None), [[0.0, 0.0, 0.0]]);
    }

    #[test]
    fn legs_that_meet_run_side_by_side() {
        let (there, back) = (leg((0, 0), (3, 0)), leg((3, 0), (0, 0)));
        let touching = leg((3, 0), (5, 0));
        assert_eq!(offsets(&[&[there, back], &[touching]], Sharing::None), [vec![-1.0, 0.0], vec![1.0]]);
        let apart = leg((4, 0), (5, 0));
        assert_eq!(offsets(&[&[there, back], &[apart]], Sharing::None), [vec![-0.5, 0.5], vec![0.0]]);
    }

    #[test]
    fn passes_share_a_lane_when_there_are_many() {
        let (there, back) = (leg((0, 0), (3, 0)), leg((3, 0), (0, 0)));
        let more = leg((2, 0), (9, 0));
        let robot = [there, back, there, back, more];
        let other = [there];
        let most = |sharing| lanes(&[&robot, &other], sharing).unwrap().most;
        assert_eq!([Sharing::None, Sharing::Direction, Sharing::Robot].map(most), [6, 3, 2]);
        let shared = offsets(&[&robot, &other], Sharing::Robot);
        assert_eq!(shared, [vec![-0.5; 5], vec![0.5]]);
    }

    #[test]
    fn robots_may_have_different_numbers_of_legs() {
        let (row, other) = (leg((0, 0), (3, 0)), leg((0, 1), (3, 1)));
        let found = lanes(&[&[other, row], &[row]], Sharing::Direction).unwrap();
        assert_eq!(found.offsets, [vec![0.0, -0.5], vec![0.5]]);
    }

    #[test]
    fn a_leg_joins_strips_that_were_apart() {
        let legs = [leg((0, 0), (1, 0)), leg((3, 0), (4, 0)), leg((0, 0), (4, 0))];
        let found = lanes(&[&legs], Sharing::Direction).unwrap();
        assert_eq!((found.most, &found.offsets[0]), (1, &vec![0.0; 3]));
    }

    #[test]
    fn too_many_lanes_are_none() {
        let legs = vec![leg((0, 0), (3, 0)); MOST + 1];
        assert_eq!(lanes(&[&legs], Sharing::None), None);
        assert_eq!(lanes(&[&legs], Sharing::Direction).unwrap().most, 1);
    }
}
