//! Robots that somebody takes off the floor.

use std::time::Duration;

use saoms_testkit::{Fleet, Run};
use serde_json::{Value, json};

const LIMIT: Duration = Duration::from_secs(2000);
const WORLD: &str = r#"<reference name="world" target="World"/>"#;

fn component(id: &str, class: &str, more: &str) -> String {
    format!(
        r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">100</property>{more}</component>
"#
    )
}

fn property(name: &str, value: &str) -> String {
    format!(r#"<property name="{name}">{value}</property>"#)
}

/// Robots with this policy, with a world or without, and a scenario. A robot that is named in `more` has more.
fn fleet(scenario: &str, policy: &str, has_world: bool, more: &[(&str, &str)]) -> Fleet {
    fleet_with("", scenario, policy, has_world, more)
}

/// The same with another component.
fn fleet_with(other: &str, scenario: &str, policy: &str, has_world: bool, more: &[(&str, &str)]) -> Fleet {
    let world = if has_world { WORLD } else { "" };
    let mut components = other.to_owned();
    if has_world {
        components += &component("World", "World", &property("moveTime", "150ms"));
    }
    components += &component("Master", "MasterEnvironment", "");
    components += &component("MasterRobot", "MasterRobot", "");
    components += &component("Environment", "Environment", &property("scenario", scenario));
    for robot in ["Robot1", "Robot2", "Robot3"] {
        let own = more.iter().find(|(name, _)| *name == robot).map_or("", |(_, more)| more);
        let all = [world, own, &property("policy", policy), &property("discharge", "0.1")].concat();
        components += &component(robot, "Robot", &all);
    }
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{components}</composite>"#
    ))
}

/// All luggage is delivered, nothing is given up, and the robot is gone.
#[track_caller]
fn assert_delivered(run: &Run, pieces: u64, context: &str) {
    let luggage = &run.sections["luggage"];
    assert_eq!(luggage["delivered"], pieces, "{context}: {:#}", json!(run.sections));
    assert_eq!(luggage.get("given_up").unwrap_or(&json!(0)), 0, "{context}");
}

fn state(run: &Run, robot: &str) -> Value {
    run.sections["robots"]["by_path"][robot]["state"].clone()
}

#[test]
fn luggage_of_a_robot_that_is_gone_is_brought_by_others_whenever_it_goes() {
    for tenths in (5..90).step_by(4).chain(15..40) {
        let scenario = format!(
            "at 0.5s luggage (2,2) to (8,2); at 0.5s luggage (2,3) to (8,3); at 0.5s luggage (2,1) to (8,1);
             at {}.{}s gone Robot2; at 15s end",
            tenths / 10,
            tenths % 10
        );
        for seed in 0..3 {
            let run = fleet(&scenario, "safe", true, &[]).run(seed, LIMIT);
            let context = format!("gone at {tenths} tenths of a second, seed {seed}");
            assert_delivered(&run, 3, &context);
            assert_eq!(run.sections["robots"]["gone"], 1, "{context}");
            assert_eq!(state(&run, "Robot2"), "gone", "{context}");
            assert_eq!(run.sections["collisions"], json!({"vertex": 0, "swap": 0}), "{context}");
            assert_eq!(run.sections.get("messages"), None, "{context}: none is ignored");
        }
    }
}

#[test]
fn robots_of_the_manual_and_those_without_a_world_bring_it_as_well() {
    for (policy, has_world) in [("classic", true), ("classic", false), ("safe", false)] {
        for tenths in (5..60).step_by(7) {
            let scenario = format!(
                "at 0.5s luggage (2,2) to (8,2); then 1s luggage (2,3) to (8,3); then 1s luggage (2,1) to (8,1);
                 at {}.{}s gone 2; at 15s end",
                tenths / 10,
                tenths % 10
            );
            let run = fleet(&scenario, policy, has_world, &[]).run(1, LIMIT);
            let context = format!("{policy}, world {has_world}, gone at {tenths} tenths of a second");
            assert_delivered(&run, 3, &context);
            assert_eq!(state(&run, "Robot2"), "gone", "{context}");
        }
    }
}

#[test]
fn its_block_is_free() {
    // Nobody gets around the robot in a corridor of one block.
    let map = property("map", "@@@@@@@@@&#10;.........&#10;@@@@@@@@@");
    let scenario = "at 0.5s luggage (4,1) to (8,1); at 4s gone Robot1; at 5s luggage (3,1) to (8,1)";
    let start = |x: &str| property("chargeX", x) + &property("chargeY", "1");
    let (first, second) = (start("2"), start("1"));
    let fleet = Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{}{}{}{}{}</composite>"#,
        component("World", "World", &map),
        component("Master", "MasterEnvironment", ""),
        component("Environment", "Environment", &property("scenario", scenario)),
        component("Robot1", "Robot", &[WORLD, &first, &property("discharge", "0.1")].concat()),
        component("Robot2", "Robot", &[WORLD, &second, &property("discharge", "0.1")].concat()),
    ));
    let run = fleet.run(1, LIMIT);
    assert_delivered(&run, 2, "corridor");
    assert_eq!(state(&run, "Robot1"), "gone");
}

