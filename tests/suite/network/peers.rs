//! Networks without a broker: each program listens, and reaches the others.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use super::certificates::Authority;
use super::nodes::{at_node, start};
use super::programs::{Given, Program, Programs, Transport, component, free_port, on_network};
use super::{MANY, took_little_memory};

/// The url of a network of these programs, each of which listens at a port of its own.
fn url(names: &[&str]) -> String {
    let named: Vec<String> = names.iter().map(|name| format!("{name}=127.0.0.1:{}", free_port())).collect();
    format!("peers://{}", named.join(","))
}

/// A fleet of three nodes at a url, with these properties of each component beside its own.
fn fleet(url: &str, more: Given<'_>) -> String {
    let task = |name: &str, class: &str, own: Given<'_>| {
        let usual = [("ID", name), ("period", "100"), ("url", url)];
        component(name, class, &[&usual, more, own].concat())
    };
    let map = "...........\n".repeat(11);
    let scenario =
        "at 1s luggage (3,1) to (3,10)\nthen 300ms every 300ms 3 times luggage (5,0)..(9,10) to (1,0)..(4,10)";
    let battery = [("dischargePerBlock", "1"), ("chargePerSecond", "10")];
    let components = task("Environment", "saoms.Environment", &[("scenario", scenario)])
        + &task("Master", "saoms.MasterEnvironment", &[])
        + &at_node("traffic", task("Zone", "saoms.Zone", &[("map", &map)]))
        + &at_node("gate", task("Robot1", "saoms.Robot", &battery))
        + &at_node("gate", task("Robot2", "saoms.Robot", &battery));
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
         targetNamespace=\"urn:fleet\" name=\"fleet\" s:defaultNode=\"control\">\n{components}</composite>\n"
    )
}

/// Runs the fleet: control, traffic and the gate, which has delivered all luggage.
#[track_caller]
fn run(programs: &Programs, composite: &str, more: &[&str]) -> [Arc<Program>; 3] {
    programs.write("fleet.composite", composite);
    // The first of the peers, which all others reach, is there last.
    let [gate, traffic] = ["gate", "traffic"].map(|node| start(programs, "fleet.composite", node, more));
    programs.until(&gate, "has joined the network at");
    sleep(Duration::from_secs(1));
    let control = start(programs, "fleet.composite", "control", more);
    for luggage in 1..=4 {
        programs.until(&gate, &format!("deposited luggage {luggage} at"));
    }
    [control, traffic, gate]
}

/// Each piece was delivered once.
#[track_caller]
fn has_delivered(programs: &Programs, gate: &Program) {
    for luggage in 1..=4 {
        let deposited = format!("deposited luggage {luggage} at");
        assert_eq!(gate.printed().matches(&deposited).count(), 1, "{}", programs.printed());
    }
    assert!(!programs.printed().contains("panicked"), "{}", programs.printed());
}

#[test]
fn nodes_without_a_broker_are_one_fleet() {
    let programs = Programs::over(Transport::Zenoh);
    let composite = fleet(&url(&["control", "traffic", "gate"]), &[]);
    let all = run(&programs, &composite, &[]);
    for program in &all {
        programs.ends(program, 0);
    }
    has_delivered(&programs, &all[2]);
    // A node that the url forgets is told before anything starts.
    programs.write("fleet.composite", &composite.replace(",gate=", ",gaet="));
    let check = programs.saoms(&["check", "fleet.composite"]);
    let said = String::from_utf8_lossy(&check.stdout).into_owned() + &String::from_utf8_lossy(&check.stderr);
    assert!(said.contains("error[S4030]: node `gate` is not among the peers of this network"), "{said}");
}

