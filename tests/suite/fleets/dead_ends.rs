//! Sites on which the batteries suffice on paper: no robot is stranded, and all luggage is brought, also where chargers
//! and luggage are in dead ends.

use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::Fleet;

const HOUR: Duration = Duration::from_secs(3600);

fn property(name: &str, value: &str) -> String {
    format!(r#"<property name="{name}">{value}</property>"#)
}

fn component(id: &str, class: &str, more: &str) -> String {
    format!(
        r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">100ms</property>{more}</component>
"#
    )
}

/// A site with this map, and a robot for each digit on it, whose charger is there.
fn site(map: &str, has_zone: bool, robot: &str, scenario: &str) -> Fleet {
    let zone = component("Zone", "Zone", r#"<reference name="world" target="World"/>"#);
    site_with(map, if has_zone { &zone } else { "" }, robot, scenario)
}

/// The same with these zones.
fn site_with(map: &str, zones: &str, robot: &str, scenario: &str) -> Fleet {
    let world = r#"<reference name="world" target="World"/>"#;
    let free: String = map.chars().map(|sign| if sign.is_ascii_digit() { '.' } else { sign }).collect();
    let mut components = component("World", "World", &property("map", &free));
    components += zones;
    components += &component("Master", "MasterEnvironment", "");
    components += &component("Environment", "Environment", &property("scenario", scenario));
    for (row, line) in map.lines().enumerate() {
        for (column, sign) in line.chars().enumerate().filter(|(_, sign)| sign.is_ascii_digit()) {
            let charger = property("chargeX", &column.to_string()) + &property("chargeY", &row.to_string());
            components += &component(&format!("Robot{sign}"), "Robot", &[world, &charger, robot].concat());
        }
    }
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="s" targetNamespace="urn:s">
{components}</composite>"#
    ))
}

/// The check says nothing, and each run ends by itself with all luggage delivered and all invariants kept.
#[track_caller]
fn expect_all_brought(fleet: &Fleet, seeds: std::ops::Range<u64>) {
    assert_eq!(fleet.diagnostics(), "");
    for seed in seeds {
        assert_eq!(fleet.violations(seed, HOUR), "", "seed {seed}");
        let run = fleet.run(seed, HOUR);
        assert_eq!(run.outcome.status, RunStatus::Done, "seed {seed}: {:?}\n{}", run.outcome.reasons, run.log());
    }
}

/// A charger in a dead end, and one beside its mouth.
const MOUTH: &str = "@1@.....\n@.@.....\n2.......\n........\n.......3";

#[test]
fn luggage_is_brought_into_the_dead_end_where_another_robot_rests() {
    for has_zone in [false, true] {
        let scenario = "at 1s luggage (5,4) to (1,0); at 1s luggage (6,3) to (1,1); at 20s luggage (1,0) to (7,0)";
        expect_all_brought(&site(MOUTH, has_zone, "", scenario), 0..5);
    }
}

#[test]
fn a_robot_that_has_to_charge_lets_another_one_out_of_the_dead_end_with_its_charger() {
    // Who goes in is the more urgent one, and holds the mouth.
    let scenario = "at 1s luggage (7,4) to (7,2) ; from 1s every 1s..3s 12 times luggage (1,0)..(1,1) to (4,2)..(7,4)";
    expect_all_brought(&site(MOUTH, false, "", scenario), 0..8);
}

#[test]
fn robots_get_past_each_other_where_a_zone_ends_in_the_middle_of_a_dead_end() {
    let zone = |number: u32, rows: &str| {
        let world = r#"<reference name="world" target="World"/>"#;
        component(&format!("Zone{number}"), "Zone", &[&property("number", &number.to_string()), rows, world].concat())
    };
    let zones = zone(1, &property("height", "5")) + &zone(2, &property("y", "5"));
    let map = "1....2\n......\n@@.@@@\n@@.@@@\n@@.@@@\n@@.@@@\n@@.@@@\n@@.@@@";
    // Who goes in is often the more urgent one, and makes way over the edge for the one that comes out.
    let scenario = "from 1s every 2s..4s 60 times luggage (0,0)..(5,1) to (2,4)..(2,7); \
        from 1s every 2s..4s 60 times luggage (2,4)..(2,7) to (0,0)..(5,1)";
    let fleet = site_with(map, &zones, &property("discharge", "0"), scenario);
    for seed in 0..4 {
        assert_eq!(fleet.violations(seed, HOUR), "", "seed {seed}");
        let run = fleet.run(seed, HOUR);
        assert_eq!(run.outcome.status, RunStatus::Done, "seed {seed}: {:?}\n{}", run.outcome.reasons, run.log());
    }
}

