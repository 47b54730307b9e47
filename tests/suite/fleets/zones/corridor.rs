//! A corridor in which no robot gets past another one, and the map of its zone.

use std::time::Duration;

use saoms_testkit::Fleet;

use super::apart::{component, robot, site};

/// A fleet of two robots in a corridor; the zone has this map of its own or wire.
fn corridor_with(zone: &str, luggage: &str) -> Fleet {
    corridor_of(zone, "0", luggage)
}

/// The same where a move takes this time.
fn corridor_of(zone: &str, move_time: &str, luggage: &str) -> Fleet {
    let map = [("map", "........".to_owned()), ("moveTime", move_time.to_owned())];
    let zone = component("Zone1", "Zone", &[]).replace(r#"<reference name="world" target="World"/>"#, zone);
    let robots = robot(1, 0, 0) + &robot(2, 7, 0);
    site(&map, &zone, &robots, luggage)
}

const WIRE: &str = r#"<reference name="world" target="World"/>"#;

/// Luggage from each end of the corridor to the other one.
const CROSSWISE: &str = "at 1s luggage (1,0) to (7,0); at 1s luggage (6,0) to (0,0)";

/// When the zone names the robots, in seconds.
pub(super) fn named(fleet: &Fleet, limit: u64) -> f64 {
    let log = fleet.run(1, Duration::from_secs(limit)).log();
    let line = log.lines().find(|line| line.contains("are in each other's way, and cannot get past"));
    let line = line.unwrap_or_else(|| panic!("{log}"));
    line.strip_prefix('[').and_then(|line| line.split_once(" s]")).unwrap().0.trim().parse().unwrap()
}

/// Each one pushes the other one back, so that only one of them is served.
#[test]
fn robots_with_luggage_for_each_others_end_of_a_corridor_are_named_soon() {
    // Luggage comes at 1 s, and they meet in 8 periods; a deadlock is named within 50.
    let time = named(&corridor_with(WIRE, CROSSWISE), 30);
    assert!(time <= 1.0 + 0.8 + 5.0, "{time}");
}

#[test]
fn robots_with_slow_moves_are_named_within_50_of_them() {
    // A move takes ten periods, and they meet after four moves.
    let time = named(&corridor_of(WIRE, "1s", CROSSWISE), 120);
    assert!(time > 1.0 + 4.0 + 10.0 && time <= 1.0 + 8.0 + 50.0, "{time}");
}

#[test]
fn a_zone_without_a_map_or_with_another_one_than_the_world_is_refused() {
    let found = |zone: &str| corridor_with(zone, "at 1s luggage (1,0) to (2,0)").diagnostics();
    let map = |map: &str| format!(r#"<property name="map">{map}</property>"#);
    for (zone, expected) in [
        (WIRE.to_owned(), ""),
        (map("........"), ""),
        (String::new(), "the zone has no map"),
        (map("......."), "the map of the zone is not that of `World`: it has 7 x 1 blocks, and that one 8 x 1"),
        (map("...@...."), "the map of the zone is not that of `World`: (3,0) is blocked here, and free there"),
    ] {
        let found = found(&zone);
        assert!(found.contains(expected) && found.contains("S5023") != expected.is_empty(), "{zone}: {found}");
    }
    let nowhere = found(r#"<reference name="world" target="Wrld"/>"#);
    assert!(nowhere.contains("S2011") && !nowhere.contains("S5023"), "{nowhere}");
}
