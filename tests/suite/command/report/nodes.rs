//! `saoms report merge`: one report of those of all nodes of a fleet.

use std::fs;
use std::path::Path;

use expect_test::expect;
use serde_json::{Value, json};

use crate::support::{answer, empty_folder, saoms_in, stdout};

/// A report of a node whose program began at this second, with what is different.
fn write(folder: &Path, node: &str, began: u64, more: &Value) {
    let component = if node == "control" { "Master" } else { "Robot-gate" };
    let mut report = json!({
        "seed": 0, "time_s": 10.0, "periods": 100,
        "components": [{
            "name": component, "id": component, "class": "saoms.Robot", "executions": 100,
            "missed": 0, "late_us": {"p50": 0, "p99": 0, "max": 0}, "deadline_misses": 0, "slow": 0, "restarts": 0,
            "failures": 0, "dropped": 0, "messages": {"sent": 7, "received": 8}
        }],
        "luggage": {"delivered": 2, "open": 0}, "collisions": {"vertex": 0},
        "journal": {"records": 0, "loops": [], "entries": []},
        "votes": {"done": 1, "open": []}, "standstill": null,
        "outcome": {"status": "done", "reasons": []}, "trace_hash": null,
        "part": {"node": node, "nodes": ["control", "gate"], "fleet": "0123456789abcdef", "began_us": began * 1_000_000}
    });
    for (name, value) in more.as_object().unwrap() {
        report[name] = value.clone();
    }
    fs::write(folder.join(format!("{node}.json")), report.to_string()).unwrap();
}

/// Records: the number, the time, the component, the phase, the text and the cause.
fn journal(records: &[(u64, f64, &str, &str, &str, u64)]) -> Value {
    let entries = records.iter().map(|(id, time, component, phase, text, cause)| {
        json!({"id": id, "time_s": time, "component": component, "phase": phase, "record": text, "text": text, "cause": cause})
    });
    json!({"records": records.len(), "loops": [], "entries": entries.collect::<Vec<_>>()})
}

/// A record of the first node, and of the second one, as a cause in the other's journal.
const CONTROL: u64 = 1 << 40;
const GATE: u64 = 2 << 40;

#[test]
fn counts_are_added_and_times_are_those_of_the_first_program() {
    let folder = empty_folder("merged-report");
    write(&folder, "control", 1_000, &json!({"events": {"taken": 3}}));
    let failed = json!({"status": "failed", "reasons": ["component `Robot-gate` failed"]});
    write(&folder, "gate", 1_004, &json!({"outcome": failed, "collisions": {"vertex": 1}}));
    let output = saoms_in(&folder, &["report", "merge", "gate.json", "control.json"]);
    let merged: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(merged["luggage"], json!({"delivered": 4, "open": 0}));
    assert_eq!((&merged["collisions"], &merged["events"]), (&json!({"vertex": 1}), &json!({"taken": 3})));
    assert_eq!((&merged["time_s"], &merged["periods"]), (&json!(14.0), &json!(200)));
    assert_eq!(
        merged["outcome"],
        json!({"status": "failed", "reasons": ["node `gate`: component `Robot-gate` failed"]})
    );
    let nodes = json!([
        {"node": "gate", "seed": 0, "began_s": 4.0, "time_s": 10.0, "outcome": failed},
        {"node": "control", "seed": 0, "began_s": 0.0, "time_s": 10.0, "outcome": {"status": "done", "reasons": []}},
    ]);
    assert_eq!(merged["nodes"], nodes);
}

