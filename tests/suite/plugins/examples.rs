//! The examples in `plugins/`: each is loaded by the command, and does the same as when it is linked in.

use std::env;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

// Linked, too: for the runs that the loaded ones are held to.
use saoms_battery_saver as _;
use saoms_camera as _;
use saoms_drive as _;
use saoms_flights as _;
use saoms_hello as _;
use saoms_own_loops as _;
use saoms_relay as _;
use saoms_sprinkler as _;
use saoms_testkit::{Fleet, Run};
use serde_json::Value;

use crate::support::{root, saoms, text};

/// The library of an example, which cargo built beside this test.
pub(crate) fn library(package: &str) -> PathBuf {
    let library = env::current_exe().unwrap().with_file_name(format!("lib{package}.so"));
    assert!(library.exists(), "{} is not there: cargo builds it for this test", library.display());
    library
}

/// Runs the fleet of an example with its code loaded from the library, and linked in. The two runs have to be the same,
/// event for event; what is given back is the report of the first, and the second.
fn loaded_and_linked(example: &str, seconds: u64) -> (Value, Run) {
    let library = library(&format!("saoms_{}", example.replace('-', "_")));
    let composite = format!("plugins/{example}/fleet.composite");
    let run = saoms(&[
        "run",
        &composite,
        "--virtual",
        "--seed",
        "3",
        "--for",
        &format!("{seconds}s"),
        "--quiet",
        "--report",
        "-",
        "--plugin",
        library.to_str().unwrap(),
    ]);
    assert!(run.status.success(), "{}", text(&run));
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    let linked = Fleet::of_file(root().join(&composite)).run(3, Duration::from_secs(seconds));
    assert!(linked.trace_hash.is_some());
    assert_eq!(
        report["trace_hash"].as_str(),
        linked.trace_hash.as_deref(),
        "loaded:\n{report:#}\nlinked:\n{}",
        linked.log()
    );
    (report, linked)
}

#[test]
fn hello_is_loaded() {
    let (_, linked) = loaded_and_linked("hello", 3);
    assert_eq!(linked.log_of("Greeter").len(), 3);
    let shown = saoms(&[
        "run",
        "plugins/hello/fleet.composite",
        "--virtual",
        "--for",
        "3s",
        "--plugin",
        library("saoms_hello").to_str().unwrap(),
    ]);
    assert_eq!(text(&shown).matches("hello, fleet").count(), 3, "{}", text(&shown));
}

#[test]
fn the_robot_with_a_camera_is_loaded() {
    let (report, _) = loaded_and_linked("camera", 60);
    assert_eq!(report["luggage"]["delivered"], 2, "{report:#}");
    assert!(report["camera"]["pictures"].as_u64() > Some(20), "{report:#}");
}

#[test]
fn the_battery_saver_is_loaded_into_robots_that_ship() {
    let (report, linked) = loaded_and_linked("battery-saver", 100);
    assert_eq!(report["luggage"]["delivered"], 40, "{report:#}");
    assert!(linked.journal().of("Robot1").of_loop("Saver").texts().len() > 3);
}

#[test]
fn the_master_that_knows_flights_is_loaded() {
    let (report, _) = loaded_and_linked("flights", 300);
    assert_eq!((&report["luggage"]["delivered"], &report["flights"]["done"]), (&4.into(), &2.into()), "{report:#}");
}

#[test]
fn the_loops_in_place_of_those_that_ship_are_loaded() {
    let (report, linked) = loaded_and_linked("own-loops", 60);
    assert_eq!(report["luggage"]["delivered"], 10, "{report:#}");
    assert_eq!(linked.journal().of("Robot2").of_record("has_looked").len(), 5);
}

#[test]
fn the_wheels_that_wear_out_are_loaded() {
    let (report, _) = loaded_and_linked("drive", 300);
    assert_eq!((&report["luggage"]["delivered"], &report["assistance"]), (&2.into(), &1.into()), "{report:#}");
}

#[test]
fn the_sprinklers_are_loaded_and_take_fires_from_outside() {
    let (report, linked) = loaded_and_linked("sprinkler", 60);
    assert_eq!((&report["fires"]["out"], linked.log_of("Hall2").len()), (&4.into(), 3), "{report:#}");
    let run = |events: &str| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("events.txt");
        fs::write(&file, events).unwrap();
        let report = folder.path().join("report.json");
        let library = library("saoms_sprinkler");
        let plugin = ["--plugin", library.to_str().unwrap(), "--events", file.to_str().unwrap()];
        let run = ["run", "plugins/sprinkler/fleet.composite", "--virtual", "--for", "1min", "--report"];
        let run = saoms(&[&run[..], &[report.to_str().unwrap()], &plugin].concat());
        assert!(run.status.success(), "{}", text(&run));
        let report: Value = serde_json::from_slice(&fs::read(report).unwrap()).unwrap();
        (report, text(&run))
    };
    let (report, told) = run("fire at=(1,1) size=1\nat 3s 2 times fire at=(0,0)..(3,3) size=1..2 fuel=OIL to Hall1\n\
        fire at=(1,1) sise=1\nfire at=(1,1) size=1 to Hall3\n");
    assert_eq!((&report["events"]["taken"], &report["events"]["ignored"]), (&3.into(), &2.into()), "{told}");
    assert_eq!(report["fires"]["out"], 8, "{told}");
    for said in [
        "line 3 of the events is ignored: event `fire` has no field `sise`; did you mean `size`?",
        "line 4 of the events is ignored: no component `Hall3` takes the event `fire`; did you mean `Hall1`?",
    ] {
        assert!(told.contains(said), "{told}");
    }
}

#[test]
fn what_the_examples_offer_is_listed_without_running_them() {
    for (package, name, expected) in [
        ("saoms_camera", "camera.Robot", "extends saoms.Robot"),
        ("saoms_camera", "camera.Robot", "CAMERATOPIC (state topic of CameraPicture)"),
        ("saoms_camera", "camera.Robot", "CollisionMS          saoms.CollisionMS"),
        ("saoms_flights", "flights.MasterEnvironment", "extends saoms.MasterEnvironment"),
        ("saoms_sprinkler", "sprinkler.Hall", "Takes the events\n  fire at=(1,1) size=1\n"),
        ("saoms_drive", "drive.Drive", "hardware: saoms.Hardware"),
        ("saoms_battery_saver", "saver.BatterySaver", "floor: "),
    ] {
        let listed = saoms(&["components", name, "--plugin", library(package).to_str().unwrap()]);
        assert!(listed.status.success() && text(&listed).contains(expected), "{}", text(&listed));
    }
}

#[test]
fn rules_over_fleets_take_a_loaded_robot_with_a_camera_for_a_robot() {
    let folder = tempfile::tempdir().unwrap();
    let composite = folder.path().join("fleet.composite");
    let fleet = fs::read_to_string(root().join("plugins/camera/fleet.composite")).unwrap();
    fs::write(&composite, fleet.replace("name=\"ID\" value=\"Robot2\"", "name=\"ID\" value=\"Other1\"")).unwrap();
    let library = library("saoms_camera");
    let checked = saoms(&["check", composite.to_str().unwrap(), "--plugin", library.to_str().unwrap()]);
    assert_eq!(checked.status.code(), Some(2));
    assert!(text(&checked).contains("robots `Robot1` and `Robot2` both have the number 1"), "{}", text(&checked));
}