#[test]
fn a_broken_robot_leaves_its_job_and_then_the_floor() {
    for between in ["100ms", "400ms", "2s"] {
        let scenario =
            format!("at 0.5s luggage (2,2) to (8,2); at 1500ms breakdown 2; then {between} gone 2; at 20s end");
        let run = fleet(&scenario, "safe", true, &[]).run(1, LIMIT);
        assert_delivered(&run, 1, between);
        let robots = &run.sections["robots"];
        assert_eq!((&robots["broken"], &robots["gone"]), (&json!(1), &json!(1)), "{between}");
        assert_eq!(state(&run, "Robot2"), "gone");
    }
}

#[test]
fn a_robot_that_nobody_knows_is_told_once() {
    let fleet = fleet("at 0.5s luggage (2,2) to (8,2); at 3s gone 99; at 9s end", "safe", true, &[]);
    let run = fleet.with_severity("S5005", "warning").run(1, LIMIT);
    assert_delivered(&run, 1, "unknown");
    assert_eq!(run.sections["faults"]["ignored"], 1);
    assert_eq!(run.sections.get("messages"), None, "the world says nothing of it");
}

#[test]
fn a_robot_that_has_failed_is_gone_for_the_others() {
    let scenario = "at 0.5s luggage (2,2) to (8,2); at 8s gone 2; at 9s luggage (2,3) to (8,3); at 20s end";
    let run = fleet(scenario, "safe", true, &[]).fail("Robot2", Duration::from_millis(1500)).run(1, LIMIT);
    assert_delivered(&run, 2, "failed");
    assert_eq!(run.sections["robots"]["gone"], 1);
}

#[test]
fn a_robot_that_comes_back_starts_anew() {
    // A shift starts it again.
    let tasks = r#"<reference name="tasks" target="Robot2/TaskInterface"/>"#;
    let shift = [&property("start", "12s"), &property("work", "100s"), &property("shifts", "1"), tasks].concat();
    let shift = component("Shift", "Shift", &shift);
    for policy in ["safe", "classic"] {
        let scenario = "at 0.5s luggage (2,2) to (8,2); at 1.5s gone Robot2; at 20s luggage (1,2) to (8,3); at 40s end";
        let run = fleet_with(&shift, scenario, policy, true, &[]).run(1, LIMIT);
        assert_delivered(&run, 2, policy);
        let robots = &run.sections["robots"];
        assert_eq!(robots["active"], 3, "{policy}");
        // By the manual's rules the first one to hear of it goes.
        let delivered = &robots["by_path"]["Robot2"]["delivered"];
        assert_eq!(*delivered, u64::from(policy == "safe"), "{policy}: it is the closest one");
        assert_eq!(state(&run, "Robot2"), "free", "{policy}");
        assert_eq!(run.sections["collisions"], json!({"vertex": 0, "swap": 0}), "{policy}");
    }
}

#[test]
fn what_it_left_is_asked_again_if_the_answer_or_the_news_is_lost() {
    let lost = ["REMOVALTOPIC", "ETOPIC to World"];
    for lost in lost {
        let scenario = format!(
            "at 0.5s luggage (2,2) to (8,2); at 0.5s luggage (2,3) to (8,3); at 0.5s luggage (2,1) to (8,1);
             at 1s for 5s violate 100 % on {lost}; at 2s gone Robot2; at 15s end"
        );
        let run = fleet(&scenario, "safe", true, &[]).run(1, LIMIT);
        assert_delivered(&run, 3, lost);
        assert_eq!(run.sections["robots"]["gone"], 1, "{lost}");
        assert_eq!(run.sections["collisions"], json!({"vertex": 0, "swap": 0}), "{lost}");
    }
}

#[test]
fn a_run_whose_world_is_never_heard_says_what_it_waits_for() {
    let scenario = "at 0.5s luggage (2,2) to (8,2); at 0.5s luggage (2,3) to (8,3); at 0.5s luggage (2,1) to (8,1);
        at 1s violate 100 % on REMOVALTOPIC; at 2s gone Robot2";
    let log = fleet(scenario, "safe", true, &[]).run(1, Duration::from_secs(60)).log();
    assert!(log.contains("waits for the world to say what robot 2 left, and where"), "{log}");
}
