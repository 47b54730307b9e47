//! Rule: luggage starts or ends on a block that no robot can enter.

use std::collections::HashMap;

use saoms_api::extension::LineFault;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::event_block;
use crate::environment::{EventSpec, Spanned, Spot};
use crate::messages::AREA;
use crate::rules::budget::Budget;
use crate::rules::hearing::together;
use crate::rules::map::{LuggageLine, WorldMap, area, areas, by_events, rows};
use crate::rules::robots::unless_elsewhere;
use crate::world::World;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5001",
        name: "luggage-place",
        meaning: "A scenario has luggage, or a block to visit, where no robot can be: the block is outside the map, or blocked. Or an \
            event that another class takes is at a block outside the map, which is a warning.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let (said, misses) = (said(fleet), fleet.misses::<World>());
    let (mut findings, mut budget) = (Vec::new(), Budget::default());
    for (events, luggage) in by_events(fleet) {
        let area = area(fleet, events);
        // The same blocks at both ends are told once, and two blocks outside of the map.
        let ends = luggage.iter().flat_map(|piece| {
            let is_told = |to: &&Spanned<Spot>| {
                let both = [piece.from.value.block(), to.value.block()];
                let are_outside = area
                    .as_ref()
                    .is_some_and(|area| both.iter().all(|block| block.is_some_and(|block| !area.map.contains(block))));
                to.value == piece.from.value || are_outside
            };
            let to = Some(&piece.to).filter(|to| !is_told(to));
            std::iter::once((piece, &piece.from)).chain(to.map(|to| (piece, to)))
        });
        for (piece, spot) in ends {
            let is_drawn = spot.value == Spot::Anywhere && !misses;
            if is_drawn && !said.contains_key(fleet.components()[piece.index].topic(AREA.name())) {
                findings.extend(unless_elsewhere(fleet, vec![nothing_to_draw(fleet, piece, spot, &said)]));
            } else if let Some(area) = &area {
                findings.extend(check_spot(area, piece, spot, &mut budget));
            }
        }
    }
    findings.extend(event_block::check(fleet));
    findings
}

/// Judges an event that does not stand in a scenario. Places are bytes of its text.
///
/// # Errors
/// It is luggage where no robot can be.
pub(crate) fn judge_luggage(fleet: &FleetView<'_>, event: &EventSpec) -> Result<(), LineFault> {
    let EventSpec::Luggage { from, to } = event else { return Ok(()) };
    let mut areas = areas(fleet);
    let (Some(area), None) = (areas.next(), areas.next()) else { return Ok(()) };
    if fleet.misses::<World>() {
        return Ok(());
    }
    for spot in [from, to] {
        let problem = spot.value.block().and_then(|block| Some((block, area.problem(block)?)));
        if let Some((block, problem)) = problem {
            let fault =
                LineFault::new(spot.bytes.clone(), format!("luggage cannot be at {block}: this block is {problem}"));
            return Err(fault.help("choose a free block of the map: robots cannot enter other blocks"));
        }
    }
    Ok(())
}

/// The names on the bus on which areas are said, each with the first component that says one.
fn said<'f>(fleet: &FleetView<'f>) -> HashMap<&'f str, usize> {
    let mut said = HashMap::new();
    for (index, component) in fleet.components().iter().enumerate() {
        if component.class.publishes.contains(&AREA.name()) {
            said.entry(component.topic(AREA.name())).or_insert(index);
        }
    }
    said
}

fn nothing_to_draw(
    fleet: &FleetView<'_>,
    piece: &LuggageLine,
    spot: &Spanned<Spot>,
    said: &HashMap<&str, usize>,
) -> Finding {
    let heard = fleet.components()[piece.index].topic(AREA.name());
    let Some((name, index)) = said.iter().min_by_key(|(_, index)| **index) else {
        let message = "`random` needs an area to draw a block from, but no component of the fleet defines one";
        let help = "add a `saoms.World`, or write two corners such as `(1,0)..(10,10)`";
        return Finding::new(piece.place(spot), message).help(help);
    };
    let message =
        format!("`random` needs an area to draw a block from, but no component publishes one on the topic `{heard}`");
    Finding::new(piece.place(spot), message)
        .label(
            Place::topic(AREA.name()).in_component(*index),
            format!("this component publishes its area on the topic `{name}`"),
        )
        .help(together(AREA.name(), &fleet.components()[*index], ("the scenario", heard)))
}

fn check_spot(area: &WorldMap, piece: &LuggageLine, spot: &Spanned<Spot>, budget: &mut Budget) -> Option<Finding> {
    let place = piece.place(spot);
    if let Some(block) = spot.value.block() {
        let problem = area.problem(block)?;
        let what = if piece.is_visit { "no robot can visit" } else { "luggage cannot be at" };
        let message = format!("{what} {block}: this block is {problem}");
        let to = piece.to.value.block().filter(|to| spot.value == piece.from.value && *to != block);
        let finding = match to.filter(|to| !area.map.contains(block) && !area.map.contains(*to)) {
            Some(to) => {
                let message = format!("{what} {block} and {to}: these blocks are {problem}");
                Finding::new(piece.whole(), message)
            }
            None => Finding::new(place, message),
        };
        return Some(
            area.explain(finding.help("choose a free block of the map: robots cannot enter other blocks"), block),
        );
    }
    let (first, last) = spot.value.corners(Some(&area.map))?;
    let (mut rows, columns) = rows(first, last, &area.map);
    // Mostly the first row already has a free block.
    let is_free = rows.any(|row| {
        !budget.admit(1 + columns.len() / 64) || area.map.free_ranges(row, columns.clone()).next().is_some()
    });
    if !is_free {
        let what = if piece.is_visit { "no robot can visit a block" } else { "luggage cannot be" };
        let message = format!("{what} from {first} to {last}: these blocks are all blocked");
        return Some(Finding::new(place, message).help("choose corners with a free block between them"));
    }
    let (x, y) = (area.map.width() - 1, area.map.height() - 1);
    let beyond = !area.map.contains(last);
    beyond.then(|| {
        let message = format!("the blocks from {first} to {last} are partly outside the map, which ends at ({x},{y})");
        Finding::new(place, message)
            .severity(Severity::Warning)
            .help("choose corners on the map: a run draws blocks of the map only")
    })
}
