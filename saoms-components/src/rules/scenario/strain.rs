//! Faults of robots and chargers in scenarios, as other rules read them; and a rule: an outage where no charger is.

use saoms_api::event::{Argument, EventCall};
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, RandomRange, Scenario};
use crate::grid::Block;
use crate::messages::ROBOT_LIST;
use crate::rules::robots::{are_all_known, has_broker, may_be_others, robots};
use crate::world::World;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5026",
        name: "unknown-charger",
        meaning: "A scenario has an outage of a charger on a block where no robot of the fleet has its charger.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

/// The event of a charger that gives nothing.
const OUTAGE: &str = "outage";
/// Greatest number of chargers that a message lists.
const LISTED: usize = 8;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    if !takes(fleet, OUTAGE) || !are_all_known(fleet) || may_be_others(fleet) || has_broker(fleet) {
        return Vec::new();
    }
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        let site = fleet.components()[index].topic(ROBOT_LIST.name());
        let chargers = || {
            let of_site = |index: usize| fleet.components()[index].topic(ROBOT_LIST.name()) == site;
            let mut all: Vec<Block> =
                robots(fleet).iter().filter(|robot| of_site(robot.index)).map(|robot| robot.charger).collect();
            all.sort_unstable_by_key(|block| (block.x, block.y));
            all.dedup();
            all
        };
        for line in scenario.lines() {
            let Some((call, start)) = call(&line.event, &[OUTAGE]).zip(Some(line.bytes.start)) else { continue };
            let Some(field) = call.arguments.iter().find(|one| one.name.text == "charger") else { continue };
            let blocks: Vec<Block> =
                field.ends().iter().filter_map(|end| end.text.replace(' ', "").parse().ok()).collect();
            let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else { continue };
            let chargers = chargers();
            let within = |block: &Block| {
                let is_between = |at: i32, one: i32, other: i32| (one.min(other)..=one.max(other)).contains(&at);
                is_between(block.x, first.x, last.x) && is_between(block.y, first.y, last.y)
            };
            if chargers.iter().any(within) {
                continue;
            }
            let bytes = start + field.value.bytes.start..start + field.value.bytes.end;
            let place = Place::property("scenario").part(line.text as usize, bytes).in_component(index);
            let message = format!("no robot has its charger at {}", field.value.text);
            findings.push(Finding::new(place, message).help(listed(&chargers)));
        }
    }
    findings
}

fn listed(chargers: &[Block]) -> String {
    let all: Vec<String> = chargers.iter().take(LISTED).map(|block| format!("`{block}`")).collect();
    match all.as_slice() {
        [] => "add the robot to the composite, or remove the event".to_owned(),
        [one] => format!("the only charger is at {one}"),
        all if chargers.len() > LISTED => {
            format!("there are {} chargers, such as at {}", chargers.len(), all.join(", "))
        }
        all => format!("the chargers are at {}", all.join(", ")),
    }
}

/// True if a world of the fleet takes an event of this name; another class may have one, too.
fn takes(fleet: &FleetView<'_>, name: &str) -> bool {
    fleet
        .indices::<World>()
        .next()
        .is_some_and(|index| fleet.components()[index].class.takes.iter().any(|event| event.name == name))
}

/// The event of a line, if it is one of these.
fn call(event: &EventSpec, names: &[&str]) -> Option<EventCall> {
    let EventSpec::Raised(text) = event else { return None };
    EventCall::read(text).ok().filter(|call| names.contains(&call.name.text.as_str()))
}

/// The robots that a line makes slow, or whose batteries it drains, with the argument that says so.
pub(super) fn robots_of(fleet: &FleetView<'_>, event: &EventSpec) -> Option<(RandomRange<u32>, Argument)> {
    let call = call(event, &["slow", "drain"])?;
    let field = call.arguments.into_iter().find(|one| one.name.text == "robot")?;
    let ends: Vec<u32> = field.ends().iter().filter_map(|end| end.text.parse().ok()).collect();
    let (least, most) = (*ends.first()?, *ends.last()?);
    takes(fleet, &call.name.text).then_some((RandomRange { least, most }, field))
}
