//! Events of other classes with a block outside the map. What such a block means, the class alone knows.

use std::collections::HashMap;

use saoms_api::event::{Event, EventCall, EventField, FieldValue, Word};
use saoms_api::host::declaration::Scalar;
use saoms_api::rule::{FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, Scenario};
use crate::grid::Block;
use crate::rules::hearing::events;
use crate::rules::map::{WorldMap, area};

/// The name of a struct that is a block; a plugin may have one of its own.
const BLOCK: &str = "Block";

pub(super) fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let taken = fleet.components().iter().flat_map(|one| &one.class.takes);
    let taken: HashMap<&str, &Event> =
        // Where chargers are, another rule tells.
        taken.filter(|one| one.name != "outage" || !one.classes.iter().any(|class| class == "saoms.World"))
        .filter(|one| one.fields.iter().any(is_block)).map(|one| (one.name.as_str(), one)).collect();
    if taken.is_empty() {
        return Vec::new();
    }
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let Some(area) = area(fleet, events(fleet, index)) else { continue };
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        for line in scenario.lines() {
            let EventSpec::Raised(text) = &line.event else { continue };
            let Ok(call) = EventCall::read(text) else { continue };
            let Some(event) = taken.get(call.name.text.as_str()) else { continue };
            let outside = blocks(event, &call).into_iter().filter(|(block, _)| !area.map.contains(*block));
            findings.extend(outside.map(|(block, word)| {
                let bytes = line.bytes.start + word.bytes.start..line.bytes.start + word.bytes.end;
                finding(
                    &area,
                    &event.name,
                    block,
                    Place::property("scenario").part(line.text as usize, bytes).in_component(index),
                )
            }));
        }
    }
    findings
}

fn finding(area: &WorldMap, event: &str, block: Block, place: Place) -> Finding {
    let problem = area.problem(block).unwrap_or_default();
    let finding = Finding::new(place, format!("the event `{event}` is at {block}: this block is {problem}"));
    area.explain(finding.severity(Severity::Warning).help("choose a block of the map"), block)
}

fn is_block(field: &EventField) -> bool {
    // ROS 2 and others write the package before the name of a struct.
    field.message.rsplit(['/', '.', ':']).next() == Some(BLOCK)
}

/// The blocks of an event, each with its text; of a range, both ends.
fn blocks(event: &Event, call: &EventCall) -> Vec<(Block, Word)> {
    let given = |field: &EventField| call.arguments.iter().find(|one| one.name.text == field.name);
    let fields = event.fields.iter().filter(|field| is_block(field));
    let words = fields
        .filter_map(|field| Some((field, given(field)?)))
        .flat_map(|(field, argument)| argument.ends().into_iter().map(move |word| (field, word)));
    let mut all = Vec::new();
    for (field, word) in words {
        // A wrong value is told by the language.
        let Ok(value) = field.of.read(&word.text) else { continue };
        all.extend(blocks_in(&value).into_iter().map(|block| (block, word.clone())));
    }
    all
}

fn blocks_in(value: &FieldValue) -> Vec<Block> {
    let number = |value: &FieldValue| match value {
        FieldValue::Scalar(Scalar::Integer(number)) => i32::try_from(number.get()).ok(),
        _ => None,
    };
    match value {
        FieldValue::List(all) => all.iter().flat_map(blocks_in).collect(),
        FieldValue::Group(fields) => match &fields[..] {
            [(_, x), (_, y)] => number(x).zip(number(y)).map(|(x, y)| Block::new(x, y)).into_iter().collect(),
            _ => Vec::new(),
        },
        FieldValue::Scalar(_) | FieldValue::None => Vec::new(),
    }
}
