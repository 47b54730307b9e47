//! Rule: the robots of two worlds hear of the same luggage.

use std::collections::{BTreeSet, HashMap, HashSet};

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::messages::ENVIRONMENT;
use crate::rules::map::luggage;
use crate::rules::robots::{by_world, robots};
use crate::world::World;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5016",
        name: "worlds-mixed",
        meaning: "Two worlds with robots, of one site or of several that share the topic, share one environment: each \
            world waits for all luggage, but robots deliver some of it in the other world.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    let topic = |index: usize| components[index].topic(ENVIRONMENT.name());
    let robots = robots(fleet);
    // What stands between robots and their world, such as a drive, hears of no luggage.
    let all: HashSet<usize> = fleet.indices::<World>().collect();
    let worlds: BTreeSet<usize> =
        by_world(&robots).into_iter().map(|(world, _)| world).filter(|world| all.contains(world)).collect();
    if worlds.len() < 2 {
        return Vec::new();
    }
    // The environment with luggage, and where it is; two of one topic are reported by another rule.
    let mut environments: HashMap<&str, (usize, Option<Place>)> = HashMap::new();
    for line in luggage(fleet) {
        let (index, place) = environments.entry(topic(line.index)).or_insert_with(|| (line.index, Some(line.whole())));
        if *index != line.index {
            *place = None;
        }
    }
    let mut first: HashMap<&str, usize> = HashMap::new();
    let mut findings = Vec::new();
    for world in worlds {
        let events = topic(world);
        let Some((_, Some(line))) = environments.get(events) else { continue };
        let Some(&other) = first.get(events) else {
            first.insert(events, world);
            continue;
        };
        let message = format!(
            "`{}` and `{}` both wait for all luggage of one environment, but luggage that is delivered in one world \
            never arrives in the other",
            components[other].path, components[world].path
        );
        findings.push(
            Finding::new(Place::component(world), message)
                .label(Place::component(other), "the first world")
                .label(line.clone(), "both worlds wait for this luggage")
                .help(
                    "wire all robots to one world, or make each world a site (`saoms:site`) with its own \
                    environment, master and robots",
                ),
        );
    }
    findings
}
