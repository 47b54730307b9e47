//! Events that are lost for good: the runs at both ends fail, and say how many it were.

use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::sync::Arc;

use serde_json::Value;

use super::programs::{Program, Programs, on_network};

/// A program with one component of this class, and a report.
fn start(programs: &Programs, name: &str, class: &str, given: &[(&str, &str)], options: &[&str]) -> Arc<Program> {
    let component = format!("{name}-1");
    let components = on_network(&programs.url(programs.port), &[], &[(&component, class, given)]);
    programs.start_with(name, &components, |run| {
        run.args(["--short-report", "--report", &format!("{name}.json")]).args(options);
    })
}

/// The number of lost messages in the report of a program, which has failed for them.
#[track_caller]
fn lost(programs: &Programs, name: &str) -> u64 {
    let report: Value = serde_json::from_str(&programs.read(&format!("{name}.json"))).unwrap();
    let reasons = report["outcome"]["reasons"].to_string();
    let count = report["networks"]["lost"].as_u64().unwrap_or_default();
    let is_told = reasons.contains(&format!("lost on the network `{}`", programs.url(programs.port)));
    assert!(report["outcome"]["status"] == "failed" && is_told, "{report}");
    count
}

/// The number of lost messages in the metrics of a program.
fn counted(programs: &Programs, program: &Program) -> f64 {
    let mut stream = UnixStream::connect(programs.socket(program)).unwrap();
    stream.write_all(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let counter = format!("saoms_network_lost_total{{network=\"{}\"}} ", programs.url(programs.port));
    let count = answer.lines().find_map(|line| line.strip_prefix(&counter)?.parse().ok());
    count.unwrap_or_else(|| panic!("{answer}"))
}

#[test]
fn events_beyond_the_memory_for_them_are_counted_at_both_ends_and_fail_the_runs() {
    let programs = Programs::new();
    let broker = programs.broker();
    // So much that no network keeps it on its way. The reader waits for one more than there is.
    let given = [("count", "2001"), ("size", "40000"), ("queue", "3000")];
    let reader = start(&programs, "reader", "numbers.Reader", &given, &[]);
    let given = [("count", "2000"), ("size", "40000"), ("each", "50")];
    let sender = start(&programs, "sender", "numbers.Sender", &given, &["--backlog", "200kB", "--stay"]);
    programs.until(&sender, "begins");
    reader.signal(libc::SIGSTOP);
    programs.until(&sender, "program `reader` was away for so long that no more events are kept for it");
    programs.until(&sender, "has sent 1 to 2000");
    reader.signal(libc::SIGCONT);
    programs.until(&reader, "are lost: it does not have them any more");
    // An operator ends them: a signal would hide how they ended.
    for (name, program) in [("sender", &sender), ("reader", &reader)] {
        let before = counted(&programs, program);
        let socket = programs.socket(program);
        programs.saoms(&["down", "--fleet", socket.to_str().unwrap()]);
        programs.ends(program, 1);
        let count = lost(&programs, name);
        assert!((1..=2000).contains(&count) && before > 0.0 && count as f64 >= before, "{name}: {before}, {count}");
    }
    programs.end_without(&broker, &["panicked"]);
}

#[test]
fn a_run_ends_as_failed_if_a_reader_that_is_away_never_receives_its_events() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = start(&programs, "reader", "numbers.Reader", &[("count", "1000")], &[]);
    let given = [("count", "1000"), ("each", "100")];
    let sender = start(&programs, "sender", "numbers.Sender", &given, &["--linger", "4s"]);
    programs.until(&sender, "begins");
    reader.kill();
    programs.until(&sender, "program `reader`, which gives no sign of life, has not received");
    programs.ends(&sender, 1);
    let count = lost(&programs, "sender");
    assert!((1..=1000).contains(&count), "{count}");
    let told = format!("program `reader` has not received {count} messages on topic `NUMBERS`, and this program ends");
    assert!(sender.printed().contains(&told), "{}", sender.printed());
    programs.end_without(&broker, &["panicked"]);
}

/// As long as the outages that networks survive.
#[test]
fn who_has_sent_all_waits_for_readers_that_are_away() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = start(&programs, "reader", "numbers.Reader", &[("count", "1000"), ("queue", "2000")], &[]);
    let sender = start(&programs, "sender", "numbers.Sender", &[("count", "1000"), ("each", "100")], &[]);
    programs.until(&sender, "begins");
    reader.signal(libc::SIGSTOP);
    programs.until(&sender, "has sent 1 to 1000");
    std::thread::sleep(std::time::Duration::from_secs(20));
    reader.signal(libc::SIGCONT);
    programs.until(&reader, "has received 1 to 1000 of sender-1");
    for program in [&reader, &sender] {
        programs.ends(program, 0);
    }
    let waits = "program `reader`, which gives no sign of life, has not received";
    assert_eq!(sender.printed().matches(waits).count(), 1, "{}", sender.printed());
    programs.end(&broker);
}

#[test]
fn ctrl_c_ends_the_wait_for_readers_that_are_away() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = start(&programs, "reader", "numbers.Reader", &[("count", "1000")], &[]);
    let given = [("count", "1000"), ("each", "100")];
    let sender = start(&programs, "sender", "numbers.Sender", &given, &["--linger", "1h"]);
    programs.until(&sender, "begins");
    reader.kill();
    programs.until(&sender, "Ctrl-C ends it before");
    sender.signal(libc::SIGINT);
    programs.ends(&sender, 130);
    assert!(sender.printed().contains("and this program ends"), "{}", sender.printed());
    programs.end_without(&broker, &["panicked"]);
}
