//! The fleet of this folder, run by the installed `saoms` in virtual time.

use std::time::Duration;

use saoms_testkit::Installed;

#[test]
fn the_robot_charges_early() {
    let run = Installed::fleet("fleet.composite").run(0, Duration::from_secs(60));
    assert!(run.journal_of("Robot1").contains(&"lets it charge at 90 %"), "{}", run.log());
    assert!(run.log_of("Robot1").iter().any(|line| line.contains("goes to charge")), "{}", run.log());
}
