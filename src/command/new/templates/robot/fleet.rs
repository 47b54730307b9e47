//! The fleet of this folder, run by the installed `saoms` in virtual time.

use std::time::Duration;

use saoms_testkit::Installed;

#[test]
fn the_robot_brings_its_luggage() {
    let run = Installed::fleet("fleet.composite").run(0, Duration::from_secs(60));
    assert!(run.log_of("Robot1").contains(&"deposited luggage 1 at (3,4)"), "{}", run.log());
}
