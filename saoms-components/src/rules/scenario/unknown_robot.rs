//! Rule: a breakdown, or a robot that is gone, names one that does not exist, or does not hear of it.

use std::collections::HashMap;
use std::ops::Range;

use saoms_api::extension::LineFault;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity, nearest};
use saoms_api::{Finding, Place};

use super::strain;
use crate::environment::{Environment, EventSpec, Line, RandomRange, Scenario, Spanned};
use crate::messages::{ENVIRONMENT, FAULT};
use crate::robot::Robot;
use crate::rules::budget::Budget;
use crate::rules::hearing::{events, passed_on, site_of};
use crate::rules::robots::{FleetRobot, are_all_known, has_broker, may_be_others, robots};

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5005",
        name: "unknown-robot",
        meaning: "A scenario has an event for a robot that is not in the fleet, or that does not receive the event.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

/// Maximum number of robots that a message lists.
const LISTED: usize = 10;

/// Cost of comparing two names, in comparisons of the budget.
const NAME: usize = 50;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let severity = if may_be_others(fleet) || has_broker(fleet) { Severity::Warning } else { Severity::Error };
    let mut budget = Budget::default();
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        if is_told(fleet, &scenario) {
            continue;
        }
        // Built on demand, since most scenarios have no breakdowns.
        let mut known: Option<Names<'_>> = None;
        for line in scenario.lines() {
            let Some(robot) = robot_of(fleet, line) else { continue };
            if known.is_none() && !budget.admit(NAME * robots.len()) {
                return findings;
            }
            let names = known.get_or_insert_with(|| Names::of(fleet, &robots, index));
            let text = &properties.scenario[line.text as usize][robot.bytes.clone()];
            let written = Written { text, value: robot.value, place: line.text as usize, bytes: robot.bytes.clone() };
            let finding = check_name(fleet, names, &written, severity, &mut budget);
            findings.extend(finding.map(|finding| finding.at(written.place(index))));
        }
    }
    findings
}

/// Judges a line that does not stand in a scenario. Places are bytes of the text.
///
/// # Errors
/// Its event is for a robot that is not in the fleet.
pub(crate) fn judge_robot(fleet: &FleetView<'_>, line: &Line, text: &str) -> Result<(), LineFault> {
    if may_be_others(fleet) || has_broker(fleet) {
        return Ok(());
    }
    let Some(robot) = robot_of(fleet, line) else { return Ok(()) };
    let all = robots(fleet);
    let names = Names::among(fleet, all.iter().collect(), Vec::new(), ENVIRONMENT.name());
    let written =
        Written { text: &text[robot.bytes.clone()], value: robot.value, place: 0, bytes: robot.bytes.clone() };
    let finding = check_name(fleet, &names, &written, Severity::Error, &mut Budget::default());
    let Some(finding) = finding.filter(|one| one.own_severity() == Some(Severity::Error)) else { return Ok(()) };
    let (instead, help) = (finding.replacement().map(str::to_owned), finding.helps().first().cloned());
    Err(LineFault { bytes: robot.bytes, message: finding.message().to_owned(), instead, help, code: None })
}

/// The robot that a line is about, or numbers of which it draws one.
fn robot_of(fleet: &FleetView<'_>, line: &Line) -> Option<Spanned<RandomRange<u32>>> {
    match &line.event {
        EventSpec::Breakdown(robot) | EventSpec::Gone(robot) | EventSpec::Visit { by: Some(robot), .. } => {
            Some(robot.clone())
        }
        event => strain::robots_of(fleet, event).map(|(value, field)| {
            let start = line.bytes.start;
            Spanned { value, bytes: start + field.value.bytes.start..start + field.value.bytes.end }
        }),
    }
}

