//! Rule: a breakdown names a robot that does not exist.

use std::cell::LazyCell;
use std::collections::HashMap;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity, nearest};
use saoms_api::{Finding, Place};

use super::budget::Budget;
use super::robots::{FleetRobot, may_be_others, robots};
use crate::environment::{Environment, EventSpec, RandomRange, Scenario};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5005",
        name: "unknown-robot",
        meaning: "A scenario has an event of a robot that the fleet does not have.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

/// Cost of comparing two names, in comparisons of the budget.
const NAME: usize = 50;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let severity = if may_be_others(fleet) { Severity::Warning } else { Severity::Error };
    // Built on demand, since most fleets have no breakdowns.
    let names = LazyCell::new(|| Names::of(fleet, &robots));
    let mut budget = Budget::default();
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        for line in scenario.lines() {
            let EventSpec::Breakdown(robot) = &line.event else { continue };
            let text = &properties.scenario[line.text][robot.bytes.clone()];
            let place = Place::property("scenario").part(line.text, robot.bytes.clone()).in_component(index);
            let finding = check_name(&robots, &names, robot.value, text, place, &mut budget);
            findings.extend(finding.map(|finding| finding.severity(severity)));
        }
    }
    findings
}

/// Names and numbers of robots.
struct Names<'r> {
    /// Number of the first robot with this ID or path.
    by_name: HashMap<&'r str, u32>,
    /// All numbers, sorted.
    numbers: Vec<u32>,
}

impl<'r> Names<'r> {
    fn of(fleet: &FleetView<'r>, robots: &'r [FleetRobot]) -> Names<'r> {
        let mut by_name = HashMap::with_capacity(robots.len());
        for robot in robots {
            by_name.entry(robot.properties.id.as_str()).or_insert(robot.number);
            by_name.entry(fleet.components()[robot.index].path).or_insert(robot.number);
        }
        let mut numbers: Vec<u32> = robots.iter().map(|robot| robot.number).collect();
        numbers.sort_unstable();
        Names { by_name, numbers }
    }

    /// Number of robots with numbers in this range.
    fn between(&self, least: u32, most: u32) -> usize {
        let up_to = |most: u32| self.numbers.partition_point(|number| *number <= most);
        up_to(most).saturating_sub(self.numbers.partition_point(|number| *number < least))
    }
}

fn check_name(
    robots: &[FleetRobot],
    names: &Names<'_>,
    RandomRange { least, most }: RandomRange<u32>,
    text: &str,
    place: Place,
    budget: &mut Budget,
) -> Option<Finding> {
    if let Some(number) = names.by_name.get(text).filter(|number| **number != least) {
        let message = format!("`{text}` stands for robot {least}, and the robot of this name has the number {number}");
        return Some(Finding::new(place, message).instead(number.to_string()));
    }
    let known = names.between(least, most);
    if known as u64 > u64::from(most - least) {
        return None;
    }
    let message = match (least == most, known) {
        (true, _) => format!("the fleet has no robot {least}"),
        (false, 0) => format!("the fleet has no robot from {least} to {most}"),
        (false, _) => format!("of the robots from {least} to {most} the fleet has only {known}"),
    };
    let ids = robots.iter().map(|robot| robot.properties.id.as_str());
    let finding = Finding::new(place, message);
    let is_name = !text.starts_with(|sign: char| sign.is_ascii_digit());
    let near = (is_name && budget.admit(NAME * robots.len())).then(|| nearest(text, ids.clone())).flatten();
    Some(match near {
        Some(near) => finding.instead(near),
        None if robots.is_empty() => finding.help("add it to the composite, or leave the event out"),
        None => {
            let all: Vec<String> = ids.take(30).map(|id| format!("`{id}`")).collect();
            finding.help(format!("its robots are {}", all.join(", ")))
        }
    })
}
