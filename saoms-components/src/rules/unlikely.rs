//! Rule: a value is so unlikely that it has probably a wrong unit.

use std::time::Duration;

use saoms_api::host::declaration::Scalar;
use saoms_api::host::{PropertyValue, format_duration};
use saoms_api::rule::{Code, ComponentView, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::robots::{FleetRobot, robots};
use crate::environment::{Environment, bare_times};
use crate::text::bytes;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5020",
        name: "unlikely-value",
        meaning: "A value probably has the wrong unit: a component has a period of more than a minute or a time of less than a \
            millisecond, a scenario a time of less than 100 without a unit, or a robot starts with a battery of 1 % or less.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// Period beyond which a component of this crate hinders the others: it handles messages once in a period.
pub(super) const LONG: Duration = Duration::from_secs(60);

/// Time below which nothing of this crate takes a time.
pub(super) const SHORT: Duration = Duration::from_millis(1);

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let mut findings = long_periods(fleet);
    findings.extend(short_times(fleet));
    findings.extend(fractions(fleet));
    findings.extend(scenario_times(fleet));
    findings
}

/// Findings about times of scenarios that are probably given in seconds: one for each text.
fn scenario_times(fleet: &FleetView<'_>) -> Vec<Finding> {
    let texts = fleet.all::<Environment>().flat_map(|(index, properties)| {
        let texts = properties.scenario.into_iter().enumerate();
        texts.map(move |(place, text)| (index, place, text))
    });
    let finding = |(index, place, text): (usize, usize, String)| {
        let mut times = bare_times(&text);
        let first = times.next()?;
        let also = match times.count() {
            0 => String::new(),
            more => format!(" (and so are {more} more here)"),
        };
        let message = format!("`{first}` is a time in milliseconds, since it has no unit{also}");
        let place = Place::property("scenario").part(place, bytes(&text, first)).in_component(index);
        let meant = |unit: &str| first.split("..").map(|end| format!("{end}{unit}")).collect::<Vec<_>>().join("..");
        let (seconds, exact) = (meant("s"), meant("ms"));
        Some(Finding::new(place, message).help(format!("write `{seconds}` for seconds, or `{exact}`")))
    };
    texts.filter_map(finding).collect()
}

/// The components of this crate; the class of a plugin may have reasons for a value.
fn shipped<'f>(fleet: &FleetView<'f>) -> impl Iterator<Item = (usize, &'f ComponentView<'f>)> + use<'f> {
    fleet.components().iter().enumerate().filter(|(_, one)| one.class.name.starts_with("saoms."))
}

/// Findings about long periods.
fn long_periods(fleet: &FleetView<'_>) -> Vec<Finding> {
    let long =
        shipped(fleet).filter_map(|(index, one)| Some((index, one.path, one.period.filter(|period| *period > LONG)?)));
    let finding = |(index, path, period): (usize, &str, Duration)| {
        let period = format_duration(period);
        let message = format!("the period of `{path}` is {period}: it reacts up to {period} late");
        Finding::new(Place::property("period").in_component(index), message)
            .help("write a shorter time with its unit, such as `500ms`: a number without a unit is in milliseconds")
    };
    long.map(finding).collect()
}

/// Findings about times that are probably given in seconds.
fn short_times(fleet: &FleetView<'_>) -> Vec<Finding> {
    let short = |value: &PropertyValue| match value {
        PropertyValue::Scalar(Scalar::Duration(time)) if !time.is_zero() && *time < SHORT => Some(*time),
        _ => None,
    };
    let times = shipped(fleet).flat_map(|(index, one)| {
        let values = one.values.iter().filter_map(move |(name, value)| Some((name.as_str(), short(value)?)));
        let period = one.period.filter(|period| *period < SHORT).map(|period| ("period", period));
        values.chain(period).map(move |(name, time)| (index, one.path, name, time))
    });
    let finding = |(index, path, name, time): (usize, &str, &str, Duration)| {
        let message = format!("`{name}` of `{path}` is {}, which is shorter than a millisecond", format_duration(time));
        // The number in seconds.
        let meant = format_duration(time * 1000);
        Finding::new(Place::property(name).in_component(index), message)
            .help(format!("write the unit, such as `{meant}`: a number without a unit is in milliseconds"))
    };
    times.map(finding).collect()
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
