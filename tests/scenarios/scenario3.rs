//! The manual's section 8.3: scenario 2 after a landing.

use crate::run::Run;
use crate::scenario2::{FIRST, SECOND};

#[test]
fn the_landing_changes_nothing_where_all_robots_are_awake() {
    let run = Run::of("scenario3.composite", 200);
    assert_eq!(run.story("Robot001"), FIRST);
    assert_eq!(run.story("Robot002"), SECOND);
    assert_eq!(run.count("luggage", "delivered"), 4);
}

#[test]
fn the_master_hears_of_the_landing_in_the_period_of_figure_8_18() {
    let run = Run::of("scenario3.composite", 200);
    let console = run.console();
    let place = |start: &str| {
        console.iter().position(|line| line.starts_with(start)).unwrap_or_else(|| panic!("no line `{start}`"))
    };
    let landing = place("Environment: Test1: New event: LANDING with 4 expected pieces of luggage.");
    let master = place("MasterEnvironmentManagingSystem: new event received and managed at ");
    let robot =
        place("MasterRobotManagingSystem updated active robot list: [Robot1 is active, Robot2 is active]");
    assert!(landing < place("Execution 3 of Robot001 ") && place("Execution 3 of Robot001 ") < master);
    assert!(master < robot && robot < place("Execution 4 of Robot001 "));
}
