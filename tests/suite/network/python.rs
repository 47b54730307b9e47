//! Programs in Python take part in a fleet: `plugins/python-peers`, over Zenoh.

use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::programs::{Program, Programs, Transport};
use super::proxy::{Line, Proxy};
use crate::peers;
use crate::support::{root, stdout};

/// That of the crate in `Cargo.toml`.
const VERSION: &str = "1.10.2";

/// The programs of a fleet, and the Python for others; `None` if the test is to be skipped.
fn programs() -> Option<(Programs, PathBuf)> {
    let python = peers::python("eclipse-zenoh", VERSION)?;
    let programs = Programs::over(Transport::Zenoh);
    let schemas = stdout(&programs.saoms(&["components", "--format", "json"]));
    programs.write("messages.json", &schemas);
    Some((programs, python))
}

/// Runs a composite of the example.
fn run(programs: &Programs, composite: &str) -> Arc<Program> {
    programs.write("fleet.composite", &fs::read_to_string(folder().join(composite)).unwrap());
    let (port, url) = (format!("port={}", programs.port), format!("url=localhost:{}", programs.port));
    let given = ["run", "fleet.composite", "--set", &port, "--set", &url, "--report", "fleet.json"];
    let fleet = programs.run("fleet", &given);
    programs.until(&fleet, "listens at");
    fleet
}

fn start(programs: &Programs, python: &PathBuf, script: &str, port: u16, more: &[&str]) -> Arc<Program> {
    let mut command = Command::new(python);
    command.arg(folder().join(script)).args([&programs.url(port), "messages.json"]).args(more);
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    programs.other(script, command)
}

fn folder() -> PathBuf {
    root().join("plugins/python-peers")
}

fn report(programs: &Programs) -> Value {
    serde_json::from_str(&programs.read("fleet.json")).unwrap()
}

/// The component and the luggage of each record of this kind in the journal.
fn records(report: &Value, kind: &str) -> Vec<(String, u64)> {
    let all = report["journal"]["entries"].as_array().unwrap().iter().filter(|entry| entry["record"] == kind);
    all.map(|entry| (entry["component"].as_str().unwrap().to_owned(), entry["values"]["luggage"].as_u64().unwrap()))
        .collect()
}

/// Luggage from Python is delivered, and Python hears by whom; this happens to its line meanwhile.
#[track_caller]
fn luggage_of_python_is_delivered(happens: impl Fn(&Proxy)) {
    let Some((programs, python)) = programs() else { return };
    let fleet = run(&programs, "environment.composite");
    let watch = start(&programs, &python, "watch.py", programs.port, &[]);
    programs.until(&watch, "listens");
    let proxy = Proxy::to(programs.port, Line::default());
    let environment = start(&programs, &python, "environment.py", proxy.port, &[]);
    programs.until(&fleet, "takes luggage 1");
    happens(&proxy);
    programs.ends(&environment, 0);
    programs.ends(&fleet, 0);
    let report = report(&programs);
    assert_eq!((&report["luggage"]["requested"], &report["luggage"]["delivered"]), (&3.into(), &3.into()));
    let deposited = records(&report, "deposits_luggage");
    let by_report = deposited.iter().map(|(robot, luggage)| {
        let place = ["(3,10)", "(5,10)", "(2,8)"][*luggage as usize - 1];
        let at = format!("robot {} is at {place}\n", robot.trim_start_matches("Robot"));
        assert!(watch.printed().contains(&at), "{at}{}", programs.printed());
        format!("luggage {luggage} DELIVERED by {robot}")
    });
    let (mut by_report, printed): (Vec<String>, String) = (by_report.collect(), environment.printed());
    let mut heard: Vec<String> = printed.lines().map(str::to_owned).collect();
    by_report.sort_unstable();
    heard.sort_unstable();
    assert_eq!(heard, by_report, "{}", programs.printed());
}

#[test]
fn robots_bring_luggage_of_an_environment_in_python() {
    luggage_of_python_is_delivered(|_| {});
}

#[test]
fn an_environment_in_python_hears_all_over_a_line_that_breaks() {
    luggage_of_python_is_delivered(|proxy| {
        for _ in 0..3 {
            proxy.cut();
            sleep(Duration::from_millis(400));
        }
    });
}

#[test]
fn a_robot_in_python_brings_what_a_master_assigns() {
    let Some((programs, python)) = programs() else { return };
    let fleet = run(&programs, "robot.composite");
    let robot = start(&programs, &python, "robot.py", programs.port, &["1"]);
    programs.ends(&fleet, 0);
    programs.ends(&robot, 0);
    assert!(fleet.printed().contains("2 of 2 pieces of luggage delivered"), "{}", programs.printed());
    let report = report(&programs);
    let assigned = records(&report, "assigns_luggage").into_iter();
    let assigned = assigned
        .map(|(_, luggage)| format!("luggage {luggage} DELIVERED at ({},10)", if luggage == 1 { 3 } else { 5 }));
    let (assigned, printed): (Vec<String>, String) = (assigned.collect(), robot.printed());
    let delivered: Vec<&str> = printed.lines().filter(|line| line.contains("DELIVERED")).collect();
    assert_eq!(delivered, assigned, "{}", programs.printed());
}

#[test]
fn a_robot_in_python_and_one_of_the_fleet_work_on_one_floor() {
    let Some((programs, python)) = programs() else { return };
    let scenario = "at 3s luggage (1,3) to (5,3)\nat 3s luggage (5,4) to (1,4)\nthen 1s every 1s 4 times luggage \
                    (1,3)..(5,5) to (1,3)..(5,5)";
    let broker = programs.broker();
    programs.until(&broker, "listens at");
    let robot = start(&programs, &python, "robot.py", programs.port, &["1"]);
    let battery = [("dischargePerBlock", "0.1"), ("chargePerSecond", "10")];
    let tasks = [
        ("Environment", "saoms.Environment", &[("scenario", scenario)][..]),
        ("Master", "saoms.MasterEnvironment", &[("assignment", "oldest")]),
        ("Robot2", "saoms.Robot", &battery),
    ];
    let fleet = programs.tasks("fleet", programs.port, &tasks);
    programs.ends(&fleet, 0);
    programs.ends(&robot, 0);
    assert!(fleet.printed().contains("6 of 6 pieces of luggage delivered, no collision"), "{}", programs.printed());
    let (own, others) = (robot.printed().matches("DELIVERED").count(), fleet.printed().matches("deposited").count());
    assert!(own > 0 && others > 0 && own + others == 6, "{own} and {others}\n{}", programs.printed());
    programs.end(&broker);
}
