//! Fires in a fleet, with the plugin's code linked in.

use std::time::Duration;

use saoms_sprinkler as _;
use saoms_testkit::{Fleet, comply};

const FLEET: &str = include_str!("../fleet.composite");

/// The fleet with another scenario.
fn fleet(scenario: &str) -> Fleet {
    let place = |text: &str| FLEET.find(text).unwrap_or(FLEET.len());
    let (start, end) = (place("at 2s fire"), place("</property>\n  </component>\n  <component name=\"Hall1\""));
    Fleet::of_text(format!("{}{scenario}{}", &FLEET[..start], &FLEET[end..]))
}

#[test]
fn fires_reach_the_hall_that_they_are_for() {
    let fleet = Fleet::of_file("fleet.composite");
    assert_eq!(fleet.diagnostics(), "");
    let run = fleet.run(1, Duration::from_secs(60));
    assert_eq!(run.log_of("Hall1"), ["the fire at (3,4) is out"]);
    assert_eq!(run.log_of("Hall2").len(), 3, "{}", run.log());
    assert_eq!(run.sections["fires"]["out"], 4, "{}", run.log());
}

#[test]
fn a_fire_for_nobody_alone_reaches_both_halls() {
    let run = fleet("at 2s fire at=(1,1) size=1; then 3s end").run(1, Duration::from_secs(60));
    assert_eq!(run.sections["fires"]["noticed"], 2, "{}", run.log());
}

#[test]
fn a_wrong_fire_is_refused_at_its_place() {
    let wrong = |line: &str| fleet(line).diagnostics();
    let told = wrong("at 2s fier at=(1,1) size=1");
    assert!(told.contains("found `fier`"), "{told}");
    let told = wrong("at 2s fire at=(1,1) size=1 fule=OIL");
    assert!(told.contains("event `fire` has no field `fule`"), "{told}");
    let told = wrong("at 2s fire at=(1,1) size=1 to Hal2");
    assert!(told.contains("no component `Hal2` takes the event `fire`"), "{told}");
}

/// A hall with a map of 10 by 10 blocks.
#[test]
fn a_fire_outside_the_map_is_told_before_the_run() {
    let world = "<component name=\"World\"><implementation.rust class=\"saoms.World\"/>\
                 <property name=\"ID\" value=\"World\"/><property name=\"period\" value=\"500ms\"/>\
                 <property name=\"width\" value=\"10\"/><property name=\"height\" value=\"10\"/></component>";
    let with_world = |scenario: &str| {
        let text = FLEET.replace("</composite>", &format!("{world}</composite>"));
        let (before, rest) = text.split_once("at 2s fire").unwrap();
        let after = &rest[rest.find("</property>").unwrap()..];
        Fleet::of_text(format!("{before}{scenario}{after}")).diagnostics()
    };
    let told = with_world("at 2s fire at=(10,4) size=2; then 1s fire at=(0,0)..(9,12) size=1 to Hall2");
    let outside = "this block is outside the map, which goes from (0,0) to (9,9)";
    for (place, block) in [("8:21", "(10,4)"), ("8:59", "(9,12)")] {
        let expected = format!("warning S5001 {place} the event `fire` is at {block}: {outside}");
        assert!(told.contains(&expected), "{expected} is missing in\n{told}");
    }
    let told = with_world("at 2s fire at=(9,9) size=2; then 1s fire at=(0,0)..(9,9) size=1 to Hall2");
    assert!(!told.contains("S5001"), "{told}");
}

#[test]
fn a_hall_keeps_what_every_component_keeps() {
    comply::<saoms_sprinkler::Hall>(&[]);
}
