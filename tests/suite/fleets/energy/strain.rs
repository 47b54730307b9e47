//! Faults that classes declare: slow robots, drained batteries, chargers that give nothing.

use std::fs;
use std::time::Duration;

use saoms_core::report::{RunReport, RunStatus};
use saoms_testkit::{Fleet, Run};
use serde_json::Value;

use crate::support::{empty_folder, root, saoms_in};

const HOUR: Duration = Duration::from_secs(3600);

/// A hall of two robots and these lines.
fn hall(scenario: &str, robot: &str) -> String {
    let robot = |number: u32| {
        format!(
            r#"<component name="Robot{number}"><implementation.rust class="saoms.Robot"/>
    <property name="ID" value="Robot{number}"/><property name="period" value="100ms"/>{robot}
    <reference name="world" target="World"/></component>"#
        )
    };
    let member = |name: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{name}"><implementation.rust class="saoms.{class}"/>
    <property name="ID" value="{name}"/><property name="period" value="100ms"/>{more}</component>"#
        )
    };
    let scenario = format!(r#"<property name="scenario">{scenario}</property>"#);
    let all = [
        member("World", "World", ""),
        member("Environment", "Environment", &scenario),
        member("Master", "MasterEnvironment", ""),
        robot(1),
        robot(2),
    ];
    format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="hall" targetNamespace="urn:hall">
{}
</composite>"#,
        all.join("\n")
    )
}

/// A battery that lasts for what slow robots do.
const PHYSICAL: &str = r#"<property name="dischargePerBlock" value="1"/><property name="dischargePerSecond" value="0.2"/>
    <property name="chargePerSecond" value="5"/>"#;

fn run(scenario: &str, robot: &str) -> Run {
    Fleet::of_text(hall(scenario, robot)).run(1, HOUR)
}

/// A number of the report; 0 where it has none.
fn number(report: &RunReport, path: &str) -> i64 {
    let (section, rest) = path.split_once('.').unwrap();
    let found = report.sections.get(section).and_then(|all| rest.split('.').try_fold(all, |at, step| at.get(step)));
    found.and_then(Value::as_i64).unwrap_or(0)
}

fn assert_delivered(report: &RunReport) {
    assert_eq!((report.outcome.status, number(report, "luggage.delivered")), (RunStatus::Done, 1), "{report:?}");
}

#[test]
fn a_slow_robot_takes_longer_and_brings_its_luggage() {
    let usual = run("at 1s luggage (3,1) to (3,9)", PHYSICAL);
    let slow =
        run("at 1s luggage (3,1) to (3,9); at 500ms slow robot=1 factor=3; at 500ms slow robot=2 factor=3", PHYSICAL);
    assert_delivered(&usual);
    assert_delivered(&slow);
    // Ten moves, collecting and depositing, two more periods for each.
    assert!(slow.time_s >= usual.time_s + 2.0, "{} {}", slow.time_s, usual.time_s);
    assert_eq!(number(&slow, "faults.applied.slow"), 2);
    assert!(slow.log_of("World").contains(&"robot 1 takes 3 times as long to the end of the run".to_owned()));
    let short = run("at 1s luggage (3,1) to (3,9); at 500ms slow robot=1 factor=3 lasting=100ms", PHYSICAL);
    assert_eq!(short.time_s, usual.time_s);
}

#[test]
fn a_move_goes_on_at_its_usual_speed_when_the_robot_is_slow_no_more() {
    let usual = run("at 1s luggage (3,1) to (3,9)", PHYSICAL);
    let short = run(
        "at 1s luggage (3,1) to (3,9); at 1500ms slow robot=1 factor=1000 lasting=5s; at 1500ms slow robot=2 factor=1000 lasting=5s",
        PHYSICAL,
    );
    assert_delivered(&short);
    assert!(short.time_s <= usual.time_s + 6.0, "{} {}", short.time_s, usual.time_s);
}

