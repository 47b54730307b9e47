//! Small fleets in virtual time: what every run of them has to keep, whatever the seed, the periods and the delays.

use std::fs;
use std::time::Duration;

use saoms_core::report::{RunReport, RunStatus};
use saoms_testkit::Fleet;
use serde_json::{Value, json};

use crate::support::root;

const HOUR: Duration = Duration::from_secs(3600);

fn pair() -> String {
    fs::read_to_string(root().join("tests/fleets/pair.composite")).unwrap()
}

/// The same composite with another text in place of one that it has.
fn with(composite: &str, old: &str, new: &str) -> String {
    assert!(composite.contains(old), "no `{old}` in {composite}");
    composite.replace(old, new)
}

fn section<'a>(report: &'a RunReport, name: &str) -> &'a Value {
    report.sections.get(name).unwrap_or(&Value::Null)
}

/// The run ended by itself with all luggage delivered, and nothing went wrong.
fn assert_delivered(report: &RunReport, pieces: u32, context: &str) {
    let sections = &report.sections;
    assert_eq!(report.outcome.status, RunStatus::Done, "{context}: {:?}, {sections:?}", report.outcome);
    let luggage = json!({"requested": pieces, "delivered": pieces, "open": 0, "given_up": 0, "ignored": 0});
    assert_eq!(section(report, "luggage"), &luggage, "{context}");
    assert_eq!(section(report, "collisions"), &json!({"vertex": 0, "swap": 0}), "{context}");
    assert_eq!(section(report, "stranded"), &json!(0), "{context}");
    for component in &report.components {
        assert_eq!((component.failures, component.dropped), (0, 0), "{context}: {}", component.name);
    }
}

