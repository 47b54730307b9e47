//! Components of robots that fail: what they were to bring is brought by others, and the run ends by itself.

use std::time::Duration;

use saoms_testkit::{Fleet, Run};
use serde_json::{Value, json};

const LIMIT: Duration = Duration::from_secs(2000);

/// What a fleet is made of, beside its robots.
#[derive(Clone, Copy, Debug)]
struct Site {
    has_world: bool,
    has_zone: bool,
}

const SITES: [Site; 3] = [
    Site { has_world: true, has_zone: false },
    Site { has_world: true, has_zone: true },
    Site { has_world: false, has_zone: false },
];

fn property(name: &str, value: &str) -> String {
    format!(r#"<property name="{name}">{value}</property>"#)
}

fn component(id: &str, class: &str, more: &str) -> String {
    format!(
        r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">100</property>{more}</component>
"#
    )
}

/// A fleet with these robots, each with more properties.
fn fleet(site: Site, scenario: &str, robots: &[(&str, &str)]) -> Fleet {
    let world = if site.has_world { r#"<reference name="world" target="World"/>"# } else { "" };
    let mut components = String::new();
    if site.has_world {
        components +=
            &component("World", "World", &(property("moveTime", "150ms") + &property("handlingTime", "300ms")));
    }
    if site.has_zone {
        components += &component("Zone", "Zone", world);
    }
    components += &component("Master", "MasterEnvironment", "");
    components += &component("MasterRobot", "MasterRobot", "");
    components += &component("Environment", "Environment", &property("scenario", scenario));
    for (robot, more) in robots {
        components += &component(robot, "Robot", &[world, more, &property("discharge", "0.1")].concat());
    }
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{components}</composite>"#
    ))
}

fn luggage(run: &Run, what: &str) -> u64 {
    run.sections["luggage"].get(what).and_then(Value::as_u64).unwrap_or_default()
}

/// How the run ended, in one line.
fn outcome(run: &Run) -> String {
    let collisions = run.sections.get("collisions").cloned().unwrap_or(json!({"vertex": 0, "swap": 0}));
    let collided = collisions["vertex"].as_u64().unwrap_or(0) + collisions["swap"].as_u64().unwrap_or(0);
    let ignored = run.sections.get("messages").map(|messages| format!(", messages {messages}")).unwrap_or_default();
    format!(
        "{:?}: {} of {} delivered, {} given up, {collided} collisions{ignored}",
        run.outcome.status,
        luggage(run, "delivered"),
        luggage(run, "requested"),
        luggage(run, "given_up"),
    )
}

const THREE: &str = "at 0.5s luggage (2,2) to (8,2); at 0.5s luggage (2,3) to (8,3); at 0.5s luggage (2,1) to (8,1);";
const TEAM: [(&str, &str); 3] = [("Robot1", ""), ("Robot2", ""), ("Robot3", "")];

/// Runs a fleet with a fault at each of these times, in tenths of a second, and expects that each run ends like this,
/// within two minutes, and keeps the invariants.
#[track_caller]
fn expect_ends(
    sites: &[Site],
    robots: &[(&str, &str)],
    times: impl Iterator<Item = u64> + Clone,
    expected: &str,
    faults: impl Fn(u64) -> String,
) {
    let mut wrong = String::new();
    for site in sites {
        for tenths in times.clone() {
            let fleet = fleet(*site, &format!("{THREE} {}; at 15s end", faults(tenths)), robots);
            let run = fleet.run(tenths, LIMIT);
            let ended = outcome(&run);
            // Without a world a robot that begins anew starts at its charger, wherever it was.
            let violations = if site.has_world { fleet.violations(tenths, LIMIT) } else { String::new() };
            if ended != expected || run.time_s > 120.0 || !violations.is_empty() {
                let (time, reasons) = (run.time_s, &run.outcome.reasons);
                wrong += &format!("{site:?} at {tenths}: {ended}, {time} s, {reasons:?} {violations}\n");
            }
        }
    }
    assert!(wrong.is_empty(), "expected {expected}:\n{wrong}");
}

fn at(tenths: u64) -> String {
    format!("at {}.{}s", tenths / 10, tenths % 10)
}

#[test]
fn a_robot_fails_for_good_at_any_time() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    expect_ends(&SITES, &TEAM, (3..60).step_by(3), expected, |tenths| format!("{} fail Robot2", at(tenths)));
}

