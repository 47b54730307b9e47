//! Rule: robots of several programs need a zone.

use std::collections::HashMap;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::messages::GRANT;
use crate::rules::robots::robots;
use crate::zone::Zone;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5030",
        name: "robots-on-nodes",
        meaning: "Robots of one site run in different nodes, and the site has no zone: what they know of each other's \
            positions is late by the time that messages take, so that they may collide.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: true,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    if fleet.misses::<Zone>() {
        return Vec::new();
    }
    let components = fleet.components();
    let grants = |index: usize| components[index].topic(GRANT.name());
    let zoned: Vec<&str> = fleet.indices::<Zone>().map(grants).collect();
    // The first robot of each site; of a site one robot is told.
    let mut first: HashMap<&str, Option<usize>> = HashMap::new();
    let mut findings = Vec::new();
    for robot in robots(fleet).iter().filter(|robot| !zoned.contains(&grants(robot.index))) {
        let known = first.entry(grants(robot.index)).or_insert(Some(robot.index));
        let is_apart = |other: &usize| components[*other].node != components[robot.index].node;
        let Some(other) = known.filter(is_apart) else { continue };
        *known = None;
        let (own, others) = (&components[robot.index], &components[other]);
        let message = format!(
            "robots `{}` of node `{}` and `{}` of node `{}` share their blocks without a zone, and may collide: what \
             they know of each other is late",
            own.path, own.node, others.path, others.node
        );
        findings.push(
            Finding::new(Place::component(robot.index), message)
                .label(Place::component(other), "the robot of the other node")
                .help("add a `saoms.Zone` to the site, in any node, or put all of its robots into one node"),
        );
    }
    findings
}
