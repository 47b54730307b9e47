//! Faults of robots and chargers in scenarios, as other rules read them; and a rule: an outage where no charger is.

use saoms_api::event::{Argument, EventCall};
use saoms_api::extension::LineFault;
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
    if !is_certain(fleet) {
        return Vec::new();
    }
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        let chargers = || chargers(fleet, fleet.components()[index].topic(ROBOT_LIST.name()));
        for line in scenario.lines() {
            let Some((call, start)) = call(&line.event, &[OUTAGE]).zip(Some(line.bytes.start)) else { continue };
            let Some(LineFault { bytes, message, help, .. }) = misplaced(&call, chargers) else { continue };
            let bytes = start + bytes.start..start + bytes.end;
            let place = Place::property("scenario").part(line.text as usize, bytes).in_component(index);
            findings.push(Finding::new(place, message).help(help.unwrap_or_default()));
        }
    }
    findings
}

/// Judges an event that does not stand in a scenario. Places are bytes of the event.
///
/// # Errors
/// It is an outage where no robot of the fleet has its charger.
pub(crate) fn judge_outage(fleet: &FleetView<'_>, event: &EventSpec) -> Result<(), LineFault> {
    let Some(call) = call(event, &[OUTAGE]).filter(|_| is_certain(fleet)) else { return Ok(()) };
    let chargers = || {
        let mut all: Vec<Block> = robots(fleet).iter().map(|robot| robot.charger).collect();
        in_order(&mut all);
        all
    };
    misplaced(&call, chargers).map_or(Ok(()), Err)
}

/// True if all chargers are known.
fn is_certain(fleet: &FleetView<'_>) -> bool {
    takes(fleet, OUTAGE) && are_all_known(fleet) && !may_be_others(fleet) && !has_broker(fleet)
}

/// The chargers of the robots whose list has this name.
fn chargers(fleet: &FleetView<'_>, list: &str) -> Vec<Block> {
    let of_site = |index: usize| fleet.components()[index].topic(ROBOT_LIST.name()) == list;
    let mut all: Vec<Block> =
        robots(fleet).iter().filter(|robot| of_site(robot.index)).map(|robot| robot.charger).collect();
    in_order(&mut all);
    all
}

fn in_order(chargers: &mut Vec<Block>) {
    chargers.sort_unstable_by_key(|block| (block.x, block.y));
    chargers.dedup();
}

/// What is wrong with an outage that has none of the chargers within its block or range.
fn misplaced(call: &EventCall, chargers: impl Fn() -> Vec<Block>) -> Option<LineFault> {
    let field = call.arguments.iter().find(|one| one.name.text == "charger")?;
    let blocks: Vec<Block> = field.ends().iter().filter_map(|end| end.text.replace(' ', "").parse().ok()).collect();
    let (first, last) = (blocks.first()?, blocks.last()?);
    let within = |block: &Block| {
        let is_between = |at: i32, one: i32, other: i32| (one.min(other)..=one.max(other)).contains(&at);
        is_between(block.x, first.x, last.x) && is_between(block.y, first.y, last.y)
    };
    let chargers = chargers();
    if chargers.iter().any(within) {
        return None;
    }
    let message = format!("no robot has its charger at {}", field.value.text);
    Some(LineFault::new(field.value.bytes.clone(), message).help(listed(&chargers)))
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
