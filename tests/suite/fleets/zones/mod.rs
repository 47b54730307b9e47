//! Fleets whose robots enter blocks only with grants of zones.

mod apart;
mod border;
mod corridor;
mod drawn;
mod entering;
mod gone;
mod impostor;
mod out_of_reach;
mod phase;
mod replicas;
mod traps;
mod unheard;
mod words;

use std::time::Duration;

use saoms_api::{Class, Component, Failure};
use saoms_components::messages::{GRANT_REQUEST, POSITION};
use saoms_testkit::{Fleet, Run};

const HOUR: Duration = Duration::from_secs(3600);

const fn seconds(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

/// A map with a corridor, dead ends and an open part.
const MAP: &str = "
    ........
    .@@.@@@.
    ........
    ..@@....
    ........
    .@.@.@..
";

/// Zones by their columns: the first one, and their number.
const ONE: &[(u32, u32)] = &[(0, 8)];
const TWO: &[(u32, u32)] = &[(0, 3), (3, 5)];

/// Robots that bring pieces from anywhere to anywhere on the map.
fn fleet(zones: &[(u32, u32)], robots: u32, pieces: u32) -> Fleet {
    fleet_after("", zones, robots, pieces)
}

/// The same, where other components execute first.
fn fleet_after(first: &str, zones: &[(u32, u32)], robots: u32, pieces: u32) -> Fleet {
    let zones: String = (1..)
        .zip(zones)
        .map(|(number, (x, width))| {
            format!(
                r#"<component name="Zone{number}">
                  <implementation.rust class="saoms.Zone"/>
                  <property name="ID">Zone{number}</property>
                  <property name="period">50</property>
                  <property name="number">{number}</property>
                  <property name="x">{x}</property>
                  <property name="width">{width}</property>
                  <property name="restart">onFailure</property>
                  <property name="restartLimit">1000</property>
                  <reference name="world" target="World"/>
                </component>"#
            )
        })
        .collect();
    let chargers = [(0, 0), (7, 0), (0, 2), (7, 2), (0, 5), (2, 5), (4, 5), (7, 5)];
    let robots: String = (1..=robots)
        .zip(chargers)
        .map(|(number, (x, y))| {
            format!(
                r#"<component name="Robot{number}">
                  <implementation.rust class="saoms.Robot"/>
                  <property name="ID">Robot{number}</property>
                  <property name="period">100</property>
                  <property name="delay">{delay}</property>
                  <property name="chargeX">{x}</property>
                  <property name="chargeY">{y}</property>
                  <property name="discharge">0.1</property>
                  <property name="restart">onFailure</property>
                  <property name="restartLimit">1000</property>
                  <reference name="world" target="World"/>
                </component>"#,
                delay = 7 * number
            )
        })
        .collect();
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:xsd="http://www.w3.org/2001/XMLSchema" name="zoned"
              targetNamespace="urn:zoned">
          <property name="moveTime" type="xsd:string">200ms</property>
          {first}
          <component name="World">
            <implementation.rust class="saoms.World"/>
            <property name="ID">World</property>
            <property name="period">50</property>
            <property name="map">{MAP}</property>
            <property name="moveTime" source="$moveTime"/>
          </component>
          {zones}
          <component name="Environment">
            <implementation.rust class="saoms.Environment"/>
            <property name="ID">Environment</property>
            <property name="period">100</property>
            <property name="scenario">from 1s every 500ms {pieces} times luggage random to random</property>
          </component>
          <component name="Master">
            <implementation.rust class="saoms.MasterEnvironment"/>
            <property name="ID">Master</property>
            <property name="period">100</property>
          </component>
          {robots}
        </composite>"#
    ))
}

fn assert_delivered(run: &Run, pieces: i64, context: &str) {
    let collisions = (run.count("collisions.vertex"), run.count("collisions.swap"));
    assert_eq!(collisions, (0, 0), "{context}: {:?}", run.outcome);
    assert_eq!(run.count("luggage.delivered"), pieces, "{context}: {:?}", run.outcome);
    // They get past each other, so that it was none.
    assert_eq!(run.count("deadlocks"), 0, "{context}\n{}", run.log());
}

#[test]
fn robots_deliver_everything_through_one_zone_and_through_two() {
    for (zones, robots) in [(ONE, 1), (ONE, 5), (ONE, 8), (TWO, 1), (TWO, 4)] {
        for seed in 0..3 {
            let run = fleet(zones, robots, 20).run(seed, HOUR);
            assert_delivered(&run, 20, &format!("{zones:?}, {robots} robots, seed {seed}"));
        }
    }
}

/// Moves take ten periods of the robots, and twenty of their zone.
#[test]
fn robots_with_slow_moves_are_in_no_deadlock() {
    for (zones, robots) in [(ONE, 5), (ONE, 8), (TWO, 4)] {
        for seed in 0..4 {
            let run = fleet(zones, robots, 20).set("moveTime", "1s").run(seed, HOUR);
            assert_delivered(&run, 20, &format!("{zones:?}, {robots} robots, seed {seed}"));
        }
    }
}

/// Messages between robots and zones are lost, late, doubled and in another order, for ten minutes.
#[test]
fn no_robots_collide_however_bad_their_links_are() {
    let topics = ["GRANTTOPIC", "GRANTREQUESTTOPIC", "ZONETOPIC", "POSTOPIC"];
    for seed in 0..3 {
        let mut disturbed = fleet(TWO, 4, 20);
        for topic in topics {
            for fault in ["lose 20 %", "delay 10ms to 300ms", "duplicate 10 %", "reorder 20 % by 300ms"] {
                disturbed = disturbed.with_fault(seconds(0), &format!("for 10min {fault} on {topic}"));
            }
        }
        assert_delivered(&disturbed.run(seed, HOUR), 20, &format!("seed {seed}"));
    }
}

