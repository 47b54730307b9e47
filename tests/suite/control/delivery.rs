//! Delivery of alerts to what the composite names, by real processes.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use super::metrics::metrics;
use super::{Running, fleet};
use crate::support::{answer, saoms_in, saoms_with, text};

/// Lines that the command of the composite writes: an alert each.
const PAGE: &str = "#!/bin/sh\nread -r line\nprintf '%s\\n' \"$line\" >> told\n";

/// The fleet with these attributes in the namespace of SAOMS.
fn with(attributes: &str) -> String {
    fleet().replacen(" name=\"fleet\"", &format!(" name=\"fleet\" xmlns:s=\"urn:saoms:1\" {attributes}"), 1)
}

/// A folder with a composite with these attributes, and the command `page.sh`.
fn folder(attributes: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fleet.composite"), with(attributes)).unwrap();
    let page = folder.path().join("page.sh");
    fs::write(&page, PAGE).unwrap();
    assert!(Command::new("chmod").arg("+x").arg(&page).status().unwrap().success());
    folder
}

/// What the command wrote.
fn told(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("told")).unwrap_or_default();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Takes a request and answers; gives its head and its body.
fn serve(listener: &TcpListener) -> (String, Value) {
    let (stream, _) = listener.accept().unwrap();
    let mut reader = BufReader::new(stream);
    let (mut head, mut length) = (String::new(), 0);
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        if line.trim().is_empty() {
            break;
        }
        length = line.strip_prefix("Content-Length: ").map_or(length, |value| value.trim().parse().unwrap());
        head += &line;
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).unwrap();
    reader.get_mut().write_all(b"HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n").unwrap();
    (head, serde_json::from_slice(&body).unwrap())
}

#[test]
fn alerts_are_sent_to_the_address_and_given_to_the_command_of_the_composite() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let folder = folder(&format!(
        "s:alertUrl=\"http://127.0.0.1:{port}/hall\" s:alertTokenEnv=\"HALL_TOKEN\" s:alertCommand=\"./page.sh\""
    ));
    let running = Running::start_with(folder, &["--stay", "--alerts", "--log", "run.log"], |run| {
        run.env("HALL_TOKEN", "s3cret-of-the-pager");
    });
    running.told(&["estop"]);
    let (head, raised) = serve(&listener);
    assert!(head.starts_with("POST /hall HTTP/1.1\r\n"), "{head}");
    assert!(head.contains("\r\nAuthorization: Bearer s3cret-of-the-pager\r\n"), "{head}");
    assert_eq!((&raised["fleet"], &raised["event"]), (&"fleet".into(), &"raised".into()));
    assert_eq!(raised["alert"]["kind"], "emergency_stop");
    running.told(&["alerts", "ack", "1"]);
    let (_, acknowledged) = serve(&listener);
    assert_eq!(acknowledged["event"], "acknowledged");
    running.told(&["release"]);
    assert_eq!(serve(&listener).1["event"], "over");
    while told(running.folder()).len() < 3 {
        sleep(Duration::from_millis(5));
    }
    assert_eq!(told(running.folder())[0], raised);
    assert!(metrics(&running).contains("saoms_alerts_undelivered_total 0\n"));
    running.told(&["down"]);
    let mut running = running;
    let (code, printed) = running.wait();
    assert_eq!(code, Some(0), "{printed}");
    let log = fs::read_to_string(running.folder().join("run.log")).unwrap();
    assert!(!(printed + &log).contains("s3cret"), "{log}");
}

#[test]
fn a_composite_sends_nothing_and_runs_nothing_unless_the_run_allows_it() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.set_nonblocking(true).unwrap();
    let port = listener.local_addr().unwrap().port();
    let attributes = format!("s:alertUrl=\"http://127.0.0.1:{port}/a?key=hidden\" s:alertCommand=\"touch ran\"");
    let folder = folder(&attributes);
    for command in ["check", "check --wiring", "expand", "fmt --check", "graph"] {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        arguments.push("fleet.composite");
        let output = saoms_in(folder.path(), &arguments);
        assert!(command.starts_with("fmt") || output.status.success(), "{command}: {}", text(&output));
    }
    let running = Running::start_in(folder, &["--stay"]);
    running.told(&["estop"]);
    running.told(&["release"]);
    running.told(&["down"]);
    let mut running = running;
    let (code, printed) = running.wait();
    assert_eq!(code, Some(0), "{printed}");
    let expected = format!(
        "alerts are not sent to `http://127.0.0.1:{port}/a` nor given to the command `touch ran`: `--alerts` allows it\n"
    );
    assert_eq!(printed.matches(&expected).count(), 1, "{printed}");
    assert!(!printed.contains("hidden"), "{printed}");
    assert!(!running.folder().join("ran").exists());
    assert!(listener.accept().is_err(), "somebody connected");
}

