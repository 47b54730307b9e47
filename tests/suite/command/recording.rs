//! `saoms run --record` and `saoms record`: recordings that others read, too.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::peers::python;
use crate::support::{code, command, empty_folder, fed, root, saoms_in, stderr, stdout, text};

fn airport() -> String {
    root().join("composites/airport.composite").display().to_string()
}

/// Records the airport in virtual time.
fn recorded(folder: &Path, file: &str, more: &[&str]) {
    let airport = airport();
    let run = ["run", &airport, "--virtual", "--quiet", "--seed", "3", "--record", file];
    let output = saoms_in(folder, &[&run[..], more].concat());
    assert_eq!(code(&output), 0, "{}", text(&output));
}

fn cat(folder: &Path, arguments: &[&str]) -> Vec<Value> {
    let output = saoms_in(folder, &[&["record", "cat"][..], arguments].concat());
    assert_eq!(code(&output), 0, "{}", text(&output));
    stdout(&output).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn info(folder: &Path, file: &str) -> Value {
    let output = saoms_in(folder, &["record", "info", file, "--format", "json"]);
    assert_eq!(code(&output), 0, "{}", text(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

#[test]
fn others_read_a_recording_message_for_message() {
    let Some(python) = python("mcap-ros2-support", "0.6.0") else { return };
    let folder = empty_folder("recording-peers");
    recorded(&folder, "r.mcap", &[]);
    let lines = saoms_in(&folder, &["record", "cat", "r.mcap"]);
    let mut peer = Command::new(python);
    peer.arg(root().join("tests/suite/peers/read_mcap.py")).arg(folder.join("r.mcap"));
    let output = fed(&mut peer, &lines.stdout);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stdout(&output).trim(), stdout(&lines).lines().count().to_string());
}

#[test]
fn equal_runs_have_equal_recordings_which_info_and_filter_understand() {
    let folder = empty_folder("recording-equal");
    recorded(&folder, "a.mcap", &["--journal", "j.ndjson", "--report", "r.json", "--short-report"]);
    recorded(&folder, "b.mcap", &[]);
    // Journal and log come from another thread than messages.
    let of = |file: &str| {
        let all = cat(&folder, &[file]);
        let part = |wanted: fn(&str) -> bool| -> Vec<Value> {
            all.iter().filter(|line| wanted(line["topic"].as_str().unwrap())).cloned().collect()
        };
        [
            part(|topic| !topic.starts_with('/')),
            part(|topic| topic == "/saoms/journal"),
            part(|topic| topic == "/rosout"),
            part(|topic| ["/scene", "/floor", "/map", "/tf"].contains(&topic)),
        ]
    };
    let [messages, records, lines, drawn] = of("a.mcap");
    assert!(messages.iter().all(|one| one["component"].is_string()) && lines.len() > 3, "{}", lines.len());
    let journal = fs::read_to_string(folder.join("j.ndjson")).unwrap();
    assert_eq!(records.len(), journal.lines().filter(|line| line.contains("\"phase\":")).count());
    let report: Value = serde_json::from_str(&fs::read_to_string(folder.join("r.json")).unwrap()).unwrap();
    let written = (messages.len() + records.len() + lines.len()) as u64;
    assert_eq!(report["recorded"], serde_json::json!({"written": written, "lost": 0}));
    assert!(drawn.iter().all(|one| one["component"].is_null() && one["message"].is_object()) && drawn.len() > 10);
    let count = drawn.iter().filter(|one| one["topic"] == "/tf").count();
    assert!(count as f64 <= info(&folder, "a.mcap")["duration_s"].as_f64().unwrap() * 10.0 + 1.0, "{count}");
    assert_eq!(of("b.mcap"), [messages.clone(), records, lines, drawn.clone()]);

    let about = info(&folder, "a.mcap");
    assert_eq!(
        (&about["clock"], &about["seed"], &about["lost"], &about["cut"]),
        (&"virtual".into(), &3.into(), &0.into(), &Value::Null)
    );
    let files: Vec<&str> =
        about["files"].as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect();
    assert!(
        files.iter().any(|name| name.ends_with("airport.composite")) && files.contains(&"report.json"),
        "{files:?}"
    );

    let topic = "POSTOPIC";
    let chosen = ["--topic", topic, "--from", "1s", "--to", "3s"];
    let output = saoms_in(&folder, &[&["record", "filter", "a.mcap", "-o", "c.mcap"][..], &chosen].concat());
    assert_eq!(code(&output), 0, "{}", text(&output));
    let part = cat(&folder, &["c.mcap"]);
    assert!(!part.is_empty());
    assert_eq!(part, cat(&folder, &[&["a.mcap"][..], &chosen].concat()));
    assert_eq!(info(&folder, "c.mcap")["files"], about["files"]);
    // Tools draw a part from its first moment on.
    let output =
        saoms_in(&folder, &["record", "filter", "a.mcap", "-o", "late.mcap", "--topic", "/map", "--from", "3s"]);
    assert_eq!(code(&output), 0, "{}", text(&output));
    assert_eq!(cat(&folder, &["late.mcap"]), cat(&folder, &["a.mcap", "--topic", "/map"]));
    recorded(&folder, "d.mcap", &["--record-topics", topic]);
    let only: Vec<Value> = messages.into_iter().filter(|one| one["topic"] == topic).collect();
    assert_eq!(cat(&folder, &["d.mcap", "--topic", topic]), only);
    assert_eq!(info(&folder, "d.mcap")["topics"].as_array().unwrap().len(), 3, "with journal and log");
    recorded(&folder, "e.mcap", &["--record-topics", "/tf"]);
    let only: Vec<Value> = drawn.into_iter().filter(|one| one["topic"] == "/tf").collect();
    assert_eq!(cat(&folder, &["e.mcap", "--topic", "/tf"]), only);
}

#[test]
fn what_was_recorded_is_read_after_a_kill() {
    let folder = empty_folder("recording-kill");
    let mut run = command(&["run", &airport(), "--stay", "--quiet", "--control", "none", "--record", "r.mcap"]);
    let mut run = run.current_dir(&folder).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let since = Instant::now();
    let count = |about: &Value| -> u64 {
        about["topics"].as_array().unwrap().iter().map(|topic| topic["messages"].as_u64().unwrap()).sum()
    };
    // The file is read while it is written.
    while !folder.join("r.mcap").exists() || fs::metadata(folder.join("r.mcap")).unwrap().len() < 20_000 {
        assert!(since.elapsed() < Duration::from_secs(60), "nothing is recorded");
        sleep(Duration::from_millis(20));
    }
    let before = count(&info(&folder, "r.mcap"));
    run.kill().unwrap();
    run.wait().unwrap();
    let about = info(&folder, "r.mcap");
    assert!(count(&about) >= before && before > 100 && about["cut"].is_string(), "{about}");
    let output = saoms_in(&folder, &["record", "cat", "r.mcap"]);
    assert_eq!((code(&output), stdout(&output).lines().count() as u64), (0, count(&about)));
    assert_eq!(
        stderr(&output),
        "warning: `r.mcap` ends in the middle: it was not finished; what stands before is complete\n"
    );
    let output = saoms_in(&folder, &["record", "filter", "r.mcap", "-o", "whole.mcap"]);
    assert_eq!(code(&output), 0, "{}", text(&output));
    let whole = info(&folder, "whole.mcap");
    assert_eq!((count(&whole), &whole["cut"], &whole["lost"]), (count(&about), &Value::Null, &Value::Null));
}

#[test]
fn what_cannot_be_recorded_or_read_is_refused() {
    let folder = empty_folder("recording-wrong");
    let airport = airport();
    recorded(&folder, "r.mcap", &["--for", "1s"]);
    let wrong = |arguments: &[&str], expected: &str| {
        let output = saoms_in(&folder, arguments);
        assert!(code(&output) == 2 && stderr(&output).contains(expected), "{arguments:?}: {}", text(&output));
    };
    wrong(
        &["run", &airport, "--virtual", "--record", "absent/r.mcap"],
        "the recording cannot be written to `absent/r.mcap`",
    );
    wrong(&["run", &airport, "--virtual", "--record", "/dev/null"], "a recording has an index; give it a file");
    wrong(&["run", &airport, "--virtual", "--record", &airport], "airport.composite");
    wrong(&["run", &airport, "--virtual", "--record", "x.mcap", "--record-limit", "1kB"], "expected 1MB at least");
    let over = ["--record", "x.mcap", "--journal", "x-2.mcap"];
    let told = "the recording would go on in `x-2.mcap`, which is an input or another output";
    wrong(&[&["run", &airport, "--virtual"][..], &over].concat(), told);
    let topics = ["--record", "x.mcap", "--record-topics", "/szene"];
    wrong(&[&["run", &airport, "--virtual"][..], &topics].concat(), "no topic `/szene`; did you mean `/scene`?");
    let topics = ["--record", "x.mcap", "--record-topics", "ELMSTOPIK"];
    wrong(&[&["run", &airport, "--virtual"][..], &topics].concat(), "no topic `ELMSTOPIK`; did you mean `ELMSTOPIC`?");
    assert!(!folder.join("x.mcap").exists());
    wrong(&["record", "info", &airport], "is no recording");
    wrong(&["record", "cat", "absent.mcap"], "absent.mcap");
    wrong(&["record", "cat", "r.mcap", "--topic", "/rosuot"], "no topic `/rosuot`; did you mean `/rosout`?");
    wrong(&["record", "filter", "r.mcap", "--topic", "NONE", "-o", "y.mcap"], "no topic `NONE`");
    wrong(&["record", "filter", "r.mcap", "-o", "r.mcap"], "r.mcap");
    assert!(!folder.join("y.mcap").exists());
}
