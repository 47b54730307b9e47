//! Rules: robots that agree among themselves on blocks may hear of each other too late.

use std::ops::Range;

use saoms_api::event::Word;
use saoms_api::event::fault::{FaultCall, FaultKind, is_named, names_component};
use saoms_api::extension::LineFault;
use saoms_api::rule::{Code, ComponentView, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::robots::robots;
use crate::environment::{Environment, EventSpec, Line, Scenario};
use crate::messages::{GRANT, POSITION};
use crate::zone::Zone;

/// The loop with which robots agree among themselves on blocks, unless their site has zones.
const PATH_FOLLOWER: &str = "saoms.PathFollowerMS";

const HELP: &str = "add a `saoms.Zone`, which grants each block to one robot at a time, however late messages are";

pub(super) static FAULTS: FleetRule = FleetRule {
    code: Code {
        id: "S5024",
        name: "positions-disturbed",
        meaning: "A scenario or `--faults` loses or delays messages about positions between robots of the policy `safe`, whose site \
            has no zone. They agree among themselves on who enters a block, and collide if they hear of each other too \
            late.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check: disturbed,
};

pub(super) static BROKER: FleetRule = FleetRule {
    code: Code {
        id: "S5025",
        name: "positions-over-network",
        meaning: "Robots of the policy `safe` send their positions through a message broker (`url`), and their site \
            has no zone. They collide if a message takes longer than the period of its sender.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check: over_network,
};

/// The robots of the policy `safe` that ask no zone.
fn peers(fleet: &FleetView<'_>) -> Vec<usize> {
    let components = fleet.components();
    let zones: Vec<&str> = fleet.indices::<Zone>().map(|zone| components[zone].topic(GRANT.name())).collect();
    let is_peer = |index: &usize| {
        let component = &components[*index];
        component.class.loops.contains(&PATH_FOLLOWER) && !zones.contains(&component.topic(GRANT.name()))
    };
    robots(fleet).iter().map(|robot| robot.index).filter(is_peer).collect()
}

fn disturbed(fleet: &FleetView<'_>) -> Vec<Finding> {
    let mut environments = fleet.all::<Environment>().peekable();
    if environments.peek().is_none() {
        return Vec::new();
    }
    let peers = peers(fleet);
    if peers.len() < 2 {
        return Vec::new();
    }
    let finding = |line: &Line, index: usize| {
        let (message, other) = disturbance(fleet, &peers, &line.event)?;
        let place = Place::property("scenario").part(line.text as usize, line.bytes.clone()).in_component(index);
        Some(Finding::new(place, message).label(Place::component(other), "the policy `safe` without a zone").help(HELP))
    };
    let found = environments.filter_map(|(index, properties)| {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        scenario.lines().iter().find_map(|line| finding(line, index))
    });
    found.collect()
}

/// Judges an event that does not stand in a scenario. Places are bytes of its text.
///
/// # Errors
/// It is a fault by which robots hear too late where others are.
pub(crate) fn judge_disturbance(
    fleet: &FleetView<'_>,
    event: &EventSpec,
    bytes: Range<usize>,
) -> Result<(), LineFault> {
    match disturbance(fleet, &peers(fleet), event) {
        Some((message, _)) => Err(LineFault::new(bytes, message).help(HELP).code(&FAULTS.code)),
        None => Ok(()),
    }
}

/// What a fault does to robots that agree among themselves on blocks, and the one that hears too late.
fn disturbance(fleet: &FleetView<'_>, peers: &[usize], event: &EventSpec) -> Option<(String, usize)> {
    let EventSpec::Raised(text) = event else { return None };
    let call = FaultCall::is_one(text).then(|| FaultCall::read(text).ok()).flatten()?;
    let (one, other) = pair(fleet, peers, &call)?;
    let paths = [one, other].map(|robot| fleet.components()[robot].path);
    Some((format!("`{}` may hear too late where `{}` is, and collide with it", paths[1], paths[0]), other))
}

/// The first two robots of which a fault keeps the second one from hearing in time where the first one is.
fn pair(fleet: &FleetView<'_>, peers: &[usize], call: &FaultCall) -> Option<(usize, usize)> {
    // A message that comes twice is no late one.
    if !call.kind.is_of_messages() || matches!(call.kind, FaultKind::Duplicate(_)) {
        return None;
    }
    let topic = |robot: usize| fleet.components()[robot].topic(POSITION.name());
    let is_disturbed = |robot: usize| call.topic.as_ref().is_none_or(|one| is_named(&one.text, topic(robot)));
    let is_one = |names: &[Word], robot: usize| {
        let ComponentView { path, node, .. } = &fleet.components()[robot];
        names.is_empty() || names.iter().any(|name| names_component(&name.text, path, node))
    };
    let of = |names: &[Word]| -> Vec<usize> {
        peers.iter().copied().filter(|robot| is_disturbed(*robot) && is_one(names, *robot)).collect()
    };
    let (senders, readers) = (of(&call.from), of(&call.to));
    senders.into_iter().find_map(|one| {
        let other = readers.iter().find(|other| **other != one && topic(**other) == topic(one));
        other.map(|other| (one, *other))
    })
}

fn over_network(fleet: &FleetView<'_>) -> Vec<Finding> {
    let peers = peers(fleet);
    let mut sending = peers.iter().filter(|robot| fleet.components()[**robot].has_broker);
    let Some(first) = sending.next() else { return Vec::new() };
    let others = match sending.count() {
        0 => String::new(),
        more => format!(" (this robot and {more} more)"),
    };
    let message =
        format!("a robot of the policy `safe` sends its position through a broker, and its site has no zone{others}");
    vec![Finding::new(Place::property("url").in_component(*first), message).help(HELP)]
}
