//! Why a robot of a running fleet did something.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use serde_json::Value;

use super::{Running, fleet};
use crate::support::{command, stdout};

#[test]
fn a_running_fleet_gives_the_same_answers_as_its_report() {
    let mut running = Running::start(&fleet(), &["--stay", "--report", "report.json"]);
    running.told(&["send", "luggage (2,1) to (4,1)"]);
    running.until("Robot1", |robot| robot["values"]["delivered"] == 1);
    // What it does from now on is in the report alone.
    running.told(&["pause"]);
    let now = running.component("Robot1")["values_s"].as_f64().unwrap();
    let times: Vec<String> = (1..=6).map(|part| format!("{}us", (now * 1e6) as u64 * part / 6)).collect();
    let asked: Vec<Vec<&str>> = times
        .iter()
        .flat_map(|time| ["human", "json"].map(|format| vec!["why", "Robot1", "--at", time, "--format", format]))
        .chain([
            vec!["why", "bot1", "--at", &times[3]],
            vec!["why", "Master", "--at", &times[5]],
            vec!["why", "Robot1", "--format", "json"],
            vec!["why", "Robot2"],
        ])
        .collect();
    assert!(running.told(&["why", "Robot1"]).starts_with("Robot1 acted at "));
    let answers: Vec<String> = asked.iter().map(|arguments| running.told(arguments)).collect();
    running.told(&["down"]);
    assert_eq!(running.wait().0, Some(0));
    let mut found = 0;
    for (arguments, answer) in asked.iter().zip(&answers) {
        let report = stdout(&running.ask(&[&arguments[..], &["--report", "report.json"]].concat()));
        assert_eq!(*answer, report, "{arguments:?}");
        found += usize::from(answer.contains("luggage"));
    }
    assert!(found > 4, "{answers:?}");
    assert!(answers.last().unwrap().contains("Robot2 has no records in the journal of this run"), "{answers:?}");
}

#[test]
fn what_cannot_be_answered_is_refused_with_the_reason() {
    let running = Running::start(&fleet(), &["--stay"]);
    let unknown = running.refused(&["why", "Robott1"]);
    assert!(unknown.contains("had no component `Robott1`: did you mean `Robot1`"), "{unknown}");
    let unknown: Value = serde_json::from_str(&running.refused(&["why", "Robott1", "--format", "json"])).unwrap();
    assert!(unknown["error"].as_str().unwrap().contains("`Robot1`"), "{unknown}");
    let late = running.refused(&["why", "Robot1", "--at", "2h"]);
    assert!(late.contains("the run is at ") && late.contains("before 7200s"), "{late}");
    let both = running.refused(&["why", "Robot1", "--report", "report.json", "--fleet", "fleet"]);
    assert!(both.contains("cannot be used with"), "{both}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn the_newest_records_of_a_component_are_shown_and_followed() {
    let running = Running::start(&fleet(), &["--stay"]);
    let mut follow = command(&["journal", "Robot1", "--follow"]);
    follow.current_dir(running.folder()).env("XDG_RUNTIME_DIR", running.folder());
    let mut follow = follow.stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(follow.stdout.take().unwrap()).lines().map(Result::unwrap);
    running.told(&["send", "luggage (2,1) to (4,1)"]);
    let deposits = "Robot1 GripperMS decision: deposits luggage";
    let mut seen: Vec<String> = Vec::new();
    while !seen.last().is_some_and(|line| line.contains(deposits)) {
        seen.push(lines.next().unwrap());
    }
    let told = seen.len();
    seen.dedup();
    assert_eq!(seen.len(), told, "each record once");
    running.told(&["pause"]);
    let all = running.told(&["journal", "Robot1", "-n", "100000"]);
    let two = running.told(&["journal", "bot1", "-n", "2"]);
    assert!(all.ends_with(&two) && two.lines().count() == 2, "{two}");
    assert!(all.starts_with(&seen.join("\n")), "{all}\n{seen:?}");
    running.told(&["down"]);
    lines.for_each(drop);
    assert_eq!(follow.wait().unwrap().code(), Some(0));
    assert_eq!(running.end().0, Some(0));
}
