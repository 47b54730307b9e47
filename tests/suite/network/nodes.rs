//! One composite, run in several programs by its nodes.

use std::fs;
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::beside_each_other;
use super::programs::{Program, Programs, Transport, component, free_port};
use crate::support::{root, saoms, stdout, text};

/// Starts a node of a composite.
pub(super) fn start(programs: &Programs, composite: &str, node: &str, more: &[&str]) -> Arc<Program> {
    let report = format!("{node}.json");
    let arguments = ["run", composite, "--node", node, "--report", &report];
    programs.run(node, &[&arguments, more].concat())
}

fn report(programs: &Programs, node: &str) -> Value {
    serde_json::from_str(&programs.read(&format!("{node}.json"))).unwrap()
}

#[test]
fn the_airport_runs_in_programs_by_its_nodes() {
    airport_by_nodes(&Programs::new(), "relay");
}

#[test]
fn the_airport_runs_in_programs_by_its_nodes_over_zenoh() {
    airport_by_nodes(&Programs::over(Transport::Zenoh), "");
}

#[track_caller]
fn airport_by_nodes(programs: &Programs, transport: &str) {
    let airport = fs::read_to_string(root().join("composites/airport-nodes.composite")).unwrap();
    // Events that another node takes, from a scenario and from outside.
    let luggage = "at 500ms luggage";
    let drain = format!("at 3s drain robot=1 percent=5.0\n{luggage}");
    programs.write("airport.composite", &airport.replace(luggage, &drain));
    programs.write("events.txt", "at 3s drain robot=2 percent=5.0\n");
    let (port, url) = (format!("port={}", programs.port), format!("url={}", programs.url(programs.port)));
    let transport = format!("transport={transport}");
    let given = ["--set", "host=127.0.0.1", "--set", &port, "--set", &url, "--set", &transport];
    let nodes = ["floor", "traffic", "control"];
    let all = nodes.map(|node| {
        let events = if node == "control" { &["--events", "events.txt"][..] } else { &[] };
        start(programs, "airport.composite", node, &[&given, events].concat())
    });
    for program in &all {
        programs.ends(program, 0);
    }
    let floor = report(programs, "floor");
    // A robot may not have begun by then, where the machine is slow.
    let faults = [&floor["faults"]["applied"]["drain"], &floor["faults"]["ignored"]];
    let faults: u64 = faults.iter().filter_map(|count| count.as_u64()).sum();
    assert!(faults >= 2, "{}", programs.printed());
    let files = ["floor.json", "control.json", "traffic.json"];
    let merged = programs.saoms(&[&["report", "merge"], &files[..]].concat());
    let merged: Value = serde_json::from_str(&stdout(&merged)).unwrap();
    assert_eq!(merged["luggage"]["delivered"], 9);
    assert_eq!(merged["luggage"]["requested"], 9);
    assert_eq!((&merged["luggage"]["open"], &merged["collisions"]["vertex"]), (&0.into(), &0.into()));
    assert_eq!(merged["components"].as_array().unwrap().len(), 11);
    assert_eq!(merged["outcome"]["status"], "done", "{}", merged["outcome"]);
    let nodes: Vec<&str> =
        merged["nodes"].as_array().unwrap().iter().map(|one| one["node"].as_str().unwrap()).collect();
    assert_eq!(nodes, ["floor", "control", "traffic"]);
    let joined = merged["journal"]["entries"].as_array().unwrap().len();
    let each = nodes.iter().map(|node| report(programs, node)["journal"]["entries"].as_array().unwrap().len());
    assert_eq!(joined, each.sum::<usize>());
    // What a robot did follows from what its program was told by another one.
    let collected = floor["journal"]["entries"].as_array().unwrap().iter();
    let mut collected = collected.filter(|entry| entry["text"].as_str().unwrap().starts_with("takes luggage"));
    let taken = collected.next().unwrap();
    let robot = taken["component"].as_str().unwrap();
    let reports = files.map(|file| ["--report", file]).concat();
    let why = stdout(&programs.saoms(&[&["why", robot], &reports[..]].concat()));
    assert!(why.contains("Master") || why.contains("Environment"), "{why}");
    assert_eq!(floor["luggage"]["delivered"], 9, "{}", programs.printed());
    assert_eq!(floor["luggage"]["open"], 0);
    assert_eq!(floor["collisions"]["vertex"], 0);
    assert_eq!(floor["collisions"]["swap"], 0);
    // The program of the environment has no world, and tells what became of its luggage all the same.
    assert!(all[2].printed().contains("9 of 9 pieces of luggage delivered"), "{}", all[2].printed());
    let printed = all[0].printed();
    for luggage in 1..=9 {
        assert_eq!(printed.matches(&format!("deposited luggage {luggage} at")).count(), 1, "{printed}");
    }
}

