//! `saoms run --history` and `saoms query`: the history of fleets in SQL.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{answer, code, command, empty_folder, project, root, saoms, saoms_in, stderr, stdout, text};

/// The cells of an answer, row by row.
pub(super) fn ask(folder: &Path, question: &str) -> Vec<Vec<String>> {
    let output = saoms_in(folder, &["query", question, "--history", "h.db", "--format", "json"]);
    assert_eq!(code(&output), 0, "{question}: {}", text(&output));
    let answer: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let cell = |cell: &serde_json::Value| cell.as_str().map_or_else(|| cell.to_string(), str::to_owned);
    let rows = answer["rows"].as_array().unwrap().iter();
    rows.map(|row| row.as_array().unwrap().iter().map(cell).collect()).collect()
}

fn one(folder: &Path, question: &str) -> String {
    ask(folder, question).remove(0).remove(0)
}

fn airport() -> String {
    root().join("composites/airport.composite").display().to_string()
}

#[test]
fn a_history_has_the_runs_with_their_records_deliveries_and_reports() {
    let folder = empty_folder("history-runs");
    let airport = airport();
    for seed in ["3", "4"] {
        let files = ["--history", "h.db", "--journal", "journal.jsonl", "--report", "report.json"];
        let output =
            saoms_in(&folder, &[&["run", &airport, "--virtual", "--quiet", "--seed", seed][..], &files].concat());
        assert_eq!(code(&output), 0, "{}", text(&output));
    }
    assert_eq!(
        ask(&folder, "select run, name, clock, seed, status, lost, ended >= began from runs"),
        [["1", "airport", "virtual", "3", "done", "0", "1"], ["2", "airport", "virtual", "4", "done", "0", "1"]]
    );
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.join("report.json")).unwrap()).unwrap();
    let delivered = report["luggage"]["delivered"].to_string();
    assert_ne!(delivered, "0");
    assert_eq!(one(&folder, "select count(*) from deliveries where run = 2 and outcome = 'delivered'"), delivered);
    assert_eq!(one(&folder, "select report ->> '$.luggage.delivered' from reports where run = 2"), delivered);
    assert_eq!(
        ask(
            &folder,
            "select count(*) from deliveries where not (asked_s <= taken_s and taken_s <= time_s and from_x is not null \
            and robot like 'Robot%')"
        ),
        [["0"]]
    );
    // Each record as the journal has it.
    let journal = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> = journal.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let records: Vec<&serde_json::Value> = lines.iter().filter(|line| line.get("id").is_some()).collect();
    let rows = ask(
        &folder,
        "select id, time_s, component, loop, phase, record, entry, text, data, cause from records where run = 2 order by id",
    );
    assert_eq!(rows.len(), records.len());
    for (row, record) in rows.iter().zip(records) {
        let names = ["id", "time_s", "component", "loop", "phase", "record", "entry", "text", "values", "cause"];
        for (cell, name) in row.iter().zip(names) {
            let expected = record.get(name).cloned().unwrap_or_default();
            let expected = expected.as_str().map_or_else(|| expected.to_string(), str::to_owned);
            assert_eq!(*cell, expected, "{name} of {record}");
        }
    }
    let components = one(&folder, "select count(*) from components where run = 2 and period_s = 0.1");
    assert_eq!(components, report["components"].as_array().unwrap().len().to_string());
    let head = &lines[0]["components"];
    assert_eq!(components, head.as_array().unwrap().len().to_string());
    assert!(!folder.join("h.db-wal").exists(), "one file is left");
}

