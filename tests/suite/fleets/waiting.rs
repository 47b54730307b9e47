//! Robots that wait for each other, and what they tell of it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::time::Duration;

use saoms_testkit::Fleet;

use crate::support::root;

/// Eight robots on both sides of a corridor as wide as one of them.
fn corridor() -> Fleet {
    let task = |id: &str| format!("<property name=\"ID\">{id}</property><property name=\"period\">100</property>");
    let map = "........\n@@@@.@@@\n@@@@.@@@\n........";
    let mut components = String::new();
    for (id, more) in [
        ("World", format!("<property name=\"moveTime\">200ms</property><property name=\"map\">{map}</property>")),
        ("MasterEnvironment", String::new()),
        (
            "Environment",
            "<property name=\"scenario\">from 1s every 1s 8 times luggage (0,0)..(7,0) to (0,3)..(7,3)</property>"
                .to_owned(),
        ),
    ] {
        let class = format!("<implementation.rust class=\"saoms.{id}\"/>");
        writeln!(components, "<component name=\"{id}\">{class}{}{more}</component>", task(id)).unwrap();
    }
    for number in 0..8 {
        let id = format!("Robot{}", number + 1);
        let charger = format!(
            "<property name=\"chargeX\">{number}</property><property name=\"chargeY\">{}</property>",
            if number % 2 == 0 { 0 } else { 3 }
        );
        let wire = "<reference name=\"world\" target=\"World\"/>";
        let class = "<implementation.rust class=\"saoms.Robot\"/>";
        writeln!(components, "<component name=\"{id}\">{class}{}{charger}{wire}</component>", task(&id)).unwrap();
    }
    let root =
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"c\" targetNamespace=\"urn:c\">";
    Fleet::of_text(format!("{root}\n{components}</composite>"))
}

#[test]
fn a_robot_says_once_for_whom_it_waits_and_when_that_ends() {
    let run = corridor().run(1, Duration::from_secs(60));
    let mut waits: BTreeMap<&str, bool> = BTreeMap::new();
    let mut told = 0;
    for line in run.log().lines() {
        let (who, what) = line.split_once("] ").unwrap().1.split_once(": ").unwrap();
        let is_waiting = waits.entry(who).or_default();
        if what.starts_with("has been waiting at") {
            assert!(!*is_waiting, "{who} says it twice: {}", run.log());
            assert!(what.contains(" for robot ") && what.contains(" since "), "{what}");
            (*is_waiting, told) = (true, told + 1);
        } else if what.starts_with("continues after waiting ") {
            assert!(*is_waiting, "{who} did not wait: {}", run.log());
            *is_waiting = false;
        }
    }
    assert!((4..40).contains(&told), "{told} in {}", run.log());
}

#[test]
fn the_journal_knows_the_battery_at_any_time() {
    let run = corridor().run(1, Duration::from_secs(60));
    let robot = run.journal().of("Robot3");
    let mut last = None;
    for change in robot.iter().filter_map(|record| record.change()).filter(|change| change.entry == "battery") {
        let (before, after) = (change.before.as_f64().unwrap(), change.after.as_f64().unwrap());
        assert!(last.is_none_or(|last| last == before && (after - before).abs() >= 5.0), "{before} {after}");
        last = Some(after);
    }
    assert!(last.is_some());
}

/// In a corridor, a robot that breaks is between another one and its work: that is no question of batteries.
#[test]
fn luggage_behind_a_broken_robot_is_told_to_have_no_path() {
    let robot = |number: u32, column: u32| {
        format!(
            "<component name=\"Robot{number}\"><implementation.rust class=\"saoms.Robot\"/>\
             <property name=\"ID\">Robot{number}</property><property name=\"period\">100ms</property>\
             <property name=\"chargeX\">{column}</property><property name=\"chargeY\">0</property>\
             <reference name=\"world\" target=\"World\"/></component>"
        )
    };
    let part = |name: &str, class: &str, property: &str| {
        format!(
            "<component name=\"{name}\"><implementation.rust class=\"saoms.{class}\"/>\
             <property name=\"ID\">{name}</property><property name=\"period\">100ms</property>{property}</component>"
        )
    };
    let scenario = "at 1s luggage (1,0) to (5,0); at 1600ms breakdown Robot8; at 3s luggage (8,0) to (1,0)";
    let text = [
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">",
        &part("World", "World", "<property name=\"map\">...........</property>"),
        &part("Environment", "Environment", &format!("<property name=\"scenario\">{scenario}</property>")),
        &part("Master", "MasterEnvironment", ""),
        &robot(8, 0),
        &robot(9, 10),
        "</composite>",
    ];
    let run = Fleet::of_text(text.concat()).run(0, Duration::from_mins(1));
    let told: Vec<String> = run.log_of("Robot9").into_iter().map(|line| line.to_string()).collect();
    let path = "cannot carry luggage 2 from (8,0) to (1,0): blocked blocks or broken robots leave no path there";
    assert!(told.iter().any(|line| line == path), "{told:?}");
    assert_eq!((run.count("luggage.delivered"), run.count("luggage.given_up")), (1, 1));
}

#[test]
fn a_robot_whose_world_does_not_answer_says_so_after_a_minute() {
    let hall = fs::read_to_string(root().join("composites/hall.composite")).unwrap();
    let robot = "<property name=\"ID\" value=\"Robot7\"/>";
    let hall = hall.replace(robot, &format!("{robot}<property name=\"discharge\" value=\"0.01\"/>"));
    let seconds = Duration::from_secs;
    let waits = |fleet: Fleet| {
        let run = fleet.run(0, seconds(800));
        assert!(run.log().contains("deposited luggage 1"), "{}", run.log());
        run.log().lines().filter(|line| line.contains("waiting")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(waits(Fleet::of_text(&hall)), [""; 0]);
    assert_eq!(
        waits(Fleet::of_text(&hall).slow("World", Duration::from_millis(1250), seconds(100))),
        [
            "[61.300 s] Robot7: has been waiting for `World`, which is busy, since 1.300 s",
            "[101.300 s] Robot7: continues after waiting 100.000 s",
        ]
    );
    let slow = hall.replace("value=\"World\"/>", "value=\"World\"/><property name=\"moveTime\" value=\"20s\"/>");
    assert_eq!(waits(Fleet::of_text(slow)), [""; 0]);
}
