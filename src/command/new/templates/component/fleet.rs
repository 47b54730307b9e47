//! The fleet of this folder, in virtual time.

use std::time::Duration;

use my_plugin as _;
use saoms_testkit::Fleet;

#[test]
fn the_fleet_counts() {
    let run = Fleet::of_file("fleet.composite").run(0, Duration::from_secs(1));
    assert_eq!(run.log_of("Counter")[1], "counts to 4");
}
