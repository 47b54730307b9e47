//! Robots that share a charger, since their own ones are taken, give nothing or are out of reach.

use std::time::Duration;

use saoms_testkit::{Fleet, Run};

const HOUR: Duration = Duration::from_secs(3600);

/// A robot: its charger, and the block where it starts.
type Place = ((i32, i32), (i32, i32));

/// A fleet on 11 x 11 blocks, with a zone or without.
fn fleet(scenario: &str, robots: &[Place], has_zone: bool) -> Fleet {
    let component = |id: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
            <property name="ID">{id}</property><property name="period">100</property>{more}</component>
"#
        )
    };
    let world = r#"<reference name="world" target="World"/>"#;
    let mut text = component("World", "World", "");
    if has_zone {
        text += &component("Zone", "Zone", world);
    }
    text += &component("Master", "MasterEnvironment", "");
    text += &component("Environment", "Environment", &format!(r#"<property name="scenario">{scenario}</property>"#));
    for (place, ((x, y), (start_x, start_y))) in robots.iter().enumerate() {
        let places = [("chargeX", x), ("chargeY", y), ("startX", start_x), ("startY", start_y)];
        let places = places.map(|(name, value)| format!(r#"<property name="{name}">{value}</property>"#)).concat();
        let battery = r#"<property name="dischargePerBlock">2</property>
            <property name="dischargePerSecond">0.15</property><property name="chargePerSecond">10</property>"#;
        text += &component(&format!("Robot{}", place + 1), "Robot", &[&places, battery, world].concat());
    }
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{text}</composite>"#
    ))
}

/// All of `pieces` are delivered, and no robot is stranded.
fn assert_served(run: &Run, pieces: u32, which: &str) {
    let luggage = &run.sections["luggage"];
    let found = (&luggage["delivered"], &run.sections["stranded"]);
    assert_eq!(found, (&pieces.into(), &0.into()), "{which}: {}", run.log());
}

#[test]
fn robots_that_share_a_charger_charge_one_after_the_other() {
    let scenario = "at 0s breakdown 1; at 0s breakdown 4; at 0s breakdown 5; \
        at 1s 4 times luggage (10,3)..(10,8) to (3,7)..(3,10); from 10s every 1s 8 times luggage random to random";
    // The first one, and those that broke on the chargers of the second and the third, leave one charger for two.
    let robots = [((0, 1), (0, 9)), ((0, 3), (3, 3)), ((0, 5), (3, 5)), ((10, 1), (0, 3)), ((10, 9), (0, 5))];
    for has_zone in [true, false] {
        for seed in 1..=5 {
            let run = fleet(scenario, &robots, has_zone).run(seed, HOUR);
            assert_served(&run, 12, &format!("zone {has_zone}, seed {seed}"));
            // Each would drive the other away for ever: then luggage is given up after a thousand seconds.
            let stays = run.log().matches("starts charging").count();
            assert!(stays < 60, "zone {has_zone}, seed {seed}: {stays} stays\n{}", run.log());
        }
    }
}

#[test]
fn robots_whose_chargers_give_nothing_share_the_one_that_does() {
    let scenario = "at 0s outage charger=(0,3) lasting=600s; at 0s outage charger=(0,5) lasting=600s; \
        from 1s every 2s 24 times luggage random to random";
    let robots = [((0, 1), (0, 1)), ((0, 3), (0, 3)), ((0, 5), (0, 5))];
    for has_zone in [true, false] {
        for seed in 1..=5 {
            let run = fleet(scenario, &robots, has_zone).run(seed, HOUR);
            assert_served(&run, 24, &format!("zone {has_zone}, seed {seed}"));
        }
    }
}

#[test]
fn robots_leave_a_charger_that_stops_giving_anything_while_they_share_it() {
    let scenario = "at 0s breakdown 1; at 0s breakdown 4; at 0s breakdown 5; \
        at 15s outage charger=(0,1) lasting=60s; from 1s every 2s 16 times luggage random to random";
    let robots = [((0, 1), (0, 9)), ((0, 3), (3, 3)), ((0, 5), (3, 5)), ((10, 1), (0, 3)), ((10, 9), (0, 5))];
    for has_zone in [true, false] {
        for seed in 1..=5 {
            let run = fleet(scenario, &robots, has_zone).run(seed, HOUR);
            assert_served(&run, 16, &format!("zone {has_zone}, seed {seed}"));
        }
    }
}

#[test]
fn a_robot_whose_battery_does_not_last_to_its_charger_charges_at_a_closer_one() {
    // The second one broke, and left its charger, close to which the battery of the first one loses what it needs.
    let scenario = "at 0s breakdown 2; at 1s visit (10,9) by Robot1; at 3s drain robot=1 percent=40";
    let robots = [((0, 0), (0, 0)), ((10, 10), (1, 9))];
    for has_zone in [true, false] {
        let run = fleet(scenario, &robots, has_zone).run(1, HOUR);
        let log = run.log();
        assert!(log.contains("charges at (10,10) this time: its own is out of reach"), "zone {has_zone}: {log}");
        assert_eq!(run.sections["stranded"], 0, "zone {has_zone}: {log}");
    }
}
