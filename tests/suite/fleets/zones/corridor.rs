//! A corridor in which no robot gets past another one, and the map of its zone.

use std::time::Duration;

use saoms_testkit::Fleet;

use super::apart::{component, robot, site};

/// A fleet of two robots in a corridor; the zone has this map of its own or wire.
fn corridor_with(zone: &str, luggage: &str) -> Fleet {
    let map = [("map", "........".to_owned()), ("moveTime", "0".to_owned())];
    let zone = component("Zone1", "Zone", &[]).replace(r#"<reference name="world" target="World"/>"#, zone);
    let robots = robot(1, 0, 0) + &robot(2, 7, 0);
    site(&map, &zone, &robots, luggage)
}

const WIRE: &str = r#"<reference name="world" target="World"/>"#;

/// Each one pushes the other one back, so that only one of them is served.
#[test]
fn robots_with_luggage_for_each_others_end_of_a_corridor_are_named_soon() {
    let run = corridor_with(WIRE, "at 1s luggage (1,0) to (7,0); at 1s luggage (6,0) to (0,0)")
        .run(1, Duration::from_secs(30));
    let log = run.log_of("Zone1").join("\n");
    assert!(log.contains("are in each other's way, and cannot get past"), "{log}\n{}", run.log());
    // Luggage comes at 1 s, and they meet in 8 periods; a deadlock is named within 50.
    let all = run.log();
    let named = all.lines().find(|line| line.contains("are in each other's way")).unwrap();
    let time: f64 = named.strip_prefix('[').and_then(|line| line.split_once(" s]")).unwrap().0.trim().parse().unwrap();
    assert!(time <= 1.0 + 0.8 + 5.0, "{all}");
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
