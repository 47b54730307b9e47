//! `saoms pause`, `resume`, `step` and `speed`, against real processes.

use serde_json::Value;

use super::{Running, fleet};

fn executions(running: &Running) -> u64 {
    running.component("Robot1")["executions"].as_u64().unwrap()
}

#[test]
fn a_fleet_in_real_time_pauses_and_goes_on() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    let paused = running.told(&["pause"]);
    assert!(paused.starts_with("paused at ") && paused.ends_with(" s\n"), "{paused}");
    assert_eq!(running.told(&["pause"]), paused, "it pauses already");
    let before = executions(&running);
    std::thread::sleep(std::time::Duration::from_millis(300));
    assert_eq!(executions(&running), before);
    let shown = running.told(&["status"]);
    assert!(shown.contains("): paused, "), "{shown}");
    // Orders take effect meanwhile.
    assert_eq!(running.told(&["send", "luggage (2,1) to (4,1)"]), "1 event accepted\n");
    assert_eq!(running.told(&["estop", "Robot1"]), "stopped: Robot1\n");
    running.until("Robot1", |robot| robot["values"]["state"] == "stopped");
    running.told(&["release"]);
    let refused = running.refused(&["step", "1s"]);
    assert!(refused.contains("real time"), "{refused}");
    let refused = running.refused(&["speed", "2"]);
    assert!(refused.contains("real time"), "{refused}");
    assert_eq!(running.told(&["resume"]), "resumed\n");
    running.until("World", |world| world["values"]["delivered"] == 1);
    // A paused fleet ends, too.
    running.told(&["pause"]);
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn a_fleet_in_virtual_time_is_stepped_steered_and_runs_again_with_the_same_trace() {
    let options = ["--virtual", "--paused", "--stay", "--for", "300s", "--journal", "first.ndjson"];
    let mut running = Running::start(&fleet(), &[&options[..], &["--report", "first.json"]].concat());
    let time = |running: &Running| -> f64 {
        let status: Value = serde_json::from_str(&running.told(&["status", "--format", "json"])).unwrap();
        status["status"]["time_s"].as_f64().unwrap()
    };
    assert_eq!(time(&running), 0.0);
    assert_eq!(running.told(&["send", "luggage (2,1) to (4,1)"]), "1 event accepted\n");
    assert_eq!(running.told(&["step"]), "advances to 0.000 s\n");
    running.until("Robot1", |robot| robot["executions"] == 1);
    assert_eq!(running.told(&["step", "10s"]), "advances to 10.000 s\n");
    running.until("World", |world| world["values"]["delivered"] == 1);
    assert_eq!(running.told(&["start", "Robot2"]), "`Robot2` starts\n");
    let wrong = running.refused(&["speed", "fast"]);
    assert!(wrong.contains("found `fast`, expected a factor"), "{wrong}");
    assert_eq!(running.told(&["speed", "20"]), "the speed is 20\n");
    assert_eq!(running.told(&["resume"]), "resumed\n");
    running.until("Robot2", |robot| robot["executions"].as_u64() > Some(20));
    assert_eq!(running.told(&["send", "luggage (4,1) to (2,1)"]), "1 event accepted\n");
    running.told(&["stop", "Robot2"]);
    running.until("World", |world| world["values"]["delivered"] == 2);
    running.told(&["speed", "max"]);
    let folder = running.folder().to_owned();
    let (code, text) = running.wait();
    assert_eq!(code, Some(0), "{text}");
    let again = ["run", "fleet.composite", "--virtual", "--for", "300s", "--quiet"];
    let output = running.ask(
        &[&again[..], &["--stay", "--control", "none", "--events", "first.ndjson", "--report", "again.json"]].concat(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", crate::support::text(&output));
    let report = |name: &str| -> Value { serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap() };
    let (first, again) = (report("first.json"), report("again.json"));
    assert_eq!((&again["trace_hash"], &again["time_s"]), (&first["trace_hash"], &first["time_s"]));
}
