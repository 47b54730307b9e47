//! Delivery to real listeners and real commands.

use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use saoms_lang::model::HttpAddress;
use serde_json::Value;

use super::*;
use crate::token::Token;

/// A long time, in which everything comes that comes at all.
const LONG: Duration = Duration::from_secs(60);

/// Alerts with a log.
struct Alerts {
    list: AlertList,
    log: Receiver<(Level, String)>,
}

impl Alerts {
    fn of(targets: Vec<AlertTarget>) -> Alerts {
        let (list, (sender, log)) = (AlertList::default(), channel());
        list.deliver("hall", 1000, targets, &move |level, text| drop(sender.send((level, text))));
        Alerts { list, log }
    }

    fn raise(&self, subject: &str) {
        self.list.raise("jam", subject, format!("the belt jams: {subject} \"ü\"\n\0"));
    }

    #[track_caller]
    fn logged(&self) -> String {
        let (level, text) = self.log.recv_timeout(LONG).unwrap();
        format!("{level:?}: {text}")
    }
}

/// A listener on loopback, and the target that is its address.
fn listener(token: Option<&str>) -> (TcpListener, AlertTarget) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let target = url(listener.local_addr().unwrap().port(), token);
    (listener, target)
}

fn url(port: u16, token: Option<&str>) -> AlertTarget {
    let address = HttpAddress::parse(
        &format!("http://127.0.0.1:{port}/page?key=hidden"),
        &saoms_lang::model::AddressHelp::ALERTS,
    )
    .unwrap();
    AlertTarget::Url { address, token: token.map(|token| Token::of(token).unwrap()) }
}

/// Takes a request, whole, and answers.
fn serve(listener: &TcpListener, status: &str) -> (String, Value) {
    let (mut stream, _) = listener.accept().unwrap();
    let request = request(&mut stream);
    stream.write_all(format!("HTTP/1.1 {status}\r\nContent-Length: 0\r\n\r\n").as_bytes()).unwrap();
    request
}

fn request(stream: &mut TcpStream) -> (String, Value) {
    let mut bytes = Vec::new();
    loop {
        let mut part = [0; 4096];
        let count = stream.read(&mut part).unwrap();
        assert_ne!(count, 0, "it ends in the middle");
        bytes.extend_from_slice(&part[..count]);
        let text = String::from_utf8_lossy(&bytes);
        let Some((head, body)) = text.split_once("\r\n\r\n") else { continue };
        let length = head.lines().find_map(|line| line.strip_prefix("Content-Length: ")).unwrap();
        if body.len() == length.parse::<usize>().unwrap() {
            return (head.to_owned(), serde_json::from_str(body).unwrap());
        }
    }
}

fn command(line: &str, folder: &Path) -> AlertTarget {
    AlertTarget::Command { line: line.to_owned(), folder: folder.to_owned() }
}

#[test]
fn each_change_is_posted_in_its_order_with_the_token() {
    let (listener, target) = listener(Some("s3cret"));
    let alerts = Alerts::of(vec![target]);
    alerts.raise("left");
    alerts.list.acknowledge(&[1], "ada").unwrap();
    alerts.list.over("jam", "left");
    let taken: Vec<(String, Value)> = (0..3).map(|_| serve(&listener, "204 No Content")).collect();
    assert_eq!(alerts.list.finish(LONG), 0);
    let events: Vec<&Value> = taken.iter().map(|(_, body)| &body["event"]).collect();
    assert_eq!(events, ["raised", "acknowledged", "over"]);
    let (head, body) = &taken[1];
    assert!(head.starts_with("POST /page?key=hidden HTTP/1.1\r\nHost: 127.0.0.1:"), "{head}");
    assert!(head.contains("\r\nAuthorization: Bearer s3cret\r\n"), "{head}");
    assert!(head.contains("\r\nContent-Type: application/json\r\n"), "{head}");
    assert_eq!((&body["fleet"], &body["started"]), (&Value::from("hall"), &Value::from(1000)));
    let alert = &body["alert"];
    assert_eq!(alert["text"], "the belt jams: left \"ü\"\n\0");
    assert_eq!((&alert["id"], &alert["kind"], &alert["subject"]), (&1.into(), &"jam".into(), &"left".into()));
    assert_eq!(alert["acknowledged"]["by"], "ada");
}

