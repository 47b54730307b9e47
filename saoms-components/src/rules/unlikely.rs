//! Rule: a value is so unlikely that it has probably a wrong unit.

use std::time::Duration;

use saoms_api::host::format_duration;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::robots::{FleetRobot, robots};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5020",
        name: "unlikely-value",
        meaning: "A value has probably a wrong unit: a component has a period of more than a minute, or a robot starts with a \
            battery of 1 % or less.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// Period beyond which a component of this crate hinders the others: it handles messages once in a period.
const LONG: Duration = Duration::from_secs(60);

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let mut findings = long_periods(fleet);
    findings.extend(fractions(fleet));
    findings
}

/// Findings about long periods; the class of a plugin may have reasons for one.
fn long_periods(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components().iter().enumerate();
    let shipped = components.filter(|(_, one)| one.class.name.starts_with("saoms."));
    let long = shipped.filter_map(|(index, one)| Some((index, one.path, one.period.filter(|period| *period > LONG)?)));
    let finding = |(index, path, period): (usize, &str, Duration)| {
        let period = format_duration(period);
        let message = format!("the period of `{path}` is {period}: it reacts up to {period} late");
        Finding::new(Place::property("period").in_component(index), message)
            .help("write a shorter time with its unit, such as `500ms`: a number without a unit is in milliseconds")
    };
    long.map(finding).collect()
}

/// Findings about batteries that are probably given as a fraction.
fn fractions(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let fractions = robots.iter().filter(|robot| robot.properties.battery > 0.0 && robot.properties.battery <= 1.0);
    let finding = |robot: &FleetRobot| {
        let level = robot.properties.battery;
        let path = fleet.components()[robot.index].path;
        let message = format!("`{path}` starts with a battery of {level} %, which is nearly empty");
        Finding::new(Place::property("battery").in_component(robot.index), message)
            .help(format!("write the level in percent: `{0}` for {0} %", level * 100.0))
    };
    fractions.map(finding).collect()
}
