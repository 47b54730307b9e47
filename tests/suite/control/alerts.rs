//! `saoms alerts`, against real processes.

use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::metrics::metrics;
use super::{Running, component, composite, fleet};
use crate::boundary::build::{c_library, library};

/// The alerts that are kept.
pub(super) fn alerts(running: &Running) -> Vec<Value> {
    let answer = running.told(&["alerts", "--all", "--format", "json"]);
    serde_json::from_str::<Value>(&answer).unwrap().as_array().unwrap().clone()
}

/// Waits for an alert of this kind that is as it should be.
#[track_caller]
pub(super) fn until(running: &Running, kind: &str, is: impl Fn(&Value) -> bool) -> Value {
    for _ in 0..1000 {
        if let Some(found) = alerts(running).into_iter().find(|one| one["kind"] == kind && is(one)) {
            return found;
        }
        sleep(Duration::from_millis(20));
    }
    panic!("it never comes to that: {:?}", alerts(running));
}

#[test]
fn a_robot_that_breaks_down_waits_for_a_person_until_somebody_takes_notice() {
    let running = Running::start(&fleet(), &["--stay"]);
    assert_eq!(running.told(&["alerts"]), "no alerts\n");
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    running.told(&["send", "luggage (2,1) to (4,9)"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "carries luggage");
    running.told(&["send", "breakdown 1"]);
    let alert = until(&running, "assistance", |_| true);
    assert_eq!(alert["component"], "Robot1");
    until(&running, "given_up", |one| one["component"] == "Master" && one["subject"] == "1000001");
    let shown = running.told(&["alerts"]);
    assert!(shown.contains("Robot1: breaks down at") && shown.contains("] given_up: Master: gives up"), "{shown}");
    while !running.told(&["status"]).contains(shown.lines().next().unwrap()) {
        sleep(Duration::from_millis(10));
    }
    while !metrics(&running).contains("saoms_alerts{kind=\"assistance\",state=\"waiting\"} 1") {
        sleep(Duration::from_millis(10));
    }

    let refused = running.refused(&["alerts", "ack", "77"]);
    assert!(refused.contains("there is no alert 77"), "{refused}");
    running.refused(&["alerts", "ack"]);
    let id = alert["id"].to_string();
    assert_eq!(running.told(&["alerts", "ack", &id]), format!("acknowledged: {id}\n"));
    assert!(!until(&running, "assistance", |one| !one["acknowledged"].is_null())["acknowledged"]["by"].is_null());
    assert!(!running.told(&["alerts"]).contains("assistance"));
    // The text of the metrics is kept for a moment.
    while !metrics(&running).contains("saoms_alerts{kind=\"assistance\",state=\"acknowledged\"} 1") {
        sleep(Duration::from_millis(10));
    }
    let is_told = |line: &str| line.contains("alerts acknowledged by ") && line.ends_with(&format!(": {id}"));
    while !running.told(&["logs"]).lines().any(is_told) {
        sleep(Duration::from_millis(10));
    }
    assert!(running.told(&["alerts", "ack", "--all"]).starts_with("acknowledged: "));
    assert_eq!(running.told(&["alerts", "ack", "--all"]), "no alert to acknowledge\n");
    assert_eq!(running.told(&["alerts"]), "no alerts\n");
    assert!(running.told(&["alerts", "--all"]).contains("(acknowledged by "));

    // A new instance of the robot needs no help.
    running.told(&["stop", "Robot1"]);
    running.until("Robot1", |robot| robot["state"] == "idle");
    running.told(&["start", "Robot1"]);
    until(&running, "assistance", |one| !one["over_s"].is_null());
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(1));
}

#[test]
fn an_emergency_stop_is_an_alert_until_the_release_of_all() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.told(&["estop"]);
    let alert = until(&running, "emergency_stop", |_| true);
    assert!(alert["text"].as_str().unwrap().ends_with(": Robot1, Robot2"), "{alert}");
    running.told(&["release", "Robot1"]);
    assert!(alerts(&running)[0]["over_s"].is_null());
    running.told(&["release"]);
    until(&running, "emergency_stop", |one| !one["over_s"].is_null());
    running.told(&["estop", "Robot2"]);
    until(&running, "emergency_stop", |one| one["id"] == 2 && one["over_s"].is_null());
}

#[test]
fn code_that_hangs_or_fails_for_good_and_a_full_disk_are_alerts() {
    let plugin = library("bad");
    let actor = |name: &str, does: &str| {
        let values = format!("<property name=\"at\">execute</property><property name=\"does\">{does}</property>");
        component(name, "bad.Actor", &values)
    };
    let fleet =
        composite(&(actor("Hangs", "never") + &actor("Fails", "fail") + &component("World", "saoms.World", "")));
    let options = ["--plugin", plugin.to_str().unwrap(), "--log", "/dev/full", "--grace", "300ms", "--stay"];
    let running = Running::start(&fleet, &options);
    let failed = until(&running, "failed", |_| true);
    assert_eq!(failed["component"], "Fails");
    assert!(failed["text"].as_str().unwrap().starts_with("failed: "), "{failed}");
    let full = until(&running, "file", |_| true);
    assert!(full["text"].as_str().unwrap().contains("the log cannot be written at `/dev/full`"), "{full}");
    let hangs = until(&running, "hangs", |_| true);
    assert_eq!(hangs["component"], "Hangs");
    running.told(&["down"]);
}

#[test]
fn a_component_in_c_raises_alerts() {
    let folder = tempfile::tempdir().unwrap();
    let library = c_library(folder.path(), &[]);
    let values = "<property name=\"at\"/><property name=\"does\">alert</property>";
    let running = Running::start(
        &composite(&component("Belt", "c.Actor", values)),
        &["--plugin", library.to_str().unwrap(), "--stay"],
    );
    until(&running, "jam", |one| one["subject"] == "left" && one["over_s"].is_null());
    until(&running, "jam", |one| one["subject"] == "right" && !one["over_s"].is_null());
    assert!(running.told(&["alerts"]).contains("] jam: Belt: the left belt jams\n"));
    assert!(running.told(&["logs"]).contains("an alert was left out"));
}

#[test]
fn changes_of_alerts_are_followed() {
    let running = Running::start(&fleet(), &["--stay"]);
    let mut follow = crate::support::command(&["alerts", "--follow", "--format", "json"]);
    follow.current_dir(running.folder()).env("XDG_RUNTIME_DIR", running.folder());
    let mut follow = follow.stdout(std::process::Stdio::piped()).spawn().unwrap();
    running.told(&["estop"]);
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(follow.stdout.take().unwrap()));
    let first: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    // It may have begun before or after the alert.
    let kind = |one: &Value| if one["alert"].is_null() { one["kind"].clone() } else { one["alert"]["kind"].clone() };
    assert_eq!(kind(&first), "emergency_stop");
    running.told(&["release"]);
    let second: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    assert_eq!((kind(&second), &second["event"]), (Value::from("emergency_stop"), &Value::from("over")));
    running.told(&["down"]);
    assert!(follow.wait().unwrap().success());
}