#[test]
fn another_text_of_an_alert_calls_nobody_again() {
    let (listener, target) = listener(None);
    let alerts = Alerts::of(vec![target]);
    alerts.list.raise("jam", "left", "one".to_owned());
    alerts.list.raise("jam", "left", "two".to_owned());
    alerts.list.over("jam", "left");
    let events = [serve(&listener, "200 OK"), serve(&listener, "200 OK")].map(|(_, body)| body["event"].clone());
    assert_eq!(events, ["raised", "over"]);
    assert_eq!(alerts.list.finish(LONG), 0);
}

#[test]
fn what_is_refused_for_now_is_tried_again_and_told_once() {
    let (listener, target) = listener(Some("s3cret"));
    let alerts = Alerts::of(vec![target]);
    alerts.raise("left");
    alerts.raise("right");
    let subjects = ["503 Busy", "429 Too Many", "200 OK", "200 OK"].map(|status| {
        let (_, body) = serve(&listener, status);
        body["alert"]["subject"].as_str().unwrap().to_owned()
    });
    assert_eq!(subjects, ["left", "left", "left", "right"], "the order stays");
    let first = alerts.logged();
    assert!(first.starts_with("Error: alert 1 cannot be delivered to `http://127.0.0.1:"), "{first}");
    assert!(first.contains("/page`: it answers with the status 503; it is tried again"), "{first}");
    assert!(!first.contains("hidden") && !first.contains("s3cret"), "{first}");
    assert!(alerts.logged().starts_with("Info: alerts are delivered to `http://127.0.0.1:"));
    assert_eq!(alerts.list.finish(LONG), 0);
    assert!(alerts.log.try_recv().is_err(), "it is told once");
}

#[test]
fn what_is_refused_for_good_does_not_hold_up_what_follows() {
    let (listener, target) = listener(None);
    let alerts = Alerts::of(vec![target]);
    alerts.raise("left");
    alerts.raise("right");
    for (status, subject) in [("301 Moved", "left"), ("404 Not Found", "right")] {
        assert_eq!(serve(&listener, status).1["alert"]["subject"], subject);
    }
    let told = alerts.logged();
    assert!(told.ends_with("it answers with the status 301: use the address to which it redirects"), "{told}");
    assert_eq!(alerts.list.finish(LONG), 2);
    assert_eq!(alerts.list.counts().undelivered, 0, "a list that was finished has no targets");
}

#[test]
fn nobody_waits_for_a_target_that_hangs_and_what_does_not_fit_is_counted() {
    let (hanging, target) = listener(None);
    let (listener, other) = listener(None);
    let alerts = Alerts::of(vec![target, other]);
    let taken = thread::spawn(move || (0..300).for_each(|_| drop(serve(&listener, "200 OK"))));
    // One that accepts and says nothing; its backlog takes the connections.
    for number in 0..300 {
        alerts.raise(&number.to_string());
        // So that the other one, which is quick, keeps up.
        thread::sleep(Duration::from_millis(2));
    }
    taken.join().unwrap();
    let undelivered = alerts.list.counts().undelivered;
    assert!((40..=44).contains(&undelivered), "{undelivered}");
    let begun = Instant::now();
    assert_eq!(alerts.list.finish(Duration::from_millis(300)), 300);
    assert!(begun.elapsed() < LONG, "the end waits");
    drop(hanging);
}

#[test]
fn a_refusing_and_a_hanging_target_are_told() {
    let (gone, target) = listener(None);
    drop(gone);
    let (hanging, other) = listener(None);
    let alerts = Alerts::of(vec![target, other]);
    alerts.raise("left");
    let mut told = [alerts.logged(), alerts.logged()];
    told.sort();
    assert!(told.iter().any(|one| one.contains("Connection refused")), "{told:?}");
    assert!(told.iter().any(|one| one.contains("it does not answer within 5 s")), "{told:?}");
    assert_eq!(alerts.list.finish(Duration::from_millis(100)), 2);
    drop(hanging);
}

#[test]
fn what_waits_is_tried_once_more_when_the_run_ends() {
    let (listener, target) = listener(None);
    let alerts = Alerts::of(vec![target]);
    alerts.raise("left");
    alerts.raise("right");
    let server = thread::spawn(move || {
        let statuses = ["500 No", "200 OK", "500 No"];
        statuses.map(|status| serve(&listener, status).1["alert"]["subject"].as_str().unwrap().to_owned())
    });
    // The first attempt has failed.
    alerts.logged();
    assert_eq!(alerts.list.finish(LONG), 1, "the second one fails once, and is not tried again");
    assert_eq!(server.join().unwrap(), ["left", "left", "right"]);
}

