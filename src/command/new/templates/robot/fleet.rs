//! The fleet of this folder, in virtual time.

use std::time::Duration;

use my_plugin as _;
use saoms_testkit::Fleet;

#[test]
fn the_robot_brings_its_luggage() {
    let run = Fleet::of_file("fleet.composite").run(0, Duration::from_secs(60));
    assert!(run.log_of("Robot1").iter().any(|line| line == "deposited luggage 1 at (3,4)"), "{}", run.log());
}
