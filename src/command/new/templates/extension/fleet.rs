//! The fleet of this folder, run by the installed `saoms` in virtual time.

use std::time::Duration;

use saoms_testkit::Installed;

#[test]
fn the_robot_brings_its_luggage_and_tells_its_way() {
    let run = Installed::fleet("fleet.composite").run(0, Duration::from_secs(60));
    let log = run.log_of("Robot1");
    assert!(log.contains(&"deposited luggage 1 at (3,10)"), "{}", run.log());
    assert!(log.contains(&"has driven 8 blocks"), "{}", run.log());
}