/// True if the rule about scenarios without effect tells that there is no robot at all: which of them one event means
/// says no more.
fn is_told(fleet: &FleetView<'_>, scenario: &Scenario) -> bool {
    let is_luggage = |event: &EventSpec| matches!(event, EventSpec::Luggage { .. } | EventSpec::Visit { .. });
    fleet.indices::<Robot>().next().is_none()
        && !fleet.misses::<Robot>()
        && !may_be_others(fleet)
        && scenario.lines().iter().any(|line| is_luggage(&line.event))
}

/// A robot as a scenario writes it.
struct Written<'s> {
    text: &'s str,
    value: RandomRange<u32>,
    /// Index of the text of the scenario.
    place: usize,
    bytes: Range<usize>,
}

impl Written<'_> {
    fn place(&self, environment: usize) -> Place {
        Place::property("scenario").part(self.place, self.bytes.clone()).in_component(environment)
    }

    /// True if it is one name, and no number.
    fn is_name(&self) -> bool {
        self.value.least == self.value.most && !self.text.starts_with(|sign: char| sign.is_ascii_digit())
    }
}

/// Names and numbers of the robots that hear of the breakdowns of an environment.
struct Names<'r> {
    robots: Vec<&'r FleetRobot>,
    /// Number of the first robot with this ID or path.
    by_name: HashMap<&'r str, u32>,
    /// All numbers, sorted.
    numbers: Vec<u32>,
    /// The other robots.
    deaf: Vec<&'r FleetRobot>,
    /// The name on the bus of the events of the environment.
    events: &'r str,
}

impl<'r> Names<'r> {
    fn of(fleet: &FleetView<'r>, all: &'r [FleetRobot], environment: usize) -> Names<'r> {
        let events = events(fleet, environment);
        let topics = passed_on(fleet, events, FAULT.name());
        let hears = |robot: &&FleetRobot| {
            topics.is_empty() || topics.contains(fleet.components()[robot.index].topic(FAULT.name()))
        };
        let (robots, deaf): (Vec<&FleetRobot>, Vec<&FleetRobot>) = all.iter().partition(hears);
        Names::among(fleet, robots, deaf, events)
    }

    fn among(
        fleet: &FleetView<'r>,
        robots: Vec<&'r FleetRobot>,
        deaf: Vec<&'r FleetRobot>,
        events: &'r str,
    ) -> Names<'r> {
        let mut by_name = HashMap::with_capacity(robots.len());
        for robot in &robots {
            by_name.entry(robot.properties.id.as_str()).or_insert(robot.number);
            by_name.entry(fleet.components()[robot.index].path).or_insert(robot.number);
        }
        let mut numbers: Vec<u32> = robots.iter().map(|robot| robot.number).collect();
        numbers.sort_unstable();
        Names { robots, by_name, numbers, deaf, events }
    }

    /// The robot with this ID or path among those that do not hear of the breakdowns.
    fn deaf_of_name(&self, fleet: &FleetView<'_>, name: &str) -> Option<&'r FleetRobot> {
        let is_named =
            |robot: &&&FleetRobot| robot.properties.id.as_str() == name || fleet.components()[robot.index].path == name;
        self.deaf.iter().find(is_named).copied()
    }

    /// Number of robots with numbers in this range.
    fn between(&self, least: u32, most: u32) -> usize {
        let up_to = |most: u32| self.numbers.partition_point(|number| *number <= most);
        up_to(most).saturating_sub(self.numbers.partition_point(|number| *number < least))
    }

    /// The robots that there are.
    fn list(&self) -> String {
        let mut robots: Vec<&FleetRobot> = self.robots.clone();
        robots.sort_by_key(|robot| robot.number);
        let id = |robot: &&FleetRobot| format!("`{}`", robot.properties.id);
        match &robots[..] {
            [one] => format!("the only robot is {}", id(one)),
            [first, .., last] if robots.len() > LISTED => {
                format!("there are {} robots, from {} to {}", robots.len(), id(first), id(last))
            }
            all => format!("the robots are {}", all.iter().map(id).collect::<Vec<String>>().join(", ")),
        }
    }

    fn ids(&self) -> impl Iterator<Item = &'r str> {
        self.robots.iter().map(|robot| robot.properties.id.as_str())
    }
}