#[test]
fn two_robots_deliver_everything_with_every_seed_period_and_delay() {
    let pair = pair();
    for seed in 0..50 {
        let (period, delay) = (20 + 7 * seed, 13 * seed);
        let composite = with(&pair, r#"name="delay">50<"#, &format!(r#"name="delay">{delay}<"#));
        let report = Fleet::of_text(composite).set("period", &period.to_string()).run(seed, HOUR);
        assert_delivered(&report, 4, &format!("seed {seed}, period {period}, delay {delay}"));
    }
}

#[test]
fn the_airport_delivers_everything_with_every_seed() {
    let airport = root().join("composites/airport.composite");
    for seed in 0..10 {
        assert_delivered(&Fleet::of_file(&airport).run(seed, HOUR), 14, &format!("seed {seed}"));
    }
}

/// The text of the world in the pair's composite.
fn world(pair: &str) -> &str {
    let start = pair.find(r#"<component name="World">"#).unwrap();
    let end = "</component>";
    &pair[start..start + pair[start..].find(end).unwrap() + end.len()]
}

#[test]
fn two_robots_run_without_a_world_too() {
    let pair = pair();
    let composite = with(&pair, world(&pair), "");
    let composite = with(&composite, r#"<reference name="world" target="World"/>"#, "");
    assert_delivered(&Fleet::of_text(composite).run(1, HOUR), 4, "without a world");
}

#[test]
fn robots_may_come_before_their_world() {
    let pair = pair();
    let world = world(&pair);
    let moved = with(&with(&pair, world, ""), "</composite>", &format!("{world}</composite>"));
    assert_delivered(&Fleet::of_text(moved).run(1, HOUR), 4, "the world comes last");
}

#[test]
fn moves_and_handling_may_take_several_periods() {
    let size = r#"<property name="width">11</property>"#;
    let times = r#"<property name="moveTime">250ms</property><property name="handlingTime">1s</property>"#;
    let slow = with(&pair(), size, &format!("{size}{times}"));
    let slow = with(&slow, r#"<property name="period" source="$period"/>"#, r#"<property name="period">50</property>"#);
    let slow = with(
        &slow,
        r#"<reference name="world""#,
        r#"<property name="discharge">0.2</property><reference name="world""#,
    );
    assert_delivered(&Fleet::of_text(slow).run(1, HOUR), 4, "slow hardware");
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let run = |seed| Fleet::of_text(pair()).run(seed, HOUR);
    assert_eq!(run(7).trace_hash, run(7).trace_hash);
    assert!(run(7).trace_hash.is_some());
}

/// The manual's rules and periods, for the scenario of its section 8.2.
fn classic(pair: &str) -> String {
    let robots = pair.matches(r#"<reference name="world""#).count();
    assert_eq!(robots, 2);
    let classic = r#"<property name="policy">classic</property><reference name="world""#;
    with(pair, r#"<reference name="world""#, classic)
}

#[test]
fn the_classic_rules_deliver_and_collide_once_as_in_figure_8_19() {
    // Ten times as fast as the manual's robots, and so are its masters.
    let mut composite = classic(&pair());
    for component in ["World", "MasterEnvironment", "MasterRobot", "Environment"] {
        let id = format!(r#"<property name="ID">{component}</property>"#);
        let old = format!("{id}\n    <property name=\"period\" source=\"$period\"/>");
        composite = with(&composite, &old, &format!(r#"{id}<property name="period">50</property>"#));
    }
    let report = Fleet::of_text(composite).run(1, HOUR);
    assert_eq!(report.outcome.status, RunStatus::Done, "{:?}", report.outcome);
    assert_eq!(
        section(&report, "luggage"),
        &json!({"requested": 4, "delivered": 4, "open": 0, "given_up": 0, "ignored": 0})
    );
    assert_eq!(section(&report, "collisions"), &json!({"vertex": 1, "swap": 0}));
    // The last piece is deposited in the 51st execution of the first robot, and the run ends when the environment hears
    // of it.
    assert_eq!(report.time_s, 5.15);
}

#[test]
fn two_robots_cannot_start_on_one_block() {
    let same = with(
        &pair(),
        r#"class="robot.Robot002"/>"#,
        r#"class="robot.Robot002"/><property name="chargeY">1</property>"#,
    );
    let found = Fleet::of_text(same).diagnostics();
    assert!(found.contains("error S5003") && found.contains("robots 1 and 2 both start at (0,1)"), "{found}");
}

#[test]
fn a_wrong_scenario_is_found_before_anything_runs() {
    let wrong = with(&pair(), "then 100ms luggage (1,5) to (10,5)", "then 100ms luggage (1,5) to");
    let found = Fleet::of_text(wrong).diagnostics();
    let expected =
        "error S3014 38:34 component `Environment`: property `scenario`: found the end of the line, expected a block";
    assert!(found.starts_with(expected), "{found}");
}

#[test]
fn the_navigator_drives_the_robot_of_figure_3_2_home() {
    let path = root().join("composites/manual/robotenvironment-wired.composite");
    let report = Fleet::of_file(path).run(1, HOUR);
    assert_eq!(report.outcome.status, RunStatus::Done);
    // Four sides of two metres, a metre in each period from the start on.
    assert_eq!(report.time_s, 0.7);
}

/// Robots in two corners of a hall that is larger than their hearing.
fn large_hall(scenario: &str) -> Fleet {
    let component = |name: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{name}"><implementation.rust class="saoms.{class}"/>
            <property name="ID">{name}</property><property name="period">100</property>{more}</component>"#
        )
    };
    let property = |name: &str, value: &str| format!(r#"<property name="{name}">{value}</property>"#);
    let mut text = component("World", "World", &(property("width", "150") + &property("height", "50")));
    text += &component("Master", "MasterEnvironment", "");
    text += &component("Environment", "Environment", &property("scenario", scenario));
    for robot in 1..=12 {
        let (x, y) = if robot <= 6 { (robot, robot % 2) } else { (149 - robot, 48 + robot % 2) };
        let place = property("chargeX", &x.to_string()) + &property("chargeY", &y.to_string());
        let battery = property("dischargePerBlock", "0.1") + &property("chargePerSecond", "4");
        let wire = r#"<reference name="world" target="World"/>"#;
        text += &component(&format!("Robot{robot}"), "Robot", &format!("{place}{battery}{wire}"));
    }
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">{text}</composite>"#
    ))
}

#[test]
fn robots_on_a_large_map_hear_positions_around_them_alone() {
    let run = large_hall("from 1s every 2s 30 times luggage (1,3)..(20,20) to (1,3)..(20,20)").run(1, HOUR);
    assert_delivered(&run, 30, "one corner");
    let received = |name: &str| run.components.iter().find(|one| one.name == name).unwrap().messages.received;
    // What is said about luggage and robots is heard everywhere.
    assert!(received("Robot12") * 2 < received("Robot1"), "{} and {}", received("Robot12"), received("Robot1"));
}

#[test]
fn robots_that_meet_far_from_where_they_started_make_way_for_each_other() {
    let across = "from 1s every 1s 30 times luggage (0,20)..(20,30) to (130,20)..(149,30); \
                  from 1s every 1s 30 times luggage (130,20)..(149,30) to (0,20)..(20,30); at 30s breakdown Robot3";
    for seed in 0..4 {
        assert_delivered(&large_hall(across).run(seed, HOUR), 60, &format!("seed {seed}"));
    }
}
