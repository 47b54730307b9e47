//! Robots that are started while others drive.

use std::time::Duration;

use saoms_testkit::Fleet;

use super::apart::{component, delivered, robot, site, zones};

/// Two robots, of which the first one is started by shifts that begin at these times, in tenths of a second.
fn crossing(shifts: &[u32], scenario: &str, zone_count: u32) -> Fleet {
    let world = [("map", "..........\n..........".to_owned()), ("moveTime", "500ms".to_owned())];
    let late = robot(1, 5, 0).replace("</component>", r#"<property name="runOnStartup">false</property></component>"#);
    let mut robots = late + &robot(2, 0, 0);
    for (shift, tenths) in (1..).zip(shifts) {
        let properties = [("start", tenths * 100), ("work", 100_000), ("shifts", 1)];
        let shift =
            component(&format!("Shift{shift}"), "Shift", &properties.map(|(name, value)| (name, value.to_string())));
        robots +=
            &shift.replace("</component>", r#"<reference name="tasks" target="Robot1/TaskInterface"/></component>"#);
    }
    site(&world, &zones(zone_count, 10 / zone_count), &robots, scenario)
}

/// The other one drives over the block where it is started, or rests there.
#[test]
fn a_robot_that_is_started_late_enters_a_block_that_is_granted_to_nobody() {
    let limit = Duration::from_secs(90);
    for tenths in (10..60).step_by(2) {
        for (zones, goal) in [(1, "(9,0)"), (2, "(5,0)")] {
            let scenario = format!("at 1s luggage (1,0) to (9,0)\nat 1s visit {goal} by Robot2");
            let fleet = crossing(&[tenths], &scenario, zones);
            let run = fleet.run(1, limit);
            let context = format!("started after {tenths} tenths of a second: {}", run.log());
            assert_eq!((run.count("collisions.vertex"), delivered(&run)), (0, 1), "{context}");
            assert!(!run.log().contains("was granted"), "{context}");
            assert_eq!(fleet.violations(1, limit), "", "{context}");
        }
    }
}

/// One that broke does not make way: the robot that waits for its block names it, and enters once it is gone.
#[test]
fn a_robot_that_cannot_enter_names_the_one_on_its_block() {
    let scenario = "
        at 1s visit (5,0) by Robot2
        at 3.9s breakdown Robot2
        at 60s gone Robot2
        at 61s luggage (1,0) to (9,0)";
    let run = crossing(&[100], scenario, 1).run(1, Duration::from_secs(120));
    let said = "waits to enter the floor at (5,0), where robot 2 is";
    assert!(run.log_of("Robot1").iter().any(|line| line.contains(said)), "{}", run.log());
    assert_eq!((delivered(&run), run.count("collisions.vertex")), (1, 0), "{}", run.log());
}

/// Its body was taken off the floor: it comes back at its charger, over which another one drives.
#[test]
fn a_robot_that_was_gone_comes_back_onto_a_free_block() {
    let limit = Duration::from_secs(90);
    let scenario = "at 2s gone Robot1\nat 3s visit (9,0) by Robot2\nat 20s luggage (1,0) to (9,0)";
    for tenths in (30..80).step_by(3) {
        let fleet = crossing(&[1, tenths], scenario, 1);
        let run = fleet.run(1, limit);
        let context = format!("back after {tenths} tenths of a second: {}", run.log());
        assert_eq!((delivered(&run), run.count("collisions.vertex")), (1, 0), "{context}");
        assert_eq!(fleet.violations(1, limit), "", "{context}");
    }
}

/// Faults are said for a robot when the run begins, before it stands on the floor.
#[test]
fn a_robot_that_is_not_on_the_floor_yet_is_slow_once_it_enters() {
    let scenario = "at 0s slow robot=1 factor=3; at 0s slow robot=2 factor=2; at 6s luggage (1,0) to (9,0)";
    let run = crossing(&[50], scenario, 1).run(1, Duration::from_secs(120));
    let log = run.log_of("World");
    for said in ["robot 1 takes 3 times as long", "robot 2 takes 2 times as long"] {
        assert!(log.iter().any(|line| line.contains(said)), "{said}: {}", run.log());
    }
    assert_eq!((delivered(&run), run.count("faults.applied.slow"), run.count("faults.ignored")), (1, 2, 0));
}
