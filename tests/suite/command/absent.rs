//! A fleet that goes on from a state folder without a robot that it had.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::memory::start;
use super::state::crossing;
use crate::support::{PATIENCE, Program, empty_folder, saoms_in, text};

/// The fleet, and the same without its fourth robot.
fn fleets() -> [String; 2] {
    let fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (5,4) to (0,4)");
    let fleet = fleet.replace(r#"name="moveTime">15ms<"#, r#"name="moveTime">100ms<"#);
    let begin = fleet.find(r#"<component name="Robot4""#).unwrap();
    let end = begin + fleet[begin..].find("</component>").unwrap() + "</component>\n".len();
    let without = [&fleet[..begin], &fleet[end..]].concat();
    [fleet, without]
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
    let [whole, without] = fleets();
    fs::write(folder.join("f.composite"), &whole).unwrap();
    let program = start(&folder);
    let since = Instant::now();
    while !fs::read_to_string(folder.join("told")).unwrap().contains("Robot4         collected luggage 1 ") {
        assert!(since.elapsed() < PATIENCE);
        sleep(Duration::from_millis(5));
    }
    drop::<Program>(program);
    fs::write(folder.join("f.composite"), &without).unwrap();
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
