//! Bugs that somebody planted: `saoms simulate` finds each within 100 seeds, and its replay line shows it again.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::boundary::build::library;
use crate::support::{empty_folder, saoms_in, stdout};

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

/// Two robots of a site with a zone: one of them, or both, take blocks that are not granted, with some seeds. One has a
/// period of its own.
fn greedy(map: &str, area: [u32; 4], robots: [(u32, u32); 2]) -> String {
    let [left, top, right, bottom] = area;
    let robots = (1..).zip(robots).map(|(number, (corner, period))| {
        format!(
            r#"<component name="Robot{number}">
    <implementation.rust class="test.Greedy"/>
    <property name="ID">Robot{number}</property>
    <property name="period">{period}ms</property>
    <property name="number">{number}</property>
    <property name="left">{left}</property>
    <property name="top">{top}</property>
    <property name="right">{right}</property>
    <property name="bottom">{bottom}</property>
    <property name="corner">{corner}</property>
    <reference name="world" target="World"/>
  </component>"#
        )
    });
    let robots: String = robots.collect();
    format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="greedy" targetNamespace="urn:greedy">
  <component name="World">
    <implementation.rust class="saoms.World"/>
    <property name="ID">World</property>
    <property name="period">100ms</property>
    <property name="moveTime">150ms</property>
    <property name="map">{map}</property>
  </component>
  <component name="Zone">
    <implementation.rust class="saoms.Zone"/>
    <property name="ID">Zone</property>
    <property name="period">100ms</property>
    <reference name="world" target="World"/>
  </component>
  {robots}
</composite>"#
    )
}

/// The zone does what it has to; the robot does not.
#[test]
fn robots_that_enter_blocks_without_grants_share_and_exchange_them() {
    let library = library("planted");
    for (name, composite, invariant, expected) in [
        // One way: robot 1 comes up behind robot 2, which is slower.
        ("follows", greedy("....\n.@@.\n....", [0, 0, 3, 2], [(0, 100), (1, 300)]), "1 ", " collide at ("),
        ("meets", greedy("......\n......", [0, 0, 5, 0], [(0, 100), (1, 100)]), "2 ", " exchange blocks at ("),
    ] {
        let folder = empty_folder(&format!("planted-{name}"));
        fs::write(folder.join("greedy.composite"), composite).unwrap();
        let plugin = library.to_str().unwrap();
        let arguments = ["greedy.composite", "--seeds", "100", "--for", "30s", "--plugin", plugin];
        let report = simulated(&folder, &arguments);
        let text = found(&folder, &report, invariant);
        assert!(text.contains(expected), "{name}: {text}");
        // With most seeds it waits for its grants, and drives on.
        let clean = report["results"].as_array().unwrap().iter();
        let clean = clean.filter(|one| one["violations"].as_array().unwrap().is_empty()).count();
        assert!(clean >= 40, "{name}: {clean} of 100 seeds are clean");
    }
}

/// A composite of one robot with a bug.
fn planted(bug: &str) -> String {
    format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="planted" targetNamespace="urn:planted">
  <component name="Planted">
    <implementation.rust class="test.Planted"/>
    <property name="ID">Planted</property>
    <property name="period">100ms</property>
    <property name="bug">{bug}</property>
  </component>
</composite>"#
    )
}

/// The table shows the first twenty failing seeds.
#[test]
fn the_result_as_json_has_a_line_for_each_failing_seed() {
    let (folder, library) = (empty_folder("planted-all"), library("planted"));
    fs::write(folder.join("planted.composite"), planted("battery")).unwrap();
    let plugin = library.to_str().unwrap();
    let arguments = ["planted.composite", "--seeds", "200", "--for", "15s", "--plugin", plugin];
    let report = simulated(&folder, &arguments);
    let is_failing = |one: &&Value| !one["violations"].as_array().unwrap().is_empty();
    let failing = report["results"].as_array().unwrap().iter().filter(is_failing).map(|one| one["seed"].clone());
    let failing: Vec<Value> = failing.collect();
    let lines = report["failing"].as_array().unwrap();
    assert!(failing.len() > 20, "{failing:?}");
    assert_eq!(lines.iter().map(|one| one["seed"].clone()).collect::<Vec<Value>>(), failing);
    for line in lines {
        assert!(line["command"].as_str().unwrap().contains(&format!("--seed {} ", line["seed"])), "{line}");
    }
}

#[test]
fn a_bug_of_a_plugin_is_found_and_shown_again() {
    let library = library("planted");
    for (bug, seeds, limit, invariant, expected) in [
        ("jump", "100", "15s", "3 ", "robot 99 was at (1,1), and is at (3,1)"),
        ("twice", "100", "15s", "4 ", "robot 99 delivers luggage 50, which was delivered at "),
        ("bearers", "100", "15s", "4 ", "robot 98 collects luggage 50 at (1,1), which is on robot 99"),
        ("elsewhere", "100", "15s", "4 ", "robot 99 collects luggage 50 at (3,3), which is at (1,1)"),
        ("battery", "100", "15s", "5 ", "the battery of robot 99 is empty, and it is not at a charger"),
        ("deadlock", "30", "90s", "6 ", "robot 99 has stood at (1,1) for 6"),
        ("open", "10", "15min", "7 ", "luggage 50 is not delivered, and nobody gave it up"),
        ("broken", "30", "90s", "8 ", "nobody takes over luggage 50 of robot 99, which is broken"),
        ("clock", "100", "5s", "9 ", "one run has the trace "),
    ] {
        let folder = empty_folder(&format!("planted-{bug}"));
        fs::write(folder.join("planted.composite"), planted(bug)).unwrap();
        let plugin = library.to_str().unwrap();
        let arguments = ["planted.composite", "--seeds", seeds, "--for", limit, "--plugin", plugin];
        let text = found(&folder, &simulated(&folder, &arguments), invariant);
        assert!(text.starts_with(expected), "{bug}: {text}");
    }
}