#[test]
fn a_slow_robot_returns_to_its_charger_in_time() {
    // Without its measured pace it would set out for luggage that is too far.
    let scenario = "from 1s every 8s 20 times luggage (1,0)..(10,10) to (1,0)..(10,10)
        at 20s slow robot=1 factor=3 lasting=60s; at 50s slow robot=2 factor=2.5";
    for seed in 0..10 {
        // The world ends a move before the robot hears of it.
        let periods = hall(scenario, PHYSICAL)
            .replace("=\"100ms\"/><property name=\"discharge", "=\"70ms\"/><property name=\"discharge");
        assert!(periods.contains("70ms"));
        let fleet = Fleet::of_text(periods);
        fleet.expect_invariants(seed..seed + 1, HOUR);
        assert_eq!(number(&fleet.run(seed, HOUR), "luggage.delivered"), 20, "seed {seed}");
    }
}

#[test]
fn a_drained_battery_is_charged_in_time() {
    let report = run("at 1s luggage (3,1) to (3,9); at 1500ms drain robot=1..2 percent=30 factor=1.5 lasting=3s", "");
    assert_delivered(&report);
    assert_eq!(number(&report, "faults.applied.drain"), 1);
    let log = report.log();
    assert!(log.contains("battery loses 30 %: ") && log.contains("battery drains 1.5 times as fast"), "{log}");
}

#[test]
fn a_battery_that_a_fault_empties_is_no_violation() {
    let scenario = "at 1s luggage (9,9) to (3,9); at 4s drain robot=1 percent=100; at 4s drain robot=2 percent=100";
    let fleet = Fleet::of_text(hall(scenario, ""));
    fleet.expect_invariants(0..3, HOUR);
    let report = fleet.run(1, HOUR);
    assert!(report.sections.get("stranded").and_then(Value::as_i64).unwrap_or(0) >= 1, "{:?}", report.sections);
}

