//! A greeter, with the plugin's code linked in.

use std::time::Duration;

use saoms_hello as _;
use saoms_testkit::{Fleet, comply};

#[test]
fn it_greets_in_each_period() {
    let run = Fleet::of_file("fleet.composite").run(0, Duration::from_secs(3));
    assert_eq!(run.log_of("Greeter"), ["hello, fleet"; 3]);
}

#[test]
fn it_keeps_what_every_component_keeps() {
    comply::<saoms_hello::Greeter>(&[]);
}
