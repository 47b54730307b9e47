//! The log of a run: format, levels, file, and files that are moved aside.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::{answer, code, root, saoms_in, stderr, stdout};

/// Runs the airport in virtual time in a folder.
fn airport(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let composite = root().join("composites/airport.composite");
    let all = [&["run", composite.to_str().unwrap(), "--virtual"], arguments].concat();
    answer(&saoms_in(folder, &all))
}

fn json_lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// True if a text begins as `2026-11-26T18:37:00.123Z`.
fn begins_with_date(text: &str) -> bool {
    let form = "dddd-dd-ddTdd:dd:dd.dddZ";
    text.len() >= form.len()
        && text.chars().zip(form.chars()).all(|(found, wanted)| match wanted {
            'd' => found.is_ascii_digit(),
            wanted => found == wanted,
        })
}

#[test]
fn lines_in_json_have_all_that_plain_ones_have() {
    let folder = tempfile::tempdir().unwrap();
    let (_, plain, _) = airport(folder.path(), &[]);
    let (exit, json, errors) = airport(folder.path(), &["--log-format", "json"]);
    assert_eq!((exit, &*errors), (0, ""));
    let lines = json_lines(&json);
    let last = lines.last().unwrap();
    assert!(last["text"].as_str().unwrap().starts_with("done after 10.000 s: 14 of 14"), "{last}");
    let plain: Vec<&str> = plain.lines().take_while(|line| !line.is_empty()).collect();
    assert_eq!(lines.len(), plain.len() + 1);
    for (line, plain) in lines.iter().zip(plain) {
        assert!(begins_with_date(line["date"].as_str().unwrap()), "{line}");
        assert!(plain.ends_with(line["text"].as_str().unwrap()), "{line} {plain}");
        assert!(plain.contains(line["component"].as_str().unwrap_or("fleet")), "{line} {plain}");
        let time = format!("{:.3} s", line["time_s"].as_f64().unwrap());
        assert!(plain.trim_start().starts_with(&time), "{line} {plain}");
        assert_eq!(line["level"] == "error", plain.contains(" error: "), "{line} {plain}");
    }
}

#[test]
fn a_file_has_the_log_whatever_the_console_shows() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("fleet.log");
    let (exit, shown, _) = airport(folder.path(), &["--quiet", "--log", "fleet.log", "--log-level", "debug"]);
    assert_eq!((exit, &*shown), (0, ""));
    let text = fs::read_to_string(&log).unwrap();
    assert!(text.contains("Robot001          started\n"), "{text}");
    assert!(text.lines().last().unwrap().contains("done after 10.000 s"), "{text}");
    // It goes on, with another level and form.
    airport(folder.path(), &["--quiet", "--log", "fleet.log", "--log-level", "error", "--log-date"]);
    let more = fs::read_to_string(&log).unwrap();
    let more: Vec<&str> = more.strip_prefix(&text).unwrap().lines().collect();
    assert!(more.iter().all(|line| begins_with_date(line)), "{more:?}");
    assert_eq!(more.len(), 2, "one robot breaks down, and the run ends: {more:?}");
    let (_, shown, errors) =
        airport(folder.path(), &["--console", "classic", "--log", "other.log", "--log-format", "json"]);
    assert!(shown.starts_with("Starting...") && errors.contains("error: breaks down"), "{shown}{errors}");
    let lines = json_lines(&fs::read_to_string(folder.path().join("other.log")).unwrap());
    assert!(lines.len() > 10 && lines.iter().all(|line| line["level"] != "debug"));
}

#[test]
fn warnings_alone_are_shown_where_only_they_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let (_, shown, _) = airport(folder.path(), &["--log-level", "warning"]);
    let lines: Vec<&str> = shown.lines().take_while(|line| !line.is_empty()).collect();
    assert!(!lines.is_empty() && lines.iter().all(|line| line.contains("error: ") || line.contains("warning: ")));
}

#[test]
fn a_log_is_moved_aside_before_it_is_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let (_, shown, _) = airport(folder.path(), &["--log", "whole.log"]);
    airport(folder.path(), &["--log", "log", "--rotate-size", "1kB", "--rotate-keep", "3"]);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let names = ["log.3", "log.2", "log.1", "log"];
    assert!(names.iter().all(|name| (1..=1000).contains(&read(name).len())));
    let kept: String = names.iter().map(|name| read(name)).collect();
    assert!(read("whole.log").ends_with(&kept), "{shown}");
    assert!(!folder.path().join("log.4").exists());
}

#[test]
fn a_full_disk_is_told_once_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let (exit, _, errors) = airport(folder.path(), &["--log", "/dev/full"]);
    assert_eq!(exit, 1);
    assert_eq!(errors.matches("error: the log could not be written at `/dev/full`").count(), 1, "{errors}");
    let lost = errors.lines().last().unwrap();
    assert!(lost.ends_with("lines could not be written to the log `/dev/full`"), "{errors}");
    let lost: usize = lost["error: ".len()..].split(' ').next().unwrap().parse().unwrap();
    assert!(lost > 10, "{errors}");
}