/// While a zone is cut off, robots drive to the ends of their passages and wait.
#[test]
fn robots_wait_for_a_zone_that_is_cut_off() {
    let run = fleet(ONE, 4, 10).with_fault(seconds(3), "for 40s cut Robot* from Zone1").run(1, HOUR);
    assert_delivered(&run, 10, "cut");
    assert!(run.time_s > 40.0, "{:?}", run.outcome);
}

#[test]
fn a_zone_that_crashes_goes_on_with_its_grants() {
    for seed in 0..3 {
        let crashed = fleet(TWO, 4, 20);
        let crashed = [2, 4, 7]
            .into_iter()
            .fold(crashed, |fleet, at| fleet.fail("Zone1", seconds(at)).fail("Zone2", seconds(at)));
        assert_delivered(&crashed.run(seed, HOUR), 20, &format!("seed {seed}"));
    }
}

#[test]
fn a_robot_that_crashes_goes_on_in_its_passage() {
    for seed in 0..3 {
        let crashed = [2, 4, 7].into_iter().fold(fleet(ONE, 4, 20), |fleet, at| fleet.fail("Robot2", seconds(at)));
        assert_delivered(&crashed.run(seed, HOUR), 20, &format!("seed {seed}"));
    }
}

/// A robot that has not said where it is keeps its zone closed, and the zone says for whom it waits.
#[test]
fn a_zone_is_closed_until_each_robot_has_said_where_it_is() {
    let run = fleet(ONE, 2, 3).with_fault(seconds(0), "for 30s cut Zone1 from Robot2").run(1, HOUR);
    assert_delivered(&run, 3, "closed");
    let log = run.log_of("Zone1").join("\n");
    assert!(log.contains("grants nothing: it waits for robots to say where they are: Robot2"), "{log}");
    assert!(run.time_s > 30.0, "{:?}", run.outcome);
}

/// Two robots in a corridor without a bay: neither can get past the other one, and the zone names them.
#[test]
fn robots_that_cannot_get_past_each_other_are_named() {
    let robot = |number: u32, column: u32| {
        format!(
            r#"<component name="Robot{number}">
              <implementation.rust class="saoms.Robot"/>
              <property name="ID">Robot{number}</property>
              <property name="period">100</property>
              <property name="chargeX">{column}</property>
              <property name="chargeY">0</property>
              <property name="discharge">0</property>
              <reference name="world" target="World"/>
            </component>"#
        )
    };
    let corridor = Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="corridor" targetNamespace="urn:corridor">
          <component name="World">
            <implementation.rust class="saoms.World"/>
            <property name="ID">World</property>
            <property name="period">100</property>
            <property name="width">6</property>
            <property name="height">1</property>
          </component>
          <component name="Zone">
            <implementation.rust class="saoms.Zone"/>
            <property name="ID">Zone</property>
            <property name="period">100</property>
            <reference name="world" target="World"/>
          </component>
          <component name="Environment">
            <implementation.rust class="saoms.Environment"/>
            <property name="ID">Environment</property>
            <property name="period">100</property>
            <property name="scenario">at 1s visit (5,0) by Robot1</property>
          </component>
          <component name="Master">
            <implementation.rust class="saoms.MasterEnvironment"/>
            <property name="ID">Master</property>
            <property name="period">100</property>
          </component>
          {}{}
        </composite>"#,
        robot(1, 0),
        robot(2, 5)
    ));
    let run = corridor.run(1, seconds(60));
    let log = run.log_of("Zone").join("\n");
    let expected =
        "robots 1 at (4,0), 2 at (5,0) are in each other's way, and cannot get past: send one of them elsewhere";
    assert!(log.contains(expected), "{log}\n{}", run.log());
    assert_eq!(run.count("deadlocks"), 1, "{log}");
}

/// Says where it is, and asks no zone.
#[derive(Class)]
#[class(name = "test.Stroller", periodic, publishes(POSITION))]
struct Stroller;

impl Component for Stroller {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Stroller)
    }
}

/// Asks its zone, and does not hear what it says.
#[derive(Class)]
#[class(name = "test.Hothead", periodic, publishes(POSITION, GRANT_REQUEST))]
struct Hothead;

impl Component for Hothead {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Hothead)
    }
}

#[test]
fn a_robot_of_a_class_that_drives_without_grants_is_refused() {
    let fleet = |class: &str, zones: &str| {
        Fleet::of_text(format!(
            r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
            <component name="World"><implementation.rust class="saoms.World"/>
            <property name="ID">World</property><property name="period">100</property></component>
            {zones}
            <component name="Robot"><implementation.rust class="test.{class}"/>
            <property name="ID">Robot</property><property name="period">100</property></component></composite>"#
        ))
    };
    let zone = r#"<component name="Zone"><implementation.rust class="saoms.Zone"/>
        <property name="ID">Zone</property><property name="period">100</property>
        <reference name="world" target="World"/></component>"#;
    for (class, fault) in [("Stroller", "asks no zone for grants"), ("Hothead", "hears no grants of its zone")] {
        let found = fleet(class, zone).diagnostics();
        let expected = format!("`Robot` is a robot that {fault}");
        assert!(found.contains("error S5023") && found.contains(&expected), "{found}");
        let without = fleet(class, "").diagnostics();
        assert!(!without.contains("S5023"), "{without}");
    }
}
