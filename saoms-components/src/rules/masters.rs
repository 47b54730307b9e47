//! Rule: two masters of the environment pass on the same events.

use std::collections::HashMap;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::master::MasterEnvironment;
use crate::messages::ENVIRONMENT;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5010",
        name: "second-master",
        meaning: "Two masters of the environment, of one site or of several that share the topic, forward the same \
            events, so all luggage is requested and counted twice.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    let mut first: HashMap<&str, usize> = HashMap::new();
    let mut findings = Vec::new();
    // One that waits to be scheduled may take the place of another one.
    for index in fleet.indices::<MasterEnvironment>().filter(|index| components[*index].starts) {
        let events = components[index].topic(ENVIRONMENT.name());
        let Some(&other) = first.get(events) else {
            first.insert(events, index);
            continue;
        };
        let message = format!(
            "`{}` forwards the same events as `{}`: all luggage is requested and counted twice",
            components[index].path, components[other].path
        );
        findings.push(
            Finding::new(Place::component(index), message)
                .label(Place::component(other), "the first master")
                .help("remove one of the two masters, or make each a site with its own environment"),
        );
    }
    findings
}