#[test]
fn nodes_without_a_broker_recognise_each_other_by_certificates() {
    let programs = Programs::over(Transport::Zenoh);
    let folder = programs.folder();
    let authority = Authority::new(&folder.join("ca.pem"));
    authority.vouch(folder, "own", &["127.0.0.1"]);
    // Who knows the authority of the fleet, but has a certificate of another one.
    Authority::new(&folder.join("other.pem")).vouch(folder, "stranger", &["127.0.0.1"]);
    let tls = |name: &str| {
        [("tlsCa", "ca.pem".to_owned()), ("tlsCertificate", format!("{name}.pem")), ("tlsKey", format!("{name}.key"))]
    };
    let url = url(&["control", "traffic", "gate"]).replace("peers://", "peers+tls://");
    let own = tls("own");
    let own = own.each_ref().map(|(name, value)| (*name, value.as_str()));
    let all = run(&programs, &fleet(&url, &own), &["--stay"]);
    let late = |name: &str, certificate: &str| {
        let files = tls(certificate);
        let files = files.each_ref().map(|(name, value)| (*name, value.as_str()));
        let url = format!("{url},{name}=127.0.0.1:{}", free_port());
        let component = format!("{name}-Reader");
        let reader = [(&*component, "numbers.Reader", &[("count", "1")][..])];
        programs.start(name, &on_network(&url, &files, &reader))
    };
    let stranger = late("stranger", "stranger");
    programs.until(&stranger, "none of them is there yet");
    // One with a certificate of the authority is let in.
    let friend = late("friend", "own");
    for node in ["control", "traffic", "gate"] {
        programs.until(&friend, &format!("program `{node}` is on the network"));
    }
    for program in all.iter().chain([&stranger, &friend]) {
        programs.stop(program);
    }
    for program in all.iter().chain([&friend]) {
        assert!(!program.printed().contains("program `stranger`"), "{}", programs.printed());
    }
    assert!(!stranger.printed().contains("is on the network"), "{}", stranger.printed());
    has_delivered(&programs, &all[2]);
}

#[test]
fn a_program_that_finds_none_of_its_peers_says_so_once() {
    let programs = Programs::over(Transport::Zenoh);
    let url = url(&["other", "reader"]);
    let address = url.strip_prefix("peers://other=").and_then(|rest| rest.split(',').next()).unwrap();
    let task = |name: &str| {
        let component = format!("{name}-Reader");
        programs.start(name, &on_network(&url, &[], &[(&component, "numbers.Reader", &[("count", "1")])]))
    };
    let reader = task("reader");
    let waits = format!("waits for the other programs of the network `{url}`: none of them is there yet");
    programs.until(&reader, &format!("{waits}; it tries `other` at {address}: start them, or correct `url`"));
    let other = task("other");
    programs.until(&reader, "program `other` is on the network");
    programs.stop(&other);
    programs.until(&reader, "program `other` has left the network");
    // Longer than it waits before it says so.
    sleep(Duration::from_secs(3));
    programs.stop(&reader);
    assert_eq!(reader.printed().matches(&waits).count(), 1, "{}", reader.printed());
    assert!(!other.printed().contains("none of them is there"), "{}", other.printed());
}

#[test]
fn peers_go_on_without_one_that_is_killed_and_take_in_who_comes_in_its_place() {
    let programs = Programs::over(Transport::Zenoh);
    let url = url(&["other", "reader", "senders"]);
    let tasks = |name: &str, tasks: &[_]| programs.start(name, &on_network(&url, &[], tasks));
    let other = || tasks("other", &[("other-Reader", "numbers.Reader", &[("count", "1000000")][..])]);
    let given = [("count", MANY), ("each", "1000"), ("readers", "2")];
    let senders = tasks("senders", &[("Sender1", "numbers.Sender", &given[..]), ("Sender2", "numbers.Sender", &given)]);
    let of_reader = [("count", MANY), ("senders", "2"), ("queue", "200000")];
    let reader = tasks("reader", &[("Reader", "numbers.Reader", &of_reader[..])]);
    let killed = other();
    programs.until(&senders, "Sender2        begins");
    killed.kill();
    sleep(Duration::from_secs(1));
    let again = other();
    programs.until(&again, "program `senders` is on the network");
    for sender in ["Sender1", "Sender2"] {
        programs.until(&reader, &format!("has received 1 to {MANY} of {sender}"));
    }
    for program in [&again, &reader, &senders] {
        programs.stop(program);
    }
    for sign in ["panicked", "are lost"] {
        assert!(!programs.printed().contains(sign), "{}", programs.printed());
    }
    assert!(!reader.printed().contains("wrong:"), "{}", programs.printed());
    took_little_memory(&programs);
    // A program that the list does not name can reach nobody, and nobody could reach it.
    let stranger = tasks("stranger", &[("Stranger", "numbers.Reader", &[("count", "1")][..])]);
    programs.ends(&stranger, 2);
    let said = "this program, `stranger`, is not among the peers of this network: `other`, `reader`, `senders`";
    assert!(stranger.printed().contains(said), "{}", stranger.printed());
}
