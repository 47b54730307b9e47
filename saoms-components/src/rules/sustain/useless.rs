//! Robots whose batteries last for no luggage at all.

use saoms_api::rule::{FleetView, Severity};
use saoms_api::{Finding, Place};

use super::Range;
use crate::environment::Spot;
use crate::grid::Block;
use crate::rules::budget::Budget;
use crate::rules::map::{LuggageLine, WorldMap};
use crate::rules::robots::FleetRobot;

/// Findings about robots that can bring no piece of the luggage, where others can bring all of it. Ways around blocked
/// blocks are longer than what is counted here, so each of them is certain.
pub(super) fn useless(
    fleet: &FleetView<'_>,
    area: &WorldMap,
    (robots, ranges): (&[&FleetRobot], &[Range]),
    luggage: &[LuggageLine],
) -> Vec<Finding> {
    let (mut findings, mut budget) = (Vec::new(), Budget::default());
    let mut ways = Vec::with_capacity(luggage.len());
    for piece in luggage {
        let [Some(from), Some(to)] = [&piece.from, &piece.to].map(|spot| corners(area, spot.value)) else {
            return findings;
        };
        ways.push((from, to));
    }
    for (robot, range) in robots.iter().zip(ranges).filter(|(_, range)| range.full < u32::MAX) {
        if ways.is_empty() || !budget.admit(ways.len()) {
            return findings;
        }
        let most = range.most();
        let least = |corners: &Corners| distance(range.charger, *corners);
        let needs = ways.iter().map(|(from, to)| least(from).max(least(to))).min().unwrap_or(0);
        if needs > most {
            findings.extend(finding(fleet, robot, needs, most));
        }
    }
    findings
}

/// The finding at the value that drains the battery, as far as the composite gives one.
fn finding(fleet: &FleetView<'_>, robot: &FleetRobot, needs: u32, most: u32) -> Option<Finding> {
    let values = fleet.components()[robot.index].values;
    let causes = ["discharge", "dischargePerBlock", "dischargePerSecond"];
    let given = causes.into_iter().find(|name| values.iter().any(|(given, _)| given == name))?;
    let message = format!(
        "robot {} can bring no luggage of this scenario: it is at least {needs} moves from its charger; a full battery \
         allows {most}, there and back",
        robot.number
    );
    let finding = Finding::new(Place::property(given).in_component(robot.index), message);
    let help = format!("reduce `{given}` of this robot, or put its charger closer to the luggage");
    Some(finding.severity(Severity::Warning).help(help))
}

type Corners = (Block, Block);

/// The corners of the blocks that a spot may be.
fn corners(area: &WorldMap, spot: Spot) -> Option<Corners> {
    spot.corners(Some(&area.map))
}

/// The number of moves to the nearest block between two corners on an open map.
fn distance(from: Block, (first, last): Corners) -> u32 {
    let side = |at: i32, first: i32, last: i32| at.clamp(first, last.max(first)).abs_diff(at);
    side(from.x, first.x, last.x) + side(from.y, first.y, last.y)
}
