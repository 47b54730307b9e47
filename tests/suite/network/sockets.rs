//! What programs open, and what goes over the wire.

use std::collections::BTreeSet;
use std::fs;

use super::programs::{Program, Programs, Transport, component};
use super::proxy::{Line, Proxy};
use super::{receives_all, senders};
use crate::support::root;

/// Number of the sockets of a program through which others of a network could be reached.
fn network_sockets(program: &Program) -> usize {
    let pid = program.pid();
    let of_kind = |kind: &str| {
        let text = fs::read_to_string(format!("/proc/{pid}/net/{kind}")).unwrap_or_default();
        let column = if kind == "packet" { 8 } else { 9 };
        let inodes = text.lines().skip(1).filter_map(|line| line.split_whitespace().nth(column));
        inodes.map(|inode| format!("socket:[{inode}]")).collect::<Vec<String>>()
    };
    let kinds = ["tcp", "tcp6", "udp", "udp6", "raw", "raw6", "packet"];
    let of_network: BTreeSet<String> = kinds.into_iter().flat_map(of_kind).collect();
    let descriptors = fs::read_dir(format!("/proc/{pid}/fd")).unwrap();
    let opened = descriptors.filter_map(|entry| fs::read_link(entry.ok()?.path()).ok());
    // Two threads may have a descriptor each for one of them.
    let sockets = opened.map(|target| target.to_string_lossy().into_owned()).filter(|one| of_network.contains(one));
    sockets.collect::<BTreeSet<String>>().len()
}

#[test]
fn a_fleet_in_one_program_opens_no_network_socket() {
    let programs = Programs::over(Transport::Zenoh);
    let airport = root().join("composites/airport.composite");
    let inside = programs.run("inside", &["run", airport.to_str().unwrap(), "--stay"]);
    programs.until(&inside, "collected luggage");
    assert_eq!(network_sockets(&inside), 0, "{}", inside.printed());
    programs.stop(&inside);
    // The count sees those of a program that has some.
    let broker = programs.broker();
    programs.until(&broker, "listens at");
    assert!(network_sockets(&broker) > 0);
    programs.end(&broker);
}

#[test]
fn a_program_has_one_connection_and_gets_each_event_once_however_many_components_read_it() {
    let received = [1, 10].map(|readers: usize| {
        let programs = Programs::new();
        let broker = programs.broker();
        programs.until(&broker, "listens at");
        let proxy = Proxy::to(programs.port, Line::default());
        let url = programs.url(proxy.port);
        let given = [("count", "20000"), ("senders", "2"), ("queue", "50000"), ("period", "100"), ("url", &url)];
        let one = |number: usize| {
            let name = format!("Reader{number}");
            component(&name, "numbers.Reader", &[&given[..], &[("ID", &name)]].concat())
        };
        let reader = programs.start("reader", &(0..readers).map(one).collect::<String>());
        let readers = readers.to_string();
        let given = [("count", "20000"), ("each", "1000"), ("readers", &*readers)];
        let senders = senders(&programs, programs.port, &given);
        programs.until(&senders, "Sender2        begins");
        assert_eq!(network_sockets(&reader), 1, "{}", programs.printed());
        receives_all(&programs, &reader, "20000");
        programs.ends(&senders, 0);
        programs.end(&broker);
        proxy.bytes()
    });
    // Signs of life and the readers themselves are a small part.
    assert!(received[1] < received[0] + received[0] / 4, "{received:?}");
}
