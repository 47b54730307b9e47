//! Rule: robots and a master wait for events, and nothing in the fleet brings any.

use std::collections::HashSet;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::Environment;
use crate::master::MasterEnvironment;
use crate::messages::{ENVIRONMENT, EVENT_LUGGAGE};
use crate::robot::Robot;
use crate::rules::hearing::site_of;
use crate::rules::robots::{has_broker, publishers_beside_robots};

pub(crate) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5018",
        name: "no-work",
        meaning: "A fleet, or a site of it, has robots and a master of the environment, but no scenario: the robots \
            never get work, unless events come from outside (`saoms run --events`).",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

/// Help where events may come from outside.
const OUTSIDE: &str = "ignore this if the events come from outside: `saoms run --events FILE`";

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    let Some(master) = fleet.indices::<MasterEnvironment>().next() else { return Vec::new() };
    if fleet.indices::<Robot>().next().is_none() || has_broker(fleet) || brings_other(fleet) {
        return Vec::new();
    }
    let mut environments = fleet.indices::<Environment>();
    let environment = environments.next();
    // One that nobody starts is reported by another rule.
    if environment.is_some_and(|index| !components[index].starts) {
        return Vec::new();
    }
    let is_given = |index: usize| components[index].values.iter().any(|(given, _)| given == "scenario");
    // An empty scenario is reported by another rule.
    if environment.into_iter().chain(environments).any(is_given) {
        return Vec::new();
    }
    let site = site_of(ENVIRONMENT.name(), components[master].topic(ENVIRONMENT.name())).unwrap_or("");
    let to_site = if site.is_empty() { String::new() } else { format!(" to the site `{site}`") };
    let finding = match environment {
        Some(index) => {
            Finding::new(Place::component(index), "this environment has no scenario, so the robots never get work")
                .help(
                    "add `<property name=\"scenario\">at 6s luggage (3,1) to (3,10)</property>` with the events to it",
                )
        }
        None => Finding::new(
            Place::component(master),
            "no component sends events to this master, so the robots never get work",
        )
        .help(format!("add a `saoms.Environment` with a `scenario`{to_site}")),
    };
    vec![finding.help(OUTSIDE)]
}

/// True if a component of another class may bring work: events, or luggage.
fn brings_other(fleet: &FleetView<'_>) -> bool {
    let known: HashSet<usize> = fleet.indices::<Environment>().chain(fleet.indices::<MasterEnvironment>()).collect();
    let brings = |topic| publishers_beside_robots(fleet, topic).any(|index| !known.contains(&index));
    brings(ENVIRONMENT.name()) || brings(EVENT_LUGGAGE.name())
}
