//! Rule: an `end` has no effect, because other events of its scenario come later.

use std::time::Duration;

use saoms_api::host::format_duration;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, Line, RandomRange, Scenario};

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5019",
        name: "early-end",
        meaning: "An `end` has no effect: its scenario has later events, and `end` does not end a run before them.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let environments = fleet.all::<Environment>();
    environments
        .flat_map(|(index, properties)| {
            let (scenario, _) = Scenario::read_partly(&properties.scenario);
            early_ends(scenario.lines(), index)
        })
        .collect()
}

/// The findings about a scenario.
fn early_ends(lines: &[Line], index: usize) -> Vec<Finding> {
    if lines.iter().all(|line| line.event != EventSpec::End) {
        // Most scenarios have none, and some are very long.
        return Vec::new();
    }
    let place =
        |line: &Line| Place::property("scenario").part(line.text as usize, line.bytes.clone()).in_component(index);
    let times = last_times(lines);
    // The line whose last event comes latest of all, at the earliest.
    let Some((last, latest)) = lines.iter().zip(&times).max_by_key(|(_, time)| time.least) else { return Vec::new() };
    let ends = lines.iter().zip(&times).filter(|(line, _)| line.event == EventSpec::End);
    let early = ends.filter(|(_, time)| time.most < latest.least);
    let finding = |(end, time): (&Line, &RandomRange<Duration>)| {
        let at = format_duration(time.most);
        let message = "this `end` has no effect: the scenario has later events";
        Finding::new(place(end), message).label(place(last), "a later event").help(format!(
            "remove it, or write a time after all events: `end` only keeps the run from ending earlier. \
             `saoms run --for {at}` ends a run after {at}"
        ))
    };
    early.map(finding).collect()
}

/// Earliest and latest time of the last event of each line.
fn last_times(lines: &[Line]) -> Vec<RandomRange<Duration>> {
    let mut before = RandomRange::fixed(Duration::ZERO);
    let times = lines.iter().map(|line| {
        let from = if line.follows { before } else { RandomRange::fixed(Duration::ZERO) };
        before = RandomRange {
            least: last(line, from.least, line.time.least, line.every.least, line.every.most),
            most: last(line, from.most, line.time.most, line.every.most, Duration::ZERO),
        };
        before
    });
    times.collect()
}

/// Time of the last event, whose first is `time` after `from`, with `every` between two. The last event before the time
/// of `until` can be `before` earlier than that.
fn last(line: &Line, from: Duration, time: Duration, every: Duration, before: Duration) -> Duration {
    let first = from.saturating_add(time);
    let repeated = |times: u64| {
        let repetitions = u32::try_from(times.saturating_sub(1)).unwrap_or(u32::MAX);
        first.saturating_add(every.saturating_mul(repetitions))
    };
    let counted = line.times.map_or(Duration::MAX, repeated);
    let limited = line.until.map_or(Duration::MAX, |until| until.saturating_sub(before).max(first));
    counted.min(limited)
}
