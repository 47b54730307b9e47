//! Calls of components of other programs.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use super::programs::{Program, Programs, component};
use super::proxy::{Line, Proxy};
use crate::boundary::build;
use crate::support::text;

/// Writes a fleet of three nodes: a broker, one that counts calls, and one of this class that makes them.
fn write_fleet(programs: &Programs, class: &str, more: &[(&str, &str)]) {
    write_fleet_with(programs, "calls.Tally", class, more);
}

/// The same with this class of the one that is called.
fn write_fleet_with(programs: &Programs, called: &str, class: &str, more: &[(&str, &str)]) {
    let port = programs.port.to_string();
    let broker = [("IP", "127.0.0.1"), ("transport", "relay"), ("port", &port)];
    let at = |node: &str, text: String| text.replacen("<component ", &format!("<component s:node=\"{node}\" "), 1);
    let caller = component("Caller", class, &[&[("ID", "Caller"), ("period", "50")], more].concat());
    let wire = "<property name=\"url\" source=\"$url\"/><reference name=\"counter\" target=\"Tally\"/></component>";
    let components = component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &broker)
        + &at("server", component("Tally", called, &[]))
        + &at("client", caller.replacen("</component>", wire, 1));
    let url = programs.url(programs.port);
    programs.write(
        "fleet.composite",
        &format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
             xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\" targetNamespace=\"urn:fleet\" name=\"fleet\" \
             s:defaultNode=\"broker\">\n<property name=\"url\" type=\"xsd:string\">{url}</property>\n{components}\
             </composite>\n"
        ),
    );
}

/// Starts a node with this library of its classes.
fn start_with(programs: &Programs, node: &str, library: &str, more: &[&str]) -> Arc<Program> {
    let library = build::library(library);
    let arguments = ["run", "fleet.composite", "--node", node, "--plugin", library.to_str().unwrap()];
    programs.run(node, &[&arguments, more].concat())
}

fn start(programs: &Programs, node: &str) -> Arc<Program> {
    start_with(programs, node, "calls", &[])
}

#[test]
fn a_class_that_is_apart_calls_a_service_of_another_program() {
    let programs = Programs::new();
    write_fleet(&programs, "calls.Caller", &[("calls", "200"), ("first", "0")]);
    let all = ["broker", "client", "server"].map(|node| start(&programs, node));
    programs.until(&all[1], "made 200 calls, 199 were answered");
    programs.until(&all[1], "failed: component `Tally` could not serve the call: nobody counts from 0");
    programs.ends(&all[1], 0);
    programs.stop(&all[2]);
    programs.end(&all[0]);
}

#[test]
fn a_call_over_a_line_that_breaks_again_and_again_runs_at_most_once() {
    let programs = Programs::new();
    write_fleet(&programs, "calls.Caller", &[("calls", "150")]);
    let (broker, server) = (start(&programs, "broker"), start(&programs, "server"));
    programs.until(&broker, "listens at");
    let proxy = Proxy::to(programs.port, Line { delay: Duration::from_millis(5), few: 0 });
    let url = format!("url={}", programs.url(proxy.port));
    let client = start_with(&programs, "client", "calls", &["--set", &url]);
    programs.until(&client, "program `server` is on the network");
    for _ in 0..4 {
        sleep(Duration::from_millis(200));
        proxy.cut();
        sleep(Duration::from_millis(200));
        proxy.swallow();
    }
    proxy.cut();
    programs.until(&client, "made 150 calls");
    programs.ends(&client, 0);
    programs.stop(&server);
    programs.end(&broker);
}

#[test]
fn a_call_whose_server_is_killed_fails_at_its_deadline_or_once_it_begins_anew() {
    let programs = Programs::new();
    write_fleet(&programs, "calls.Caller", &[("calls", "20"), ("rest", "60000")]);
    let broker = start(&programs, "broker");
    let server = start(&programs, "server");
    let client = start(&programs, "client");
    programs.until(&server, "rests");
    server.kill();
    let url = programs.url(programs.port);
    let late = format!("component `Tally` could not serve the call: no answer came within 3s over the network `{url}`");
    programs.until(&client, &late);
    let server = start(&programs, "server");
    programs.until(&client, "made 20 calls");
    programs.ends(&client, 0);
    assert!(!server.printed().contains("rests"), "{}", programs.printed());
    programs.stop(&server);
    programs.end(&broker);
}

