//! Maps whose parts are not connected.

use saoms_api::{Code, Finding, FleetRule, FleetView, Severity};

use super::map::{Area, Luggage, area, luggage};
use super::robots::{Known, may_be_others, robots};
use crate::environment::{Spot, Written, blocks};
use crate::grid::{Block, Map};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5007",
        name: "map-divided",
        meaning: "No way on the map connects a charger, where luggage is, and where it has to go.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let (Some(area), robots) = (area(fleet), robots(fleet)) else { return Vec::new() };
    let robots: Vec<&Known> = robots.iter().filter(|robot| robot.world == Some(area.index)).collect();
    if area.map.is_open() || robots.is_empty() || may_be_others(fleet) {
        return Vec::new();
    }
    let parts = Parts::of(&area.map);
    // A charger where no robot can be is reported: nobody knows which part it is meant to be in.
    if robots.iter().any(|robot| parts.part(robot.charger).is_none()) {
        return Vec::new();
    }
    let chargers: Vec<u32> = robots.iter().filter_map(|robot| parts.part(robot.charger)).collect();
    luggage(fleet).iter().flat_map(|piece| judge(&area, &parts, &chargers, piece)).collect()
}

fn judge(area: &Area, parts: &Parts<'_>, chargers: &[u32], piece: &Luggage) -> Vec<Finding> {
    let mut findings: Vec<Finding> = [&piece.from, &piece.to]
        .into_iter()
        .filter_map(|spot| cut_off(area, parts, chargers, piece, spot))
        .collect();
    let ends = [&piece.from, &piece.to].map(|spot| spot.value.block().and_then(|block| parts.part(block)));
    if let [Some(from), Some(to)] = ends
        && from != to
        && findings.is_empty()
    {
        let message = "no way on the map leads from where the luggage is to where it has to go";
        findings.push(
            Finding::new(piece.place(&piece.to), message)
                .label(piece.place(&piece.from), "from here")
                .help("both have to be in one part of the map, with a charger in it"),
        );
    }
    findings
}

/// What is wrong with a spot that no robot can reach from its charger.
fn cut_off(
    area: &Area,
    parts: &Parts<'_>,
    chargers: &[u32],
    piece: &Luggage,
    spot: &Written<Spot>,
) -> Option<Finding> {
    const HELP: &str = "open a way through the blocked blocks, or put a robot with its charger there";
    let is_cut = |block: &Block| parts.part(*block).is_some_and(|part| !chargers.contains(&part));
    if let Some(block) = spot.value.block() {
        let message = format!("no way on the map leads to {block} from the charger of any robot");
        return is_cut(&block).then(|| Finding::new(piece.place(spot), message).help(HELP));
    }
    let (first, last) = spot.value.corners(Some(&area.map))?;
    let free = || blocks(first, last, Some(&area.map)).filter(|block| area.map.is_free(*block));
    let (cut, all) = (free().filter(is_cut).count(), free().count());
    let message = format!(
        "no way on the map leads to {cut} of the {all} free blocks here from the charger of any robot"
    );
    let severity = if cut == all { Severity::Error } else { Severity::Warning };
    (cut > 0).then(|| Finding::new(piece.place(spot), message).severity(severity).help(HELP))
}

/// The parts of a map between which no way leads.
struct Parts<'m> {
    map: &'m Map,
    /// The part of each block, from 1; 0 where it is blocked.
    parts: Vec<u32>,
}

impl<'m> Parts<'m> {
    fn of(map: &'m Map) -> Parts<'m> {
        let (mut parts, mut count, mut open) = (vec![0; map.size()], 0, Vec::new());
        for start in 0..map.size() {
            if parts[start] != 0 || !map.is_free(map.block(start)) {
                continue;
            }
            count += 1;
            parts[start] = count;
            open.push(map.block(start));
            while let Some(block) = open.pop() {
                for beside in block.neighbours().into_iter().filter(|beside| map.is_free(*beside)) {
                    if let Some(place) = map.place(beside).filter(|place| parts[*place] == 0) {
                        parts[place] = count;
                        open.push(beside);
                    }
                }
            }
        }
        Parts { map, parts }
    }

    fn part(&self, block: Block) -> Option<u32> {
        self.map.place(block).map(|place| self.parts[place]).filter(|part| *part != 0)
    }
}
