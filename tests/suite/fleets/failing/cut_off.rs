//! Robots that fail in the only way of others.

use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::{Fleet, Run};

/// Two rooms and a door between them. Robot 1 starts on this block; robot 2 fails in the door two seconds after its
/// start.
fn run(has_zone: bool, assignment: &str, start: (&str, &str), crash: &str, scenario: &str) -> Run {
    let mut text = String::new();
    let mut add = |class: &str, id: &str, properties: &[(&str, &str)]| {
        let reference = match class {
            "Robot" | "Zone" => r#"<reference name="world" target="World"/>"#,
            _ => "",
        };
        let values = properties.iter().map(|(name, value)| format!(r#"<property name="{name}">{value}</property>"#));
        text += &format!(
            r#"<component name="{id}"><implementation.rust class="saoms.{class}"/><property name="ID">{id}</property>
            <property name="period">100</property>{}{reference}</component>"#,
            values.collect::<String>()
        );
    };
    add("World", "World", &[("map", "\n...@...\n.......\n...@...\n"), ("moveTime", "300")]);
    if has_zone {
        add("Zone", "Zone", &[]);
    }
    add("MasterEnvironment", "Master", &[("assignment", assignment)]);
    // Where there is a zone, the world has the robot from 200 ms on.
    let slow = "at 0s slow robot=2 factor=1000 lasting=3s; at 300ms slow robot=2 factor=1000 lasting=3s";
    let scenario = format!("{slow}; at 2s crash Robot2{crash}; {scenario}");
    add("Environment", "Environment", &[("scenario", &scenario)]);
    for (id, charger, start) in
        [("Robot1", ("0", "0"), start), ("Robot2", ("6", "2"), ("3", "1")), ("Robot3", ("6", "0"), ("5", "0"))]
    {
        let [x, y, start_x, start_y] = [charger.0, charger.1, start.0, start.1];
        let places = [("chargeX", x), ("chargeY", y), ("startX", start_x), ("startY", start_y)];
        add("Robot", id, &[&places[..], &[("discharge", "0.01")]].concat());
    }
    let fleet = Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{text}</composite>"#
    ));
    fleet.run(1, Duration::from_secs(600))
}

#[test]
fn nobody_gives_up_luggage_because_of_a_robot_that_starts_again() {
    // The first two pieces are taken when the door closes, the others wait since.
    let scenario = "at 100ms luggage (0,1) to (6,1); at 100ms luggage (5,1) to (0,2); \
        at 4s luggage (1,1) to (5,2); at 4s luggage (5,0) to (2,2)";
    for (has_zone, assignment) in [(false, "robots"), (true, "robots"), (true, "oldest"), (true, "optimal")] {
        let run = run(has_zone, assignment, ("1", "0"), " restart 20s", scenario);
        let which = format!("zone {has_zone}, {assignment}: {}", run.log());
        assert_eq!(run.outcome.status, RunStatus::Done, "{which}");
        assert_eq!(run.sections["luggage"]["delivered"], 4, "{which}");
        assert!(!which.contains("cannot carry"), "{which}");
    }
}

#[test]
fn luggage_behind_a_robot_that_does_not_start_again_is_given_up() {
    for has_zone in [false, true] {
        let run =
            run(has_zone, "robots", ("1", "0"), "", "at 100ms luggage (0,1) to (6,1); at 4s luggage (1,1) to (5,2)");
        let log = run.log();
        assert_eq!(run.sections["luggage"]["given_up"], 2, "zone {has_zone}: {log}");
    }
}

#[test]
fn a_robot_that_is_cut_off_from_its_charger_for_now_comes_back_to_it() {
    // Robot 1 is in the other room when the door closes.
    for has_zone in [false, true] {
        let run = run(has_zone, "robots", ("5", "1"), " restart 20s", "at 30s luggage (5,1) to (5,2)");
        let log = run.log_of("Robot1").join("\n");
        assert!(log.contains("charges at (6,2) until") && log.contains("charges at (0,0) again"), "{log}");
    }
}