fn check_name(
    fleet: &FleetView<'_>,
    names: &Names<'_>,
    written: &Written<'_>,
    severity: Severity,
    budget: &mut Budget,
) -> Option<Finding> {
    let (text, RandomRange { least, most }) = (written.text, written.value);
    let finding = |message: String| Finding::new(Place::default(), message).severity(severity);
    if let Some(number) = names.by_name.get(text) {
        // Of robots that share a number, that is told.
        if *number == least || names.between(*number, *number) > 1 {
            return None;
        }
        let message = format!("`{text}` means robot {least} here, but the robot with this ID has the number {number}");
        return Some(finding(message).instead(number.to_string()));
    }
    let site = site_of(ENVIRONMENT.name(), names.events).filter(|site| !site.is_empty());
    let whole = site.map_or_else(|| "the fleet".to_owned(), |site| format!("site `{site}`"));
    let known = names.between(least, most);
    if known as u64 > u64::from(most - least) {
        if !written.is_name() {
            return None;
        }
        if let Some(robot) = names.deaf_of_name(fleet, text) {
            return Some(deaf(fleet, robot, format!("robot `{text}`"), severity));
        }
        if text.contains('/') && are_all_known(fleet) {
            // A path means one robot, and not the one with its number here.
            return Some(finding(format!("{whole} has no robot `{text}`")).help(names.list()));
        }
        let robot = names.robots.iter().find(|robot| robot.number == least)?;
        let id = robot.properties.id.as_str();
        let message = format!("no robot has the ID `{text}`: it means robot {least} here, whose ID is `{id}`");
        return Some(finding(message).severity(Severity::Warning).instead(id));
    }
    if let Some(robot) = names.deaf.iter().find(|robot| least == most && robot.number == least) {
        return Some(deaf(fleet, robot, format!("robot {least}"), severity));
    }
    if !are_all_known(fleet) || names.numbers.windows(2).any(|pair| pair[0] == pair[1]) {
        // Robots that share an ID or a number are told of; which are missing is not known.
        return None;
    }
    let message = match (least == most, known) {
        (true, _) => format!("{whole} has no robot {least}"),
        (false, 0) => format!("{whole} has no robot from {least} to {most}"),
        (false, _) => format!("{whole} has only {known} of the robots from {least} to {most}"),
    };
    let is_name = !text.starts_with(|sign: char| sign.is_ascii_digit());
    let near = (is_name && budget.admit(NAME * names.robots.len())).then(|| nearest(text, names.ids())).flatten();
    // Another number alone is another robot, and no slip, unless its digits are in another order.
    let near = near.filter(|near| parted(near).0 != parted(text).0 || parted(near).1 == parted(text).1);
    Some(match near {
        Some(near) => finding(message).instead(near),
        None if names.robots.is_empty() => finding(message).help("add the robot to the composite, or remove the event"),
        None => finding(message).help(names.list()),
    })
}

/// The finding for a robot, with its name, that does not hear of its breakdown.
fn deaf(fleet: &FleetView<'_>, robot: &FleetRobot, name: String, severity: Severity) -> Finding {
    let topic = fleet.components()[robot.index].topic(FAULT.name());
    let message = format!("{name} does not receive this event: it receives breakdowns on the topic `{topic}`");
    let help = "move the event to the environment whose master forwards it to this robot";
    Finding::new(Place::default(), message).severity(severity).label(Place::component(robot.index), name).help(help)
}

/// The text before the digits at the end of a name, and these digits, sorted.
fn parted(name: &str) -> (&str, Vec<u8>) {
    let (text, digits) = name.split_at(name.trim_end_matches(|sign: char| sign.is_ascii_digit()).len());
    let mut digits = digits.as_bytes().to_vec();
    digits.sort_unstable();
    (text, digits)
}