#[test]
fn a_journal_that_was_moved_aside_is_read_as_one() {
    let folder = tempfile::tempdir().unwrap();
    airport(folder.path(), &["--quiet", "--journal", "whole.jsonl"]);
    // What an earlier run left is no part of it.
    airport(folder.path(), &["--quiet", "--journal", "journal.jsonl", "--seed", "5", "--rotate-size", "50kB"]);
    let rotated = ["--quiet", "--journal", "journal.jsonl", "--rotate-size", "50kB", "--rotate-keep", "99"];
    airport(folder.path(), &rotated);
    assert!(folder.path().join("journal.jsonl.9").exists());
    let told = |arguments: &[&str]| {
        let output = saoms_in(folder.path(), arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        stdout(&output)
    };
    for at in ["1s", "5s", "9s"] {
        let why = |file: &str| told(&["why", "Robot002", "--at", at, "--report", file]);
        assert_eq!(why("journal.jsonl"), why("whole.jsonl"));
    }
    let report = |file: &str| -> Value { serde_json::from_str(&told(&["report", "--from-journal", file])).unwrap() };
    assert_eq!(report("journal.jsonl"), report("whole.jsonl"));

    // With fewer files, what is left is read, and what is not is counted.
    let rotated = ["--quiet", "--journal", "few.jsonl", "--rotate-size", "50kB", "--rotate-keep", "1"];
    airport(folder.path(), &rotated);
    let (few, whole) = (report("few.jsonl"), report("whole.jsonl"));
    assert_eq!(few["journal"]["records"], whole["journal"]["records"]);
    let (kept, all) = (few["journal"]["entries"].as_array().unwrap(), whole["journal"]["entries"].as_array().unwrap());
    assert!(!kept.is_empty() && kept.len() < all.len() && all.ends_with(kept));
    assert_eq!(few["journal"]["overwritten"], all.len() - kept.len());
    assert_eq!(few["journal"]["lost"], 0);
    let missing = saoms_in(folder.path(), &["why", "Robot002", "--at", "1s", "--report", "few.jsonl"]);
    let words = stdout(&missing) + &stderr(&missing);
    assert!(words.contains("its first record in the journal is at") || words.contains("--rotate-keep"), "{words}");
    std::os::unix::fs::symlink("few.jsonl", folder.path().join("link.jsonl")).unwrap();
    assert_eq!(report("link.jsonl"), few);
    fs::remove_file(folder.path().join("few.jsonl.1")).unwrap();
    assert!(report("few.jsonl")["journal"]["entries"].as_array().unwrap().len() < kept.len());
}

#[test]
fn no_file_is_moved_over_an_input_or_another_output() {
    let folder = tempfile::tempdir().unwrap();
    let composite = fs::read(root().join("composites/hall.composite")).unwrap();
    fs::write(folder.path().join("hall.2"), &composite).unwrap();
    for (arguments, taken) in [
        (&["--log", "hall"][..], "hall.2`"),
        (&["--journal", "hall", "--rotate-keep", "2"], "hall.2`"),
        (&["--log", "a", "--journal", "a.1"], "a.1`"),
        (&["--log", "a", "--report", "a.9"], "a.9`"),
    ] {
        let all = [&["run", "hall.2", "--virtual", "--rotate-size", "1kB"], arguments].concat();
        let (exit, _, errors) = answer(&saoms_in(folder.path(), &all));
        assert!(exit == 2 && errors.contains("would be rotated onto") && errors.contains(taken), "{errors}");
    }
    assert_eq!(fs::read(folder.path().join("hall.2")).unwrap(), composite);
    let (exit, _, errors) = answer(&saoms_in(
        folder.path(),
        &["run", "hall.2", "--virtual", "--rotate-size", "1kB", "--log", "hall", "--rotate-keep", "1"],
    ));
    assert_eq!(exit, 0, "{errors}");
}

#[test]
fn options_without_effect_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, word) in [
        (&["--rotate-size", "1MB"][..], "--journal"),
        (&["--rotate-age", "24h"], "--journal"),
        (&["--log", "a", "--rotate-keep", "2"], "--rotate-keep"),
        (&["--quiet", "--log-level", "debug"], "--log-level"),
        (&["--console", "classic", "--log-format", "json"], "--log-format"),
        (&["--console", "classic", "--log-date"], "--log-date"),
        (&["--log-format", "json", "--log-date"], "--log-date"),
        (&["--log", "-"], "standard output"),
        (&["--log", "a", "--journal", "a"], "`a`"),
        (&["--log", "missing/a"], "missing/a"),
    ] {
        let (exit, shown, errors) = airport(folder.path(), arguments);
        assert!(exit == 2 && shown.is_empty() && errors.contains(word), "{arguments:?}: {errors}");
    }
}
