//! The fleet of this folder, run by the installed `saoms` in virtual time.

use std::time::Duration;

use saoms_testkit::Installed;

#[test]
fn the_fleet_counts() {
    let run = Installed::fleet("fleet.composite").run(0, Duration::from_secs(1));
    assert_eq!(run.log_of("Counter")[1], "counts to 4");
}
