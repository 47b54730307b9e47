//! A fleet that is divided among programs works as one.

use std::fs;
use std::sync::Arc;

use super::namespace::Namespace;
use super::programs::{Program, Programs, Transport};
use super::{reader, receives_all, senders};
use crate::support::root;

fn work(programs: &Programs) -> Arc<Program> {
    let scenario = "at 3s luggage (3,1) to (3,10)\nat 3s luggage (5,1) to (5,10)";
    let environment = ("Environment", "saoms.Environment", &[("scenario", scenario)][..]);
    programs.tasks("work", programs.port, &[environment, ("Master", "saoms.MasterEnvironment", &[])])
}

fn robots(programs: &Programs) -> Arc<Program> {
    programs.tasks("robots", programs.port, &[("Robot001", "robot.Robot001", &[]), ("Robot002", "robot.Robot002", &[])])
}

#[track_caller]
fn deliver_all(programs: &Programs, broker: &Program, work: &Program, robots: &Program) {
    for luggage in ["deposited luggage 1 at (3,10)", "deposited luggage 2 at (5,10)"] {
        programs.until(robots, luggage);
    }
    // Nobody sees work left: all end that have any.
    programs.ends(work, 0);
    programs.ends(robots, 0);
    assert!(work.printed().contains("2 of 2 pieces of luggage delivered"), "{}", work.printed());
    programs.end(broker);
}

#[test]
fn robots_of_another_program_deliver_all_luggage() {
    let programs = Programs::new();
    let broker = programs.broker();
    let (work, robots) = (work(&programs), robots(&programs));
    deliver_all(&programs, &broker, &work, &robots);
}

#[test]
fn programs_wait_for_the_broker() {
    let programs = Programs::new();
    let (work, robots) = (work(&programs), robots(&programs));
    for program in [&work, &robots] {
        programs.until(program, &format!("waits for the message broker at `{}`", programs.url(programs.port)));
    }
    let broker = programs.broker();
    deliver_all(&programs, &broker, &work, &robots);
}

#[test]
fn a_program_says_that_it_has_joined_once_it_hears_what_it_reads() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = reader(&programs, "reader", programs.port, &[("count", "10"), ("prepares", "1500")]);
    programs.until(&reader, "has joined the network at");
    assert!(reader.printed().contains("is ready"), "{}", reader.printed());
    let senders = senders(&programs, programs.port, &[("count", "10"), ("each", "1")]);
    receives_all(&programs, &reader, "10");
    programs.ends(&senders, 0);
    programs.end(&broker);
}

#[test]
fn robots_of_another_program_deliver_all_luggage_over_zenoh_too() {
    let programs = Programs::over(Transport::Zenoh);
    let (work, robots) = (work(&programs), robots(&programs));
    programs.until(&robots, "waits for the message broker at");
    programs.until(&robots, "nobody listens there");
    let broker = programs.broker();
    deliver_all(&programs, &broker, &work, &robots);
}

/// Figures 6.25 and 6.26 of the manual, each in a program as a user starts it, but for the port, which others may have
/// here.
#[test]
fn the_files_of_the_manual_are_one_fleet() {
    deliver_by_the_manual(&Programs::over(Transport::Zenoh));
}

/// The same to the letter, where nobody else has the port.
#[test]
fn the_files_of_the_manual_are_one_fleet_as_they_are() {
    let Some(namespace) = Namespace::new() else { return };
    let mut programs = Programs::within(namespace, Transport::Zenoh);
    programs.port = 61616;
    deliver_by_the_manual(&programs);
}

/// A third program gives the robots work.
#[track_caller]
fn deliver_by_the_manual(programs: &Programs) {
    for file in ["launchbroker.composite", "launchtasks.composite"] {
        let text = fs::read_to_string(root().join("composites/manual").join(file)).unwrap();
        assert!(text.contains("localhost:61616") || text.contains(">localhost<") && text.contains(">61616<"));
        programs.write(file, &text.replace("61616", &programs.port.to_string()));
    }
    let robots = programs.run("tasks", &["run", "launchtasks.composite"]);
    let broker = programs.run("broker", &["run", "launchbroker.composite"]);
    programs.until(&robots, "has joined the network at");
    let scenario = "at 3s luggage (1,1) to (2,1)\nat 3s luggage (1,2) to (2,2)";
    let environment = ("Environment", "saoms.Environment", &[("scenario", scenario)][..]);
    let work = programs.tasks("work", programs.port, &[environment, ("Master", "saoms.MasterEnvironment", &[])]);
    for luggage in ["deposited luggage 1 at (2,1)", "deposited luggage 2 at (2,2)"] {
        programs.until(&robots, luggage);
    }
    programs.ends(&work, 0);
    programs.ends(&robots, 0);
    programs.end(&broker);
}

#[test]
fn messages_of_a_megabyte_arrive() {
    let programs = Programs::new();
    let broker = programs.broker();
    let usual = [("count", "6"), ("size", "1048576")];
    let reader = reader(&programs, "reader", programs.port, &usual);
    let senders = senders(&programs, programs.port, &[&usual[..], &[("each", "1")]].concat());
    receives_all(&programs, &reader, "6");
    programs.ends(&senders, 0);
    programs.end(&broker);
}
