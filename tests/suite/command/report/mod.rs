//! `saoms report --from-journal`: what can be known of a run that wrote no report.

mod adaptation;
mod nodes;

use std::fs;

use serde_json::Value;

use crate::support::{empty_folder, project, saoms_in, text};

#[test]
fn the_report_of_a_journal_is_that_of_the_run_as_far_as_it_can_be_known() {
    let folder = empty_folder("rebuilt-report");
    fs::write(folder.join("hall.composite"), project("composites/hall.composite")).unwrap();
    let run = ["run", "hall.composite", "--virtual", "--for", "20s", "--quiet", "--seed", "5"];
    let output = saoms_in(&folder, &[&run[..], &["--journal", "journal.jsonl", "--report", "report.json"]].concat());
    assert!(output.status.success(), "{}", text(&output));
    let of_run: Value = serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap();
    let rebuild = |name: &str| {
        let output = saoms_in(&folder, &["report", "--from-journal", name]);
        assert!(output.status.success(), "{}", text(&output));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let rebuilt = rebuild("journal.jsonl");
    for field in ["seed", "time_s"] {
        assert_eq!(rebuilt[field], of_run[field], "{field}");
    }
    for field in ["records", "overwritten", "lost", "entries"] {
        assert_eq!(rebuilt["journal"][field], of_run["journal"][field], "{field}");
    }
    // Who counts work is not in the journal.
    let mut adaptation = of_run["adaptation"].clone();
    adaptation["kinds"].as_array_mut().unwrap().iter_mut().for_each(|kind| kind["throughput"] = Value::Null);
    assert_eq!(rebuilt["adaptation"], adaptation);
    let counts = |report: &Value| {
        let mut all: Vec<String> = Vec::new();
        for one in report["journal"]["loops"].as_array().unwrap() {
            let fields = ["component", "loop", "symptoms", "decisions", "effects"].map(|name| one[name].to_string());
            all.push(fields.join(" "));
        }
        all.sort();
        all
    };
    assert_eq!(counts(&rebuilt), counts(&of_run));
    assert_eq!(rebuilt["outcome"]["status"], Value::Null);
    let known = ["seed", "time_s", "components", "journal", "adaptation", "outcome", "unknown"];
    let unknown = rebuilt["unknown"].to_string();
    let shipped = [
        "luggage", "messages", "faults", "events", "collisions", "stranded", "assistance", "robots", "worlds",
        "scenario",
    ];
    for field in of_run.as_object().unwrap().keys().filter(|field| !shipped.contains(&field.as_str())) {
        assert!(known.contains(&field.as_str()) || unknown.contains(field.as_str()), "{field} is neither");
    }
    // `why` answers from it as from the journal.
    fs::write(folder.join("rebuilt.json"), rebuilt.to_string()).unwrap();
    let why = |file: &str| text(&saoms_in(&folder, &["why", "Robot7", "--at", "1s", "--report", file]));
    assert_eq!(why("rebuilt.json"), why("journal.jsonl"));
    // Killed in the middle of a record.
    let journal = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
    fs::write(folder.join("cut.jsonl"), &journal[..journal.len() / 2]).unwrap();
    let cut = rebuild("cut.jsonl");
    assert!(cut["outcome"]["reasons"][0].as_str().unwrap().starts_with("the journal has no end: the run crashed"));
    let entries = cut["journal"]["entries"].as_array().unwrap();
    assert!(!entries.is_empty() && cut["time_s"] == entries.last().unwrap()["time_s"]);
}

#[test]
fn what_is_no_journal_is_refused() {
    let folder = empty_folder("no-rebuilt-report");
    let refused = |content: &str| {
        fs::write(folder.join("file"), content).unwrap();
        let output = saoms_in(&folder, &["report", "--from-journal", "file"]);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        text(&output)
    };
    assert!(refused("no journal").contains("neither a report of `saoms run --report` nor a file"));
    let report = r#"{"time_s": 1.0, "components": [], "journal": {"records": 0, "overwritten": 0, "lost": 0, "loops": [], "entries": []}}"#;
    assert!(refused(report).contains("`file` is a report already"));
}
