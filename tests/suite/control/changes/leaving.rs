//! Robots that leave finish what they have begun, or are called back.

use std::fs;
use std::process::{Child, Stdio};

use serde_json::{Value, json};

use super::{LEAVES, Running, WORLD, component, composite, fleet, logged, until_logged, write};
use crate::support::{code, stderr, stdout, text};

#[test]
fn a_robot_that_leaves_finishes_its_job_and_goes_home() {
    for policy in ["safe", "classic"] {
        let policy = format!("<property name=\"policy\">{policy}</property>");
        let fleet = |robots: &[&str]| {
            let robots = robots.iter().map(|name| component(name, "saoms.Robot", &format!("{WORLD}{policy}")));
            let others = [component("World", "saoms.World", ""), component("Master", "saoms.MasterEnvironment", "")];
            composite(&others.into_iter().chain(robots).collect::<Vec<_>>().concat())
        };
        let running = Running::start(&fleet(&["Robot1"]), &["--stay", "--invariants"]);
        running.until("Robot1", |robot| robot["values"]["state"] == "free");
        running.told(&["send", "luggage (2,1) to (6,4)"]);
        running.until("Robot1", |robot| robot["values"]["job"].is_string());
        write(&running, &fleet(&["Robot2"]));
        let done = running.ask(&["apply", "other.composite"]);
        assert!(code(&done) == 0 && !stderr(&done).contains("without having finished"), "{}", text(&done));
        let world = running.component("World");
        assert_eq!(world["values"]["delivered"], 1, "{world}");
        assert!(running.refused(&["status", "Robot1"]).contains("Robot1"));
        let log = running.told(&["logs"]);
        assert!(!log.contains("assistance"), "{log}");
        // It comes back, and takes work again.
        running.told(&["apply", "fleet.composite"]);
        running.until("Robot1", |robot| robot["values"]["state"] == "free");
        running.told(&["send", "luggage (2,1) to (2,4)"]);
        running.until("World", |world| world["values"]["delivered"] == 2);
        running.told(&["down"]);
        let (code, text) = running.end();
        assert_eq!(code, Some(0), "{text}");
    }
}

#[test]
fn a_robot_that_does_not_finish_in_time_hands_its_job_over() {
    let running = Running::start(&fleet(), &["--stay", "--invariants"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    running.told(&["send", "luggage (2,1) to (10,10)"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "carries luggage");
    running.told(&["estop", "Robot1"]);
    running.told(&["start", "Robot2"]);
    write(&running, &fleet().replace(&component("Robot1", "saoms.Robot", WORLD), ""));
    let done = running.ask(&["apply", "other.composite", "--wait", "100ms"]);
    assert_eq!(code(&done), 0, "{}", text(&done));
    let expected = "note: `Robot1` ended without having finished within 100ms: what was begun is handed over as after \
                    `saoms stop`\n";
    assert!(stderr(&done).ends_with(expected), "{}", stderr(&done));
    assert!(stdout(&done).ends_with("done: 1 removed\n"), "{}", stdout(&done));
    running.until("World", |world| world["values"]["delivered"] == 1);
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("1 of 1 pieces of luggage delivered, no collision"), "{text}");
}

/// Starts to remove the robot, which cannot finish its job, and waits until it is asked to leave.
fn removing_a_stopped_robot(running: &Running) -> Child {
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    running.told(&["send", "luggage (2,1) to (6,4)"]);
    running.until("Robot1", |robot| robot["values"]["job"].is_string());
    running.told(&["estop", "Robot1"]);
    write(running, &fleet().replace(&component("Robot1", "saoms.Robot", WORLD), ""));
    let mut apply = crate::support::command(&["apply", "other.composite"]);
    apply.current_dir(running.folder()).env("XDG_RUNTIME_DIR", running.folder()).env("USER", "alice");
    let before = logged(running, LEAVES);
    let child = apply.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    until_logged(running, LEAVES, before + 1);
    child
}

fn interrupt(child: &Child, signal: i32) {
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(i32::try_from(child.id()).unwrap(), signal) }, 0);
}

