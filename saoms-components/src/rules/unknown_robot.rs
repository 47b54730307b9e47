//! Breakdowns of robots that do not exist.

use saoms_api::{Code, Finding, FleetRule, FleetView, Place, Severity, nearest};

use super::robots::{Known, may_be_others, robots};
use crate::environment::{Drawn, Environment, Happening, Scenario, Written};

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

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let severity = if may_be_others(fleet) { Severity::Warning } else { Severity::Error };
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        for line in scenario.lines() {
            let Happening::Breakdown(robot) = &line.happening else { continue };
            let text = &properties.scenario[line.text][robot.bytes.clone()];
            let place = Place::property("scenario").part(line.text, robot.bytes.clone()).in_component(index);
            findings
                .extend(judge(fleet, &robots, robot, text, place).map(|finding| finding.severity(severity)));
        }
    }
    findings
}

fn judge(
    fleet: &FleetView<'_>,
    robots: &[Known],
    written: &Written<Drawn<u32>>,
    text: &str,
    place: Place,
) -> Option<Finding> {
    let named = robots
        .iter()
        .find(|robot| robot.properties.id == text || fleet.components()[robot.index].path == text);
    if let Some(robot) = named.filter(|robot| robot.number != written.value.least) {
        let number = robot.number;
        let message = format!(
            "`{text}` stands for robot {}, and the robot of this name has the number {number}",
            written.value.least
        );
        return Some(Finding::new(place, message).instead(number.to_string()));
    }
    let Drawn { least, most } = written.value;
    let known = robots.iter().filter(|robot| (least..=most).contains(&robot.number)).count();
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
    Some(match nearest(text, ids.clone()).filter(|_| !text.starts_with(|sign: char| sign.is_ascii_digit())) {
        Some(near) => finding.instead(near),
        None if robots.is_empty() => finding.help("add it to the composite, or leave the event out"),
        None => {
            let all: Vec<String> = ids.take(30).map(|id| format!("`{id}`")).collect();
            finding.help(format!("its robots are {}", all.join(", ")))
        }
    })
}