#[test]
fn random_luggage_strands_nobody_on_sites_whose_batteries_suffice() {
    let maps = [
        "1......2\n..@@.@..\n..@.....\n.....@..\n.@......\n3.@....4",
        "..1@..2.\n..@...@.\n3.......\n..@.@...\n.@...@4.",
        "1..........\n2.@@@.@@@..\n3..........\n4.@@@.@@@..\n...........\n5..........",
    ];
    let physical = property("dischargePerBlock", "0.8")
        + &property("dischargePerSecond", "0.5")
        + &property("chargePerSecond", "1.5");
    let scenario = "from 1s every 300ms..900ms 20 times luggage random to random";
    let by_execution = property("discharge", "1");
    let by_execution = by_execution.as_str();
    // So many runs in all.
    let seeds: u64 = std::env::var("SAOMS_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(24);
    let each = seeds.div_ceil(12);
    for (index, map) in (0..).zip(maps) {
        for (has_zone, robot) in
            [(false, by_execution), (true, by_execution), (false, physical.as_str()), (true, physical.as_str())]
        {
            expect_all_brought(&site(map, has_zone, robot, scenario), each * index..each * (index + 1));
        }
    }
}

/// Twelve robots with the manual's battery on 14 x 14 blocks, with chargers side by side in this many columns, and two
/// pieces a second.
fn crowd(columns: usize) -> Fleet {
    let map: Vec<String> = (0..14).map(|_| ".".repeat(14)).collect();
    let world = r#"<reference name="world" target="World"/>"#;
    let optimal = property("assignment", "optimal") + &property("restart", "onFailure");
    let scenario = "from 1s every 500ms 240 times luggage (2,0)..(13,13) to (2,0)..(13,13)";
    let mut components = component("World", "World", &property("map", &map.join("\n")));
    components += &component("Zone", "Zone", world);
    components += &component("Master", "MasterEnvironment", &optimal);
    components += &component("Environment", "Environment", &property("scenario", scenario));
    for robot in 0..12 {
        let charger = |name: &str, at: usize| property(name, &at.to_string());
        let charger = charger("chargeX", robot % columns) + &charger("chargeY", robot / columns);
        components += &component(&format!("Robot{}", robot + 1), "Robot", &[world, &charger].concat());
    }
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="s" targetNamespace="urn:s">
{components}</composite>"#
    ))
}

#[test]
fn robots_on_the_way_to_their_chargers_do_not_keep_each_other_from_them() {
    // In each of these seeds a robot was stranded while blocks were granted all the way to the charger.
    expect_all_brought(&crowd(1), 29..30);
    expect_all_brought(&crowd(1), 7..8);
    expect_all_brought(&crowd(2), 12..13);
    // Here one with hardly any battery left waited for one that could wait.
    expect_all_brought(&crowd(2), 97..98);
}

#[test]
fn a_robot_gets_to_luggage_that_is_just_within_its_reach_whatever_else_it_is_offered() {
    // It was offered another piece each time, and turned back each time before it came to its own, for 300 s.
    let fleet = crowd(2);
    for seed in [3, 53] {
        let run = fleet.run(seed, HOUR);
        assert_eq!(run.outcome.status, RunStatus::Done, "seed {seed}: {:?}\n{}", run.outcome.reasons, run.log());
        assert!(run.time_s < 200.0, "seed {seed}: {} s", run.time_s);
    }
}

#[test]
fn a_robot_that_charges_for_long_does_not_stand_still_and_one_that_is_stranded_is_told() {
    let slow = property("dischargePerBlock", "2") + &property("chargePerSecond", "0.4") + &property("battery", "30");
    let fleet = site("1....\n.....\n.....", false, &slow, "at 1s luggage (4,2) to (0,2)");
    expect_all_brought(&fleet, 0..1);
    let far = property("startX", "6") + &property("startY", "2") + &property("battery", "3");
    let fleet = site("1......\n.......\n.......", false, &far, "at 1s luggage (1,0) to (3,0); at 5s end");
    let violations = fleet.violations(0, HOUR);
    assert!(violations.contains("5 no battery is empty away from a charger"), "{violations}");
}
