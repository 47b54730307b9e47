//! The fleet of this folder, in virtual time.

use std::time::Duration;

use my_plugin as _;
use saoms_testkit::Fleet;

#[test]
fn the_robot_charges_early() {
    let run = Fleet::of_file("fleet.composite").run(0, Duration::from_secs(60));
    let decisions = run.journal().of("Robot1").decisions();
    assert!(decisions.with("lets it charge at 90 %").last().is_some());
    assert!(run.log_of("Robot1").iter().any(|line| line.contains("goes to charge")), "{}", run.log());
}
