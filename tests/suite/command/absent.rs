//! A fleet that goes on from a state folder without a robot that it had.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::memory::start;
use super::state::crossing;
use crate::support::{PATIENCE, Program, ask, empty_folder, saoms_in, text};

/// The fleet, whose fourth robot is the next one to its luggage.
fn fleet() -> String {
    let fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (5,4) to (0,4)");
    fleet.replace(r#"name="moveTime">15ms<"#, r#"name="moveTime">100ms<"#)
}

/// A fleet without one of its components.
fn without(fleet: &str, name: &str) -> String {
    let begin = fleet.find(&format!(r#"<component name="{name}""#)).unwrap();
    let end = begin + fleet[begin..].find("</component>").unwrap() + "</component>\n".len();
    [&fleet[..begin], &fleet[end..]].concat()
}

/// Waits until the program in a folder has told something.
#[track_caller]
fn until_told(folder: &Path, what: &str) {
    let since = Instant::now();
    while !fs::read_to_string(folder.join("told")).unwrap().contains(what) {
        assert!(since.elapsed() < PATIENCE, "never told: {what}");
        sleep(Duration::from_millis(5));
    }
}

/// Runs the fleet of the folder until all its work is done, and gives what it tells.
fn run(folder: &Path, more: &[&str]) -> String {
    let usual = ["run", "f.composite", "--state", "state", "--invariants", "--control", "none", "--for", "60s"];
    let output = saoms_in(folder, &[&usual[..], more].concat());
    let told = text(&output);
    assert_eq!(output.status.code(), Some(0), "{told}");
    told
}

#[test]
fn others_do_what_a_robot_had_begun_that_the_fleet_has_no_more() {
    let folder = empty_folder("memory-absent");
    let whole = fleet();
    fs::write(folder.join("f.composite"), &whole).unwrap();
    let program = start(&folder);
    until_told(&folder, "Robot4         collected luggage 1 ");
    drop::<Program>(program);
    fs::write(folder.join("f.composite"), without(&whole, "Robot4")).unwrap();
    let told = run(&folder, &[]);
    let warning = "`Robot4` is no part of the fleet any more: the others hear that it has failed, and it begins anew if \
        it is there again";
    assert!(told.contains(warning), "{told}");
    assert!(told.contains("1 of 1 pieces of luggage delivered"), "{told}");
    assert!(!told.contains("Robot4         "), "{told}");
    // It is there again, without the job that others have done.
    fs::write(folder.join("f.composite"), &whole).unwrap();
    fs::write(folder.join("events"), "luggage (4,5) to (4,0)\n").unwrap();
    let told = run(&folder, &["--events", "events"]);
    assert!(!told.contains(warning), "{told}");
    assert!(told.contains("2 of 2 pieces of luggage delivered, no collision"), "{told}");
}

#[test]
fn nobody_is_told_that_a_robot_has_failed_which_was_off_or_stopped_or_gone() {
    let folder = empty_folder("memory-absent-in-order");
    let named = r#"<property name="ID">Robot3</property>"#;
    let whole = fleet().replace(named, &format!(r#"{named}<property name="runOnStartup">false</property>"#));
    let slow = whole.replace(r#"name="moveTime">100ms<"#, r#"name="moveTime">1s<"#);
    fs::write(folder.join("f.composite"), &slow).unwrap();
    let program = start(&folder);
    until_told(&folder, "Robot4         collected luggage 1 ");
    let post = |path: &str, body: &str| ask(&folder.join("socket"), "POST", path, body).unwrap();
    post("/v1/components/Robot4/stop", "");
    until_told(&folder, "takes over luggage 1 from robot 4");
    // One that failed, which everybody has heard, and was taken away then.
    post("/v1/events", "crash Robot2");
    until_told(&folder, "robot 2 has failed: it stays at ");
    post("/v1/events", "gone Robot2");
    until_told(&folder, "robot 2 is gone: ");
    // Answered once all of that is kept.
    post("/v1/events", "luggage (1,1) to (2,2)");
    drop::<Program>(program);
    let left = ["Robot2", "Robot3", "Robot4"].iter().fold(whole, |fleet, robot| without(&fleet, robot));
    fs::write(folder.join("f.composite"), left).unwrap();
    let told = run(&folder, &[]);
    assert!(!told.contains("no part of the fleet any more") && !told.contains("has failed"), "{told}");
    assert!(told.contains("2 of 2 pieces of luggage delivered, no collision"), "{told}");
}
