//! What users are told when a network cannot be used.

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::os::fd::AsRawFd as _;
use std::sync::Arc;
use std::thread::spawn;
use std::time::Duration;

use super::certificates::write_private;
use super::namespace::Namespace;
use super::programs::{Program, Programs, Transport, component, free_port, on_network};

const SENDER: (&str, &str, &[(&str, &str)]) = ("Sender1", "numbers.Sender", &[("count", "10"), ("each", "1")]);

/// What a message about a broker that is not there ends with.
const TO_DO: &str = ": start it, or correct `url` (component `Sender1` needs it)";

/// A program at a url that waits for no broker.
pub(super) fn impatient(programs: &Programs, name: &str, url: &str, time: &str) -> Arc<Program> {
    programs.start_with(name, &on_network(url, &[], &[SENDER]), |command| {
        command.args(["--connect-timeout", time]);
    })
}

#[track_caller]
pub(super) fn ends_with(programs: &Programs, program: &Program, texts: &[&str]) {
    programs.ends(program, 1);
    let printed = program.printed();
    assert!(texts.iter().all(|text| printed.contains(text)), "{texts:?}\n{printed}");
}

#[test]
fn programs_wait_for_a_broker_as_long_as_they_are_told() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    let not = impatient(&programs, "not", &url, "0s");
    let why = format!("the network `{url}` cannot be used: no message broker was there: nobody listens there");
    ends_with(&programs, &not, &[&why, TO_DO, "(component `Sender1` needs it)", "nothing runs"]);
    assert!(!not.printed().contains("waits for"), "{}", not.printed());
    let some = impatient(&programs, "some", &url, "600ms");
    ends_with(&programs, &some, &["waits for the message broker at", "within the 600ms of `--connect-timeout`", TO_DO]);
    assert_eq!(some.printed().matches("waits for the message broker").count(), 1, "{}", some.printed());
}

#[test]
fn who_listens_at_a_port_and_is_no_broker_is_told() {
    let programs = Programs::over(Transport::Zenoh);
    for (name, greeting, said) in [
        ("activemq", &b"\0\0\0\xf0\x01ActiveMQ\0\0\0\x0c"[..], "an ActiveMQ broker listens there"),
        ("ssh", b"SSH-2.0-OpenSSH_9.2\r\n", "speaks first, which no router of a fleet does"),
    ] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = programs.url(listener.local_addr().unwrap().port());
        spawn(move || {
            for stream in listener.incoming() {
                let _ = stream.unwrap().write_all(greeting);
            }
        });
        let program = impatient(&programs, name, &url, "10s");
        ends_with(&programs, &program, &[said, &url, "component `Sender1`"]);
    }
    // One that says nothing, and does not understand.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = programs.url(listener.local_addr().unwrap().port());
    spawn(move || listener.incoming().for_each(drop));
    let program = impatient(&programs, "silent", &url, "3s");
    ends_with(&programs, &program, &["no message broker was there", &url, "component `Sender1`"]);
}

/// A listener that takes no connection any more, as a machine that does not answer: the system drops what asks for one.
fn full() -> (TcpListener, Vec<TcpStream>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    // SAFETY: the socket is open; it has less room from now on.
    assert_eq!(unsafe { libc::listen(listener.as_raw_fd(), 0) }, 0);
    let address = listener.local_addr().unwrap();
    let connect = || TcpStream::connect_timeout(&address, Duration::from_millis(500)).ok();
    let waiting: Vec<TcpStream> = std::iter::from_fn(connect).take(100).collect();
    assert!(waiting.len() < 100, "the listener is never full");
    (listener, waiting)
}

#[test]
fn a_machine_that_does_not_answer_is_told() {
    let programs = Programs::over(Transport::Zenoh);
    let (listener, _waiting) = full();
    let url = programs.url(listener.local_addr().unwrap().port());
    let program = impatient(&programs, "silent", &url, "200ms");
    ends_with(&programs, &program, &["the machine does not answer", &url, TO_DO]);
}

#[test]
fn a_machine_that_cannot_be_reached_is_told() {
    let Some(namespace) = Namespace::new() else { return };
    namespace.ip(&["route", "add", "unreachable", "10.7.0.0/16"]);
    let programs = Programs::within(namespace, Transport::Zenoh);
    for (name, url, said) in [
        ("host", "10.7.0.1:61616", "the machine cannot be reached, or is off"),
        ("network", "10.8.0.1:61616", "this machine has no network that leads there"),
    ] {
        let program = impatient(&programs, name, url, "0s");
        ends_with(&programs, &program, &[said, url, TO_DO]);
    }
}

/// What a router of Zenoh says to a program of another version, and to one without a user where it asks for one: the
/// length of the message, that it closes the session, and that what it heard is invalid.
const CLOSE: [u8; 4] = [2, 0, 0x23, 2];

#[test]
fn a_broker_that_may_speak_another_version_of_zenoh_is_told() {
    let programs = Programs::over(Transport::Zenoh);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = programs.url(listener.local_addr().unwrap().port());
    spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            spawn(move || {
                // Who only looks who listens says nothing.
                if matches!(stream.read(&mut [0; 1024]), Ok(1..)) {
                    let _ = stream.write_all(&CLOSE);
                    let _ = stream.read(&mut [0; 1024]);
                }
            });
        }
    });
    let program = impatient(&programs, "nobody", &url, "10s");
    let both = "the broker asks for a user, or speaks another version of Zenoh";
    ends_with(&programs, &program, &[both, "build both programs from one version", &url, "component `Sender1`"]);
    write_private(&programs.folder().join("password"), "sesame");
    let account = [("user", "fleet"), ("passwordFile", "password")];
    let program = programs.start("fleet", &on_network(&url, &account, &[SENDER]));
    ends_with(&programs, &program, &["it speaks another version of Zenoh", &url, "component `Sender1`"]);
}

#[test]
fn a_name_that_is_not_found_and_a_port_that_is_taken_are_told() {
    let programs = Programs::over(Transport::Zenoh);
    let unknown = impatient(&programs, "unknown", "gate-a.invalid:61616", "0s");
    ends_with(&programs, &unknown, &["the name of the machine is not known", "gate-a.invalid:61616", TO_DO]);
    let port = free_port();
    let _taken = TcpListener::bind(("127.0.0.1", port)).unwrap();
    let address = [("IP", "127.0.0.1"), ("port", &port.to_string())];
    let broker = programs.start("broker", &component("Broker", "saoms.MessageBroker", &address));
    ends_with(
        &programs,
        &broker,
        &["another program listens at this port", "(component `Broker` serves it)", &port.to_string()],
    );
}

#[test]
fn credentials_for_a_transport_without_users_are_refused() {
    let programs = Programs::new();
    let given = [("user", "fleet"), ("password", "sesame")];
    let tasks = on_network(&programs.url(programs.port), &given, &[SENDER]);
    let program = programs.start("tasks", &tasks);
    programs.ends(&program, 2);
    let printed = program.printed();
    let all = ["error[S4028]", "a relay has neither users nor TLS", "property `user`", "--> tasks.composite:2:"];
    assert!(all.iter().all(|text| printed.contains(text)), "{printed}");
}