#[test]
fn alerts_are_there() {
    let folder = empty_folder("history-alerts");
    let scenario = "at 1s luggage (3,1) to (3,3); at 2s breakdown Robot1";
    let component = |id: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">100</property>{more}</component>
"#
        )
    };
    let charger =
        |x: u32| format!(r#"<property name="chargeX">{x}</property><reference name="world" target="World"/>"#);
    let components = [
        component("World", "World", ""),
        component("Master", "MasterEnvironment", ""),
        component("Environment", "Environment", &format!(r#"<property name="scenario">{scenario}</property>"#)),
        component("Robot1", "Robot", &charger(0)),
        component("Robot2", "Robot", &charger(5)),
    ];
    let composite = format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">{}</composite>"#,
        components.concat()
    );
    fs::write(folder.join("f.composite"), composite).unwrap();
    let output =
        saoms_in(&folder, &["run", "f.composite", "--virtual", "--for", "30s", "--history", "h.db", "--quiet"]);
    assert!([0, 1].contains(&code(&output)), "{}", text(&output));
    let alerts = ask(&folder, "select kind, component, over_s is null from alerts order by alert");
    assert!(alerts.contains(&vec!["assistance".to_owned(), "Robot1".to_owned(), "1".to_owned()]), "{alerts:?}");
}

#[test]
fn a_history_is_asked_while_the_fleet_runs_and_after_it_was_killed() {
    let folder = empty_folder("history-live");
    let airport = airport();
    let socket = folder.join("s.sock");
    let socket = socket.to_str().unwrap();
    let mut run = command(&["run", &airport, "--stay", "--quiet", "--history", "h.db", "--control", socket]);
    let mut run = run.current_dir(&folder).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let question = "select count(*) from records where run = (select max(run) from runs)";
    let since = Instant::now();
    loop {
        // From another folder, by the fleet.
        let output = saoms(&["query", question, "--fleet", socket]);
        let count = stdout(&output).lines().nth(1).and_then(|count| count.trim().parse::<u64>().ok());
        if count.is_some_and(|count| count > 200) {
            break;
        }
        assert!(since.elapsed() < Duration::from_secs(30), "{}", text(&output));
        sleep(Duration::from_millis(20));
    }
    assert_eq!(ask(&folder, "select run, ended, status from runs"), [["1", "null", "null"]]);
    run.kill().unwrap();
    run.wait().unwrap();
    let count: u64 = one(&folder, question).parse().unwrap();
    assert!(count > 200);
    let output = saoms_in(&folder, &["run", &airport, "--virtual", "--quiet", "--history", "h.db"]);
    assert_eq!(code(&output), 0, "{}", text(&output));
    assert_eq!(ask(&folder, "select run, status from runs"), [["1", "null"], ["2", "done"]]);
    assert_eq!(one(&folder, "select count(*) from records where run = 1"), count.to_string(), "what was there stays");
}

#[test]
fn old_records_are_removed_and_the_rest_stays() {
    let folder = empty_folder("history-keep");
    let airport = airport();
    let run = |more: &[&str]| {
        let arguments = [&["run", &airport, "--virtual", "--quiet", "--history", "h.db"][..], more].concat();
        let output = saoms_in(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", text(&output));
    };
    run(&[]);
    let whole: u64 = one(&folder, "select count(*) from records").parse().unwrap();
    run(&["--history-keep", "2s"]);
    let first: f64 = one(&folder, "select min(time_s) from records where run = 2").parse().unwrap();
    let end: f64 = one(&folder, "select time_s from runs where run = 2").parse().unwrap();
    assert!(first > end - 2.2 && first < end - 1.5, "from {first} to {end}");
    // The first one ended at most some seconds ago.
    assert_eq!(one(&folder, "select count(*) from records where run = 1"), whole.to_string());
    sleep(Duration::from_millis(300));
    run(&["--history-keep", "100ms"]);
    assert_eq!(ask(&folder, "select count(*) from records where run < 3"), [["0"]]);
    assert_eq!(one(&folder, "select count(distinct run) from deliveries"), "3");
}

#[test]
fn what_is_wrong_is_told() {
    let folder = empty_folder("history-wrong");
    let airport = airport();
    let run = |arguments: &[&str]| {
        let output = saoms_in(&folder, &[&["run", &airport, "--virtual", "--quiet"][..], arguments].concat());
        (code(&output), stderr(&output))
    };
    fs::write(folder.join("text.db"), "no database, but a text that is longer than a page of one ".repeat(100))
        .unwrap();
    let foreign =
        "error: `--history`: `text.db` is no history of a fleet: name another file, or one that does not exist";
    let (code_, told) = run(&["--history", "text.db"]);
    assert!(code_ == 2 && told.contains(foreign) && told.contains("nothing was started"), "{told}");
    let (code_, told) = run(&["--history", "same", "--journal", "same"]);
    assert!(code_ == 2 && told.contains("--history"), "{told}");
    let (code_, told) = run(&["--history", "missing/h.db"]);
    assert!(code_ == 2 && told.contains("missing/h.db"), "{told}");
    let (code_, told) = run(&["--history", "-"]);
    assert!(code_ == 2 && told.contains("the history is a database; give it a file"), "{told}");
    assert_eq!(run(&["--history-keep", "1h"]).0, 2);
    assert_eq!(run(&["--history", "h.db"]).0, 0);
    let before = fs::read(folder.join("h.db")).unwrap();
    for (question, expected) in [
        ("delete from runs", "error: this would change the history, which can only be asked"),
        ("drop table runs", "error: this would change the history, which can only be asked"),
        ("select 1; select 2", "error: expected one question in SQL, as `select * from runs`"),
        ("", "error: expected one question in SQL, as `select * from runs`"),
        ("select nmae from runs", "error: the question cannot be answered: no such column: nmae"),
        ("selct", "error: the question cannot be answered: near \"selct\": syntax error"),
        ("attach 'x.db' as x", "error: "),
    ] {
        let output = saoms_in(&folder, &["query", question, "--history", "h.db"]);
        let (code, out, told) = answer(&output);
        assert_eq!((code, out.as_str()), (2, ""), "{question}: {told}");
        assert!(told.starts_with(expected), "{question}: {told}");
    }
    assert!(!folder.join("x.db").exists());
    assert_eq!(fs::read(folder.join("h.db")).unwrap(), before, "no question changes anything");
    let output = saoms_in(&folder, &["query", "select 1", "--history", "none.db"]);
    assert!(code(&output) == 2 && stderr(&output).contains("there is no history at `none.db`"), "{}", stderr(&output));
    assert!(!folder.join("none.db").exists());
    let output = saoms_in(&folder, &["query", "select 1", "--history", "text.db"]);
    assert!(code(&output) == 2 && stderr(&output).contains("`text.db` is no history"), "{}", stderr(&output));
}

#[test]
fn an_answer_is_a_table_or_json() {
    let folder = empty_folder("history-answer");
    let airport = airport();
    assert_eq!(code(&saoms_in(&folder, &["run", &airport, "--virtual", "--quiet", "--history", "h.db"])), 0);
    let question = "select run, 1.5 as figure, 'two' || char(10) || 'lines' as words, null as empty from runs";
    let output = saoms_in(&folder, &["query", question, "--history", "h.db"]);
    assert_eq!(stdout(&output), "run  figure  words       empty\n  1     1.5  two\\nlines\n", "{}", text(&output));
    let output = saoms_in(&folder, &["query", question, "--history", "h.db", "--format", "json"]);
    let answer: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(answer["rows"], serde_json::json!([[1, 1.5, "two\nlines", null]]));
}

#[test]
fn the_page_has_the_tables_as_the_command_shows_them() {
    let shown = stdout(&saoms(&["query"]));
    let page = project("docs/history.md");
    let (before, rest) = page.split_once("```text\n").unwrap();
    let (_, after) = rest.split_once("```\n").unwrap();
    let expected = format!("{before}```text\n{shown}```\n{after}");
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(root().join("docs/history.md"), &expected).unwrap();
    } else {
        assert!(page == expected, "docs/history.md is not fresh: run this test with UPDATE_EXPECT=1");
    }
}

/// `sqlite3` of Debian reads a history while a fleet writes it.
#[test]
fn another_program_reads_it_while_the_fleet_writes() {
    if Command::new("sqlite3").arg("--version").output().is_err() {
        assert!(std::env::var_os("SAOMS_PEERS").is_none_or(|value| value != "required"), "sqlite3 is not installed");
        eprintln!("skipped: `sqlite3` is not installed (apt-get install sqlite3)");
        return;
    }
    let folder = empty_folder("history-sqlite3");
    let airport = airport();
    let mut run = command(&["run", &airport, "--quiet", "--history", "h.db", "--control", "none"]);
    let mut run = run.current_dir(&folder).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut counts = Vec::new();
    while run.try_wait().unwrap().is_none() {
        let output =
            Command::new("sqlite3").args(["h.db", "select count(*) from records"]).current_dir(&folder).output();
        let output = output.unwrap();
        if output.status.success() {
            counts.push(stdout(&output).trim().parse::<u64>().unwrap());
        }
        sleep(Duration::from_millis(100));
    }
    let output = run.wait_with_output().unwrap();
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(counts.windows(2).all(|pair| pair[0] <= pair[1]), "{counts:?}");
    counts.dedup();
    assert!(counts.len() > 5, "it grows while it is read: {counts:?}");
    let question = "pragma integrity_check; select lost from runs";
    let check = Command::new("sqlite3").args(["h.db", question]).current_dir(&folder).output().unwrap();
    assert_eq!(stdout(&check), "ok\n0\n");
}
