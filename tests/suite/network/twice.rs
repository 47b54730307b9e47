//! A component runs once in a fleet.

use super::nodes::{start, write_fleet};
use super::programs::{Given, Programs, Transport, component, free_port, on_network};
use super::{reader, receives_all, senders};

const GIVEN: Given<'_> = &[("count", "10000"), ("each", "100")];

#[test]
fn a_component_that_runs_in_another_program_is_refused_and_that_one_is_not_disturbed() {
    for transport in [Transport::Relay, Transport::Zenoh] {
        let programs = Programs::over(transport);
        let broker = programs.broker();
        let reader = reader(&programs, "reader", programs.port, &[("count", "10000")]);
        let first = senders(&programs, programs.port, GIVEN);
        programs.until(&first, "Sender2        begins");
        let one: (_, _, Given<'_>) = ("Sender2", "numbers.Sender", GIVEN);
        let second = programs.tasks("second", programs.port, &[one]);
        programs.ends(&second, 1);
        let printed = second.printed();
        let said =
            "component `Sender2` runs in program `senders`, which is there, and a component runs once in a fleet";
        for text in ["runs in program `senders` still: waits for the end of that", said, "nothing runs"] {
            assert!(printed.contains(text), "{text}\n{printed}");
        }
        receives_all(&programs, &reader, "10000");
        programs.ends(&first, 0);
        assert!(!programs.printed().contains("`second` is on the network"), "{}", programs.printed());
        programs.end_without(&broker, &["wrong:", "panicked", "are lost", "has begun anew"]);
    }
}

/// A program with two networks takes nobody's place on the one before it is accepted on the other.
#[test]
fn a_program_that_is_refused_on_one_of_its_networks_ends_nobody_on_another_one() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = reader(&programs, "reader", programs.port, &[("count", "10000")]);
    let first = senders(&programs, programs.port, GIVEN);
    let url = programs.url(programs.port);
    let mut ports = std::iter::repeat_with(free_port);
    let later = ports.find(|port| programs.url(*port) > url).unwrap();
    let address = [("IP", "127.0.0.1"), ("transport", "relay"), ("port", &later.to_string())];
    let there = [("count", "10000"), ("senders", "2")];
    let there = on_network(&programs.url(later), &[], &[("There", "numbers.Reader", &there)]);
    let there_too = programs.start("there", &component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &address));
    let other = programs.start("other", &there);
    programs.until(&other, "has joined the network");
    programs.until(&first, "Sender2        begins");
    // It does not answer for a moment.
    first.signal(libc::SIGSTOP);
    let both = on_network(&url, &[], &[("Sender2", "numbers.Sender", GIVEN)]) + &there;
    let second = programs.start("second", &both);
    programs.until(&second, "`There` runs in program `other` still: waits for the end of that");
    first.signal(libc::SIGCONT);
    programs.ends(&second, 1);
    receives_all(&programs, &reader, "10000");
    programs.ends(&first, 0);
    programs.stop(&other);
    programs.stop(&there_too);
    programs.end_without(&broker, &["wrong:", "panicked", "are lost", "has begun anew", "by now"]);
}

#[test]
fn a_node_that_runs_already_is_refused() {
    let programs = Programs::new();
    write_fleet(&programs, "at 2s luggage (9,1) to (9,10)", &[("gate-a", "500"), ("gate-b", "500")]);
    let all = ["control", "traffic", "gate-a", "gate-b"].map(|node| start(&programs, "fleet.composite", node, &[]));
    programs.until(&all[2], "has joined the network");
    let again = programs.run("again", &["run", "fleet.composite", "--node", "gate-a"]);
    programs.ends(&again, 1);
    let printed = again.printed();
    assert!(printed.contains("runs in program `gate-a`, which is there"), "{printed}");
    assert!(printed.contains("this program runs node `gate-a`"), "{printed}");
    all.iter().for_each(|program| programs.ends(program, 0));
}

/// As a service manager restarts a program that hangs.
#[test]
fn a_program_takes_the_place_of_one_that_says_nothing_any_more() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = reader(&programs, "reader", programs.port, &[("count", "10000")]);
    let first = senders(&programs, programs.port, GIVEN);
    programs.until(&first, "Sender2        begins");
    // It answers once, and then no more.
    let second = senders(&programs, programs.port, GIVEN);
    programs.until(&second, "runs in program `senders` still: waits for the end of that");
    first.signal(libc::SIGSTOP);
    receives_all(&programs, &reader, "10000");
    programs.ends(&second, 0);
    // It comes back when all is over, hears that another one was there in its place, and changes nothing.
    first.signal(libc::SIGCONT);
    programs.ends(&first, 1);
    assert!(first.printed().contains("runs in program `senders` by now"), "{}", first.printed());
    programs.end_without(&broker, &["panicked"]);
}