#[test]
fn a_call_of_a_program_that_is_not_there_fails_at_its_deadline() {
    let programs = Programs::new();
    write_fleet(&programs, "calls.Caller", &[("calls", "1")]);
    let (broker, client) = (start(&programs, "broker"), start(&programs, "client"));
    programs.until(&client, "nobody runs its node `server` there");
    programs.until(&client, "made 1 calls, 0 were answered");
    programs.stop(&client);
    programs.end(&broker);
}

#[test]
fn a_reference_sets_the_deadline_of_its_calls() {
    for (deadline, more, answered) in
        [("500ms", &[("calls", "1")][..], 0), ("1min", &[("calls", "1"), ("rest", "4000")], 1)]
    {
        let programs = Programs::new();
        write_fleet(&programs, "calls.Caller", more);
        let given = format!("target=\"Tally\" s:deadline=\"{deadline}\"");
        programs.write("fleet.composite", &programs.read("fleet.composite").replace("target=\"Tally\"", &given));
        let (broker, client) = (start(&programs, "broker"), start(&programs, "client"));
        // Without a server, a call fails in time; with one, it is waited for longer than usual.
        match answered {
            0 => programs.until(&client, "no answer came within 500ms over the network"),
            _ => {
                let server = start(&programs, "server");
                programs.until(&client, "has rested");
                programs.until(&client, "made 1 calls, 1 were answered");
                programs.ends(&client, 0);
                programs.stop(&server);
            }
        }
        programs.until(&client, &format!("made 1 calls, {answered} were answered"));
        programs.stop(&client);
        programs.end(&broker);
    }
}

#[test]
fn programs_with_different_interfaces_say_so_with_both_ends() {
    let programs = Programs::new();
    write_fleet(&programs, "calls.Caller", &[("calls", "1")]);
    let (broker, client) = (start(&programs, "broker"), start(&programs, "client"));
    let server = start_with(&programs, "server", "calls_other", &[]);
    programs.until(
        &client,
        "failed: the interface `calls.Counter` differs: component `Caller` of node `client` has another form of it \
         than component `Tally` of node `server`",
    );
    programs.ends(&client, 0);
    programs.stop(&server);
    programs.end(&broker);
}

#[test]
fn a_class_that_does_not_wait_is_refused_and_one_program_needs_no_network() {
    let programs = Programs::new();
    let library = build::library("calls");
    let check = |arguments: &[&str]| {
        let given = ["fleet.composite", "--plugin", library.to_str().unwrap()];
        text(&programs.saoms(&[arguments, &given].concat()))
    };
    write_fleet(&programs, "calls.Hasty", &[]);
    let refused = check(&["check"]);
    assert!(refused.contains("error[S2065]") && refused.contains("class `calls.Hasty` is not `apart`"), "{refused}");
    write_fleet(&programs, "calls.Caller", &[("calls", "3")]);
    let whole = check(&["run", "--virtual"]);
    assert!(whole.contains("made 3 calls, 3 were answered"), "{whole}");
}

#[test]
fn hardware_stops_when_the_program_that_moves_it_is_killed_and_hears_heartbeats_before() {
    let programs = Programs::new();
    write_fleet_with(&programs, "calls.Motor", "calls.Caller", &[("calls", "100000")]);
    let [broker, server, client] = ["broker", "server", "client"].map(|node| start(&programs, node));
    programs.until(&server, "the next heartbeat comes within 50ms");
    // Who waits for an answer while hardware may move hangs, and has it stopped, which can happen at the start.
    let stops = || server.printed().matches("the motor stops").count();
    let before = stops();
    client.kill();
    programs.wait("the motor does not stop", || stops() > before);
    programs.stop(&server);
    programs.end(&broker);
}

#[test]
fn an_emergency_stop_of_who_moves_hardware_stops_it_in_its_program() {
    let programs = Programs::new();
    write_fleet_with(&programs, "calls.Motor", "calls.Caller", &[("calls", "100000")]);
    let (broker, server) = (start(&programs, "broker"), start(&programs, "server"));
    let client = start_with(&programs, "client", "calls", &["--control", "client.socket"]);
    programs.until(&server, "the next heartbeat comes within 50ms");
    let stops = || server.printed().matches("the motor stops").count();
    let before = stops();
    let socket = programs.folder().join("client.socket");
    let stopped = text(&programs.saoms(&["estop", "--fleet", socket.to_str().unwrap()]));
    assert!(stopped.contains("Caller"), "{stopped}");
    programs.wait("the motor does not stop", || stops() > before);
    [client, server].iter().for_each(|program| programs.stop(program));
    programs.end(&broker);
}