#[test]
fn a_robot_crashes_for_good_which_is_no_failure_of_the_run() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    expect_ends(&SITES, &TEAM, (3..60).step_by(11), expected, |tenths| format!("{} crash Robot2", at(tenths)));
}

#[test]
fn a_robot_starts_again_without_what_it_knew() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    for pause in ["10ms", "150ms", "2s"] {
        let crash = |tenths: u64| format!("{} crash Robot2 restart {pause}", at(tenths));
        expect_ends(&SITES, &TEAM, (4..60).step_by(7), expected, crash);
    }
}

#[test]
fn a_robot_that_is_alone_starts_again_without_what_it_knew() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    let crash = |tenths: u64| format!("{} crash Robot2 restart 1500ms", at(tenths));
    expect_ends(&SITES, &TEAM[1..2], (7..150).step_by(11), expected, crash);
}

#[test]
fn a_robot_goes_on_from_what_it_saved() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    let robots = [TEAM[0], ("Robot2", r#"<property name="restart">onFailure</property>"#), TEAM[2]];
    expect_ends(&SITES, &robots, (3..60).step_by(11), expected, |tenths| format!("{} fail Robot2", at(tenths)));
}

#[test]
fn two_robots_fail() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    for between in [0, 3, 10, 25] {
        let both = |tenths: u64| format!("{} fail Robot1; {} fail Robot2", at(tenths), at(tenths + between));
        expect_ends(&SITES, &TEAM, (6..60).step_by(9), expected, both);
    }
}

#[test]
fn a_robot_breaks_and_who_helps_it_fails() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    for helper in ["Robot1", "Robot3"] {
        let both = |tenths: u64| format!("at 2s breakdown 2; {} fail {helper}", at(tenths));
        expect_ends(&SITES, &TEAM, (19..80).step_by(7), expected, both);
    }
}

#[test]
fn all_robots_fail_and_what_they_leave_is_given_up() {
    for site in SITES {
        let all = "at 0.8s fail Robot1; at 0.8s fail Robot2; at 0.9s fail Robot3; at 9s end";
        let run = fleet(site, &format!("{THREE} {all}"), &TEAM).run(1, LIMIT);
        assert_eq!(outcome(&run), "Failed: 0 of 3 delivered, 3 given up, 0 collisions", "{site:?}");
        assert!(run.time_s < 20.0);
    }
}

#[test]
fn a_run_without_its_master_or_world_ends_and_says_what_it_waits_for() {
    let mut ends = String::new();
    for (component, tenths) in [("Master", 2), ("Master", 10), ("World", 10), ("Environment", 10), ("MasterRobot", 10)]
    {
        let fleet = fleet(SITES[0], &format!("{THREE} {} fail {component}; at 9s end", at(tenths)), &TEAM);
        // With a limit a run waits for what may still come.
        let run = fleet.run(1, Duration::MAX);
        ends += &format!("{component} at {tenths}: {}\n  {}\n", outcome(&run), run.outcome.reasons.join("\n  "));
    }
    expect_test::expect![[r#"
        Master at 2: Failed: 0 of 0 delivered, 0 given up, 0 collisions
          component `Master` failed: this execution fails by fault injection
          nothing has happened since 75.500 s, and nothing more can: `World` waits for a robot to carry luggage 1 and 2 more pieces; `Environment` waits for a master of the environment to pass on luggage 1 and 2 more pieces on `ELMSTOPIC`; `MasterRobot` waits for landings and take-offs; `Robot1` and 2 more wait for luggage
        Master at 10: Failed: 3 of 3 delivered, 0 given up, 0 collisions
          component `Master` failed: this execution fails by fault injection
        World at 10: Failed: 0 of 3 delivered, 0 given up, 0 collisions
          component `World` failed: this execution fails by fault injection
          nothing has happened since 100.800 s, and nothing more can: `Environment` and 1 more wait for a robot to carry luggage 1 and 2 more pieces; `MasterRobot` waits for landings and take-offs; `Robot1` and 2 more wait for its world, which does not run
        Environment at 10: Failed: 3 of 3 delivered, 0 given up, 0 collisions
          component `Environment` failed: this execution fails by fault injection
        MasterRobot at 10: Failed: 3 of 3 delivered, 0 given up, 0 collisions
          component `MasterRobot` failed: this execution fails by fault injection
    "#]].assert_eq(&ends);
}
