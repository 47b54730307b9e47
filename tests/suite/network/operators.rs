//! Commands that reach all programs of a network: `--url`.

use std::process::Output;
use std::time::Duration;

use serde_json::Value;

use super::certificates::write_private;
use super::links::robot;
use super::passwords::{broker, numbers};
use super::programs::{Programs, Transport, free_port};
use crate::plugins::library;
use crate::support::{command, stdout, text};

/// Runs a command for all programs of a network.
fn asked(programs: &Programs, arguments: &[&str], url: &str, more: &[&str]) -> Output {
    let transport = if url.starts_with("relay") { "saoms_relay" } else { "saoms_zenoh" };
    let mut run = command(&[arguments, &["--url", url], more].concat());
    run.arg("--plugin").arg(library(transport)).current_dir(programs.folder());
    run.env("SAOMS_PASSWORD", "sesame").output().unwrap()
}

/// Runs a command that is accepted, and gives what it says.
#[track_caller]
pub(super) fn accepted(programs: &Programs, arguments: &[&str]) -> String {
    let done = asked(programs, arguments, &programs.url(programs.port), &[]);
    assert_eq!(done.status.code(), Some(0), "{}\n{}", text(&done), programs.printed());
    stdout(&done)
}

/// Runs a command that is refused, and gives what it says.
#[track_caller]
fn refused(programs: &Programs, arguments: &[&str]) -> String {
    let done = asked(programs, arguments, &programs.url(programs.port), &[]);
    assert_eq!(done.status.code(), Some(2), "{}\n{}", text(&done), programs.printed());
    text(&done)
}

#[test]
fn commands_reach_all_programs_of_a_network() {
    let programs = Programs::new();
    let broker = programs.broker();
    let robots = ["Robot1", "Robot2"].map(|name| robot(&programs, name, ""));
    let master = programs.tasks("work", programs.port, &[("Master", "saoms.MasterEnvironment", &[])]);
    for program in robots.iter().chain([&master]) {
        programs.until(program, "program `broker` is on the network");
    }
    let status = accepted(&programs, &["status"]);
    for part in ["program `Robot1`:", "program `Robot2`:", "program `work`:", "program `broker`:", "Master"] {
        assert!(status.contains(part), "{part}\n{status}");
    }
    let one = accepted(&programs, &["status", "Robot2"]);
    assert!(one.contains("program `Robot2`:") && !one.contains("Robot1"), "{one}");
    let json = accepted(&programs, &["status", "--program", "Robot1", "--format", "json"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["programs"][0]["program"], "Robot1");
    assert_eq!(json["programs"][0]["answer"]["status"]["components"][0]["name"], "Robot1");
    assert!(refused(&programs, &["status", "Robot3"]).contains("no program that answers has a component `Robot3`"));

    // It goes to one program, and reaches the readers in all.
    let sent = accepted(&programs, &["send", "luggage (3,1) to (3,4)"]);
    assert_eq!(sent.matches("1 event accepted").count(), 1, "{sent}");
    let collects = |program: &super::programs::Program| program.printed().contains("collected luggage");
    while !robots.iter().any(|program| collects(program)) {
        std::thread::sleep(Duration::from_millis(50));
    }
    let wrong = refused(&programs, &["send", "lugage (3,1) to (3,4)"]);
    assert!(wrong.contains("program `"), "{wrong}");

    let list = accepted(&programs, &["topic", "list"]);
    assert!(list.contains("POSTOPIC") && list.contains("program `Robot1`:"), "{list}");
    let echoed = accepted(&programs, &["topic", "echo", "POSTOPIC", "-n", "2", "--format", "json"]);
    let components: Vec<String> = echoed
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap()["component"].as_str().unwrap().to_owned())
        .collect();
    assert!(components.len() == 2 && components.iter().all(|name| name.starts_with("Robot")), "{echoed}");
    accepted(&programs, &["topic", "hz", "POSTOPIC", "--for", "300ms"]);
    assert!(refused(&programs, &["topic", "echo", "NOTOPIC", "-n", "1"]).contains("NOTOPIC"));

    let stopped = accepted(&programs, &["estop", "Robot2"]);
    assert!(stopped.contains("program `Robot2`: stopped: Robot2"), "{stopped}");
    programs.until(&robots[1], "emergency stop");
    assert!(!robots[0].printed().contains("emergency stop"), "{}", programs.printed());
    accepted(&programs, &["estop"]);
    programs.until(&robots[0], "emergency stop");

    // Who is stopped answers nothing.
    robots[0].signal(libc::SIGSTOP);
    let silent = asked(&programs, &["estop"], &programs.url(programs.port), &[]);
    robots[0].signal(libc::SIGCONT);
    assert_eq!(silent.status.code(), Some(1), "{}", text(&silent));
    assert!(text(&silent).contains("program `Robot1` does not answer"), "{}", text(&silent));
    let unknown = asked(&programs, &["status"], &programs.url(programs.port), &["--program", "gate"]);
    assert!(text(&unknown).contains("program `gate` is not on the network"), "{}", text(&unknown));
    for program in robots.iter().chain([&master]) {
        programs.stop(program);
    }
    programs.end_without(&broker, &["panicked"]);
}

#[test]
fn a_network_that_is_not_there_is_told() {
    let programs = Programs::new();
    let url = programs.url(free_port());
    let nobody = asked(&programs, &["status"], &url, &[]);
    assert_eq!(nobody.status.code(), Some(2));
    assert!(text(&nobody).contains(&format!("no message broker is at `{url}`")), "{}", text(&nobody));
    let unknown = asked(&programs, &["status"], "tin://can:1", &[]);
    assert!(text(&unknown).contains("the network `tin://can:1` cannot be joined"), "{}", text(&unknown));
}

#[test]
fn users_without_the_right_reach_no_program() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    write_private(&programs.folder().join("users"), "fleet:sesame\nguest:sesame\n");
    let access = "<value>fleet: reads *; writes *; controls</value><value>guest: reads *</value>";
    let broker = broker(&programs, &[("users", "users"), ("access", access)]);
    programs.until(&broker, "listens at");
    let reader = numbers(&programs, "reader", &url, &[("user", "fleet"), ("password", "sesame")]);
    programs.until(&reader, "program `broker` is on the network");
    let done = asked(&programs, &["status"], &url, &["--user", "fleet"]);
    assert!(stdout(&done).contains("program `reader`:"), "{}\n{}", text(&done), programs.printed());
    let guest = asked(&programs, &["status"], &url, &["--user", "guest"]);
    assert_eq!(guest.status.code(), Some(2));
    let said = format!("user `guest` may not control the programs on the network `{url}`");
    assert!(text(&guest).contains(&said), "{}", text(&guest));
    let wrong = asked(&programs, &["status"], &url, &["--user", "other"]);
    assert!(text(&wrong).contains("the broker refuses user `other`"), "{}", text(&wrong));
    programs.stop(&reader);
    programs.end_without(&broker, &["panicked"]);
}
