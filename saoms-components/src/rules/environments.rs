//! Rule: two environments give their luggage the same numbers.

use std::collections::{BTreeSet, HashMap};

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::hearing::{events, hearing};
use super::map::{LuggageLine, luggage};
use crate::messages::EVENT_LUGGAGE;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5011",
        name: "luggage-number",
        meaning: "Two environments, of one site or of several that share a topic, have luggage, and both number it from \
            1: of two pieces with the same number, only the first is delivered.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let (components, hearing) = (fleet.components(), hearing(fleet));
    // The first environment with luggage of each name of a topic on which its events, or its luggage, are told.
    let mut first: HashMap<&str, LuggageLine> = HashMap::new();
    let mut passed: HashMap<&str, BTreeSet<&str>> = HashMap::new();
    let mut findings = Vec::new();
    let mut all = luggage(fleet);
    all.dedup_by_key(|line| line.index);
    for line in all {
        let events = events(fleet, line.index);
        // Where nobody passes events on, no luggage is brought at all, which another rule reports.
        if !hearing.passes_on(events) {
            continue;
        }
        let names = passed.entry(events).or_insert_with(|| {
            let masters = hearing.masters(events).iter();
            masters.map(|master| components[*master].topic(EVENT_LUGGAGE.name())).chain([events]).collect()
        });
        let Some(other) = names.iter().find_map(|name| first.get(name)) else {
            first.extend(names.iter().map(|name| (*name, line.clone())));
            continue;
        };
        let message = format!(
            "`{}` and `{}` both number their luggage from 1: of two pieces with the same number, only the first is \
            delivered",
            components[other.index].path, components[line.index].path
        );
        findings.push(
            Finding::new(line.whole(), message).label(other.whole(), "luggage of the other environment").help(
                "move all luggage to one environment: its `scenario` can have several values; or make each a site with \
                its own master",
            ),
        );
    }
    findings
}
