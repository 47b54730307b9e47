//! Robots that charge in the only way of others to their chargers.

use saoms_api::Finding;
use saoms_api::rule::{FleetView, Severity};

use super::Range;
use super::missed::Missed;
use crate::grid::{Block, Map};
use crate::rules::budget::Budget;
use crate::rules::cuts::Cuts;
use crate::rules::map::{LuggageLine, WorldMap};
use crate::rules::robots::FleetRobot;

/// A robot whose way to its charger leads over another charger may wait there for as long as a robot charges, which may
/// not get out past it. So it needs twice the energy for its work: two of three random sites where half of a battery
/// did not last for the farthest luggage, there and back, had robots that were stranded or stood still in some runs.
const SPARE: u32 = 2;

/// The finding about the first charger that bars the way to others whose robots have no energy to wait.
pub(super) fn barred(
    fleet: &FleetView<'_>,
    area: &WorldMap,
    (robots, ranges): (&[&FleetRobot], &[Range]),
    luggage: &[LuggageLine],
) -> Option<Finding> {
    let map = &area.map;
    let of_map: Vec<(&FleetRobot, &Range)> = robots
        .iter()
        .zip(ranges)
        .filter(|(robot, range)| robot.world == Some(area.index) && range.full < u32::MAX)
        .map(|(robot, range)| (*robot, range))
        .collect();
    let mut narrow: Vec<Block> = of_map.iter().map(|(robot, _)| robot.charger).collect();
    narrow.sort_unstable();
    narrow.dedup();
    let count = narrow.len();
    narrow.retain(|charger| is_narrow(map, *charger));
    let mut budget = Budget::default();
    if count < 2 || narrow.is_empty() || !budget.admit(map.size()) {
        return None;
    }
    let cuts = Cuts::of(map, |block| map.is_free(block));
    for charger in narrow {
        let Some(parts) = cuts.without(charger).filter(|_| budget.admit(of_map.len())) else { continue };
        let behind = of_map.iter().filter(|(robot, _)| cuts.is_cut_off(robot.charger, &parts));
        let short: Vec<&FleetRobot> = behind
            .filter(|(_, range)| budget.admit(map.size()) && !lasts_twice(area, range, luggage, &mut budget))
            .map(|(robot, _)| *robot)
            .collect();
        if !short.is_empty() {
            let in_the_way = of_map.iter().find(|(robot, _)| robot.charger == charger)?;
            return Some(finding(fleet, in_the_way.0, &short));
        }
    }
    None
}

/// True if a block may be the only way between two parts of a map: its free neighbours are not connected by the blocks
/// around it.
fn is_narrow(map: &Map, block: Block) -> bool {
    const AROUND: [(i32, i32); 8] = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];
    let free = AROUND.map(|(x, y)| map.is_free(Block::new(block.x + x, block.y + y)));
    // Each way around begins beside the block and goes on over a corner; a corner alone leads nowhere.
    let ways =
        (0..8).filter(|place| place % 2 == 0 && free[*place] && !(free[(place + 1) % 8] && free[(place + 2) % 8]));
    ways.count() > 1
}

/// True if a part of the battery lasts for all luggage, there and back.
fn lasts_twice(area: &WorldMap, range: &Range, luggage: &[LuggageLine], budget: &mut Budget) -> bool {
    let part = Range { full: range.full / SPARE, ..*range };
    let Some(missed) = Missed::on(&area.map, &[part]) else { return true };
    let mut spots = luggage.iter().flat_map(|piece| [&piece.from, &piece.to]);
    spots.all(|spot| missed.count(area, spot.value, budget).is_none())
}

fn finding(fleet: &FleetView<'_>, in_the_way: &FleetRobot, short: &[&FleetRobot]) -> Finding {
    let mut numbers: Vec<u32> = short.iter().map(|robot| robot.number).collect();
    numbers.sort_unstable();
    let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
    let (noun, chargers, they) = match short {
        [_] => ("robot", "its charger", "it"),
        _ => ("robots", "their chargers", "one of them"),
    };
    let message = format!(
        "a robot that charges at {} is in the only way of {noun} {} to {chargers}, and {they} may be stranded while it \
         waits: half of a battery does not last for the farthest luggage, there and back",
        in_the_way.charger,
        numbers.join(", "),
    );
    Finding::new(in_the_way.charger_place(fleet), message).severity(Severity::Warning).help(
        "put this charger where others can drive past it, or let the batteries last longer: reduce what these robots \
         discharge, or bring their chargers closer to the luggage",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_narrow_if_its_neighbours_are_not_connected_around_it() {
        let map = Map::read("...@.\n.....\n...@.\n@@@@.\n..@@.").unwrap();
        let is_narrow = |x: i32, y: i32| is_narrow(&map, Block::new(x, y));
        assert!(is_narrow(3, 1) && is_narrow(4, 1) && is_narrow(4, 3) && is_narrow(2, 1));
        assert!(!is_narrow(0, 0) && !is_narrow(1, 1) && !is_narrow(1, 2) && !is_narrow(4, 0) && !is_narrow(0, 4));
    }
}
