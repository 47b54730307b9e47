//! Programs that are killed or stop.

use std::thread::sleep;
use std::time::Duration;

use super::namespace::Namespace;
use super::programs::{Programs, Transport, component, on_network};
use super::{AWAY, MANY, STOPPED, beside_each_other, reader, receives_all, senders, took_little_memory};

#[test]
fn a_broker_that_is_killed_and_comes_again_costs_no_event() {
    broker_comes_again(&Programs::new());
}

#[test]
fn a_broker_that_is_killed_and_comes_again_costs_no_event_over_zenoh() {
    broker_comes_again(&Programs::over(Transport::Zenoh));
}

#[track_caller]
fn broker_comes_again(programs: &Programs) {
    let first = programs.broker();
    let reader = reader(programs, "reader", programs.port, &[("count", MANY)]);
    let senders = senders(programs, programs.port, &[("count", MANY), ("each", "1000")]);
    programs.until(&senders, "Sender2        begins");
    sleep(Duration::from_secs(1));
    first.kill();
    sleep(AWAY);
    assert!(senders.printed().contains("program `broker` gives no sign of life"), "{}", programs.printed());
    let second = programs.broker();
    receives_all(programs, &reader, MANY);
    programs.ends(&senders, 0);
    took_little_memory(programs);
    programs.end(&second);
}

#[test]
fn a_link_that_is_down_for_seconds_costs_no_event() {
    let trial = |transport| {
        let Some(namespace) = Namespace::new() else { return };
        let programs = Programs::within(namespace, transport);
        let broker = programs.broker();
        let reader = reader(&programs, "reader", programs.port, &[("count", MANY)]);
        let senders = senders(&programs, programs.port, &[("count", MANY), ("each", "1000")]);
        programs.until(&senders, "Sender2        begins");
        sleep(Duration::from_secs(1));
        programs.set_link(false);
        sleep(AWAY);
        assert!(senders.printed().contains("program `reader` gives no sign of life"), "{}", programs.printed());
        programs.set_link(true);
        receives_all(&programs, &reader, MANY);
        programs.ends(&senders, 0);
        took_little_memory(&programs);
        programs.end(&broker);
    };
    beside_each_other(&[&|| trial(Transport::Relay), &|| trial(Transport::Zenoh)]);
}

#[test]
fn programs_that_stop_for_seconds_miss_nothing_and_nothing_of_them_is_missed() {
    let trial = |transport, stops_reader: bool| {
        let programs = Programs::over(transport);
        let broker = programs.broker();
        let reader = reader(&programs, "reader", programs.port, &[("count", MANY)]);
        let senders = senders(&programs, programs.port, &[("count", MANY), ("each", "1000")]);
        programs.until(&senders, "Sender2        begins");
        let (stopped, name, other) =
            if stops_reader { (&reader, "reader", &senders) } else { (&senders, "senders", &reader) };
        stopped.signal(libc::SIGSTOP);
        programs.until(other, &format!("program `{name}` gives no sign of life"));
        sleep(STOPPED);
        stopped.signal(libc::SIGCONT);
        programs.until(other, &format!("program `{name}` gives signs of life again"));
        receives_all(&programs, &reader, MANY);
        programs.ends(&senders, 0);
        took_little_memory(&programs);
        programs.end(&broker);
    };
    beside_each_other(&[
        &|| trial(Transport::Relay, true),
        &|| trial(Transport::Relay, false),
        &|| trial(Transport::Zenoh, true),
        &|| trial(Transport::Zenoh, false),
    ]);
}

/// It has room for less than what is sent while it executes once.
#[test]
fn a_reader_that_is_slower_than_the_senders_receives_all_in_order() {
    let trial = |transport| {
        let programs = Programs::over(transport);
        let broker = programs.broker();
        let slow = [("count", MANY), ("senders", "2"), ("queue", "1500")];
        let reader = programs.tasks("reader", programs.port, &[("Reader", "numbers.Reader", &slow)]);
        let senders = senders(&programs, programs.port, &[("count", MANY), ("each", "1000")]);
        receives_all(&programs, &reader, MANY);
        programs.ends(&senders, 0);
        took_little_memory(&programs);
        programs.end(&broker);
    };
    beside_each_other(&[&|| trial(Transport::Relay), &|| trial(Transport::Zenoh)]);
}

