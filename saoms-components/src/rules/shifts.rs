//! Rule: shifts that cannot keep to their times.

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use saoms_api::host::format_duration;
use saoms_api::rule::{Code, ComponentView, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::master::{MasterEnvironment, MasterRobot};
use crate::robot::Robot;
use crate::shift::{Shift, ShiftProperties};
use crate::world::World;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5013",
        name: "shift",
        meaning: "A shift schedules itself, a world, a master, a component that runs from the start of the fleet, or a \
            component that another shift schedules at the same time; a shift is shorter than the component's \
            period; or no component schedules a shift that waits for its start.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// Maximum number of shifts of two components that are compared.
const COMPARED: usize = 10_000;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    let path = |index: usize| components[index].path;
    // The first shift that schedules each component.
    let mut first: HashMap<usize, (usize, ShiftProperties)> = HashMap::new();
    let (mut findings, mut wrong_tasks) = (Vec::new(), None);
    // Without these, luggage and robots are lost.
    let masters = fleet.indices::<MasterEnvironment>().chain(fleet.indices::<MasterRobot>());
    let always: HashSet<usize> = fleet.indices::<World>().chain(masters).collect();
    for (index, properties) in fleet.all::<Shift>() {
        let mut tasks: Vec<usize> = components[index].wires.iter().map(|(_, target)| *target).collect();
        tasks.sort_unstable();
        tasks.dedup();
        for task in tasks {
            if task == index {
                let message = format!("`{}` schedules itself: it stops at the end of its first shift", path(index));
                let help = "wire its reference `tasks` to the components that work in shifts";
                wrong_tasks = Some(findings.len());
                findings.push(Finding::new(Place::component(index), message).severity(Severity::Error).help(help));
                continue;
            }
            if always.contains(&task) {
                let message = format!(
                    "`{}` is scheduled in shifts by `{}`: between them the robots cannot work, and the run has no end",
                    path(task),
                    path(index)
                );
                let help = "let it run all the time: remove it from `tasks`, and its `runOnStartup`";
                wrong_tasks = Some(findings.len());
                findings.push(
                    Finding::new(Place::component(task), message)
                        .label(Place::component(index), "this component schedules the shifts")
                        .help(help),
                );
                continue;
            }
            if let Some((other, others)) = first.get(&task) {
                let Some(at) = properties.overlaps(others) else { continue };
                let message = format!(
                    "the shifts of `{}` and `{}` overlap: both schedule `{}` at {}, and the shift that starts later \
                    decides when it stops",
                    path(*other),
                    path(index),
                    path(task),
                    format_duration(at)
                );
                findings.push(
                    Finding::new(Place::component(index), message)
                        .label(Place::component(*other), "the other shift")
                        .help(
                            "change `start`, `work` or `pause` so that the shifts do not overlap, or wire only one \
                            of the two to this component",
                        ),
                );
                continue;
            }
            if components[task].starts {
                let message = format!(
                    "`{}` runs from the start of the fleet, but `{}` schedules it only for its shifts",
                    path(task),
                    path(index)
                );
                wrong_tasks = Some(findings.len());
                findings.push(
                    Finding::new(Place::property("runOnStartup").in_component(task), message)
                        .label(Place::component(index), "this component schedules the shifts")
                        .help("set `runOnStartup` to `false`: the component then waits for its first shift"),
                );
            }
            findings.extend(too_short(fleet, index, &properties, task));
            first.insert(task, (index, properties.clone()));
        }
    }
    let waiting = never_scheduled(fleet, &always);
    // A shift that schedules the wrong component is one mistake with that which it does not schedule.
    match (wrong_tasks, &waiting[..]) {
        (Some(place), [(index, _)]) if !always.contains(index) => {
            let help = format!("wire the reference `tasks` to `{}`, which waits to be scheduled", path(*index));
            findings[place] = findings[place].clone().help(help);
        }
        _ => findings.extend(waiting.into_iter().map(|(_, finding)| finding)),
    }
    findings
}

/// A finding about a shift that is over before its component executes again.
fn too_short(fleet: &FleetView<'_>, shift: usize, properties: &ShiftProperties, task: usize) -> Option<Finding> {
    let component = &fleet.components()[task];
    let (work, period) = (properties.work, component.period?);
    (work < period).then(|| {
        let message = format!(
            "a shift of {} is shorter than the period of `{}`, {}: the component executes only once in a shift",
            format_duration(work),
            component.path,
            format_duration(period)
        );
        Finding::new(Place::property("work").in_component(shift), message)
            .label(Place::property("period").in_component(task), "the period")
            .help("write a longer time, with its unit, such as `15s`: a number without a unit is in milliseconds")
    })
}

/// Findings about components of this crate that wait to be scheduled, and nothing does that; some must run `always`.
fn never_scheduled(fleet: &FleetView<'_>, always: &HashSet<usize>) -> Vec<(usize, Finding)> {
    // What is left out for a fault may schedule any of them.
    if !fleet.missing().is_empty() {
        return Vec::new();
    }
    let (components, robots) = (fleet.components(), fleet.indices::<Robot>().collect::<HashSet<usize>>());
    // Robots are wired to their world, which they do not schedule; others may.
    let wires = components.iter().enumerate().filter(|(index, _)| !robots.contains(index));
    let scheduled: HashSet<usize> = wires.flat_map(|(_, one)| one.wires.iter().map(|(_, target)| *target)).collect();
    let running: HashSet<&str> = components.iter().filter(|one| one.starts).map(|one| one.class.name).collect();
    let waits = components.iter().enumerate().filter(|(index, one)| {
        // One of several may be there to be started in place of another by hand; robots work side by side.
        let is_needed = robots.contains(index) || !running.contains(one.class.name);
        !one.starts && is_needed && one.class.name.starts_with("saoms.") && !scheduled.contains(index)
    });
    let finding = |(index, one): (usize, &ComponentView<'_>)| {
        let message = format!("`{}` never runs: it waits to be scheduled, and nothing schedules it", one.path);
        let finding = Finding::new(Place::property("runOnStartup").in_component(index), message);
        let help = match always.contains(&index) {
            true => "remove `runOnStartup`: the robots cannot work without it",
            false => "remove `runOnStartup`, or wire the reference `tasks` of a `saoms.Shift` to this component",
        };
        (index, finding.help(help))
    };
    waits.map(finding).collect()
}

impl ShiftProperties {
    /// Start and end of a shift; `None` after the last one.
    fn shift(&self, number: u32) -> Option<(Duration, Duration)> {
        let start = self.start + (self.work + self.pause).checked_mul(number)?;
        self.shifts.is_none_or(|shifts| number < shifts).then(|| (start, start + self.work))
    }

    /// Time at which a shift begins during one of the others, as far as they are compared.
    fn overlaps(&self, others: &ShiftProperties) -> Option<Duration> {
        let (mut own, mut other) = (0, 0);
        for _ in 0..COMPARED {
            let ((start, end), (other_start, other_end)) = (self.shift(own)?, others.shift(other)?);
            if start < other_end && other_start < end {
                return Some(start.max(other_start));
            }
            if end <= other_start { own += 1 } else { other += 1 }
        }
        None
    }
}
