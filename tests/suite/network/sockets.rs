//! What programs open, and what goes over the wire.

use std::collections::BTreeSet;
use std::fs;
use std::net::UdpSocket;

use super::programs::{Program, Programs, Transport, component, free_port, on_network};
use super::proxy::{Line, Proxy};
use super::{beside_each_other, reader, receives_all, senders};
use crate::support::root;

/// Number of the sockets of a program through which others of a network could be reached.
fn network_sockets(program: &Program) -> usize {
    sockets(program.pid(), &["tcp", "tcp6", "udp", "udp6", "raw", "raw6", "packet"])
}

/// Number of the sockets of a process for datagrams: without one, it neither says nor hears anything by multicast.
fn datagram_sockets(pid: i32) -> usize {
    sockets(pid, &["udp", "udp6"])
}

/// Number of the sockets of a process of these kinds.
fn sockets(pid: i32, kinds: &[&str]) -> usize {
    let of_kind = |kind: &str| {
        let text = fs::read_to_string(format!("/proc/{pid}/net/{kind}")).unwrap_or_default();
        let column = if kind == "packet" { 8 } else { 9 };
        let inodes = text.lines().skip(1).filter_map(|line| line.split_whitespace().nth(column));
        inodes.map(|inode| format!("socket:[{inode}]")).collect::<Vec<String>>()
    };
    let of_network: BTreeSet<String> = kinds.iter().flat_map(|kind| of_kind(kind)).collect();
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
fn no_program_of_a_network_opens_a_socket_for_datagrams() {
    // The count sees one.
    let own = UdpSocket::bind("127.0.0.1:0").unwrap();
    assert!(datagram_sockets(i32::try_from(std::process::id()).unwrap()) > 0);
    drop(own);
    let programs = Programs::over(Transport::Zenoh);
    let broker = programs.broker();
    let reader = [("Reader", "numbers.Reader", &[("count", "1")][..])];
    let client = programs.tasks("client", programs.port, &reader);
    programs.until(&client, "program `broker` is on the network");
    let url = format!("peers://one=127.0.0.1:{},two=127.0.0.1:{}", free_port(), free_port());
    let peers = ["one", "two"].map(|name| {
        let component = format!("{name}-Reader");
        let reader = [(&*component, "numbers.Reader", &[("count", "1")][..])];
        programs.start(name, &on_network(&url, &[], &reader))
    });
    programs.until(&peers[0], "program `two` is on the network");
    programs.until(&peers[1], "program `one` is on the network");
    for program in [&broker, &client, &peers[0], &peers[1]] {
        assert!(network_sockets(program) > 0, "{}", programs.printed());
        assert_eq!(datagram_sockets(program.pid()), 0, "{}", programs.printed());
    }
    for program in [&client, &peers[0], &peers[1]] {
        programs.stop(program);
    }
    programs.end(&broker);
}

#[test]
fn a_program_has_one_connection_and_gets_each_event_once_however_many_components_read_it() {
    let trial = |transport| {
        let received = [1, 10].map(|readers: usize| {
            let programs = Programs::over(transport);
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
            proxy.received()
        });
        // Signs of life and the readers themselves are a small part.
        assert!(received[1] < received[0] + received[0] / 4, "{received:?}");
    };
    beside_each_other(&[&|| trial(Transport::Relay), &|| trial(Transport::Zenoh)]);
}

#[test]
fn an_event_leaves_a_program_once_however_many_programs_read_it() {
    let trial = |transport| {
        let sent = [1, 5].map(|readers: usize| {
            let programs = Programs::over(transport);
            let broker = programs.broker();
            programs.until(&broker, "listens at");
            let proxy = Proxy::to(programs.port, Line::default());
            let all = (0..readers)
                .map(|number| reader(&programs, &format!("reader{number}"), programs.port, &[("count", "20000")]));
            let all: Vec<_> = all.collect();
            let readers = readers.to_string();
            let given = [("count", "20000"), ("each", "1000"), ("readers", &*readers)];
            let senders = senders(&programs, proxy.port, &given);
            for reader in &all {
                receives_all(&programs, reader, "20000");
            }
            programs.ends(&senders, 0);
            programs.end(&broker);
            proxy.sent()
        });
        // Signs of life name the readers.
        assert!(sent[1] < sent[0] + sent[0] / 4, "{sent:?}");
    };
    beside_each_other(&[&|| trial(Transport::Relay), &|| trial(Transport::Zenoh)]);
}

#[test]
fn one_thread_reads_the_network_unless_the_user_wants_more() {
    let readers = |program: &Program| {
        let tasks = fs::read_dir(format!("/proc/{}/task", program.pid())).unwrap();
        let names = tasks.filter_map(|task| fs::read_to_string(task.ok()?.path().join("comm")).ok());
        names.filter(|name| name.starts_with("rx-")).count()
    };
    for (own, expected) in [(None, 1), (Some("(rx: (worker_threads: 3))"), 3)] {
        let programs = Programs::over(Transport::Zenoh);
        let broker = programs.broker();
        let tasks = on_network(&programs.url(programs.port), &[], &[("Reader", "numbers.Reader", &[("count", "1")])]);
        let client = programs.start_with("client", &tasks, |run| {
            own.map(|own| run.env("ZENOH_RUNTIME", own));
        });
        programs.until(&client, "program `broker` is on the network");
        assert_eq!(readers(&client), expected, "{}", client.printed());
        programs.stop(&client);
        programs.end(&broker);
    }
}