/// A component at a node, in a composite with `s` for the prefix of its attributes.
pub(super) fn at_node(node: &str, component: String) -> String {
    component.replacen("<component ", &format!("<component s:node=\"{node}\" "), 1)
}

/// Robots that are in another program than the world that they move in.
#[test]
fn the_airport_runs_in_four_programs() {
    let trial = |transport, named: &str| {
        let programs = Programs::over(transport);
        let airport = fs::read_to_string(root().join("composites/airport-nodes.composite")).unwrap();
        let together = "saoms:node=\"floor\" saoms:count";
        assert!(airport.contains(together));
        programs.write("airport.composite", &airport.replace(together, "saoms:node=\"robots\" saoms:count"));
        let (port, url) = (format!("port={}", programs.port), format!("url={}", programs.url(programs.port)));
        let transport = format!("transport={named}");
        let given = ["--set", "host=127.0.0.1", "--set", &port, "--set", &url, "--set", &transport];
        let nodes = ["robots", "floor", "traffic", "control"];
        let all = nodes.map(|node| start(&programs, "airport.composite", node, &given));
        for program in &all {
            programs.ends(program, 0);
        }
        let floor = report(&programs, "floor");
        assert_eq!(floor["luggage"]["delivered"], 9, "{}", programs.printed());
        assert_eq!((&floor["collisions"]["vertex"], &floor["collisions"]["swap"]), (&0.into(), &0.into()));
        let printed = all[0].printed();
        for luggage in 1..=9 {
            assert_eq!(printed.matches(&format!("deposited luggage {luggage} at")).count(), 1, "{printed}");
        }
    };
    beside_each_other(&[&|| trial(Transport::Relay, "relay"), &|| trial(Transport::Zenoh, "")]);
}

#[test]
fn what_no_node_of_a_fleet_has_is_an_error_that_names_the_nodes() {
    let programs = Programs::new();
    write_fleet(&programs, "at 2s luggage random to (9,10)", &[("gate-a", "500")]);
    let fleet = programs.read("fleet.composite");
    let (before, master) = fleet.split_once("<component name=\"Master\">").unwrap();
    let after = master.split_once("</component>").unwrap().1;
    programs.write("fleet.composite", &format!("{before}{after}"));
    let said = text(&programs.saoms(&["check", "fleet.composite"]));
    let nodes = "none of the nodes of this fleet has it: `control`, `gate-a`, `traffic`";
    assert!(said.contains("error[S5001]") && said.contains("warning[S5008]"), "{said}");
    assert_eq!(said.matches(nodes).count(), 2, "{said}");
}

/// Writes a fleet with a broker, a scenario and a master in `control`, a zone in `traffic`, and robots: each with its
/// node and its period.
pub(super) fn write_fleet(programs: &Programs, scenario: &str, robots: &[(&str, &str)]) {
    let url = programs.url(programs.port);
    let task = |name: &str, class: &str, period: &str, more: &[(&str, &str)]| {
        let usual = [("ID", name), ("period", period), ("url", &url)];
        component(name, class, &[&usual, more].concat())
    };
    let port = programs.port.to_string();
    let broker = [("IP", "127.0.0.1"), ("transport", "relay"), ("port", &port)];
    let map = "...........\n".repeat(11);
    let mut components = component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &broker)
        + &task("Environment", "saoms.Environment", "100", &[("scenario", scenario)])
        + &task("Master", "saoms.MasterEnvironment", "100", &[])
        + &at_node("traffic", task("Zone", "saoms.Zone", "100", &[("map", &map)]));
    let battery = [("dischargePerBlock", "1"), ("chargePerSecond", "10")];
    for ((node, period), robot) in robots.iter().zip(1..) {
        components += &at_node(node, task(&format!("Robot{robot}"), "saoms.Robot", period, &battery));
    }
    programs.write(
        "fleet.composite",
        &format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
             targetNamespace=\"urn:fleet\" name=\"fleet\" s:defaultNode=\"control\">\n{components}</composite>\n"
        ),
    );
}

