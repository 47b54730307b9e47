//! Brokers that ask for a password.

use std::sync::Arc;

use super::certificates::write_private;
use super::programs::{Given, Program, Programs, Transport, component, on_network};

pub(super) const BROKER: &str = "unibg.robotics.tca.MessageBrokerImpl";
/// A broker with these properties; the password of the environment is `sesame`.
pub(super) fn broker(programs: &Programs, more: Given<'_>) -> Arc<Program> {
    let port = programs.port.to_string();
    let usual = [("IP", "127.0.0.1"), ("port", port.as_str())];
    programs.start_with("broker", &component("Broker", BROKER, &[&usual, more].concat()), |command| {
        command.env("SAOMS_PASSWORD", "sesame");
    })
}

/// A sender or a reader of numbers, with these properties beside its own.
pub(super) fn numbers(programs: &Programs, name: &str, url: &str, more: Given<'_>) -> Arc<Program> {
    let (class, given) = match name.starts_with("sender") {
        true => ("numbers.Sender", &[("count", "200"), ("each", "20")][..]),
        false => ("numbers.Reader", &[("count", "200")][..]),
    };
    let tasks = [(name, class, given)];
    programs.start_with(name, &on_network(url, more, &tasks), |command| {
        command.env("SAOMS_PASSWORD", "sesame");
    })
}

#[test]
fn programs_with_the_right_password_are_one_fleet_and_others_are_refused() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    write_private(&programs.folder().join("password"), "sesame\n");
    let account = [("user", "fleet"), ("password", "$SAOMS_PASSWORD")];
    let broker = broker(&programs, &account);
    programs.until(&broker, "listens at");
    let reader = numbers(&programs, "reader", &url, &[("user", "fleet"), ("passwordFile", "password")]);
    programs.until(&reader, "has joined the network at");
    let refused = [
        ("sender1", &[("user", "fleet"), ("password", "sesam")][..], "the broker refuses user `fleet`"),
        ("sender2", &[("user", "other"), ("password", "$SAOMS_PASSWORD")], "the broker refuses user `other`"),
        ("sender3", &[], "the broker asks for a user"),
    ];
    for (name, given, said) in refused {
        let program = numbers(&programs, name, &url, given);
        programs.ends(&program, 1);
        let printed = program.printed();
        let who = format!("component `{name}`");
        assert!([said, &url, &who].iter().all(|text| printed.contains(text)), "{printed}");
    }
    let sender = numbers(&programs, "sender", &url, &account);
    programs.until(&reader, "has received 1 to 200 of sender");
    programs.ends(&reader, 0);
    programs.ends(&sender, 0);
    programs.end(&broker);
}

#[test]
fn a_broker_that_knows_no_password_is_not_the_one_that_is_meant() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    let broker = broker(&programs, &[]);
    programs.until(&broker, "listens at");
    let sender = numbers(&programs, "sender", &url, &[("user", "fleet"), ("password", "$SAOMS_PASSWORD")]);
    programs.ends(&sender, 1);
    assert!(sender.printed().contains("the broker asks for no password"), "{}", sender.printed());
    programs.end(&broker);
}

#[test]
fn a_program_is_told_why_it_does_not_come_back_to_a_broker_with_another_password() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    let account = [("user", "fleet"), ("password", "$SAOMS_PASSWORD")];
    let first = broker(&programs, &account);
    let reader = numbers(&programs, "reader", &url, &account);
    programs.until(&reader, "program `broker` is on the network");
    first.kill();
    let second = broker(&programs, &[("user", "fleet"), ("password", "another")]);
    programs.until(&reader, "the broker refuses user `fleet`");
    programs.stop(&reader);
    programs.end_without(&second, &["panicked"]);
}

#[test]
fn what_a_password_is_kept_in_is_checked_before_the_start() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    std::fs::write(programs.folder().join("open"), "sesame").unwrap();
    let wrong = [
        ("sender1", &[("user", "fleet"), ("passwordFile", "nowhere")][..], "`nowhere` cannot be read: No such file"),
        ("sender2", &[("user", "fleet"), ("passwordFile", "open")], "other users can read or change `open`"),
        ("sender3", &[("user", "fleet"), ("password", "$NOWHERE")], "the environment variable `NOWHERE` is not set"),
        ("sender4", &[("user", "a:b"), ("password", "x")], "user `a:b` needs a name without `:`"),
    ];
    for (name, given, said) in wrong {
        let program = numbers(&programs, name, &url, given);
        programs.ends(&program, 2);
        let printed = program.printed();
        let place = format!("--> {name}.composite:2:");
        let all = [said, "error[S4028]", &place, &format!("component `{name}`"), "nothing was started"];
        assert!(all.iter().all(|text| printed.contains(text)), "{printed}");
    }
}
