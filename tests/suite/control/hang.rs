//! Fleets in which code hangs are shown and ended all the same.

use super::{Running, component, composite};
use crate::boundary::build::library;

/// A fleet whose component hangs at a place of its code.
fn hanging(at: &str) -> Running {
    let plugin = library("bad");
    let values = format!("<property name=\"at\">{at}</property><property name=\"does\">never</property>");
    let bad = component("Bad", "bad.Actor", &values);
    let caller = "<reference name=\"callee\" target=\"Bad/callee\"/>";
    let caller = if at == "serve" { component("Caller", "bad.Actor", caller) } else { String::new() };
    let world = component("World", "saoms.World", "");
    let fleet = composite(&(bad + &caller + &world));
    Running::start(&fleet, &["--plugin", plugin.to_str().unwrap(), "--grace", "300ms"])
}

#[test]
fn a_fleet_with_code_that_hangs_is_shown_and_ended() {
    for at in ["execute", "serve"] {
        let running = hanging(at);
        let hangs = running.until("Bad", |bad| bad["in_code_s"].as_f64() > Some(0.3));
        assert_eq!(hangs["state"], "running", "{at}");
        running.until("World", |world| world["values_s"].as_f64() > Some(0.3));
        running.told(&["down"]);
        let (code, text) = running.end();
        assert_eq!(code, Some(1), "{at}: {text}");
        assert!(text.contains("component `Bad` did not end"), "{at}: {text}");
    }
}

#[test]
fn a_fleet_that_never_starts_is_shown_and_ended() {
    let running = hanging("initialize");
    let shown = running.told(&["status"]);
    assert!(shown.contains(": starting, "), "{shown}");
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("`initialize`") && text.contains("`Bad`"), "{text}");
}

#[test]
fn a_fleet_with_code_that_hangs_stops_at_once_and_pauses() {
    for at in ["execute", "serve", "initialize"] {
        let running = hanging(at);
        if at != "initialize" {
            running.until("Bad", |bad| bad["in_code_s"].as_f64() > Some(0.1));
        }
        // Nothing of it moves anything.
        assert_eq!(running.told(&["estop"]), "nothing is stopped\n", "{at}");
        assert_eq!(running.told(&["estop", "Bad"]), "stopped: Bad\n", "{at}");
        let paused = running.told(&["pause"]);
        assert!(paused.starts_with("paused at "), "{at}: {paused}");
        let shown = running.told(&["status"]);
        assert!(shown.contains("emergency stop"), "{at}: {shown}");
        assert_eq!(running.told(&["resume"]), "resumed\n", "{at}");
        running.told(&["down"]);
        assert_eq!(running.end().0, Some(1), "{at}");
    }
}