#[test]
fn robots_of_two_nodes_share_a_zone_of_a_third() {
    let programs = Programs::new();
    let scenario =
        "at 1s luggage (3,1) to (3,10)\nthen 300ms every 300ms 7 times luggage (5,0)..(9,10) to (1,0)..(4,10)";
    write_fleet(&programs, scenario, &[("gate-a", "100"), ("gate-b", "100")].repeat(3));
    // The zone is there first: it waits for the robots of both gates.
    let traffic = start(&programs, "fleet.composite", "traffic", &[]);
    let control = start(&programs, "fleet.composite", "control", &[]);
    programs.until(&traffic, "has joined the network");
    let gates = ["gate-a", "gate-b"].map(|node| start(&programs, "fleet.composite", node, &[]));
    for program in [&traffic, &control, &gates[0], &gates[1]] {
        programs.ends(program, 0);
    }
    let printed = gates.each_ref().map(|gate| gate.printed()).concat();
    for luggage in 1..=8 {
        assert_eq!(printed.matches(&format!("deposited luggage {luggage} at")).count(), 1, "{}", programs.printed());
    }
    assert!(!programs.printed().contains("which was granted to"), "{}", programs.printed());
}

#[test]
fn a_robot_that_crashes_in_one_node_is_replaced_by_one_of_another() {
    let programs = Programs::new();
    // The first robot is nearer, and slow.
    write_fleet(&programs, "at 3s luggage (1,1) to (1,10)", &[("gate-a", "500"), ("gate-b", "100")]);
    programs.write("faults.txt", "at 5s crash Robot1\n");
    let others = ["control", "traffic"].map(|node| start(&programs, "fleet.composite", node, &[]));
    let first = start(&programs, "fleet.composite", "gate-a", &["--faults", "faults.txt"]);
    let second = start(&programs, "fleet.composite", "gate-b", &[]);
    programs.until(&second, "deposited luggage 1 at");
    for program in [&others[0], &others[1], &first, &second] {
        programs.ends(program, 0);
    }
}

/// Whether it began after it was gone is told by times of two programs, of which one runs for longer.
#[test]
fn a_robot_whose_program_was_killed_is_gone_and_comes_back_in_a_new_one() {
    let programs = Programs::new();
    let scenario = "at 1s luggage (1,1) to (1,9)\nat 15s gone Robot1\nat 25s luggage (2,1) to (2,9)";
    write_fleet(&programs, scenario, &[("gate", "100")]);
    let others = ["control", "traffic"].map(|node| start(&programs, "fleet.composite", node, &[]));
    let first = start(&programs, "fleet.composite", "gate", &[]);
    programs.until(&first, "deposited luggage 1 at");
    // The others are to hear of it.
    sleep(Duration::from_millis(500));
    first.kill();
    programs.until(&others[0], "robot 1 is gone");
    let second = start(&programs, "fleet.composite", "gate", &[]);
    programs.until(&second, "deposited luggage 2 at");
    for program in [&others[0], &others[1], &second] {
        programs.ends(program, 0);
    }
}

#[test]
fn all_nodes_run_in_one_program_unless_one_is_named() {
    let airport = root().join("composites/airport-nodes.composite");
    let run = |more: &[&str]| text(&saoms(&[&["run", airport.to_str().unwrap(), "--for", "200ms"], more].concat()));
    // Nobody else may listen at the usual port.
    let port = free_port();
    let (port, url) = (format!("port={port}"), format!("url=localhost:{port}"));
    let whole = run(&["--set", &port, "--set", &url]);
    let note = "all nodes run in this program, `control`, `floor`, `traffic`: `--node` runs one of them alone";
    assert_eq!(whole.matches(note).count(), 1, "{whole}");
    assert!(!run(&["--virtual"]).contains("all nodes"));
    assert!(run(&["--virtual", "--node", "floor"]).contains("cannot be used with"));
    let unknown = run(&["--node", "flor"]);
    assert!(unknown.contains("replace `flor` with `floor`"), "{unknown}");
}
