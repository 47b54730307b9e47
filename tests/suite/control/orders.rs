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
    assert_eq!(running.told(&["send", "luggage (2,1) to (4,1); luggage (2,2) to (4,2)"]), "2 events accepted\n");
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
    assert_eq!(running.told(&["send", "fire at=(7,7) size=1 to Hall2"]), "1 event accepted\n");
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
    assert!(lines.iter().all(|line| line["date"].as_str() > Some("2026-01-01T00:00:00.000Z")), "{followed}");
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn operations_are_called() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    let area = running.told(&["call", "World.area"]);
    assert!(area.starts_with('{') && area.contains("\"width\":"), "{area}");
    let answer: Value = serde_json::from_str(&running.told(&["call", "World.area", "--format", "json"])).unwrap();
    assert!(answer["reply"]["width"].is_u64(), "{answer}");
    let refused = running.refused(&["call", "World.poll"]);
    assert!(refused.contains("operation `poll(robot: uint32)") && refused.contains("is missing"), "{refused}");
    let refused = running.refused(&["call", "World.are"]);
    assert!(refused.contains("offers no operation `are`; did you mean `area`?"), "{refused}");
    let refused = running.refused(&["call", "World"]);
    assert!(refused.contains("expected `COMPONENT.OPERATION`"), "{refused}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

/// What came from outside, with its times, in a file of `--journal`.
fn from_outside(file: &std::path::Path) -> Vec<(f64, String)> {
    let journal = std::fs::read_to_string(file).unwrap();
    let records = journal.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let of_outside = records.filter(|record| record["component"] == "(outside)");
    of_outside.map(|record| (record["time_s"].as_f64().unwrap(), record["text"].as_str().unwrap().to_owned())).collect()
}

#[test]
fn what_came_from_outside_is_in_the_journal_and_happens_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("events.txt"), "luggage (1,3) to (3,3)\n").unwrap();
    let options = ["--stay", "--journal", "first.ndjson", "--events", "events.txt"];
    let mut running = Running::start_beside(folder, &fleet(), &options);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    assert_eq!(running.told(&["send", "luggage (2,1) to (4,1)"]), "1 event accepted\n");
    // Work that is left when Robot2 starts could be claimed by it, and waits while it is stopped.
    running.until("World", |world| world["values"]["delivered"] == 2);
    assert_eq!(running.told(&["send", "start Robot2"]), "done\n");
    running.until("Robot2", |robot| robot["state"] == "running");
    running.told(&["topic", "pub", "RMSTOPIC", "{\"robot\":2,\"awake\":true,\"emulate\":0}"]);
    running.told(&["call", "World.area"]);
    running.told(&["stop", "Robot2"]);
    let refused = running.refused(&["send", "stopp Robot2"]);
    assert!(refused.contains("did you mean `stop`?"), "{refused}");
    let refused = running.refused(&["send", "stop Robot"]);
    assert!(refused.contains("the fleet has no component `Robot`"), "{refused}");
    running.told(&["down"]);
    let folder = running.folder().to_owned();
    let (code, text) = running.wait();
    assert_eq!(code, Some(0), "{text}");
    let given = from_outside(&folder.join("first.ndjson"));
    let texts: Vec<&str> = given.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(
        texts,
        [
            "luggage (1,3) to (3,3) number 1000001",
            "luggage (2,1) to (4,1) number 1000002",
            "start Robot2",
            "publish RMSTOPIC {\"awake\":true,\"emulate\":0,\"robot\":2}",
            "call World.area",
            "stop Robot2",
        ]
    );

    // At the same times in virtual time, twice with the same trace.
    let again = |journal: &str| {
        let replay = ["run", "fleet.composite", "--virtual", "--for", "60s", "--report", "again.json"];
        let output = running.ask(&[&replay[..], &["--events", "first.ndjson", "--journal", journal]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", crate::support::text(&output));
        let report: Value = serde_json::from_slice(&std::fs::read(folder.join("again.json")).unwrap()).unwrap();
        (report["trace_hash"].clone(), from_outside(&folder.join(journal)))
    };
    let (trace, second) = again("second.ndjson");
    assert_eq!(second, given);
    assert_eq!(again("third.ndjson"), (trace, given));
}