#[test]
fn what_the_option_lacks_is_told_before_anything_starts() {
    let wrong = |attributes: &str, set: Option<&str>| {
        let folder = folder(attributes);
        let mut run = crate::support::command(&["run", "fleet.composite", "--virtual", "--alerts"]);
        run.current_dir(folder.path()).env_remove("HALL_TOKEN");
        if let Some(value) = set {
            run.env("HALL_TOKEN", value);
        }
        let (code, printed, said) = answer(&run.output().unwrap());
        assert_eq!((code, printed.as_str()), (2, ""), "{said}");
        assert!(said.ends_with("\n1 error: nothing was started\n"), "{said}");
        said
    };
    let said = wrong("s:hangup=\"hold\"", None);
    assert!(said.contains("error: `--alerts` has nothing to deliver to: no composite names"), "{said}");
    let url = "s:alertUrl=\"http://127.0.0.1:1/\" s:alertTokenEnv=\"HALL_TOKEN\"";
    for empty in [None, Some("")] {
        let said = wrong(url, empty);
        assert!(said.contains("error: the environment variable `HALL_TOKEN`, which the composite names"), "{said}");
    }
    let said = wrong(url, Some("s3cret\r\nX: y"));
    assert!(said.contains("`HALL_TOKEN` holds no token") && !said.contains("s3cret"), "{said}");
}

#[test]
fn a_run_ends_although_a_target_hangs_and_says_what_is_lost() {
    let hanging = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = hanging.local_addr().unwrap().port();
    let folder = folder(&format!("s:alertUrl=\"http://127.0.0.1:{port}/\" s:alertCommand=\"sleep 1000\""));
    let running = Running::start_in(folder, &["--stay", "--alerts"]);
    running.told(&["estop"]);
    // The first execution after the stop is none that waits for a target.
    let stopped = running.component("Robot1")["executions"].as_u64().unwrap();
    running.until("Robot1", |robot| robot["executions"].as_u64().unwrap() > stopped + 20);
    running.told(&["down"]);
    let (code, printed) = running.end();
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("error: 2 changes of alerts could not be delivered\n"), "{printed}");
}

#[test]
fn what_is_raised_at_the_end_is_delivered_and_a_failing_target_is_in_the_log() {
    let folder = folder("s:alertCommand=\"test -e open &amp;&amp; ./page.sh\"");
    let running = Running::start_in(folder, &["--stay", "--alerts"]);
    running.told(&["estop"]);
    let is_told =
        |log: &str| log.contains("alert 1 cannot be delivered to the command of the composite: it ended with");
    while !is_told(&running.told(&["logs"])) {
        sleep(Duration::from_millis(10));
    }
    fs::write(running.folder().join("open"), "").unwrap();
    running.told(&["down"]);
    let mut running = running;
    let (code, printed) = running.wait();
    assert_eq!(code, Some(0), "{printed}");
    assert_eq!(told(running.folder())[0]["alert"]["kind"], "emergency_stop");
    assert!(!printed.contains("could not be delivered"), "{printed}");
}

#[test]
fn alerts_of_a_run_in_virtual_time_are_delivered_in_the_folder_of_the_composite() {
    let folder = folder("s:alertCommand=\"./page.sh\"");
    fs::write(folder.path().join("events.txt"), "at 1s estop by ada\nat 2s release by ada\n").unwrap();
    let from = folder.path().parent().unwrap();
    let within = |name: &str| folder.path().join(name).display().to_string();
    let arguments = ["run", &within("fleet.composite"), "--virtual", "--for", "3s", "--alerts", "--quiet"];
    let output = saoms_in(from, &[&arguments[..], &["--events", &within("events.txt")]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    let events: Vec<Value> = told(folder.path()).iter().map(|one| one["event"].clone()).collect();
    assert_eq!(events, ["raised", "over"]);
    assert_eq!(told(folder.path())[0]["alert"]["time_s"], 1.0);
}

#[test]
fn the_checker_says_where_a_target_is_wrong_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let check = |attributes: &str| text(&saoms_with(folder.path(), &["check", "-"], with(attributes).as_bytes()));
    let said = check("s:alertUrl=\"https://page.example/a\"");
    assert!(said.contains("`https://page.example/a` is an address of HTTPS"), "{said}");
    assert!(said.contains("saoms:alertCommand=\"curl --fail"), "{said}");
    let said = check("s:alertUrl=\"http://me:pass@page.example/a\"");
    assert!(said.contains("has an account before `@`") && said.contains("`alertTokenEnv`"), "{said}");
}
