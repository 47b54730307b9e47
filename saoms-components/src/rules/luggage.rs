//! Rule: luggage starts or ends on a block that no robot can enter.

use saoms_api::Finding;
use saoms_api::rule::{Code, ComponentView, FleetRule, FleetView, Severity};

use super::budget::Budget;
use super::map::{LuggageLine, WorldMap, area, luggage, rows};
use super::robots::unless_elsewhere;
use crate::environment::{Spanned, Spot};
use crate::messages::AREA;
use crate::world::World;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5001",
        name: "luggage-place",
        meaning: "A scenario has luggage at a block where no robot can be: outside the map, or blocked.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let area = area(fleet);
    let says = |component: &ComponentView<'_>| component.class.publishes.contains(&AREA.name());
    let is_said = fleet.misses::<World>() || fleet.components().iter().any(says);
    let (mut findings, mut budget) = (Vec::new(), Budget::default());
    for piece in luggage(fleet) {
        for spot in [&piece.from, &piece.to] {
            match &area {
                Some(area) => findings.extend(check_spot(area, &piece, spot, &mut budget)),
                None if spot.value == Spot::Anywhere && !is_said => {
                    let message = "`random` needs an area to draw from, and nothing in the fleet says one";
                    let help = "add a `saoms.World`, or write two corners such as `(1,0)..(10,10)`";
                    let finding = Finding::new(piece.place(spot), message).help(help);
                    findings.extend(unless_elsewhere(fleet, vec![finding]));
                }
                None => {}
            }
        }
    }
    findings
}

fn check_spot(area: &WorldMap, piece: &LuggageLine, spot: &Spanned<Spot>, budget: &mut Budget) -> Option<Finding> {
    let place = piece.place(spot);
    if let Some(block) = spot.value.block() {
        let problem = area.problem(block)?;
        let finding = Finding::new(place, format!("luggage cannot be at {block}: it is {problem}"));
        return Some(area.explain(finding.help("robots collect and deposit luggage on free blocks"), block));
    }
    let (first, last) = spot.value.corners(Some(&area.map))?;
    let (mut rows, columns) = rows(first, last, &area.map);
    // Mostly the first row already has a free block.
    let is_free = rows.any(|row| {
        !budget.admit(1 + columns.len() / 64) || area.map.free_ranges(row, columns.clone()).next().is_some()
    });
    if !is_free {
        let message = format!("there is no free block from {first} to {last}, so no luggage can be there");
        return Some(Finding::new(place, message).help("choose blocks of the map that are not blocked"));
    }
    let (x, y) = (area.map.width() - 1, area.map.height() - 1);
    let beyond = !area.map.contains(last);
    beyond.then(|| {
        let message = format!("the blocks from {first} to {last} reach beyond the map, which ends at ({x},{y})");
        Finding::new(place, message).severity(Severity::Warning).help("only blocks of the map are drawn")
    })
}