#[test]
fn a_command_reads_the_change_in_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let line = "read -r line; printf '%s\\n' \"$line\" \"$SAOMS_ALERT_FLEET|$SAOMS_ALERT_EVENT|$SAOMS_ALERT_ID|\
                $SAOMS_ALERT_KIND|$SAOMS_ALERT_COMPONENT|$SAOMS_ALERT_SUBJECT\" \"$SAOMS_ALERT_TEXT\" > told; echo x";
    let alerts = Alerts::of(vec![command(line, folder.path())]);
    alerts.raise("$(touch injected)");
    assert_eq!(alerts.list.finish(LONG), 0);
    let told = fs::read_to_string(folder.path().join("told")).unwrap();
    let (json, rest) = told.split_once('\n').unwrap();
    let body: Value = serde_json::from_str(json).unwrap();
    assert_eq!((&body["event"], &body["alert"]["subject"]), (&"raised".into(), &"$(touch injected)".into()));
    let text = "the belt jams: $(touch injected) \"ü\"\n\u{fffd}";
    assert_eq!(rest, format!("hall|raised|1|jam||$(touch injected)\n{text}\n"));
    assert!(!folder.path().join("injected").exists());
}

#[test]
fn a_command_may_read_nothing_and_a_failing_one_is_tried_again() {
    let folder = tempfile::tempdir().unwrap();
    let line = "echo x >> tried; test $(wc -l < tried) -ge 2";
    let alerts = Alerts::of(vec![command(line, folder.path())]);
    // More than a pipe takes.
    alerts.list.raise("jam", "left", "\u{1}".repeat(4000));
    let told = alerts.logged();
    assert!(told.contains("to the command of the composite: it ended with exit status: 1; it is tried"), "{told}");
    assert!(alerts.logged().starts_with("Info: "));
    assert_eq!(alerts.list.finish(LONG), 0);
    assert_eq!(fs::read_to_string(folder.path().join("tried")).unwrap(), "x\nx\n");
}

#[test]
fn a_command_that_hangs_ends_with_the_run_and_so_does_what_it_started() {
    let folder = tempfile::tempdir().unwrap();
    let alerts = Alerts::of(vec![command("sleep 1000 & echo $! > begun.new; mv begun.new begun; wait", folder.path())]);
    alerts.raise("left");
    let begun = folder.path().join("begun");
    while !begun.exists() {
        thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(alerts.list.finish(Duration::from_millis(100)), 1);
    let pid = fs::read_to_string(begun).unwrap();
    let runs = || {
        let stat = fs::read_to_string(format!("/proc/{}/stat", pid.trim())).unwrap_or_default();
        // One that has ended may wait for its parent.
        stat.rsplit_once(") ").is_some_and(|(_, rest)| !rest.starts_with('Z'))
    };
    let until = Instant::now() + LONG;
    while runs() && Instant::now() < until {
        thread::sleep(Duration::from_millis(5));
    }
    assert!(!runs(), "process {pid} goes on");
}

#[test]
fn a_command_that_cannot_be_started_is_told() {
    let alerts = Alerts::of(vec![command("true", Path::new("/nonexistent"))]);
    alerts.raise("left");
    let told = alerts.logged();
    assert!(told.contains("it cannot be started: No such file or directory"), "{told}");
    assert_eq!(alerts.list.finish(LONG), 1);
}

/// Other code of the process can wait for any child, or let the system forget how they ended.
#[test]
fn a_command_whose_end_somebody_else_took_has_ended() {
    let mut child = std::process::Command::new("true").spawn().unwrap();
    let mut status = 0;
    // SAFETY: the status is written to where there is room for it.
    unsafe { libc::waitpid(libc::pid_t::try_from(child.id()).unwrap(), &raw mut status, 0) };
    assert_eq!(super::command::wait(&mut child, &delivery::End::default()), Ok(()));
}

#[test]
fn a_token_that_no_header_can_hold_is_none() {
    for wrong in ["", "two words", "line\r\nX: y", "grün", &"x".repeat(1025)] {
        assert!(Token::of(wrong).is_none(), "{wrong:?}");
    }
    assert_eq!(format!("{:?}", url(1, Some("s3cret"))).matches("s3cret").count(), 0);
}