#[test]
fn reports_that_do_not_belong_together_are_refused() {
    let folder = empty_folder("refused-merge");
    write(&folder, "control", 1_000, &json!({}));
    write(&folder, "gate", 1_000, &json!({}));
    fs::copy(folder.join("gate.json"), folder.join("again.json")).unwrap();
    let other = json!({"node": "gate", "nodes": ["gate"], "fleet": "fedcba9876543210", "began_us": 0});
    write(&folder, "other", 1_000, &json!({"part": other}));
    write(&folder, "whole", 1_000, &json!({"part": null}));
    fs::write(folder.join("text.json"), "luggage").unwrap();
    let mut told = String::new();
    for files in
        [["gate", "again"], ["control", "other"], ["control", "whole"], ["control", "text"], ["control", "none"]]
    {
        let files = files.map(|file| format!("{file}.json"));
        let (code, _, errors) = answer(&saoms_in(&folder, &["report", "merge", &files[0], &files[1]]));
        told += &format!("{code} {errors}");
    }
    expect![[r#"
        2 error: `gate.json` and `again.json` are both of node `gate`
        2 error: `other.json` is of another fleet than `control.json`: their composites have other components, classes, sites or nodes
        2 error: `whole.json` is not the report of a node, as `saoms run --node NAME --report FILE` writes it
        2 error: `text.json` is not a report of `saoms run --report`: expected value at line 1 column 1
        2 error: `none.json` cannot be read: No such file or directory (os error 2)
    "#]].assert_eq(&told);
    // What is missing is said, and it is not done without it.
    let three =
        json!({"node": "control", "nodes": ["control", "gate", "hall"], "fleet": "0123456789abcdef", "began_us": 0});
    write(&folder, "control", 0, &json!({"part": three}));
    let merged = stdout(&saoms_in(&folder, &["report", "merge", "control.json", "gate.json"]));
    let merged: Value = serde_json::from_str(&merged).unwrap();
    assert_eq!(
        merged["outcome"],
        json!({"status": "incomplete", "reasons": ["the report of node `hall` is not among these"]})
    );
}

#[test]
fn causes_lead_over_programs_however_their_clocks_differ() {
    let folder = empty_folder("merged-why");
    let control = [
        (1, 1.0, "Environment", "symptom", "a piece waits", 0),
        (2, 1.1, "Master", "decision", "asks robots", 1),
        // By its clock it was before the robot said so.
        (3, 2.0, "Master", "decision", "leaves the piece to it", GATE | 2),
    ];
    write(&folder, "control", 1_000, &json!({"journal": journal(&control)}));
    let gate = [
        (1, 4.5, "Robot-gate", "symptom", "hears of a piece", CONTROL | 2),
        (2, 4.6, "Robot-gate", "decision", "takes it", 1),
        (3, 5.0, "Robot-gate", "decision", "goes on", CONTROL | 9),
    ];
    write(&folder, "gate", 1_000, &json!({"journal": journal(&gate)}));
    let why = |component: &str, arguments: &[&str]| {
        let (code, shown, errors) = answer(&saoms_in(&folder, &[&["why", component], arguments].concat()));
        format!("{code}\n{shown}{errors}")
    };
    let both = ["--report", "gate.json", "--report", "control.json"];
    expect![[r#"
        0
        Master acted at 2.000 s; this led to it:

          1  2.000 s  Master       -  decision  leaves the piece to it
          2  4.600 s  Robot-gate   -  decision  takes it
          3  4.500 s  Robot-gate   -  symptom   hears of a piece
          4  1.100 s  Master       -  decision  asks robots
          5  1.000 s  Environment  -  symptom   a piece waits
    "#]]
    .assert_eq(&why("Master", &both));
    expect![[r#"
        0
        Robot-gate acted at 4.600 s; this led to it:

          1  4.600 s  Robot-gate   -  decision  takes it
          2  4.500 s  Robot-gate   -  symptom   hears of a piece
          3  1.100 s  Master       -  decision  asks robots
          4  1.000 s  Environment  -  symptom   a piece waits
    "#]]
    .assert_eq(&why("Robot-gate", &[&both[..], &["--at", "4.6s"]].concat()));
    // Where only one is known, or a record was overwritten, it says so.
    expect![[r#"
        2
        Robot-gate acted at 4.600 s; this led to it:

          1  4.600 s  Robot-gate  -  decision  takes it
          2  4.500 s  Robot-gate  -  symptom   hears of a piece
             ... earlier causes are not in the journal any more ...
        error: record 2 of node `control` led to this, and is not known here: give `--report` for each program of the fleet, or it was overwritten there
    "#]].assert_eq(&why("Robot-gate", &["--report", "gate.json", "--at", "4.6s"]));
    expect![[r#"
        2
        Robot-gate acted at 5.000 s; this led to it:

          1  5.000 s  Robot-gate  -  decision  goes on
             ... earlier causes are not in the journal any more ...
        error: record 9 of node `control` led to this, and is not known here: give `--report` for each program of the fleet, or it was overwritten there
    "#]].assert_eq(&why("Robot-gate", &both));
}
