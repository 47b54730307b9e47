//! Plugins together with each other and with linked classes.

use std::fs;

use serde_json::Value;

use super::build::library;
use super::run::{component, fleet, property, saoms, second};

#[test]
fn messages_and_calls_go_between_plugins_and_the_program() {
    let world = component("World", "saoms.World", &property("map", "...\n.@.\n..."));
    let wired = "<reference name=\"doubler\" target=\"Reader/doubler\"/>";
    let components = world
        + &component("Sender", "good.Sender", wired)
        + &component("Reader", "good.Reader", "")
        + &component("Echo", "elsewhere.Echo", "");
    let run = second(&components, &[library("good"), library("elsewhere")]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    // Ten readings, doubled, and the echo of each a period later; the last echo is still on its way.
    assert_eq!(run.report["readings"]["heard"], 10 + 9, "{}", run.report);
    assert_eq!(run.report["readings"]["sum"], (0..10).sum::<i32>() * 2 + (0..9).sum::<i32>() * 2 + 9000);
    assert_eq!(run.report["area"]["width"], 3);
    assert_eq!(run.report["area"]["blocked"], 1);
}

#[test]
fn a_library_of_another_version_in_another_folder_works() {
    let bytes = fs::read(library("elsewhere")).unwrap();
    let own = format!("\"api\":\"{}\"", saoms_api::boundary::API);
    let has = |text: &str| bytes.windows(text.len()).any(|part| part == text.as_bytes());
    assert!(has("\"api\":\"0.1.99\"") && !has(&own), "the test has to be one of another version");
    let components = component("Sender", "good.Sender", "") + &component("Echo", "elsewhere.Echo", "");
    let run = second(&components, &[library("good"), library("elsewhere")]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert_eq!(run.component("Echo")["messages"]["sent"], 10, "{}", run.report);
}

#[test]
fn a_rule_of_a_plugin_takes_part_in_the_check() {
    let components = component("A", "good.Sender", "") + &component("B", "good.Sender", "");
    let run = second(&components, &[library("good")]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert!(run.text.contains("warning[X0001]: this is one more sender"), "{}", run.text);
    assert!(run.text.contains("the first") && run.text.contains("help: keep one"), "{}", run.text);
}

#[test]
fn what_a_library_offers_is_listed_and_runs_not() {
    let folder = tempfile::tempdir().unwrap();
    let good = library("good");
    let run = saoms(folder.path(), &["components", "--plugin", good.to_str().unwrap()]);
    for expected in ["good.Sender", "Sends a reading in each period", "X0001  one-sender  A fleet has several senders"]
    {
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
    let run = saoms(folder.path(), &["components", "--format", "json", "--plugin", good.to_str().unwrap()]);
    let listed: Value = serde_json::from_str(&run.text).unwrap();
    let rules = listed["rules"].as_array().unwrap();
    let rule = rules.iter().find(|rule| rule["code"] == "X0001").unwrap();
    assert_eq!((&rule["severity"], &rule["library"]), (&"warning".into(), &good.to_str().unwrap().into()));
    let run = saoms(folder.path(), &["explain", "one-sender", "--plugin", good.to_str().unwrap()]);
    assert!(run.text.starts_with("X0001 one-sender (warning)\n\nA fleet has several senders"), "{}", run.text);
}

#[test]
fn what_a_constructor_finds_is_shown_where_it_is_written() {
    let components = component("A", "good.Sender", &property("limits", "zero to ten"));
    let run = second(&components, &[library("good")]);
    assert_eq!(run.code, Some(2), "{}", run.text);
    for expected in ["found `zero`, expected a number", "found `ten`, expected a number", "2:"] {
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
    assert_eq!(run.text.matches("error[S3014]").count(), 2, "{}", run.text);
}

#[test]
fn a_library_with_an_allocator_of_its_own_works() {
    let restarts = property("restart", "onFailure") + &property("restartBackoff", "1ms");
    let run = fleet(
        &component("A", "alone.Talker", &restarts),
        &[library("alone")],
        &["--virtual", "--for", "10s", "--seed", "3"],
    );
    let a = run.component("A");
    assert!(a["failures"].as_u64().unwrap() >= 5, "{}\n{}", a, run.text);
    assert!(run.report["notes"]["heard"].as_u64().unwrap() > 50, "{}", run.report);
}
