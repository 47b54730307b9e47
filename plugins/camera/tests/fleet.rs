//! A robot with a camera among others, with the plugin's code linked in.

use std::time::Duration;

use saoms_camera as _;
use saoms_testkit::Fleet;

#[test]
fn a_robot_with_a_camera_works_as_any_robot() {
    let fleet = Fleet::of_file("fleet.composite");
    assert_eq!(fleet.diagnostics(), "");
    let run = fleet.run(1, Duration::from_secs(60));
    let report = &run.sections;
    assert_eq!(report["luggage"]["delivered"], 2, "{}", run.log());
    for robot in ["Robot1", "Robot2"] {
        assert!(run.log_of(robot).iter().any(|line| line.starts_with("deposited luggage")), "{}", run.log());
    }
    let pictures = report["camera"]["pictures"].as_u64();
    assert!(pictures > Some(20), "{report:?}");
    assert!(run.log_of("Viewer").iter().any(|line| line.starts_with("sees 1 other robots from robot 1")));
    // Its loops are those of the robot, and write to the journal.
    assert!(run.journal().of("Robot1").of_loop("EventLuggageMS").texts().len() > 2);
}

#[test]
fn the_robot_of_the_manual_has_its_number_and_its_charger() {
    let text = std::fs::read_to_string("fleet.composite").unwrap();
    let text =
        text.replace("implementation.rust class=\"camera.Robot\"", "implementation.java class=\"robot.Robot999\"");
    let run = Fleet::of_text(text.replace("value=\"Robot1\"", "value=\"Robot999\"")).run(1, Duration::from_secs(60));
    assert_eq!(run.sections["luggage"]["delivered"], 2, "{}", run.log());
    let seen = run.log_of("Viewer");
    assert!(seen[0].ends_with("from robot 999 at (0,1)"), "{seen:?}");
}

#[test]
fn rules_over_fleets_take_it_for_a_robot() {
    let text = std::fs::read_to_string("fleet.composite").unwrap();
    let found = Fleet::of_text(text.replace("value=\"Robot2\"", "value=\"Other1\"")).diagnostics();
    assert!(found.contains("both have the number 1"), "{found}");
    let text = text.replace("at 1s luggage (3,1)", "at 1s breakdown 7").replace(" to (8,2)", "");
    let found = Fleet::of_text(text).diagnostics();
    assert!(found.contains("error S5005") && found.contains("the fleet has no robot 7"), "{found}");
}

#[test]
fn composites_change_its_loops_as_those_of_a_robot() {
    let text = std::fs::read_to_string("fleet.composite").unwrap();
    let robot = text.replace(
        "<property name=\"reach\" value=\"3\"/>",
        "<saoms:loop xmlns:saoms=\"urn:saoms:1\" name=\"GripperMS\" remove=\"true\"/><property name=\"policy\" value=\"safe\"/>",
    );
    let run = Fleet::of_text(robot).run(1, Duration::from_secs(60));
    assert!(run.log_of("Robot1").iter().all(|line| !line.starts_with("collected")), "{}", run.log());
}