#[test]
fn a_change_is_taken_back_when_its_client_hangs_up() {
    let running = Running::start(&fleet(), &["--stay"]);
    for (signal, times) in [(libc::SIGINT, 1), (libc::SIGKILL, 2)] {
        let child = removing_a_stopped_robot(&running);
        interrupt(&child, signal);
        let output = child.wait_with_output().unwrap();
        if signal == libc::SIGINT {
            assert_eq!(code(&output), 130, "{}", text(&output));
            let expected = "error: interrupted: the fleet takes the change back unless it has made it already, which \
                            `saoms plan` shows\n";
            assert_eq!(stderr(&output), expected);
        }
        let what = "a change of the fleet is taken back: whoever asked for it does not wait any more";
        until_logged(&running, what, times);
        assert_eq!(running.told(&["plan", "fleet.composite"]), "nothing to do\n");
        running.told(&["release", "Robot1"]);
        running.until("Robot1", |robot| robot["values"]["job"].is_null());
    }
    // It was called back, and works again.
    running.until("World", |world| world["values"]["delivered"] == 2);
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn commands_are_carried_out_while_a_robot_leaves() {
    let running = Running::start(&fleet(), &["--stay"]);
    let child = removing_a_stopped_robot(&running);
    // What is set or called does not hinder the change of another component, nor does it hinder that one.
    let job = running.component("Robot1")["values"]["job"].clone();
    running.told(&["set", "Robot1", "stopped=true"]);
    assert!(running.refused(&["set", "Robot1", "speed=x"]).contains("speed"));
    let called = running.ask(&["call", "Robot1", "is_running"]);
    assert!(!text(&called).contains("panicked"), "{}", text(&called));
    assert_eq!(running.component("Robot1")["values"]["job"], job);
    running.told(&["start", "Robot2"]);
    running.until("Robot2", |robot| robot["executions"].as_u64() > Some(3));
    running.told(&["release"]);
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 0, "{}", text(&output));
    running.until("World", |world| world["values"]["delivered"] == 1);
    // One that is stopped has nothing to finish.
    running.told(&["apply", "fleet.composite"]);
    running.told(&["stop", "Robot2"]);
    let child = removing_a_stopped_robot(&running);
    running.told(&["stop", "Robot1"]);
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 0, "{}", text(&output));
    running.told(&["down"]);
    // Nobody is left for its job, which may be given up by now.
    let (_, text) = running.end();
    assert!(text.contains("1 of 2 pieces of luggage delivered") && text.contains("no collision"), "{text}");
}

#[test]
fn the_journal_and_the_history_have_who_changed_what() {
    let mut running = Running::start(&fleet(), &["--stay", "--journal", "run.ndjson", "--history", "run.db"]);
    let child = removing_a_stopped_robot(&running);
    interrupt(&child, libc::SIGINT);
    assert_eq!(code(&child.wait_with_output().unwrap()), 130);
    until_logged(&running, "a change of the fleet is taken back", 1);
    running.told(&["apply", "other.composite", "--wait", "0s"]);
    running.told(&["apply", "fleet.composite"]);
    running.told(&["down"]);
    // Nobody was left for the job of the first one, which may be given up by now.
    running.wait();
    let journal = fs::read_to_string(running.folder().join("run.ndjson")).unwrap();
    let records = journal.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let changes: Vec<Value> = records.filter(|record| record["record"] == "fleet_changed").collect();
    let first = &changes[0];
    let expected = "change by alice: 1 removed (Robot1): not made: the change was taken back before it was made";
    assert_eq!(first["text"], expected, "{changes:?}");
    assert_eq!((&first["component"], &first["values"]["by"]), (&"(outside)".into(), &"alice".into()));
    assert_eq!((&first["values"]["removed"], &first["values"]["made"]), (&json!(["Robot1"]), &false.into()));
    let second = &changes[1];
    assert!(second["text"].as_str().unwrap().ends_with(": 1 removed (Robot1): made; unfinished: Robot1"), "{second}");
    assert_eq!((&second["values"]["unfinished"], &second["values"]["made"]), (&json!(["Robot1"]), &true.into()));
    let last = &changes[2];
    assert!(last["text"].as_str().unwrap().ends_with(": 1 added (Robot1): made"), "{last}");
    assert!(changes.len() == 3 && last["values"].get("unfinished").is_none(), "{changes:?}");
    let question = "select text from records where record = 'fleet_changed' order by id";
    let asked = running.told(&["query", question, "--history", "run.db", "--format", "json"]);
    let answer: Value = serde_json::from_str(&asked).unwrap();
    let told: Vec<&Value> = answer["rows"].as_array().unwrap().iter().map(|row| &row[0]).collect();
    let expected: Vec<&Value> = changes.iter().map(|change| &change["text"]).collect();
    assert_eq!(told, expected, "{asked}");
    // They do not happen again.
    let mut again = vec!["run", "fleet.composite", "--virtual", "--for", "60s", "--events", "run.ndjson"];
    again.extend(["--stay", "--control", "none"]);
    let played = running.ask(&again);
    assert!(code(&played) != 2 && stdout(&played).contains("emergency stop"), "{}", text(&played));
}
