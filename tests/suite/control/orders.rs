//! Each command as a user types it.

use serde_json::Value;

use super::{Running, fleet};

#[test]
fn a_fleet_is_listed_shown_and_ended() {
    let mut running = Running::start(&fleet(), &["--report", "report.json"]);
    let listed = running.told(&["ps"]);
    assert!(listed.starts_with("NAME   PID") && listed.contains("fleet.composite"), "{listed}");
    running.until("Robot1", |robot| robot["values"]["state"] == "free" && robot["executions"].as_u64() > Some(2));
    let shown = running.told(&["status"]);
    assert!(shown.starts_with("fleet (process "), "{shown}");
    let line = shown.lines().find(|line| line.starts_with("Robot1")).unwrap();
    assert!(line.contains("free · battery 100 · block (0,1)"), "{shown}");
    assert!(shown.lines().any(|line| line.starts_with("Robot2") && line.contains("idle")), "{shown}");
    assert_eq!(running.told(&["down"]), "the fleet ends\n");
    let folder = running.folder().to_owned();
    let report = folder.join("report.json");
    let (code, text) = running.wait();
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("\nstopped after "), "{text}");
    let report: Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert_eq!(report["outcome"]["status"], "stopped");
    assert_eq!(std::fs::read_dir(folder.join("saoms")).unwrap().count(), 0, "the socket is removed");
}

#[test]
fn work_is_sent_and_told_of() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    assert_eq!(running.told(&["send", "luggage (2,1) to (4,1); luggage (2,2) to (4,2)"]), "2 events taken\n");
    let robot = running.until("Robot1", |robot| robot["values"]["job"].is_string());
    assert_eq!(robot["values"]["job"], "luggage 1000001 from (2,1) to (4,1)");
    running.until("World", |world| world["values"]["delivered"] == 2);
    let log = running.told(&["logs"]);
    assert!(log.contains("s] Robot1: takes luggage 1000001 from (2,1) to (4,1)\n"), "{log}");
    let of_world = running.told(&["logs", "Master", "-n", "5"]);
    assert!(!of_world.contains("Robot1: "), "{of_world}");
    let wrong = running.refused(&["send", "lugage (2,1) to (4,1)"]);
    assert!(wrong.contains("found `lugage`") && wrong.contains("did you mean `luggage`?"), "{wrong}");
    let wrong = running.refused(&["send", "luggage (2,1) to (4,1)\nluggage (2,1) to (4,1)"]);
    assert!(wrong.contains("one line"), "{wrong}");
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("2 of 2 pieces of luggage delivered"), "{text}");
}

#[test]
fn components_start_and_stop() {
    let running = Running::start(&fleet(), &[]);
    assert_eq!(running.component("Robot2")["state"], "idle");
    assert_eq!(running.told(&["start", "Robot2", "--for", "100ms"]), "`Robot2` starts for 100ms\n");
    running.until("Robot2", |robot| robot["state"] == "idle" && robot["executions"].as_u64() > Some(0));
    assert_eq!(running.told(&["start", "Robot2"]), "`Robot2` starts\n");
    running.until("Robot2", |robot| robot["state"] == "running" && robot["executions"].as_u64() > Some(3));
    assert_eq!(running.told(&["stop", "Robot2"]), "`Robot2` stops\n");
    running.until("Robot2", |robot| robot["state"] == "idle");
    let unknown = running.refused(&["start", "Robot3"]);
    assert!(unknown.contains("the fleet has no component `Robot3`; did you mean `Robot"), "{unknown}");
    let unknown = running.refused(&["status", "Wrld"]);
    assert!(unknown.contains("no component `Wrld`; did you mean `World`?"), "{unknown}");
    let wrong = running.refused(&["set", "Robot1", "number=4"]);
    assert!(wrong.contains("number"), "{wrong}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn events_of_classes_are_sent() {
    let library = crate::plugins::library("saoms_sprinkler");
    let text = crate::support::project("plugins/sprinkler/fleet.composite");
    let running = Running::start(&text, &["--stay", "--plugin", library.to_str().unwrap()]);
    assert_eq!(running.told(&["send", "fire at=(7,7) size=1 to Hall2"]), "1 event taken\n");
    let wrong = running.refused(&["send", "fire at=(7,7) sise=1 to Hall2"]);
    assert!(wrong.contains("has no field `sise`") && wrong.contains("did you mean `size`?"), "{wrong}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn the_log_is_followed_to_the_end_of_the_fleet() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    let followed = std::thread::scope(|scope| {
        let follower = scope.spawn(|| running.told(&["logs", "--follow", "--format", "json"]));
        running.told(&["send", "luggage (2,1) to (4,1)"]);
        running.until("World", |world| world["values"]["delivered"] == 1);
        running.told(&["down"]);
        follower.join().unwrap()
    });
    let lines: Vec<Value> = followed.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let is_delivered = |line: &Value| line["text"].as_str().unwrap().starts_with("deposited luggage 1000001");
    assert!(lines.iter().any(is_delivered), "{followed}");
    assert!(lines.iter().all(|line| line["date_s"].as_f64() > Some(1.7e9)), "{followed}");
    assert_eq!(running.end().0, Some(0));
}