#[test]
fn others_go_on_without_a_reader_that_is_killed() {
    let trial = |transport| {
        let programs = Programs::over(transport);
        let broker = programs.broker();
        let stays = reader(&programs, "stays", programs.port, &[("count", MANY)]);
        let dies = reader(&programs, "dies", programs.port, &[("count", MANY)]);
        let given = [("count", MANY), ("each", "1000"), ("readers", "2")];
        let tasks = [("Sender1", "numbers.Sender", &given[..]), ("Sender2", "numbers.Sender", &given)];
        let tasks = on_network(&programs.url(programs.port), &[], &tasks);
        let senders = programs.start_with("senders", &tasks, |run| {
            run.args(["--linger", "3s"]);
        });
        programs.until(&senders, "Sender2        begins");
        sleep(Duration::from_millis(500));
        dies.kill();
        receives_all(&programs, &stays, MANY);
        // One that wanted them has not received all.
        programs.ends(&senders, 1);
        assert!(senders.printed().contains("program `dies` has not received"), "{}", senders.printed());
        took_little_memory(&programs);
        programs.end(&broker);
    };
    beside_each_other(&[&|| trial(Transport::Relay), &|| trial(Transport::Zenoh)]);
}

/// As a service manager does it.
#[test]
fn a_program_that_is_killed_and_started_again_at_once_is_heard_from_its_first_event() {
    let trial = |transport| {
        let programs = Programs::over(transport);
        let broker = programs.broker();
        let reader = reader(&programs, "reader", programs.port, &[("count", MANY)]);
        let given = [("count", MANY), ("each", "1000")];
        let first = senders(&programs, programs.port, &given);
        programs.until(&first, "Sender2        begins");
        sleep(Duration::from_millis(500));
        first.kill();
        let second = senders(&programs, programs.port, &given);
        receives_all(&programs, &reader, MANY);
        programs.ends(&second, 0);
        let printed = reader.printed();
        let wrong: Vec<&str> = printed.lines().filter_map(|line| Some(line.split_once("wrong: ")?.1)).collect();
        let is_first =
            |sender: u32| wrong.iter().any(|line| line.starts_with(&format!("received 1 of Sender{sender},")));
        assert!(wrong.len() == 2 && is_first(1) && is_first(2), "{wrong:?}\n{}", programs.printed());
        took_little_memory(&programs);
        programs.end_without(&broker, &["panicked", "are lost", "runs in program"]);
    };
    beside_each_other(&[&|| trial(Transport::Relay), &|| trial(Transport::Zenoh)]);
}

#[test]
fn a_component_that_reads_nothing_for_long_keeps_nothing_from_others_in_its_program() {
    let programs = Programs::new();
    let broker = programs.broker();
    let url = programs.url(programs.port);
    // It executes once, and has room for a part of what is sent.
    let slow = [("ID", "slow"), ("period", "1h"), ("url", &url), ("count", "1000"), ("queue", "64")];
    let near = [("ID", "near"), ("period", "100"), ("url", &url), ("from", "10"), ("to", "10")];
    let both = component("slow", "numbers.Reader", &slow) + &component("near", "numbers.Walker", &near);
    let reader = programs.start("reader", &both);
    let sender = [("Sender1", "numbers.Sender", &[("count", "1000"), ("each", "100")][..])];
    let senders = programs.tasks("senders", programs.port, &sender);
    programs.until(&senders, "has sent 1 to 1000");
    let walks = [("walks", "numbers.Walker", &[("from", "10"), ("to", "12")][..])];
    let walks = programs.tasks("walks", programs.port, &walks);
    programs.until(&reader, "meets walks at");
    for program in [&reader, &walks, &senders] {
        programs.stop(program);
    }
    programs.end_without(&broker, &["wrong:", "panicked"]);
}
