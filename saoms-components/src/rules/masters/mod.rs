//! Rule: masters of the environment do not divide the luggage among them.

mod ends;
mod forgets;

use std::collections::{BTreeMap, BTreeSet};

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::master::{FIRST, MasterEnvironment};
use crate::messages::{ENVIRONMENT, TERRITORY};
use crate::zone::Zone;

pub(super) use ends::RULE as ENDS;
pub(super) use forgets::RULE as FORGETS;

pub(crate) use ends::judge_end;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5010",
        name: "second-master",
        meaning: "Two masters of the environment, of one site or of several that share the topic, forward the same \
            events, so all luggage is requested and counted twice. Or masters that divide the luggage by zones leave \
            a zone out, or name one that the site does not have.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// A master that starts.
struct Master<'f> {
    index: usize,
    zone: Option<u32>,
    /// The name on the bus of the topic of zones: masters and zones that share it are of one site.
    zones: &'f str,
}

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    let mut before: BTreeMap<&str, Vec<Master<'_>>> = BTreeMap::new();
    let mut findings = Vec::new();
    // One that waits to be scheduled may take the place of another one.
    for (index, properties) in fleet.all::<MasterEnvironment>().filter(|(index, _)| components[*index].starts) {
        let component = &components[index];
        let master = Master { index, zone: properties.zone, zones: component.topic(TERRITORY.name()) };
        let before = before.entry(component.topic(ENVIRONMENT.name())).or_default();
        match before.iter().find(|other| !other.divides_with(&master)) {
            None => before.push(master),
            Some(other) => findings.push(second(fleet, other, &master)),
        }
    }
    if findings.is_empty() && !fleet.misses::<Zone>() && !fleet.misses::<MasterEnvironment>() {
        findings.extend(before.values().flat_map(|masters| left_out(fleet, masters)));
    }
    findings
}

impl Master<'_> {
    fn divides_with(&self, other: &Master<'_>) -> bool {
        self.zone.is_some() && other.zone.is_some() && self.zone != other.zone
    }
}

/// The finding about a master that has the luggage of another one.
fn second(fleet: &FleetView<'_>, other: &Master<'_>, master: &Master<'_>) -> Finding {
    let components = fleet.components();
    let message = format!(
        "`{}` forwards the same events as `{}`: all luggage is requested and counted twice",
        components[master.index].path, components[other.index].path
    );
    Finding::new(Place::component(master.index), message).label(Place::component(other.index), "the first master").help(
        "remove one of the two masters, or make each a site with its own environment, or give each its own `zone`",
    )
}

/// The findings about masters that name a zone that is not there, and about zones without a master.
fn left_out(fleet: &FleetView<'_>, masters: &[Master<'_>]) -> Vec<Finding> {
    let Some(first) = masters.first().filter(|master| master.zone.is_some()) else { return Vec::new() };
    let components = fleet.components();
    let of_site = fleet.all::<Zone>().filter(|(index, _)| components[*index].topic(TERRITORY.name()) == first.zones);
    let zones: Vec<(usize, u32)> = of_site.map(|(index, properties)| (index, properties.number)).collect();
    let served: BTreeSet<u32> = masters.iter().filter_map(|master| master.zone).collect();
    let mut findings = Vec::new();
    for master in masters {
        let Some(zone) = master.zone.filter(|zone| zones.iter().all(|(_, number)| number != zone)) else { continue };
        let message = format!("the site has no zone {zone}: this master assigns nothing");
        findings.push(
            Finding::new(Place::property("zone").in_component(master.index), message)
                .help("give the `number` of a zone of the site, or add that zone"),
        );
    }
    for (index, number) in zones.iter().filter(|(_, number)| !served.contains(number)) {
        let message = format!("luggage in zone {number} is for no master: the others have zones of their own");
        findings.push(
            Finding::new(Place::component(*index), message)
                .label(Place::component(first.index), "a master of another zone")
                .help(format!("add a master with `zone` {number}")),
        );
    }
    if !served.contains(&FIRST) && findings.is_empty() {
        let message = format!("no master has `zone` {FIRST}: nobody passes on landings, take-offs and faults");
        findings.push(
            Finding::new(Place::property("zone").in_component(first.index), message)
                .help(format!("give one of the zones, and its master, the number {FIRST}")),
        );
    }
    findings
}