#[test]
fn a_robot_whose_charger_gives_nothing_takes_another_one() {
    let scenario =
        "at 100ms outage charger=(0,1) lasting=30s; at 1s visit (9,1) by Robot1; at 200ms visit (5,5) by Robot2
        then 12s visit (9,2) by Robot2; at 25s visit (9,1) by Robot1";
    let report = run(scenario, r#"<property name="battery" value="60"/>"#);
    let log = report.log();
    assert!(log.contains("Robot1: battery gains nothing at its charger at (0,1): it stays at "), "{log}");
    assert!(log.contains("Robot1: charges at (0,2) this time: its own gives nothing"), "{log}");
    assert!(log.contains("World: the charger at (0,1) gives nothing for 30 s"), "{log}");
    assert_eq!(number(&report, "faults.applied.outage"), 1);
    assert!(number(&report, "chargers.without_gain") >= 1);
    assert_eq!(report.outcome.status, RunStatus::Done, "{:?}\n{log}", report.outcome);
}

#[test]
fn a_robot_without_another_charger_waits_for_its_own() {
    for policy in ["safe", "classic"] {
        let scenario = "at 0s outage charger=(0,1) lasting=20s; at 0s outage charger=(0,2) lasting=20s
            at 1s luggage (6,1) to (7,9); at 40s end";
        let robot = format!(r#"<property name="battery" value="45"/><property name="policy" value="{policy}"/>"#);
        let report = run(scenario, &robot);
        assert_delivered(&report);
        let log = report.log();
        assert!(log.contains("Robot1: battery gains nothing at its charger at (0,1): it stays at "), "{policy}: {log}");
        assert!(number(&report, "chargers.without_gain") >= 1, "{policy}");
    }
}

#[test]
fn faults_of_robots_that_do_not_exist_are_told_and_counted() {
    let folder = empty_folder("strain-ignored");
    fs::write(folder.join("hall.composite"), hall("at 1s luggage (3,1) to (3,9)", "")).unwrap();
    fs::write(folder.join("events.txt"), "at 1s slow robot=9 factor=2\nat 1s drain robot=8 percent=2\n").unwrap();
    let output =
        saoms_in(&folder, &["run", "hall.composite", "--virtual", "--events", "events.txt", "--report", "r.json"]);
    assert_eq!(output.status.code(), Some(0));
    let report: Value = serde_json::from_str(&fs::read_to_string(folder.join("r.json")).unwrap()).unwrap();
    assert_eq!(report["faults"]["ignored"], 2, "{report}");
}

/// As in a scenario (S5024).
#[test]
fn faults_of_messages_are_refused_where_robots_rest_on_positions() {
    let folder = empty_folder("strain-peers");
    fs::write(folder.join("hall.composite"), hall("at 1s luggage (3,1) to (3,9)", "")).unwrap();
    fs::write(folder.join("faults.txt"), "at 1s for 40s reorder 10 % by 200ms\nat 2s for 1s lose 5 % on ETOPIC\n")
        .unwrap();
    let output = saoms_in(&folder, &["run", "hall.composite", "--virtual", "--faults", "faults.txt"]);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{printed}");
    let found = "faults.txt:1:7: `Robot2` may hear too late where `Robot1` is, and collide with it";
    assert!(printed.contains(&format!("error[S5024]: {found}")), "{printed}");
    assert!(printed.contains("add `--severity S5024=warning`"), "{printed}");
    assert!(!printed.contains("faults.txt:2"), "{printed}");
    let arguments = ["run", "hall.composite", "--virtual", "--faults", "faults.txt", "--severity"];
    let output = saoms_in(&folder, &[&arguments[..], &["S5024=warning"]].concat());
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{printed}");
    assert!(printed.contains(&format!("warning[S5024]: {found}")), "{printed}");
}

/// As in a scenario (S5031).
#[test]
fn a_world_that_forgets_all_when_it_crashes_is_warned_of() {
    let folder = empty_folder("strain-forgets");
    fs::write(folder.join("hall.composite"), hall("at 1s luggage (3,1) to (3,9)", "")).unwrap();
    fs::write(folder.join("faults.txt"), "at 1s crash Wor* restart 1s\nat 1min crash World\n").unwrap();
    let output = saoms_in(&folder, &["run", "hall.composite", "--virtual", "--for", "2s", "--faults", "faults.txt"]);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    let found = "faults.txt:1:7: `World` has forgotten its robots and its luggage when it starts again";
    assert!(printed.contains(&format!("warning[S5031]: {found}")), "{printed}");
    assert!(!printed.contains("faults.txt:2") && output.status.code() != Some(2), "{printed}");
}

#[test]
fn nothing_has_to_happen_where_a_zone_has_failed_for_good() {
    let folder = empty_folder("strain-zone");
    let airport = root().join("composites/airport.composite").display().to_string();
    let restarts = fs::read_to_string(&airport).unwrap().replace(
        r#"<implementation.java class="saoms.Zone"/>"#,
        r#"<implementation.java class="saoms.Zone"/><property name="restart">onFailure</property>"#,
    );
    fs::write(folder.join("restarts.composite"), restarts).unwrap();
    fs::write(folder.join("faults.txt"), "at 3s fail Zone\n").unwrap();
    let run = |composite: &str| {
        let arguments =
            ["run", composite, "--virtual", "--invariants", "--quiet", "--for", "5min", "--faults", "faults.txt"];
        let output = saoms_in(&folder, &arguments);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, printed) = run(&airport);
    assert!(code == Some(1) && !printed.contains("error: ["), "{printed}");
    let (code, printed) = run("restarts.composite");
    assert_eq!(code, Some(0), "{printed}");
}

#[test]
fn a_fault_that_means_nothing_is_refused_at_its_place_before_anything_starts() {
    let folder = empty_folder("strain-refused");
    fs::write(folder.join("hall.composite"), hall("at 1s luggage (3,1) to (3,9)", "")).unwrap();
    let faults = "at 1s slow robot=1 factor=0.5
at 1s slow robot=1 factor=1e308
at 1s slow robot=1
at 1s outage charger=(5,5) lasting=3s
at 1s outage charger=(0,0)..(0,9)
at 1s outage charger=(3,0)..(5,9)
at 2s for 0s lose 20 %
at 2s for 0 ms stall Robot1
at 2s loose 20 %
at 2s storm
at 3s breakdown Robot9
at 3s gone 1..9; at 4s slow robot=9 factor=2
at 4s luggage (3,1) to (99,1)
";
    fs::write(folder.join("faults.txt"), faults).unwrap();
    let output = saoms_in(&folder, &["run", "hall.composite", "--virtual", "--faults", "faults.txt"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{told}");
    expect_test::expect![[r#"
        error: faults.txt:1:27: field `factor`: found `0.5`, expected a number from 1 to 1000
            at 1s slow robot=1 factor=0.5
                                      ^^^
        error: faults.txt:2:27: field `factor`: found `1e308`, expected a number from 1 to 1000
            at 1s slow robot=1 factor=1e308
                                      ^^^^^
        error: faults.txt:3:7: event `slow` needs its fields: `factor` is missing
            at 1s slow robot=1
                  ^^^^
            = help: add `factor=1.5`, with a number for `factor`
        error: faults.txt:4:22: no robot has its charger at (5,5)
            at 1s outage charger=(5,5) lasting=3s
                                 ^^^^^
            = help: the chargers are at `(0,1)`, `(0,2)`
        error: faults.txt:6:22: no robot has its charger at (3,0)..(5,9)
            at 1s outage charger=(3,0)..(5,9)
                                 ^^^^^^^^^^^^
            = help: the chargers are at `(0,1)`, `(0,2)`
        error: faults.txt:7:11: found `0s`, expected a time above 0: a fault that lasts no time does nothing
            at 2s for 0s lose 20 %
                      ^^
            = help: write a time such as `for 2s`
        error: faults.txt:8:11: found `0 ms`, expected a time above 0: a fault that lasts no time does nothing
            at 2s for 0 ms stall Robot1
                      ^^^^
            = help: write a time such as `for 2s`
        error: faults.txt:9:7: found `loose`, expected `luggage`, `visit`, `landing`, `takeoff`, `breakdown`, `gone`, `end`, `drain`, `outage`, `slow`, `lose`, `violate`, `delay`, `jitter`, `duplicate`, `reorder`, `cut`, `part`, `stall`, `fail`, `crash` or `drift`; did you mean `lose`?
            at 2s loose 20 %
                  ^^^^^
        error: faults.txt:10:7: found `storm`, expected `luggage`, `visit`, `landing`, `takeoff`, `breakdown`, `gone`, `end`, `drain`, `outage`, `slow`, `lose`, `violate`, `delay`, `jitter`, `duplicate`, `reorder`, `cut`, `part`, `stall`, `fail`, `crash` or `drift`
            at 2s storm
                  ^^^^^
        error: faults.txt:11:17: the fleet has no robot 9
            at 3s breakdown Robot9
                            ^^^^^^
            = help: the robots are `Robot1`, `Robot2`
        error: faults.txt:12:12: the fleet has only 2 of the robots from 1 to 9
            at 3s gone 1..9; at 4s slow robot=9 factor=2
                       ^^^^
            = help: the robots are `Robot1`, `Robot2`
        error: faults.txt:13:24: luggage cannot be at (99,1): this block is outside the map, which goes from (0,0) to (10,10)
            at 4s luggage (3,1) to (99,1)
                                   ^^^^^^
            = help: choose a free block of the map: robots cannot enter other blocks

        12 errors: nothing was started
    "#]]
    .assert_eq(&told);
}

#[test]
fn robots_and_chargers_that_a_scenario_names_wrongly_are_mistakes_at_their_place() {
    let folder = empty_folder("strain-wrong");
    let scenario = "at 1s luggage (3,1) to (3,9); at 2s slow robot=9 factor=2; at 2s drain robot=3..4 percent=2
        at 3s outage charger=(5,5); at 3s slow robot=1 factor=0.2; at 3s drain robot=2";
    fs::write(folder.join("hall.composite"), hall(scenario, "")).unwrap();
    let output = saoms_in(&folder, &["check", "hall.composite"]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    for line in [
        "error[S5005]: the fleet has no robot 9\n",
        "error[S5005]: the fleet has no robot from 3 to 4\n",
        "error[S5026]: no robot has its charger at (5,5)\n",
        "field `factor`: found `0.2`, expected a number from 1 to 1000\n",
        "event `drain` says neither what the battery loses at once, nor how much faster it drains\n",
        "= help: the chargers are at `(0,1)`, `(0,2)`\n",
    ] {
        assert!(told.contains(line), "{line}{told}");
    }
}
