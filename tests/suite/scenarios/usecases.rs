//! The use cases of the manual's chapter 7, and its stress test, by the default policy: what has to have happened in
//! the end, and in which order.

use super::run::Run;

/// Runs a composite until all is delivered and checks that no robot collided or was left without battery.
fn run(composite: &str, pieces: i64) -> Run {
    let run = Run::of(composite, 3600);
    let count = |section, name| run.count(section, name);
    assert_eq!((count("luggage", "requested"), count("luggage", "delivered")), (pieces, pieces), "{composite}");
    assert_eq!((count("collisions", "vertex"), count("collisions", "swap")), (0, 0), "{composite}");
    assert_eq!(run.report.sections["stranded"], 0, "{composite}");
    run
}

/// Checks that these lines of the log came in this order, perhaps with others between them; given as component and
/// text.
fn assert_order(run: &Run, expected: &[(&str, &str)]) {
    let mut log = run.whole_log();
    for (component, text) in expected {
        assert!(log.any(|line| line == (*component, *text)), "`{component}: {text}` does not come in its place");
    }
}

#[test]
fn the_closest_robot_brings_new_luggage_and_the_other_stays_available() {
    let run = run("usecase-luggage.composite", 2);
    assert_order(
        &run,
        &[
            ("Environment", "luggage 1 waits at (4,6) to go to (9,2)"),
            ("Robot006", "takes luggage 1 from (4,6) to (9,2)"),
            ("Robot003", "takes luggage 2 from (2,8) to (8,8)"),
        ],
    );
    // Both were interested in the first piece at once.
    let interested =
        |robot: &str| run.report.journal.of(robot).of_loop("EventLuggageMS").decisions().texts()[0].clone();
    assert_eq!(interested("Robot003"), interested("Robot006"));
}

#[test]
fn a_landing_awakes_robots_and_a_takeoff_does_too() {
    assert_order(
        &run("usecase-landing.composite", 5),
        &[
            ("MasterRobot", "wakes robots 3, 4 and 2"),
            ("Robot003", "wakes up"),
            ("MasterRobot", "sends robots 4, 3 and 2 to charge"),
            ("Robot003", "sleeps"),
            ("Environment", "an airplane takes off with 2 pieces of luggage"),
            ("MasterRobot", "wakes robot 4"),
            ("Robot004", "takes luggage 5 from (1,9) to (9,9)"),
        ],
    );
}

#[test]
fn a_healer_brings_what_a_broken_robot_carries() {
    assert_order(
        &run("usecase-breakdown.composite", 2),
        &[
            ("Robot001", "collected luggage 1 at (3,1)"),
            ("Robot001", "breaks down at (4,2) while carrying luggage: needs assistance"),
            ("Robot002", "takes over luggage 1 from robot 1"),
            ("Robot010", "wakes up"),
            ("Robot002", "collected luggage 1 at (4,2)"),
            ("Robot002", "deposited luggage 1 at (9,5)"),
        ],
    );
}

#[test]
fn a_robot_awakes_another_one() {
    assert_order(
        &run("usecase-awaking.composite", 1),
        &[
            ("Robot001", "breaks down at (0,1) while idle: needs assistance"),
            ("Robot002", "wakes robot 3 to stand in for robot 1"),
            ("Robot003", "wakes up"),
            ("Robot003", "deposited luggage 1 at (9,4)"),
        ],
    );
}

#[test]
fn the_stress_test_ends() {
    run("scenario4.composite", 100);
}
