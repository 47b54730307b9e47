//! What becomes an alert by itself, against real processes: empty batteries, hardware that moves, code that does not
//! end, and files that cannot be written; and the alerts of a plugin in Rust.

use std::fs;
use std::os::unix::process::CommandExt;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::alerts::{alerts, until};
use super::{Running, component, composite, fleet};
use crate::boundary::build::{c_library, library};

/// The text of an alert about this component.
#[track_caller]
fn about<'a>(alert: &'a Value, component: &str) -> &'a str {
    assert_eq!(alert["component"], component, "{alert}");
    alert["text"].as_str().unwrap()
}

#[test]
fn a_robot_without_battery_is_stranded_until_it_starts_anew() {
    let battery =
        "<property name=\"dischargePerSecond\">60</property><property name=\"chargePerSecond\">100</property>";
    let text = fleet().replacen(
        "<property name=\"ID\">Robot1</property>",
        &format!("<property name=\"ID\">Robot1</property>{battery}"),
        1,
    );
    let running = Running::start(&text, &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    running.told(&["send", "luggage (2,1) to (4,9)"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "carries luggage");
    // A stopped robot goes nowhere, and time empties its battery.
    running.told(&["estop", "Robot1"]);
    let stranded = until(&running, "stranded", |_| true);
    assert!(about(&stranded, "Robot1").contains("its battery is empty"), "{stranded}");
    assert_eq!(stranded["over_s"], Value::Null);
    running.told(&["stop", "Robot1"]);
    running.until("Robot1", |robot| robot["state"] == "idle");
    running.told(&["start", "Robot1"]);
    until(&running, "stranded", |one| !one["over_s"].is_null());
    running.told(&["down"]);
}

#[test]
fn hardware_that_could_not_be_stopped_is_an_alert() {
    let folder = tempfile::tempdir().unwrap();
    let library = c_library(folder.path(), &["STOPS=true"]);
    let values = "<property name=\"does\">dead line</property>";
    let text = composite(&component("Belt", "c.Actor", values));
    let running = Running::start(&text, &["--plugin", library.to_str().unwrap(), "--stay"]);
    running.until("Belt", |belt| belt["state"] == "running");
    assert!(alerts(&running).is_empty());
    running.told(&["estop", "Belt"]);
    let moves = until(&running, "not_stopped", |_| true);
    let text = about(&moves, "Belt");
    assert!(text.starts_with("its hardware may still move: the line is dead"), "{text}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(1));
}

#[test]
fn a_component_that_does_not_end_is_an_alert_that_still_leaves_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let values = "<property name=\"at\">shutdown</property><property name=\"does\">never</property>";
    let own = "xmlns:s=\"urn:saoms:1\" s:alertCommand=\"cat >> told\"";
    let text = composite(&component("Stays", "bad.Actor", values));
    fs::write(folder.path().join("fleet.composite"), text.replacen(" name=", &format!(" {own} name="), 1)).unwrap();
    let plugin = library("bad");
    let options = ["--plugin", plugin.to_str().unwrap(), "--grace", "200ms", "--stay", "--alerts"];
    let mut running = Running::start_in(folder, &options);
    running.until("Stays", |stays| stays["state"] == "running");
    running.told(&["down"]);
    assert_eq!(running.wait().0, Some(1));
    let told = fs::read_to_string(running.folder().join("told")).unwrap();
    let all: Vec<Value> = told.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let abandoned = all.iter().find(|one| one["alert"]["kind"] == "abandoned").unwrap_or_else(|| panic!("{told}"));
    assert_eq!(about(&abandoned["alert"], "Stays"), "did not end in time and is abandoned");
}

/// Lets files of a process grow up to this size, as on a full disk.
fn limit_files(pid: u32, bytes: libc::rlim_t) {
    let limit = libc::rlimit { rlim_cur: bytes, rlim_max: libc::RLIM_INFINITY };
    let pid = libc::pid_t::try_from(pid).unwrap();
    // SAFETY: the limit is read, and nothing is written; the process is our own child, not yet waited for.
    let set = unsafe { libc::prlimit(pid, libc::RLIMIT_FSIZE, &raw const limit, std::ptr::null_mut()) };
    assert_eq!(set, 0, "{}", std::io::Error::last_os_error());
}

#[test]
fn a_log_and_a_journal_that_cannot_grow_are_alerts() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fleet.composite"), fleet()).unwrap();
    let options = ["--stay", "--log", "run.log", "--journal", "run.ndjson"];
    let mut running = Running::start_with(folder, &options, |run| {
        // SAFETY: the call between fork and exec is one that signal handlers may make.
        unsafe {
            run.pre_exec(|| {
                // A write beyond the limit is then an error, as on a full disk.
                libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
                Ok(())
            });
        }
    });
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    assert!(alerts(&running).is_empty());
    limit_files(running.pid(), 1);
    // A line of each.
    running.told(&["send", "luggage (2,1) to (4,9)"]);
    let full = |subject: &str| until(&running, "file", |one| one["subject"] == subject && one["over_s"].is_null());
    let (log, journal) = (full("log"), full("journal"));
    for (alert, expected) in [
        (&log, "the log cannot be written at `run.log`: File too large"),
        (&journal, "the journal could not be written to `run.ndjson`: File too large"),
    ] {
        assert_eq!(alert["component"], Value::Null, "{alert}");
        assert!(alert["text"].as_str().unwrap().starts_with(expected), "{alert}");
    }
    limit_files(running.pid(), libc::RLIM_INFINITY);
    for _ in 0..500 {
        running.told(&["estop"]);
        running.told(&["release"]);
        if alerts(&running).iter().any(|one| one["subject"] == "log" && !one["over_s"].is_null()) {
            break;
        }
        sleep(Duration::from_millis(10));
    }
    until(&running, "file", |one| one["subject"] == "log" && !one["over_s"].is_null());
    // What was lost leaves a gap in the journal, which is given up.
    full("journal");
    running.told(&["down"]);
    let (code, printed) = running.wait();
    assert_eq!(code, Some(1), "{printed}");
    assert!(printed.contains("error: the log could not be written at `run.log`"), "{printed}");
}

#[test]
fn a_plugin_in_rust_raises_alerts() {
    let plugin = library("bad");
    let values = "<property name=\"at\">alert</property>";
    let text = composite(&component("Belt", "bad.Actor", values));
    let running = Running::start(&text, &["--plugin", plugin.to_str().unwrap(), "--stay"]);
    let left = until(&running, "jam", |one| one["subject"] == "left" && one["over_s"].is_null());
    assert_eq!(about(&left, "Belt"), "the left belt jams");
    // It is raised and over in each execution, an alert of its own each time.
    let right = until(&running, "jam", |one| one["subject"] == "right" && !one["over_s"].is_null());
    assert_eq!(about(&right, "Belt"), "the right belt jams");
    let same = |one: &&Value| one["subject"] == "left";
    assert_eq!(alerts(&running).iter().filter(same).count(), 1, "one that lasts is one alert");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}
