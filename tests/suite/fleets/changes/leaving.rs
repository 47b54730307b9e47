//! Robots that leave with a job: they finish it, or hand it over where their time for that is over. Nothing is lost,
//! and nothing is delivered twice.

use std::sync::Arc;
use std::thread::{scope, sleep};
use std::time::Duration;

use saoms_api::Time;
use saoms_core::observe::InvariantWatch;
use saoms_core::report::RunStatus;
use saoms_core::schedule::{ChangeOptions, RunningFleet, Settings};
use saoms_lang::registry::Registry;
use serde_json::json;

use super::compiled;

/// Columns and rows of the hall.
const SIDE: u32 = 9;

/// A hall whose robots, with batteries that last for ever, bring two pieces: the first one brings the first piece.
fn hall(robots: &[u32], assignment: &str, zones: bool) -> String {
    let mut text = String::from(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">",
    );
    let mut add = |class: &str, id: &str, properties: &str, rest: &str| {
        text += &format!("<component name=\"{id}\"><implementation.rust class=\"{class}\"/>");
        for property in format!("ID={id} period=100 {properties}").split_whitespace() {
            let (name, value) = property.split_once('=').unwrap();
            text += &format!("<property name=\"{name}\">{value}</property>");
        }
        text += &format!("{rest}</component>\n");
    };
    let world = "<reference name=\"world\" target=\"World\"/>";
    let work = "at 500ms luggage (3,0) to (3,6); at 1s luggage (8,0) to (5,5)";
    add("saoms.World", "World", &format!("width={SIDE} height={SIDE} moveTime=1s handlingTime=500ms"), "");
    add("saoms.MasterEnvironment", "Master", &format!("assignment={assignment}"), "");
    add("saoms.MasterRobot", "Crew", "", "");
    add("saoms.Environment", "Environment", "", &format!("<property name=\"scenario\">{work}</property>"));
    for (number, x, width) in [(1, 0, 4), (2, 4, SIDE - 4)].into_iter().filter(|_| zones) {
        add("saoms.Zone", &format!("Zone{number}"), &format!("number={number} x={x} width={width}"), world);
    }
    for (robot, x, y) in [(1, 0, 0), (2, 0, 8), (3, 8, 8)].into_iter().filter(|one| robots.contains(&one.0)) {
        let properties = format!("chargeX={x} chargeY={y} discharge=0");
        add("saoms.Robot", &format!("Robot{robot}"), &properties, world);
    }
    text + "</composite>"
}

/// Removes the first robot at a time at which it is in this state, and gives it so long to finish.
fn leaves((at, state): (u64, &str), wait: Duration, assignment: &str, zones: bool) {
    let registry = Registry::linked().unwrap();
    let [all, others] = [&[1, 2, 3][..], &[2, 3]].map(|robots| compiled(&hall(robots, assignment, zones), &registry));
    let watch = Arc::new(InvariantWatch::default());
    let settings = Settings { limit: Some(Duration::from_secs(1000)), ..Settings::simulated(1) };
    let fleet = RunningFleet::start(all, settings, vec![watch.clone()]).unwrap();
    let (handle, hold) = (fleet.handle(), fleet.handle().hold());
    let mut now = at;
    fleet.run_until(Time::from_nanos(now * 1_000_000));
    let of = |name: &str| {
        let status = handle.status();
        status.components.into_iter().find(|one| one.report.name == name).unwrap().values
    };
    let told = format!("{state} at {at} ms, {wait:?}, {assignment}, zones: {zones}");
    assert_eq!(of("Robot1")["state"], state, "{told}");
    let changed = scope(|scope| {
        let options = ChangeOptions { wait, ..ChangeOptions::default() };
        let (handle, others) = (handle.clone(), &others);
        let apply = scope.spawn(move || handle.apply(others, options));
        // One that has no time to finish has to hear that it leaves.
        let mut steps = if wait.is_zero() { 1 } else { 3000 };
        while !apply.is_finished() {
            if steps > 0 {
                (now, steps) = (now + 100, steps - 1);
                fleet.run_until(Time::from_nanos(now * 1_000_000));
            }
            sleep(Duration::from_millis(1));
        }
        apply.join().unwrap().unwrap_or_else(|error| panic!("{told}: {error}"))
    });
    assert_eq!(changed.removed, ["Robot1"], "{told}");
    let unfinished: &[&str] = if wait.is_zero() { &["Robot1"] } else { &[] };
    assert_eq!(changed.unfinished, unfinished, "{told}");
    drop(hold);
    let report = fleet.run_to_end();
    let violations: Vec<String> = watch.violations().iter().map(|one| format!("{}: {}", one.at, one.text)).collect();
    assert!(violations.is_empty(), "{told}: {violations:?}");
    assert_eq!(report.outcome.status, RunStatus::Done, "{told}: {:?}, {:?}", report.outcome, report.sections);
    let luggage = &report.sections["luggage"];
    let counts = ["requested", "delivered", "given_up", "open"].map(|name| luggage[name].clone());
    assert_eq!(counts, [json!(2), json!(2), json!(0), json!(0)], "{told}: {luggage}");
    assert_eq!(report.sections["collisions"], json!({"vertex": 0, "swap": 0}), "{told}");
    // Its piece was brought by the robot itself, or by another one.
    let delivered = &report.sections["robots"]["by_path"]["Robot1"]["delivered"];
    assert_eq!(*delivered, u32::from(!wait.is_zero()), "{told}: {:?}", report.sections["robots"]);
}

#[test]
fn a_robot_that_leaves_finishes_its_job_or_hands_it_over() {
    for assignment in ["robots", "oldest", "optimal"] {
        for zones in [false, true] {
            for moment in [(2000, "goes to luggage"), (8000, "carries luggage")] {
                for wait in [Duration::from_secs(600), Duration::ZERO] {
                    leaves(moment, wait, assignment, zones);
                }
            }
        }
    }
}
