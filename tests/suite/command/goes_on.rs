//! What a fleet with a state folder goes on with after a kill, beside its luggage: shifts and pauses.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::memory::{start, start_with};
use super::state::crossing;
use crate::support::{PATIENCE, ask, empty_folder, project};

/// What the program in a folder has printed.
fn told(folder: &Path) -> String {
    fs::read_to_string(folder.join("told")).unwrap_or_default()
}

/// Waits until it is so.
#[track_caller]
fn until(folder: &Path, what: &str, mut is: impl FnMut() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !is() {
        assert!(Instant::now() < until, "never: {what}\n{}", told(folder));
        sleep(Duration::from_millis(20));
    }
}

/// Something that is answered once the disk has it, and all that was before.
fn commit(folder: &Path) {
    ask(&folder.join("socket"), "POST", "/v1/events", "luggage (1,1) to (2,2)").unwrap();
}

/// What is asked of the program, once it answers.
#[track_caller]
fn status(folder: &Path) -> Value {
    let mut status = Value::Null;
    until(folder, "it answers", || {
        status = ask(&folder.join("socket"), "GET", "/v1/status", "").unwrap_or_default();
        !status.is_null()
    });
    status["status"].take()
}

/// The lines about shifts, each with its time in milliseconds.
fn shifts(told: &str) -> Vec<(u64, String)> {
    let lines = told.lines().filter(|line| line.contains(" shift "));
    let parts = lines.map(|line| {
        let (time, text) = line.trim().split_once(" s  ").unwrap();
        let milliseconds = (time.trim().parse::<f64>().unwrap() * 1e3).round() as u64;
        (milliseconds, text.trim_start_matches("Shift").trim().to_owned())
    });
    parts.collect()
}

#[test]
fn shifts_go_on_as_they_were_planned() {
    let folder = empty_folder("memory-shifts");
    let fleet = [("start", "5s", "500ms"), ("work", "15s", "1500ms"), ("pause", "10s", "1s")].iter().fold(
        project("composites/shift.composite"),
        |fleet, (name, value, shorter)| {
            let [present, wanted] = [value, shorter].map(|value| format!("name=\"{name}\" value=\"{value}\""));
            assert!(fleet.contains(&present));
            fleet.replace(&present, &wanted)
        },
    );
    fs::write(folder.join("f.composite"), fleet).unwrap();
    let mut all = Vec::new();
    // In the middle of the second shift, and after the last one.
    for last in ["starts shift 2", "shift 3 is over"] {
        let program = start(&folder);
        until(&folder, last, || told(&folder).contains(last));
        commit(&folder);
        drop(program);
        all.extend(shifts(&told(&folder)));
    }
    let program = start(&folder);
    let begin = status(&folder)["time_s"].as_f64().unwrap();
    // For longer than the first shift would wait if they began anew.
    until(&folder, "time passes", || status(&folder)["time_s"].as_f64().unwrap() > begin + 1.0);
    drop(program);
    assert_eq!(shifts(&told(&folder)), []);
    let texts: Vec<&str> = all.iter().map(|(_, text)| text.as_str()).collect();
    let expected = [1, 2, 3].map(|shift| {
        let begins = format!("starts shift {shift} of 1.5 s for 1 component");
        [begins, format!("shift {shift} is over for 1 component")]
    });
    assert_eq!(texts, expected.as_flattened());
    // Each begins at the time that was planned before the kills, or a little later on a busy machine.
    for (shift, (time, _)) in all.iter().step_by(2).enumerate() {
        let planned = 500 + 2500 * shift as u64;
        assert!((planned..planned + 2500).contains(time), "{all:?}");
    }
}

#[test]
fn a_fleet_that_pauses_still_pauses() {
    let folder = empty_folder("memory-paused");
    fs::write(folder.join("f.composite"), crossing()).unwrap();
    let socket = folder.join("socket");
    let executions = || -> u64 {
        let status = status(&folder);
        status["components"].as_array().unwrap().iter().map(|one| one["executions"].as_u64().unwrap()).sum()
    };
    let still = "is still paused, as before the end of the last program: `saoms resume` lets it go on";
    let mut program = start(&folder);
    until(&folder, "it executes", || executions() > 0);
    let paused = ask(&socket, "POST", "/v1/pause", "").unwrap()["time_s"].as_f64().unwrap();
    for ends_usually in [false, true] {
        if ends_usually {
            ask(&socket, "POST", "/v1/down", "").unwrap();
            program.0.wait().unwrap();
        }
        drop(program);
        program = start(&folder);
        until(&folder, "it pauses", || status(&folder)["paused"] == true);
        let stands = status(&folder)["time_s"].as_f64().unwrap();
        assert!(stands >= paused, "{stands} {paused}");
        assert!(told(&folder).contains(still), "{}", told(&folder));
        sleep(Duration::from_millis(200));
        assert_eq!(status(&folder)["time_s"].as_f64(), Some(stands));
        assert_eq!(executions(), 0, "{}", told(&folder));
    }
    ask(&socket, "POST", "/v1/resume", "").unwrap();
    until(&folder, "it executes", || executions() > 0);
    // That it goes on is kept, too.
    drop(program);
    let _program = start_with(&folder, &["--invariants"]);
    until(&folder, "it executes", || executions() > 0);
    assert!(!told(&folder).contains(still), "{}", told(&folder));
}
