//! A run that has ended in a real browser, and the files that `saoms view` refuses.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

use serde_json::{Value, json};

use super::{component, composite};
use crate::peers::browser::Browser;
use crate::support::{PROGRAM, Program, command, project, saoms_in, saoms_with, text};

/// A run in virtual time with a report in `run.json`; gives the report.
#[track_caller]
fn recorded(folder: &Path, composite: &str, arguments: &[&str]) -> Value {
    fs::write(folder.join("fleet.composite"), composite).unwrap();
    let run = ["run", "fleet.composite", "--virtual", "--quiet", "--report", "run.json"];
    let output = saoms_in(folder, &[&run[..], arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    report(folder)
}

fn report(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("run.json")).unwrap()).unwrap()
}

/// Shows `run.json`: the program, its first line, and the address of the page.
fn shown(folder: &Path, arguments: &[&str]) -> (Program, String, String) {
    let mut view = command(&[&["view", "run.json"], arguments].concat());
    let child = view.current_dir(folder).stdout(Stdio::piped()).spawn().unwrap();
    let mut program = Program(child);
    let mut line = String::new();
    BufReader::new(program.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let url = line.split_whitespace().find(|word| word.starts_with("http://127.0.0.1:")).unwrap_or_default().to_owned();
    assert!(url.ends_with('/'), "{line}");
    (program, line, url)
}

/// An expression: what the row of a robot says of its block and of what it delivered.
fn row(robot: &str) -> String {
    format!(
        "JSON.stringify([...document.querySelector('tr[data-robot={robot}]').cells].slice(3).map((one) => one.textContent))"
    )
}

/// An expression: true while this text is in an element.
fn says(selector: &str, text: &str) -> String {
    format!("!!document.querySelector({})?.textContent.includes({})", json!(selector), json!(text))
}

/// Presses a key in the element of a selector.
fn press(browser: &mut Browser, selector: &str, key: &str) {
    browser.value(&format!(
        "document.querySelector({}).dispatchEvent(new KeyboardEvent('keydown', {{key: {}, bubbles: true, cancelable: true}}))",
        json!(selector),
        json!(key)
    ));
}

#[test]
fn a_person_looks_at_a_run_that_has_ended() {
    let Some(mut browser) = Browser::start("view") else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let report = recorded(folder, &project("composites/airport.composite"), &["--journal", "run.jsonl"]);
    let robots = report["robots"]["by_path"].as_object().unwrap();
    let end = report["time_s"].as_f64().unwrap();
    let (_view, line, url) = shown(folder, &["--journal", "run.jsonl"]);
    assert!(line.starts_with(&format!("fleet, {end:.3} s: open ")), "{line}");

    // It begins at the start of the run.
    browser.open(&url);
    browser.until(&format!("document.querySelectorAll('tr[data-robot]').length === {}", robots.len()));
    browser.until(&says("#phase", "running"));
    browser.until(&says("#time", "0.0 s of"));
    assert_eq!(browser.value("document.querySelectorAll('button[data-order], form').length"), 0, "nobody can order");
    let first =
        browser.value("JSON.stringify([...document.querySelectorAll('tr[data-robot]')].map((one) => one.textContent))");

    // The slider, by hand and by keys.
    browser.value("moment.value = 5; moment.dispatchEvent(new Event('input'))");
    browser.until(&says("#time", "5.0 s of"));
    let rows = "JSON.stringify([...document.querySelectorAll('tr[data-robot]')].map((one) => one.textContent))";
    browser.until(&format!("{rows} !== {first}"));
    press(&mut browser, "#moment", "ArrowRight");
    browser.until(&says("#time", "5.2 s of"));
    press(&mut browser, "#moment", "ArrowLeft");
    press(&mut browser, "body", "ArrowLeft");
    browser.until(&says("#time", "4.8 s of"));
    press(&mut browser, "body", "Home");
    browser.until(&format!("{rows} === {first}"));
    browser.value("speed.value = '30'");
    press(&mut browser, "body", " ");
    browser.until(&says("#play", "Pause"));
    browser.until(&says("#play", "Play"));
    press(&mut browser, "body", "Home");
    press(&mut browser, "body", "End");

    // At the end, it shows what the report says.
    browser.until(&says("#phase", report["outcome"]["status"].as_str().unwrap()));
    let luggage = &report["luggage"];
    let summary = format!("{} of {} pieces of luggage delivered", luggage["delivered"], luggage["requested"]);
    browser.until(&says("#summary", &summary));
    let places = last_places(&report);
    for (path, robot) in robots {
        let expected = json!([places[path], robot["delivered"].to_string()]).to_string();
        browser.until(&format!("{} === {}", row(path), json!(expected)));
    }
    assert_eq!(robots.len(), places.len());

    // A robot with its records and why.
    let robot = robots.keys().next().unwrap();
    browser.open(&format!("{url}#/component/{robot}"));
    browser.until("document.querySelectorAll('ol.records li').length > 10");
    browser.until("document.querySelectorAll('.timeline .mark').length > 5");
    browser.click(".columns .bar button");
    browser.until("document.querySelectorAll('.why ol.chain li').length > 0");
    let why = saoms_in(folder, &["why", robot, "--report", "run.jsonl", "--format", "json"]);
    let why: Value = serde_json::from_slice(&why.stdout).unwrap();
    assert_eq!(browser.text(".why ol.chain li .what"), why["chains"][0]["acts"][0]["text"].as_str().unwrap());
    press(&mut browser, "body", "Home");
    browser.until("document.querySelectorAll('ol.records li').length < 10");
    press(&mut browser, "body", "End");
    browser.until("document.querySelectorAll('ol.records li').length > 10");

    // The other parts.
    for (part, seen) in [
        ("components", "document.querySelectorAll('table.components tbody tr').length > 10"),
        (
            "plots",
            "[...document.querySelectorAll('.plot .line')].filter((one) => one.getAttribute('d').length > 50).length > 5",
        ),
        ("alerts", "document.querySelector('ol.alerts, .empty') !== null"),
        ("log", "document.querySelectorAll('ol.log li').length > 0"),
    ] {
        browser.open(&format!("{url}#/{part}"));
        browser.until(seen);
    }
    assert_eq!(browser.errors(), Vec::<String>::new());

    // Who does not know the key sees nothing of the run.
    let (origin, _) = url.rsplit_once('/').unwrap().0.rsplit_once('/').unwrap();
    for path in ["", "/run", "/why", "/0123456789abcdef0123456789abcdef/run"] {
        assert_eq!(browser.value(&format!("fetch('{origin}{path}').then((answer) => answer.status)")), 404, "{path}");
    }
}

/// The last block of each robot in the records of the journal, as the page writes it.
fn last_places(report: &Value) -> serde_json::Map<String, Value> {
    let recording = &report["recording"];
    let mut places = serde_json::Map::new();
    for (_, changes) in recording["samples"].as_array().unwrap().iter().map(|sample| (&sample[0], &sample[1])) {
        for pair in changes.as_array().unwrap().chunks(2) {
            let cell = &recording["cells"][pair[0].as_u64().unwrap() as usize];
            let subject = &recording["subjects"][cell[0].as_u64().unwrap() as usize];
            if cell[1] == "values" && cell[2] == "block" && !pair[1].is_null() {
                let block = format!("({},{})", pair[1][0], pair[1][1]);
                places.insert(subject["component"].as_str().unwrap().to_owned(), block.into());
            }
        }
    }
    places
}

#[test]
fn names_of_a_run_are_text() {
    let Some(mut browser) = Browser::start("view-text") else { return };
    let folder = tempfile::tempdir().unwrap();
    let odd = component("&lt;img&gt;&lt;script&gt;7", "saoms.Robot", "");
    let text = composite(&[component("Master", "saoms.MasterEnvironment", ""), odd].concat());
    recorded(folder.path(), &text, &["--for", "5s"]);
    let (_view, _, url) = shown(folder.path(), &[]);
    let robot = "<img><script>7";
    browser.open(&url);
    browser.until(&says("table.robots", robot));
    for (part, place) in [("components", "table.components"), ("alerts", "main"), ("log", "main")] {
        browser.open(&format!("{url}#/{part}"));
        browser.until(&format!("!!document.querySelector('{place}')"));
        assert_eq!(browser.value("document.querySelectorAll('main img, body script').length"), 0, "{part}");
    }
    browser.open(&format!("{url}#/component/%3Cimg%3E%3Cscript%3E7"));
    browser.until(&says("main h2", robot));
    browser.until("document.querySelectorAll('ol.records li').length > 0");
    assert_eq!(browser.value("document.querySelectorAll('main img, body script').length"), 0);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
fn a_file_that_cannot_be_shown_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let fleet = composite(&component("Robot1", "saoms.Robot", ""));
    recorded(folder, &fleet, &["--for", "3s", "--journal", "run.jsonl"]);
    let whole = fs::read_to_string(folder.join("run.json")).unwrap();
    assert!(whole.contains("\"recording\":"), "{whole}");
    let refused = |text: &str| {
        fs::write(folder.join("other.json"), text).unwrap();
        let output = saoms_in(folder, &["view", "other.json"]);
        assert_eq!(output.status.code(), Some(2), "{}", crate::support::text(&output));
        crate::support::stderr(&output)
    };
    let without = serde_json::from_str::<Value>(&whole).map(|mut report| {
        report.as_object_mut().unwrap().remove("recording");
        report.to_string()
    });
    let help = "  = help: run again with `--report FILE` and without `--short-report`; of reports that were joined or rebuilt \
                from a journal, look at that of each program\n";
    assert_eq!(
        refused(&without.unwrap()),
        format!("error: `other.json` cannot be shown: it has no recording of the run\n{help}")
    );
    assert_eq!(
        refused(&whole[..whole.len() / 2]),
        "error: `other.json` cannot be shown: it ends in the middle\n  = help: copy it again, or run again with `--report FILE`\n"
    );
    let report = "\n  = help: `saoms run FILE --report FILE` writes one\n";
    let no_report = "error: `other.json` cannot be shown: it is no report of `saoms run --report`";
    assert_eq!(refused(""), format!("{no_report}: it is empty{report}"));
    assert_eq!(refused("[1, 2]"), format!("{no_report}: expected an object in JSON{report}"));
    assert_eq!(refused("{}"), format!("{no_report}: missing field `time_s` at line 1 column 2{report}"));
    let journal = fs::read_to_string(folder.join("run.jsonl")).unwrap();
    assert_eq!(refused(&journal), format!("{no_report}: it is a journal of `saoms run --journal`{report}"));
    assert_eq!(
        refused(&whole.replace("\"recording\": {\"version\":1,", "\"recording\": {\"version\":2,")),
        "error: `other.json` cannot be shown: its recording has the format 2, and this program shows the format 1\n  = help: use the version of `saoms` that wrote it\n"
    );
    let damaged = refused(&whole.replacen("\"samples\":[[0,[0,", "\"samples\":[[0,[999,", 1));
    assert_eq!(
        damaged,
        "error: `other.json` cannot be shown: its recording is malformed: the sample of 0 s names a cell that there is not\n"
    );
    for (from, to, what) in [
        (
            "\"samples\":[[0,[",
            "\"samples\":[[0,[0,{\"#\":[99999]},",
            "the sample of 0 s names a text that there is not",
        ),
        (
            "\"subjects\":[{}",
            "\"subjects\":[{\"topic\":\"T\"}",
            "subject 0 is neither the fleet nor a component nor a message",
        ),
        ("\"cells\":[[0,\"summaries\"]", "\"cells\":[[0,7]", "a cell has no subject, or no name"),
        ("\"cells\":[[0,\"summaries\"]", "\"cells\":[[0,\"paused\",\"x\"]", "`paused` is both a value and has values"),
    ] {
        assert!(whole.contains(from), "{from}");
        let refused = refused(&whole.replacen(from, to, 1));
        assert!(refused.ends_with(&format!("its recording is malformed: {what}\n")), "{refused}");
    }
    let missing = saoms_in(folder, &["view", "none.json"]);
    assert_eq!(missing.status.code(), Some(2));
    let missing = crate::support::stderr(&missing);
    assert!(missing.starts_with("error: `none.json` cannot be read: "), "{missing}");

    // A journal of another run, and no journal.
    fs::write(folder.join("other.jsonl"), journal.replacen("\"seed\":0", "\"seed\":1", 1)).unwrap();
    let other = saoms_in(folder, &["view", "run.json", "--journal", "other.jsonl"]);
    assert_eq!(
        crate::support::stderr(&other),
        "error: `other.jsonl` does not belong to this report: it is the journal of another run: its seed or its components differ\n"
    );
    let other = saoms_with(folder, &["view", "run.json", "--journal", "-"], whole.as_bytes());
    assert_eq!(
        crate::support::stderr(&other),
        "error: standard input is no journal: it is a report\n  = help: leave `--journal` out\n"
    );

    // A port that is taken.
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let output = saoms_in(folder, &["view", "run.json", "--port", &port]);
    assert_eq!(output.status.code(), Some(2));
    let told = crate::support::stderr(&output);
    assert!(told.starts_with(&format!("error: `--port {port}`: ")) && told.contains("name another port"), "{told}");
}

#[test]
fn a_report_has_a_recording_unless_it_is_short_and_a_recorded_run_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = project("composites/airport.composite");
    let long = recorded(folder.path(), &fleet, &[]);
    assert_eq!(recorded(folder.path(), &fleet, &[]).to_string(), long.to_string(), "the same run has the same report");
    let short = recorded(folder.path(), &fleet, &["--short-report"]);
    assert!(short.get("recording").is_none());
    assert_eq!(short["trace_hash"], long["trace_hash"]);
    let recording = &long["recording"];
    let samples = recording["samples"].as_array().unwrap();
    let times: Vec<f64> = samples.iter().map(|sample| sample[0].as_f64().unwrap()).collect();
    assert_eq!((times[0], times[1], *times.last().unwrap()), (0.0, 0.2, long["time_s"].as_f64().unwrap()));
    assert_eq!((&recording["version"], &recording["every_s"]), (&json!(1), &json!(0.2)));
    assert!(PROGRAM.ends_with("saoms"));
}
