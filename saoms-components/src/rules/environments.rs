//! Rule: two environments give their luggage the same numbers.

use std::collections::HashMap;

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::map::{LuggageLine, luggage};
use crate::messages::ENVIRONMENT;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5011",
        name: "luggage-number",
        meaning: "Two environments have luggage: both number it from 1 on, and of two pieces with one number only the \
            first is brought.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    let luggage = luggage(fleet);
    let mut first: HashMap<&str, &LuggageLine> = HashMap::new();
    let mut findings = Vec::new();
    for lines in luggage.chunk_by(|one, other| one.index == other.index) {
        let Some(line) = lines.first() else { continue };
        let events = components[line.index].topic(ENVIRONMENT.name());
        let Some(other) = first.get(events) else {
            first.insert(events, line);
            continue;
        };
        let message = format!(
            "`{}` and `{}` both number their luggage from 1 on: of two pieces with one number only the first is \
             brought",
            components[other.index].path, components[line.index].path
        );
        findings.push(
            Finding::new(line.whole(), message)
                .label(other.whole(), "luggage of the other one")
                .help("let one environment have all luggage: its `scenario` can have many values"),
        );
    }
    findings
}
