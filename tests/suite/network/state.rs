//! Programs with a state folder, which are killed: `docs/networks.md` says what holds.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use super::operators::accepted;
use super::programs::{Given, Program, Programs, on_network};
use super::{MANY, reader, receives_all, took_little_memory};

const COUNT: &str = MANY;
const GIVEN: Given<'_> = &[("count", COUNT), ("each", "1000")];

/// Two senders in one program with a state folder.
fn senders(programs: &Programs) -> Arc<Program> {
    let tasks = [("Sender1", "numbers.Sender", GIVEN), ("Sender2", "numbers.Sender", GIVEN)];
    let components = on_network(&programs.url(programs.port), &[], &tasks);
    programs.start_with("senders", &components, |run| {
        run.args(["--state", "senders-state"]);
    })
}

#[test]
fn what_killed_senders_had_accepted_arrives_once_and_in_order() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = reader(&programs, "R", programs.port, &[("count", COUNT)]);
    let first = senders(&programs);
    programs.until(&first, "begins");
    sleep(Duration::from_millis(200));
    // What they send from now on, nobody has when they are killed.
    reader.signal(libc::SIGSTOP);
    sleep(Duration::from_millis(300));
    first.kill();
    let second = senders(&programs);
    programs.until(&second, "has joined the network");
    reader.signal(libc::SIGCONT);
    sleep(Duration::from_millis(300));
    second.kill();
    let third = senders(&programs);
    receives_all(&programs, &reader, COUNT);
    programs.ends(&third, 0);
    took_little_memory(&programs);
    let printed = reader.printed();
    assert!(printed.contains("goes on from its state"), "{printed}");
    assert!(!printed.contains("has begun anew"), "{printed}");
    programs.end(&broker);
}

#[test]
fn a_killed_reader_with_a_state_folder_misses_nothing() {
    let programs = Programs::new();
    let broker = programs.broker();
    let start = || {
        let given = [("senders", "2"), ("queue", "200000"), ("count", COUNT)];
        let components = on_network(&programs.url(programs.port), &[], &[("R-Reader", "numbers.Reader", &given)]);
        programs.start_with("R", &components, |run| {
            run.args(["--state", "reader-state"]);
        })
    };
    let first = start();
    let senders = super::senders(&programs, programs.port, GIVEN);
    programs.until(&senders, "begins");
    sleep(Duration::from_millis(300));
    first.kill();
    let second = start();
    sleep(Duration::from_millis(1_000));
    second.kill();
    let third = start();
    receives_all(&programs, &third, COUNT);
    programs.ends(&senders, 0);
    took_little_memory(&programs);
    programs.end(&broker);
}

#[test]
fn what_an_operator_sends_outlives_the_program_as_well() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = reader(&programs, "R", programs.port, &[("count", "3")]);
    let start = || {
        let tasks: [(_, _, Given<'_>); 1] = [("Sender1", "numbers.Sender", &[("count", "3"), ("each", "3")])];
        let components = on_network(&programs.url(programs.port), &[], &tasks);
        programs.start_with("senders", &components, |run| {
            run.args(["--state", "senders-state"]);
        })
    };
    let first = start();
    programs.until(&reader, "has received 1 to 3 of Sender1");
    reader.signal(libc::SIGSTOP);
    for number in ["1", "2", "3"] {
        let message = format!("{{\"sender\": \"X\", \"number\": {number}, \"filler\": \"\"}}");
        accepted(&programs, &["topic", "pub", "NUMBERS", &message, "--program", "senders"]);
    }
    sleep(Duration::from_millis(300));
    first.kill();
    let second = start();
    programs.until(&second, "has joined the network");
    reader.signal(libc::SIGCONT);
    programs.until(&reader, "has received 1 to 3 of X");
    programs.ends(&reader, 0);
    programs.ends(&second, 0);
    programs.end(&broker);
}
