//! Each command of a running fleet answers programs, too.

use std::process::Stdio;

use serde_json::{Value, json};

use super::{Running, component, composite, fleet};
use crate::support::command;

#[test]
fn each_command_answers_in_json() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    let request = json!({"robot": 70, "awake": true, "emulate": 0}).to_string();
    // Those that give an answer for each line, message or refresh give lines.
    for arguments in [
        vec!["ps"],
        vec!["status"],
        vec!["top", "-n", "1"],
        vec!["why", "Robot1"],
        vec!["send", "luggage (3,1) to (3,9)"],
        vec!["topic", "list"],
        vec!["topic", "info", "POSTOPIC"],
        vec!["topic", "echo", "POSTOPIC", "-n", "1"],
        vec!["topic", "hz", "POSTOPIC", "--for", "10ms"],
        vec!["topic", "pub", "RMSTOPIC", &request],
        vec!["start", "Robot2"],
        vec!["stop", "Robot2"],
        vec!["call", "World.area"],
        vec!["set", "Robot1", "stopped=false"],
        vec!["estop", "Robot1"],
        vec!["release"],
        vec!["logs", "-n", "1"],
        vec!["journal", "Robot1", "-n", "1"],
        vec!["pause"],
        vec!["resume"],
        vec!["down"],
    ] {
        let answer = running.told(&[&arguments[..], &["--format", "json"]].concat());
        assert!(serde_json::from_str::<Value>(&answer).is_ok(), "{arguments:?}: {answer:?}");
    }
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn what_is_refused_is_told_in_json() {
    let running = Running::start(&fleet(), &["--stay"]);
    for arguments in [
        vec!["status", "Nobody"],
        vec!["why", "Nobody"],
        vec!["journal", "Nobody"],
        vec!["send", "lugage"],
        vec!["topic", "info", "NOTHING"],
        vec!["topic", "echo", "NOTHING"],
        vec!["topic", "pub", "NOTHING", "{}"],
        vec!["start", "Nobody"],
        vec!["stop", "Nobody"],
        vec!["call", "World.nothing"],
        vec!["set", "Robot1", "stopped=maybe"],
        vec!["estop", "Nobody"],
        vec!["top", "--fleet", "nobody"],
    ] {
        let refused = running.refused(&[&arguments[..], &["--format", "json"]].concat());
        let refused: Value = serde_json::from_str(&refused).unwrap_or_else(|_| panic!("{arguments:?}: {refused}"));
        assert!(refused["error"].is_string(), "{arguments:?}: {refused}");
    }
}

#[test]
fn the_log_and_messages_steer_no_terminal_and_are_json_all_the_same() {
    let world = component("World", "saoms.World", "");
    let robot = component("Rob&#x9b;ot1", "saoms.Robot", "<reference name=\"world\" target=\"World\"/>");
    let running = Running::start(&composite(&(world + &robot)), &["--stay"]);
    running.until("Rob\u{9b}ot1", |robot| robot["values"]["state"] == "free");
    running.told(&["estop", "Rob\u{9b}ot1"]);
    // A robot that is stopped says nothing more: it is what the topic retains.
    let line = running.told(&["topic", "echo", "POSTOPIC", "-n", "1", "--format", "json"]);
    assert!(serde_json::from_str::<Value>(&line).is_ok() && !line.contains('\u{9b}'), "{line:?}");
    let lines = running.told(&["logs", "--format", "json"]);
    assert!(!lines.contains('\u{9b}') && lines.contains("\\u009b"), "{lines:?}");
    for line in lines.lines() {
        assert!(serde_json::from_str::<Value>(line).is_ok(), "{line:?}");
    }
}

#[test]
fn a_fleet_that_is_suspended_holds_up_no_command_for_another() {
    let running = Running::start(&fleet(), &["--stay"]);
    let mut other = command(&["run", "fleet.composite", "--stay"]);
    other.current_dir(running.folder()).env("XDG_RUNTIME_DIR", running.folder());
    let mut other = other.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let fleets = || {
        let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
        listed.as_array().unwrap().len()
    };
    while fleets() < 2 {}
    // SAFETY: no pointers; the process is not waited for yet.
    unsafe { assert_eq!(libc::kill(other.id() as libc::pid_t, libc::SIGSTOP), 0) };
    // Without it, which would be asked for half a minute.
    assert_eq!(fleets(), 1);
    running.told(&["status"]);
    // SAFETY: as above.
    unsafe { assert_eq!(libc::kill(other.id() as libc::pid_t, libc::SIGCONT), 0) };
    while fleets() < 2 {}
    other.kill().unwrap();
    other.wait().unwrap();
}
