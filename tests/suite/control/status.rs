//! Components of libraries whose `status` does what it must not.

use std::fs;

use serde_json::json;

use super::{Running, component, composite};
use crate::boundary::build::c_library;
use crate::support::{saoms_in, text};

/// A fleet with a component in C whose `status` does this, and one that does as it should.
fn fleet(does: &str, more: &str) -> String {
    let values = format!("<property name=\"at\">status</property><property name=\"does\">{does}</property>{more}");
    composite(&(component("Bad", "c.Actor", &values) + &component("Good", "c.Actor", "")))
}

fn running(does: &str, more: &str) -> Running {
    let folder = tempfile::tempdir().unwrap();
    let library = c_library(folder.path(), &["HOLES=.status=status"]);
    let fleet = fleet(does, more);
    // The program has loaded a copy when it can be reached.
    Running::start(&fleet, &["--plugin", library.to_str().unwrap(), "--grace", "300ms"])
}

#[test]
fn what_a_component_in_c_says_is_shown() {
    let running = running("", "");
    let good = running.until("Good", |good| !good["values_s"].is_null());
    assert_eq!(good["values"], json!({"level": 80.5, "most": 18446744073709551615_f64, "at": [3, -1], "on": null}));
    assert_eq!(running.component("Bad")["failures"], 0);
}

#[test]
fn a_status_that_cannot_be_read_is_a_failure_of_its_component() {
    for (does, expected) in [
        ("names twice", "its status has `level` twice: give each value a name of its own"),
        ("names twice inside", "its status has `left` twice: give each value a name of its own"),
        ("half an object", "its status is not one JSON object: EOF while parsing"),
        ("two objects", "its status is not one JSON object: trailing characters"),
        ("a list", "its status is not one JSON object: it is another value"),
        ("bytes", "its status is not one JSON object: invalid unicode code point"),
        ("fail", "nobody knows"),
        ("odd", "answered with the unknown status 77"),
    ] {
        let running = running(does, "");
        running.until("Bad", |bad| bad["state"] == "failed");
        let good = running.until("Good", |good| !good["values_s"].is_null());
        assert_eq!((&good["state"], &good["failures"]), (&json!("running"), &json!(0)), "{does}");
        running.told(&["down"]);
        let (code, text) = running.end();
        assert_eq!(code, Some(1), "{does}: {text}");
        assert!(text.contains("component `Bad` ") && text.contains(expected), "{does}: {text}");
        assert!(text.contains("libactor.so`)\n"), "with its library: {does}: {text}");
    }
}

#[test]
fn a_component_whose_status_fails_is_restarted_as_the_composite_says() {
    let restart = "<property name=\"restart\">onFailure</property><property name=\"restartBackoff\">1ms</property>";
    let running = running("fail", restart);
    running.until("Bad", |bad| bad["restarts"].as_u64() > Some(0));
}

#[test]
fn a_status_that_hangs_is_shown_and_holds_up_nobody() {
    let running = running("hang", "");
    let bad = running.until("Bad", |bad| bad["in_code_s"].as_f64() > Some(0.3));
    assert_eq!(bad["state"], "running");
    running.until("Good", |good| good["values_s"].as_f64() > Some(0.3));
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("component `Bad` did not end within 300ms: `status` of library `"), "{text}");
    assert!(text.contains("libactor.so` has not returned"), "{text}");
}

#[test]
fn a_status_that_crashes_is_told_with_component_library_and_function() {
    for does in ["segv", "exit"] {
        // It is asked at once, for the figures of the fleet.
        let folder = tempfile::tempdir().unwrap();
        let library = c_library(folder.path(), &["HOLES=.status=status"]);
        fs::write(folder.path().join("fleet.composite"), fleet(does, "")).unwrap();
        let run = ["run", "fleet.composite", "--control", "socket", "--plugin", library.to_str().unwrap()];
        let output = saoms_in(folder.path(), &run);
        let (code, text) = (output.status.code(), text(&output));
        let line = text.lines().find(|line| line.starts_with("error: component `Bad` of library `"));
        let line = line.unwrap_or_else(|| panic!("{does}: {text}"));
        assert!(line.contains("libactor.so` ") && line.contains("`status`"), "{does}: {line}");
        assert_ne!(code, Some(0), "{does}: {text}");
    }
}
