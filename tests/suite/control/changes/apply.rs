//! Changes that are made, and what goes on untouched.

use std::fs;

use serde_json::Value;

use super::{Running, fleet, other, write};
use crate::support::{code, stderr, stdout, text};

/// The executions of a component, and those that it missed.
fn executions(running: &Running, name: &str) -> (u64, u64) {
    let component = running.component(name);
    (component["executions"].as_u64().unwrap(), component["missed"].as_u64().unwrap())
}

#[test]
fn a_change_is_applied_and_what_is_the_same_goes_on() {
    let running = Running::start(&fleet(), &["--stay", "--report", "report.json"]);
    running.until("Robot1", |robot| robot["executions"].as_u64() > Some(3));
    write(&running, &other());
    let done = running.told(&["apply", "other.composite"]);
    assert!(done.ends_with("done: 1 added, 1 removed, 1 replaced\n"), "{done}");
    assert!(running.told(&["ps"]).contains("other.composite"));
    assert_eq!(running.told(&["plan", "other.composite"]), "nothing to do\n");
    assert_eq!(running.told(&["apply", "other.composite"]), "nothing to do\n");
    let back = running.ask(&["plan", "fleet.composite"]);
    assert_eq!(code(&back), 3, "{}", text(&back));
    running.until("Robot3", |robot| robot["executions"].as_u64() > Some(3));
    assert!(running.refused(&["status", "Robot2"]).contains("Robot2"));
    let log = running.told(&["logs"]);
    assert!(log.contains("the fleet has changed: 1 added, 1 removed, 1 replaced"), "{log}");
    // It was not touched.
    let (before, _) = executions(&running, "Robot1");
    running.until("Robot1", |robot| robot["executions"].as_u64() > Some(before + 3));
    let robot = running.component("Robot1");
    assert_eq!((&robot["replaced"], &robot["failures"]), (&Value::from(0), &Value::from(0)), "{robot}");
    // The new robot takes work.
    assert_eq!(running.told(&["stop", "Robot1"]), "`Robot1` stops\n");
    running.told(&["send", "luggage (2,1) to (4,1)"]);
    running.until("World", |world| world["values"]["delivered"] == 1);
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn a_lost_state_has_to_be_allowed() {
    let robots = "resources.robotEnvironment";
    let navigated = |period: &str| {
        fleet().replace(
            "</composite>",
            &format!(
                "<component name=\"Gps\"><implementation.java class=\"{robots}.GPS\"/></component>\
                 <component name=\"Carrier\"><implementation.java class=\"{robots}.Robot\"/>\
                 <property name=\"ID\">Carrier</property><reference name=\"updatePosition\" target=\"Gps\"/></component>\
                 <component name=\"Navigator\"><implementation.java class=\"{robots}.Navigator\"/>\
                 <property name=\"ID\">Navigator</property><property name=\"period\">{period}</property>\
                 <reference name=\"move\" target=\"Carrier\"/></component>\
                 </composite>"
            ),
        )
    };
    let running = Running::start(&navigated("100"), &["--stay"]);
    write(&running, &navigated("200"));
    let planned = running.ask(&["plan", "other.composite"]);
    assert_eq!(code(&planned), 3, "{}", text(&planned));
    assert!(stdout(&planned).contains("~ Navigator is replaced: loses its state\n"), "{}", stdout(&planned));
    let refused = running.refused(&["apply", "other.composite"]);
    let expected = "error: the state of `Navigator` would be lost: its class saves none\n  \
                    = help: allow that with `--allow-loss`\n\nnothing has changed\n";
    assert!(refused.ends_with(expected), "{refused}");
    let done = running.told(&["apply", "other.composite", "--allow-loss"]);
    assert!(done.ends_with("done: 1 replaced\n"), "{done}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn live_values_are_set_without_a_new_instance() {
    let stops = |text: String| {
        text.replace("<reference name=\"world\"", "<property name=\"stopped\">true</property><reference name=\"world\"")
    };
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    write(&running, &stops(fleet()));
    let planned = running.ask(&["plan", "other.composite"]);
    assert_eq!(stdout(&planned), "= Robot1 stopped: false -> true\n= Robot2 stopped: false -> true\n2 set\n");
    running.told(&["apply", "other.composite"]);
    let robot = running.until("Robot1", |robot| robot["values"]["state"] == "stopped");
    assert_eq!(robot["replaced"], 0);
    // A plan compares with what the fleet has now.
    running.told(&["set", "Robot1", "stopped=false"]);
    let planned = running.ask(&["plan", "other.composite"]);
    assert_eq!(stdout(&planned), "= Robot1 stopped: false -> true\n1 set\n");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn components_of_another_site_begin_there_anew() {
    let of_site = |site: &str| {
        let attribute = if site.is_empty() { String::new() } else { format!(" s:site=\"{site}\"") };
        let head = " name=\"fleet\" xmlns:s=\"urn:saoms:1\"";
        fleet().replacen(" name=\"fleet\"", head, 1).replace("<component name", &format!("<component{attribute} name"))
    };
    let running = Running::start(&of_site(""), &["--stay", "--invariants"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    write(&running, &of_site("North"));
    let planned = running.ask(&["plan", "other.composite"]);
    assert_eq!(code(&planned), 3, "{}", text(&planned));
    let expected = "~ Robot1 is replaced: loses its state\n    site: (none) -> North\n";
    assert!(stdout(&planned).contains(expected), "{}", stdout(&planned));
    let refused = running.refused(&["apply", "other.composite"]);
    let expected = "would be lost: they begin anew in another class or site\n  \
                    = help: allow that with `--allow-loss`\n\nnothing has changed\n";
    assert!(refused.ends_with(expected), "{refused}");
    running.told(&["apply", "other.composite", "--allow-loss"]);
    running.told(&["send", "North: luggage (2,1) to (4,1)"]);
    running.until("World", |world| world["values"]["delivered"] == 1);
    assert_eq!(running.told(&["plan", "other.composite"]), "nothing to do\n");
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn a_change_that_does_not_come_to_the_state_folder_is_told() {
    let running = Running::start(&fleet(), &["--stay", "--state", "state"]);
    fs::rename(running.folder().join("state"), running.folder().join("away")).unwrap();
    write(&running, &other());
    let made = running.ask(&["apply", "other.composite"]);
    assert_eq!(code(&made), 1, "{}", text(&made));
    assert!(stdout(&made).ends_with("done: 1 added, 1 removed, 1 replaced\n"), "{}", stdout(&made));
    let told = stderr(&made);
    let expected = "error: the fleet has changed: it takes effect, but is not in the state folder: ";
    assert!(told.contains(expected) && !told.contains("as it was"), "{told}");
    assert_eq!(running.told(&["plan", "other.composite"]), "nothing to do\n");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(1));
}

#[test]
fn only_the_socket_of_the_user_has_files_read() {
    let running = Running::start(&fleet(), &["--stay", "--serve", "127.0.0.1:0"]);
    let told: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
    let fleet = &told.as_array().map_or(&told, |all| &all[0]);
    let (url, token) = (fleet["url"].as_str().unwrap(), fleet["token_file"].as_str().unwrap());
    for command in ["plan", "apply"] {
        let refused = running.refused(&[command, "fleet.composite", "--fleet", url, "--token-file", token]);
        assert!(refused.contains("at the socket of the user"), "{refused}");
    }
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}
