//! `saoms estop` and `saoms release`, against real processes.

use serde_json::Value;

use super::{Running, component, composite, fleet};

#[test]
fn robots_keep_their_blocks_and_jobs_until_they_are_released() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    running.told(&["send", "luggage (2,1) to (4,9); luggage (2,2) to (4,9)"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "carries luggage");
    // Robot2 is not started, and would start stopped.
    assert_eq!(running.told(&["estop"]), "stopped: Robot1, Robot2\n");
    let stopped = running.until("Robot1", |robot| robot["values"]["state"] == "stopped");
    assert_eq!(stopped["emergency_stop"], true);
    let shown = running.told(&["status", "Robot1"]);
    assert!(shown.contains("emergency stop") && shown.contains("waits for its release after a stop"), "{shown}");
    let at = |robot: &Value| (robot["values"]["block"].clone(), robot["values"]["job"].clone());
    let executed = |robot: &Value| robot["executions"].as_u64().unwrap();
    let later = running.until("Robot1", |robot| executed(robot) > executed(&stopped) + 30);
    let last = running.until("Robot1", |robot| executed(robot) > executed(&later) + 30);
    assert_eq!(at(&last), at(&later));
    assert!(last["values"]["job"].is_string(), "{last}");
    // What stops and releases robots otherwise ends no emergency stop.
    let refused = running.refused(&["set", "Robot1", "stopped=false"]);
    assert!(refused.contains("component `Robot1`: it is stopped by `saoms estop`"), "{refused}");
    running.told(&["set", "Robot1", "stopped=true"]);
    assert_eq!(running.component("Robot1")["values"]["state"], "stopped");
    assert_eq!(running.told(&["release", "Robot1"]), "released: Robot1\n");
    running.until("World", |world| world["values"]["delivered"] == 2);
    let log = running.told(&["logs"]);
    assert!(log.contains("emergency stop") && log.contains("release"), "{log}");
    let refused = running.refused(&["estop", "Robot3"]);
    assert!(refused.contains("the fleet has no component `Robot3`"), "{refused}");
    assert_eq!(running.told(&["release"]), "released: Robot2\n");
    assert_eq!(running.told(&["release"]), "nothing is released\n");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn a_stopped_robot_is_an_obstacle_and_the_same_run_happens_again() {
    let robot = |number: u32, x: u32, y: u32| {
        let more = format!(
            "<property name=\"chargeX\">{x}</property><property name=\"chargeY\">{y}</property>\
             <property name=\"discharge\">0</property><reference name=\"world\" target=\"World\"/>"
        );
        component(&format!("Robot{number}"), "saoms.Robot", &more)
    };
    let text = composite(
        &[
            component("World", "saoms.World", ""),
            component("Master", "saoms.MasterEnvironment", ""),
            component(
                "Environment",
                "saoms.Environment",
                "<property name=\"scenario\">at 1s 8 times luggage (2,2)..(8,4) to (2,6)..(8,9)</property>",
            ),
            robot(1, 0, 3),
            robot(2, 0, 5),
            robot(3, 0, 7),
        ]
        .concat(),
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("fleet.composite"), text).unwrap();
    std::fs::write(folder.path().join("stops.txt"), "at 2500ms estop Robot1 by ada\nat 40s release by ada\n").unwrap();
    let run = |events: &str, journal: &str| {
        let mut run = crate::support::command(&["run", "fleet.composite", "--virtual", "--quiet"]);
        run.args(["--report", "report.json", "--events", events, "--journal", journal]).current_dir(folder.path());
        let output = run.output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", crate::support::text(&output));
        let report = std::fs::read(folder.path().join("report.json")).unwrap();
        serde_json::from_slice::<Value>(&report).unwrap()
    };
    let report = run("stops.txt", "first.ndjson");
    assert_eq!(report["luggage"]["delivered"], 8);
    assert_eq!((&report["collisions"]["vertex"], &report["collisions"]["swap"]), (&Value::from(0), &Value::from(0)));
    let again = run("first.ndjson", "second.ndjson");
    assert_eq!(again["trace_hash"], report["trace_hash"]);
}
