//! How a run ends: its status, its exit code, and what is told of work that is left or was given up.

use std::fs;
use std::process::Output;

use serde_json::Value;

use crate::support::{code, empty_folder, project, saoms, stdout, text};

/// Runs the fleet of `hall.composite` in virtual time, changed so, with further options; the output and the report.
fn hall(name: &str, change: impl Fn(String) -> String, options: &[&str]) -> (Output, Value) {
    let folder = empty_folder(name);
    let (fleet, report) = (folder.join("hall.composite"), folder.join("report.json"));
    fs::write(&fleet, change(project("composites/hall.composite"))).unwrap();
    let mut arguments = vec!["run", fleet.to_str().unwrap(), "--virtual", "--report", report.to_str().unwrap()];
    arguments.extend(options);
    let output = saoms(&arguments);
    let report = fs::read(&report).map(|bytes| serde_json::from_slice(&bytes).unwrap());
    (output, report.unwrap_or_default())
}

/// The line that says how the run ended, and those below it up to the table.
fn end(output: &Output) -> String {
    let shown = stdout(output);
    let from = shown.find("\n\n").unwrap_or_else(|| panic!("{}", text(output))) + 2;
    shown[from..].split("\n\n").next().unwrap().to_owned()
}

#[test]
fn a_run_whose_luggage_was_given_up_is_incomplete() {
    let breaks = |composite: String| composite.replace("to (3,10)<", "to (3,10); at 1500ms breakdown Robot7<");
    let (output, report) = hall("outcome-given-up", breaks, &[]);
    assert_eq!(code(&output), 1, "{}", text(&output));
    let end = end(&output);
    assert!(end.starts_with("incomplete after 1.600 s: 0 of 1 pieces of luggage delivered, 1 given up, no"), "{end}");
    assert!(end.ends_with("\n  work was given up, as told by `World`, `Environment`, `Master`"), "{end}");
    assert_eq!(report["outcome"]["status"], "incomplete");
    assert_eq!(report["luggage"]["given_up"], 1);
    assert_eq!(report["votes"]["given_up"], serde_json::json!(["World", "Environment", "Master"]));
    // It is so whatever ends the run.
    let (output, report) = hall("outcome-given-up-for", breaks, &["--for", "1900ms"]);
    assert_eq!((code(&output), &report["outcome"]["status"]), (1, &Value::from("incomplete")));
}
