//! Topics of a fleet over ROS 2 and rosbridge: with programs that know nothing of fleets, and with another fleet.

use std::path::PathBuf;
use std::process::Command;
use std::sync::Arc;

use saoms_api::Message;
use saoms_components::messages::{EnvironmentEvent, EventLuggage, Position};
use saoms_lang::ros::RosType;
use serde_json::{Value, json};

use super::programs::{Given, Program, Programs, component};
use crate::peers;
use crate::plugins::library;
use crate::support::{self, root};

const MAP: &str = "...........\n...........\n...........\n...........\n...........\n...........\n...........\n\
                   ...........\n...........\n...........\n...........";

/// Starts a program with these components; `scheme` is that of a transport of topics.
fn start(programs: &Programs, scheme: &str, name: &str, components: &str) -> Arc<Program> {
    let file = programs.write_composite(name, components);
    let report = format!("{name}.json");
    let mut command = support::command(&["run", &file, "--report", &report, "--plugin"]);
    command.arg(library(&format!("saoms_{scheme}"))).env("XDG_RUNTIME_DIR", programs.folder());
    command.env_remove("ROS_DOMAIN_ID");
    programs.other(name, command)
}

/// A task on the network.
fn task(name: &str, class: &str, url: &str, more: Given<'_>) -> String {
    component(name, class, &[&[("ID", name), ("period", "100"), ("url", url)][..], more].concat())
}

/// Two robots that listen for luggage at a url.
fn robots(programs: &Programs, scheme: &str) -> Arc<Program> {
    let (port, url) = (programs.port.to_string(), url(programs, scheme));
    let broker = [("IP", "127.0.0.1"), ("port", &*port), ("transport", scheme)];
    let components = [
        component("Broker", "saoms.MessageBroker", &broker),
        task("Master", "saoms.MasterEnvironment", &url, &[]),
        task("Zone", "saoms.Zone", &url, &[("map", MAP)]),
        task("Robot1", "saoms.Robot", &url, &[]),
        task("Robot2", "saoms.Robot", &url, &[]),
    ];
    let fleet = start(programs, scheme, "robots", &components.concat());
    programs.until(&fleet, "the program listens at");
    fleet
}

fn url(programs: &Programs, scheme: &str) -> String {
    format!("{scheme}://127.0.0.1:{}", programs.port)
}

fn python(programs: &Programs, python: PathBuf, script: &str, arguments: &[&str]) -> Arc<Program> {
    let mut command = Command::new(python);
    command.arg(root().join("tests/suite/network").join(script)).args(arguments);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env_remove("ROS_DOMAIN_ID");
    programs.other(script, command)
}

/// Ends the robots, which have no end of their own; their report.
fn ended(programs: &Programs, fleet: &Program) -> Value {
    programs.stop(fleet);
    assert!(!programs.printed().contains("panicked"), "{}", programs.printed());
    serde_json::from_str(&programs.read("robots.json")).unwrap()
}

#[test]
fn a_program_with_roslibpy_hears_robots_and_brings_luggage() {
    let Some(interpreter) = peers::python("roslibpy", "2.1.0") else { return };
    let programs = Programs::new();
    let fleet = robots(&programs, "rosbridge");
    let client = python(&programs, interpreter, "by_roslibpy.py", &[&programs.port.to_string()]);
    programs.ends(&client, 0);
    let printed = client.printed();
    for said in [
        "POSTOPIC is saoms_msgs/msg/Position",
        "refused: the message is none of topic `/ETOPIC` (saoms_msgs/msg/EnvironmentEvent): ",
        "has no field `luggages`",
        "refused: topic `/ETOPIC` has messages of `saoms_msgs/msg/EnvironmentEvent`, not of `std_msgs/String`",
        "delivered [1, 2]",
    ] {
        assert!(printed.contains(said), "{said}\n{}", programs.printed());
    }
    let report = ended(&programs, &fleet);
    assert_eq!((&report["luggage"]["delivered"], &report["topics"]["refused"]), (&2.into(), &1.into()), "{report}");
}

#[test]
fn a_node_of_ros_2_hears_robots_and_brings_luggage() {
    let Some(interpreter) = peers::python("zenoh-ros2-sdk", "0.1.8") else { return };
    let programs = Programs::new();
    let fleet = robots(&programs, "ros2");
    let form = |schema: &str| RosType::of(schema).map(|form| json!([form.name, form.text, form.description])).unwrap();
    let topics = json!({
        "POSTOPIC": form(Position::SCHEMA), "ELMSTOPIC": form(EventLuggage::SCHEMA),
        "ETOPIC": form(EnvironmentEvent::SCHEMA),
    });
    programs.write("topics.json", &topics.to_string());
    let node = python(&programs, interpreter, "by_ros2_sdk.py", &[&programs.port.to_string(), "topics.json"]);
    programs.ends(&node, 0);
    assert!(node.printed().contains("delivered [1, 2]"), "{}", programs.printed());
    let report = ended(&programs, &fleet);
    assert_eq!((&report["luggage"]["delivered"], &report["topics"]["refused"]), (&2.into(), &1.into()), "{report}");
    assert!(fleet.printed().contains("its sender has another definition of the type"), "{}", programs.printed());
}

/// An environment in another program, which ends when its luggage is delivered.
#[track_caller]
fn an_environment_elsewhere_hears_of_its_luggage(scheme: &str) {
    let programs = Programs::new();
    let scenario = [("scenario", "at 1s luggage (3,1) to (3,10)")];
    let components = task("Environment", "saoms.Environment", &url(&programs, scheme), &scenario);
    let environment = start(&programs, scheme, "environment", &components);
    programs.until(&environment, "waits for the message broker at");
    let fleet = robots(&programs, scheme);
    programs.until(&environment, "the program has joined the network at");
    programs.ends(&environment, 0);
    assert!(environment.printed().contains("1 of 1 pieces of luggage delivered"), "{}", programs.printed());
    ended(&programs, &fleet);
}

#[test]
fn an_environment_elsewhere_hears_of_its_luggage_over_rosbridge() {
    an_environment_elsewhere_hears_of_its_luggage("rosbridge");
}

#[test]
fn an_environment_elsewhere_hears_of_its_luggage_over_ros_2() {
    an_environment_elsewhere_hears_of_its_luggage("ros2");
}

#[test]
fn what_such_a_network_cannot_do_is_refused_before_anything_starts() {
    let programs = Programs::new();
    let url = url(&programs, "rosbridge");
    let users = [("user", "ada"), ("password", "sesame")];
    let told = start(&programs, "rosbridge", "users", &task("Robot1", "saoms.Robot", &url, &users));
    programs.ends(&told, 2);
    assert!(told.printed().contains("property `user`: rosbridge has neither users nor TLS here"), "{}", told.printed());
    let asked = programs.saoms(&["status", "--url", &url, "--plugin", library("saoms_rosbridge").to_str().unwrap()]);
    let said = "urls with `rosbridge://` lead to topics of other programs, which know no operators";
    assert!(support::text(&asked).contains(said), "{}", support::text(&asked));
}
