//! Zones that get other borders again and again while robots drive, with bad links and crashes.

use std::sync::Arc;
use std::time::Duration;

use saoms_api::Time;
use saoms_core::observe::InvariantWatch;
use saoms_core::report::RunReport;
use saoms_core::schedule::{ChangeOptions, RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_tools::diagnostics::human_of;

use super::MAP;

/// First column and row, and number of columns and rows, of each zone of the map.
type Borders = &'static [(u32, u32, u32, u32)];

const BORDERS: [Borders; 4] = [
    &[(0, 0, 8, 6)],
    &[(0, 0, 3, 6), (3, 0, 5, 6)],
    &[(0, 0, 8, 3), (0, 3, 8, 3)],
    &[(4, 0, 4, 6), (0, 0, 4, 3), (0, 3, 4, 3)],
];

/// Robots that bring pieces from anywhere to anywhere on the map, with other events.
fn site(borders: Borders, events: &str, registry: &Registry) -> Assembly {
    let value = |name: &str, value: &str| format!("<property name=\"{name}\">{value}</property>");
    let component = |name: &str, class: &str, more: String| {
        let world = if matches!(class, "Zone" | "Robot") { r#"<reference name="world" target="World"/>"# } else { "" };
        let given = [value("ID", name), value("period", "100"), more].concat();
        format!("<component name=\"{name}\"><implementation.rust class=\"saoms.{class}\"/>{given}{world}</component>")
    };
    let restarts = || [value("restart", "onFailure"), value("restartLimit", "1000")].concat();
    let zones = (1..).zip(borders).map(|(number, (x, y, width, height))| {
        let of = [("number", &number), ("x", x), ("y", y), ("width", width), ("height", height)];
        let of = of.map(|(name, number)| value(name, &number.to_string())).concat();
        component(&format!("Zone{number}"), "Zone", of + &restarts())
    });
    let chargers = [(0, 0), (7, 0), (0, 2), (7, 2), (0, 5)];
    let robots = (1..).zip(chargers).map(|(number, (x, y))| {
        let of = [("delay", 7 * number), ("chargeX", x), ("chargeY", y)];
        let of = of.map(|(name, number)| value(name, &number.to_string())).concat();
        component(&format!("Robot{number}"), "Robot", of + &value("discharge", "0.1") + &restarts())
    });
    let scenario = format!("from 1s every 1s 40 times luggage random to random\n{events}");
    let others = [
        component("World", "World", value("map", MAP) + &value("moveTime", "200ms")),
        component("Master", "MasterEnvironment", String::new()),
        component("Environment", "Environment", value("scenario", &scenario)),
    ];
    let all: String = others.into_iter().chain(zones).chain(robots).collect();
    let text = format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="t" targetNamespace="urn:t">{all}</composite>"#
    );
    let compilation = Project::new().text("site.composite", &text).in_memory().compile(registry);
    let shown = human_of(&compilation);
    compilation.output.unwrap_or_else(|| panic!("{shown}"))
}

/// Runs the site with other borders after each of these times, in milliseconds.
fn run(seed: u64, every: &[u64], events: &str) -> RunReport {
    let registry = Registry::linked().unwrap();
    let watch = Arc::new(InvariantWatch::default());
    let settings = Settings { limit: Some(Duration::from_secs(3600)), ..Settings::simulated(seed) };
    let fleet = RunningFleet::start(site(BORDERS[0], events, &registry), settings, vec![watch.clone()]).unwrap();
    let mut now = 0;
    for (change, wait) in (1..).zip(every) {
        now += wait;
        fleet.run_until(Time::from_nanos(now * 1_000_000));
        let wanted = site(BORDERS[change % BORDERS.len()], events, &registry);
        let changed = fleet.handle().apply(&wanted, ChangeOptions::default()).unwrap();
        assert!(!changed.plan.consequences.is_empty(), "seed {seed}: {:?}", changed.plan);
    }
    let report = fleet.run_to_end();
    let violations = watch.violations();
    let violations: Vec<String> = violations.iter().map(|one| format!("{}: {}", one.invariant, one.text)).collect();
    assert!(violations.is_empty(), "seed {seed}: {violations:?}");
    assert_eq!(report.sections["collisions"], serde_json::json!({"vertex": 0, "swap": 0}), "seed {seed}");
    assert_eq!(report.sections["luggage"]["delivered"], 40, "seed {seed}: {:?}", report.outcome);
    report
}

/// Times between changes: some follow each other before robots have heard of the last one.
const TIMES: [u64; 12] = [2030, 3110, 40, 4070, 90, 130, 5210, 2950, 10, 3370, 4410, 2220];

#[test]
fn robots_deliver_everything_through_borders_that_change_again_and_again() {
    for seed in 0..4 {
        run(seed, &TIMES, "");
    }
}

#[test]
fn borders_change_safely_however_bad_links_are() {
    let topics = ["GRANTTOPIC", "GRANTREQUESTTOPIC", "PRESENCETOPIC", "ZONETOPIC"];
    let faults = ["lose 20 %", "delay 10ms to 300ms", "duplicate 10 %", "reorder 20 % by 300ms"];
    let lines = topics.iter().flat_map(|topic| faults.map(|fault| format!("at 0s for 10min {fault} on {topic}\n")));
    let lines: String = lines.collect();
    for seed in 0..4 {
        run(seed, &TIMES, &lines);
    }
}

#[test]
fn borders_change_safely_while_robots_and_zones_crash() {
    let lines = "at 2s crash Zone1 restart 1s\nat 5s crash Zone1 restart 300ms\nat 9s crash Zone1 restart 2s\n\
        at 6s crash Robot1 restart 1s\nat 12s crash Robot2 restart 500ms\nat 20s crash Robot3 restart 2s";
    for seed in 0..4 {
        run(seed, &TIMES, lines);
    }
}
