//! The fleet of this folder, run by the installed `saoms` in virtual time.

use std::time::Duration;

use saoms_testkit::Installed;

#[test]
fn the_robot_brings_what_the_master_asks_for() {
    let run = Installed::fleet("fleet.composite").run(0, Duration::from_secs(60));
    assert!(run.log_of("Master").contains(&"asks for luggage 2"), "{}", run.log());
    assert!(run.log_of("Robot1").contains(&"deposited luggage 2 at (3,10)"), "{}", run.log());
}
