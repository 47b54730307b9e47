//! Bugs that somebody planted: `saoms simulate` finds each within 100 seeds, and its replay line shows it again.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::boundary::build::library;
use crate::support::{empty_folder, root, saoms_in, stdout};

/// The result of a simulation of at most 100 seeds that finds violations.
fn simulated(folder: &Path, arguments: &[&str]) -> Value {
    let output = saoms_in(folder, &[&["simulate", "--report", "json"], arguments].concat());
    let told = stdout(&output);
    assert_eq!(output.status.code(), Some(1), "{told}{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_str(&told).unwrap()
}

/// What it found first of an invariant, after the replay line of that seed has shown the same again.
fn found(folder: &Path, report: &Value, invariant: &str) -> String {
    let of = |result: &Value| {
        let all = result["violations"].as_array().unwrap();
        let found = all.iter().find(|one| one["invariant"].as_str().unwrap().starts_with(invariant));
        found.map(|one| one["text"].as_str().unwrap().to_owned())
    };
    let failing =
        report["results"].as_array().unwrap().iter().filter(|one| !one["violations"].as_array().unwrap().is_empty());
    let places = failing.zip(report["failing"].as_array().unwrap());
    let (text, replay) = places
        .into_iter()
        .find_map(|(one, replay)| Some((of(one)?, replay)))
        .unwrap_or_else(|| panic!("no seed violates {invariant}: {}", report["violations"]));
    let line = replay["command"].as_str().unwrap();
    let words: Vec<String> = line.split(' ').skip(1).map(|word| word.trim_matches('\'').to_owned()).collect();
    let again = saoms_in(folder, &words.iter().map(String::as_str).collect::<Vec<_>>());
    let seen = String::from_utf8_lossy(&again.stderr).into_owned() + &stdout(&again);
    assert_eq!(again.status.code(), Some(1), "{line}\n{seen}");
    // Of traces, the same is that there are two.
    let expected = if invariant == "9 " { "9 the same seed has the same trace" } else { &text };
    assert!(seen.contains(expected), "{line}: `{expected}` is not in\n{seen}");
    text
}

#[test]
fn robots_that_hear_of_each_other_too_late_share_and_exchange_blocks() {
    let folder = empty_folder("planted-late");
    // Without its zone, safety rests on messages that are faster than a period.
    let airport = fs::read_to_string(root().join("composites/airport.composite")).unwrap();
    let (before, after) = airport.split_once("  <component name=\"Zone\">").unwrap();
    fs::write(folder.join("peers.composite"), [before, after.split_once("</component>").unwrap().1].concat()).unwrap();
    fs::write(folder.join("late.txt"), "at 1s for 20s delay 50ms to 300ms\n").unwrap();
    let faults = ["--faults", "late.txt", "--severity", "S5024=warning"];
    let report = simulated(&folder, &[&["peers.composite", "--seeds", "12", "--for", "40s"], &faults[..]].concat());
    for (invariant, expected) in [("1 ", " collide at ("), ("2 ", "robots ")] {
        let text = found(&folder, &report, invariant);
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn a_bug_of_a_plugin_is_found_and_shown_again() {
    let library = library("planted");
    for (bug, seeds, limit, invariant, expected) in [
        ("jump", "100", "15s", "3 ", "robot 99 was at (1,1), and is at (3,1)"),
        ("twice", "100", "15s", "4 ", "robot 99 delivers luggage 50, which was delivered at "),
        ("battery", "100", "15s", "5 ", "the battery of robot 99 is empty, and it is not at a charger"),
        ("deadlock", "30", "90s", "6 ", "robot 99 has stood at (1,1) for 6"),
        ("open", "10", "15min", "7 ", "luggage 50 is not delivered, and nobody gave it up"),
        ("broken", "30", "90s", "8 ", "nobody takes over luggage 50 of robot 99, which is broken"),
        ("clock", "100", "5s", "9 ", "one run has the trace "),
    ] {
        let folder = empty_folder(&format!("planted-{bug}"));
        let composite = format!(
            r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="planted" targetNamespace="urn:planted">
  <component name="Planted">
    <implementation.rust class="test.Planted"/>
    <property name="ID">Planted</property>
    <property name="period">100ms</property>
    <property name="bug">{bug}</property>
  </component>
</composite>"#
        );
        fs::write(folder.join("planted.composite"), composite).unwrap();
        let plugin = library.to_str().unwrap();
        let arguments = ["planted.composite", "--seeds", seeds, "--for", limit, "--plugin", plugin];
        let text = found(&folder, &simulated(&folder, &arguments), invariant);
        assert!(text.starts_with(expected), "{bug}: {text}");
    }
}
