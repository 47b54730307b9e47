//! When a zone executes, beside its robots.

use std::fmt::Write as _;

use saoms_testkit::{Fleet, Run};

use super::seconds;

/// Eight robots with small batteries and chargers side by side, all of which begin at once, and the zone with them.
fn run(zone: &str, seed: u64) -> Run {
    let mut text = String::from(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="phase" targetNamespace="urn:phase">"#,
    );
    let mut add = |name: &str, class: &str, more: &str| {
        let _ = write!(
            text,
            r#"<component name="{name}"><implementation.rust class="saoms.{class}"/><property name="ID">{name}</property>
               <property name="period">100</property>{more}</component>"#
        );
    };
    let wire = r#"<reference name="world" target="World"/>"#;
    add("World", "World", r#"<property name="width">10</property><property name="height">10</property>"#);
    add("Zone", "Zone", &format!("{zone}{wire}"));
    add("MasterEnvironment", "MasterEnvironment", "");
    add("MasterRobot", "MasterRobot", "");
    let scenario = "from 1s every 500ms 100 times luggage (1,1)..(9,9) to (1,1)..(9,9)";
    add("Environment", "Environment", &format!(r#"<property name="scenario">{scenario}</property>"#));
    for robot in 0..8 {
        let (x, y) = (robot % 2, 1 + robot / 2);
        let charger = format!(r#"<property name="chargeX">{x}</property><property name="chargeY">{y}</property>"#);
        add(&format!("Robot{}", robot + 1), "Robot", &format!("{charger}{wire}"));
    }
    text.push_str("</composite>");
    Fleet::of_text(text).run(seed, seconds(120))
}

fn stranded(run: &Run) -> usize {
    run.log().matches("is stranded").count()
}

#[test]
fn without_a_delay_a_zone_answers_robots_that_begin_at_once_within_a_period() {
    let late = |seed: u64| run(r#"<property name="delay">0</property>"#, seed).time_s;
    for seed in [31, 37, 74] {
        let usual = run("", seed);
        assert_eq!((stranded(&usual), usual.count("luggage.delivered")), (0, 100), "{seed}:\n{}", usual.log());
        let (late, usual) = (late(seed), usual.time_s);
        assert!(late > 1.05 * usual, "{seed}: {late} s where answers come late, {usual} s");
    }
}
