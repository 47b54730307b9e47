//! Events from outside, as somebody writes them to `saoms run --events`.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Output, Stdio};

use serde_json::Value;

use crate::support::{command, saoms_in, stdout};

/// An area with two robots, a master, and an environment without a scenario.
const FLEET: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="Yard" targetNamespace="http://example.com/yard">
  <component name="World">
    <implementation.rust class="saoms.World"/>
    <property name="ID">World</property>
    <property name="period">100</property>
    <property name="width">6</property>
    <property name="height">6</property>
  </component>
  <component name="Environment">
    <implementation.rust class="saoms.Environment"/>
    <property name="ID">Environment</property>
    <property name="period">100</property>
  </component>
  <component name="Master">
    <implementation.rust class="saoms.MasterEnvironment"/>
    <property name="ID">Master</property>
    <property name="period">100</property>
  </component>
  <component name="Robot001">
    <implementation.rust class="saoms.Robot"/>
    <property name="ID">Robot001</property>
    <property name="period">100</property>
    <property name="chargeX">0</property>
    <property name="chargeY">0</property>
    <reference name="world" target="World"/>
  </component>
</composite>
"#;

struct Yard {
    folder: tempfile::TempDir,
}

impl Yard {
    fn new() -> Yard {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("yard.composite"), FLEET).unwrap();
        Yard { folder }
    }

    fn spawn(&self, arguments: &[&str]) -> Child {
        command(&["run", "yard.composite", "--report", "report.json"])
            .args(arguments)
            .current_dir(self.folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// Runs with these lines on standard input.
    fn run(&self, arguments: &[&str], lines: &str) -> (Output, String) {
        let mut child = self.spawn(arguments);
        child.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8(output.stdout.clone()).unwrap();
        (output, text)
    }

    fn report(&self) -> Value {
        serde_json::from_str(&fs::read_to_string(self.folder.path().join("report.json")).unwrap()).unwrap()
    }
}

const LINES: &str = "luggage (3,1) to (3,4)\nat 20s luggage (1,1) to (5,5); then 1s landing 2\nat 60s end\n";

#[test]
fn events_of_standard_input_and_of_a_file_give_the_same_run_in_virtual_time() {
    let yard = Yard::new();
    let (output, text) = yard.run(&["--virtual", "--events", "-", "--for", "10min"], LINES);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("2 of 2 pieces of luggage delivered"), "{text}");
    let report = yard.report();
    assert_eq!((&report["events"]["taken"], &report["events"]["ignored"]), (&4.into(), &Value::Null));
    assert!(report["time_s"].as_f64().unwrap() >= 60.0, "{}", report["time_s"]);
    fs::write(yard.folder.path().join("events.txt"), LINES).unwrap();
    let (_, again) = yard.run(&["--virtual", "--events", "events.txt", "--for", "10min"], "");
    assert_eq!(again, text);
    assert_eq!(yard.report()["trace_hash"], report["trace_hash"]);
    let other = LINES.replace("(5,5)", "(5,4)");
    yard.run(&["--virtual", "--events", "-", "--for", "10min"], &other);
    assert_ne!(yard.report()["trace_hash"], report["trace_hash"]);
}

#[test]
fn events_bring_the_work_that_no_scenario_does() {
    let yard = Yard::new();
    let (output, _) = yard.run(&["--virtual", "--events", "-", "--for", "10min"], LINES);
    assert!(!String::from_utf8_lossy(&output.stderr).contains("S5018"));
    let (output, _) = yard.run(&["--virtual", "--for", "10s"], "");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("warning[S5018]") && told.contains("--events"), "{told}");
}

#[test]
fn a_composite_in_place_of_events_is_told_once() {
    let yard = Yard::new();
    let (output, text) = yard.run(&["--virtual", "--events", "yard.composite"], "");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), text.as_str()), (Some(2), ""), "{told}");
    assert!(told.contains("`yard.composite`: it is XML, expected a line for each event"), "{told}");
}

#[test]
fn a_mark_at_the_start_of_events_is_no_part_of_their_first_line() {
    let yard = Yard::new();
    let lines = format!("\u{feff}{LINES}");
    fs::write(yard.folder.path().join("events.txt"), &lines).unwrap();
    for (file, input) in [("events.txt", ""), ("-", lines.as_str())] {
        let (_, text) = yard.run(&["--virtual", "--events", file, "--for", "10min"], input);
        assert!(text.contains("2 of 2 pieces of luggage delivered"), "{file}: {text}");
        let report = yard.report();
        assert_eq!((&report["events"]["taken"], &report["events"]["ignored"]), (&4.into(), &Value::Null), "{file}");
    }
    // One that stands elsewhere is a mistake.
    yard.run(&["--virtual", "--events", "-", "--for", "10min"], &format!("{LINES}{lines}"));
    assert_eq!(yard.report()["events"]["ignored"], 1);
}

#[test]
fn events_that_cannot_be_read_are_told_with_what_helps() {
    let yard = Yard::new();
    let wide: Vec<u8> = format!("\u{feff}{LINES}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(yard.folder.path().join("wide.txt"), &wide).unwrap();
    fs::write(yard.folder.path().join("events.txt"), LINES).unwrap();
    for (file, told) in [
        (
            "wide.txt",
            "`wide.txt`: it is in UTF-16LE, expected UTF-8\n  = help: convert it: `iconv -f UTF-16LE -t UTF-8 wide.txt`",
        ),
        ("event.txt", "`event.txt`: there is no such file\n  = help: there is `events.txt`\n"),
        ("nowhere/events.txt", "there is no such file\n  = help: there is no folder `nowhere`\n"),
    ] {
        let (output, text) = yard.run(&["--virtual", "--events", file], "");
        let found = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), text.as_str()), (Some(2), ""), "{found}");
        assert!(found.contains(told) && !found.contains("os error"), "{file}: {found}");
    }
    // Of what comes from a pipe the start is not known when the fleet starts.
    let mut child = yard.spawn(&["--virtual", "--events", "-", "--for", "1s"]);
    child.stdin.take().unwrap().write_all(&wide).unwrap();
    let output = child.wait_with_output().unwrap();
    let found = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    assert!(found.contains("they are in UTF-16LE, expected UTF-8"), "{found}");
}

#[test]
fn an_event_says_its_site() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("inner.composite"), FLEET).unwrap();
    let site = |name: &str| {
        format!(
            "<component name=\"{name}\" saoms:site=\"{name}\"><implementation.composite name=\"y:Yard\"/></component>"
        )
    };
    let outer = FLEET[..FLEET.find('>').unwrap() + 1].to_owned()
        + "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" \
           xmlns:y=\"http://example.com/yard\" name=\"Yards\" targetNamespace=\"http://example.com/yard\">"
        + &site("North")
        + &site("South")
        + "</composite>";
    fs::write(folder.path().join("yard.composite"), outer).unwrap();
    let yard = Yard { folder };
    let lines = "North: luggage (3,1) to (3,4)\nluggage (1,1) to (5,5)\nNort: luggage (1,1) to (5,5)\n\
                 South: lugage (1,1)\nnorth: luggage (1,1) to (5,5)\nat 3s South: luggage (1,1) to (5,5)\n\
                 at 3s south: luggage (1,1) to (5,5)\nat 3s Paris: luggage (1,1) to (5,5)\nParis: luggage (1,1) to (5,5)\n";
    let (output, text) = yard.run(&["--virtual", "--events", "-", "--for", "10min"], lines);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("North/Robot001    deposited luggage 1000001"), "{text}");
    assert!(
        text.contains("line 2 of the events is ignored: this fleet has sites: write the site before the event"),
        "{text}"
    );
    assert!(
        text.contains("line 3 of the events is ignored: the fleet has no site `Nort`; did you mean `North`?"),
        "{text}"
    );
    let told = |line: usize, problem: &str| {
        assert!(text.contains(&format!("line {line} of the events is ignored: {problem}\n")), "{text}");
    };
    told(5, "the fleet has no site `north`; did you mean `North`?");
    told(6, "the site comes first: write `South: at 3s ...`");
    told(7, "the site comes first: write `South: at 3s ...`");
    told(8, "the fleet has no site `Paris`; its sites are North, South");
    told(9, "the fleet has no site `Paris`; its sites are North, South");
    assert!(text.contains("    South: lugage (1,1)\n           ^^^^^^\n"), "{text}");
    fs::write(yard.folder.path().join("faults.txt"), "at 1s breakdown 1\nNort: at 1s breakdown 1\n").unwrap();
    let output = saoms_in(yard.folder.path(), &["run", "yard.composite", "--virtual", "--faults", "faults.txt"]);
    let refused = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{refused}");
    let expected = "error: faults.txt:1:7: this fleet has sites: write the site before the event, as in `North: at 3s ...`; \
                    the sites are North, South\n    at 1s breakdown 1\n          ^^^^^^^^^^^\n\
                    error: faults.txt:2:13: the fleet has no site `Nort`; did you mean `North`?\n    \
                    Nort: at 1s breakdown 1\n                ^^^^^^^^^^^\n\n2 errors: nothing was started\n";
    assert!(refused.ends_with(expected), "{refused}");
    for line in ["North: luggage (3,1) to (3,4)\n", "at 2s North: luggage (3,1) to (3,4)\n"] {
        let (_, text) = Yard::new().run(&["--virtual", "--events", "-", "--for", "10min"], line);
        assert!(text.contains("this fleet has no sites: write the event without `North:`"), "{text}");
    }
}

#[test]
fn a_wrong_line_is_told_with_its_number_and_the_run_goes_on() {
    let lines = "at 1s lugage (3,1) to (3,4)\n\nluggage (3,1) to (3,4)\nluggage (99,1) to (3,4)\n\x1b[2Jend\n\u{fffd}";
    let yard = Yard::new();
    let (output, text) = yard.run(&["--virtual", "--events", "-", "--for", "10min"], lines);
    assert!(output.status.success(), "{text}");
    let first = "line 1 of the events is ignored: found `lugage`, expected `luggage`, `visit`, `landing`, `takeoff`, `breakdown`, \
                 `gone`, `end`, `drain`, `outage`, `slow`, `lose`, `violate`, `delay`, `jitter`, `duplicate`, `reorder`, `cut`, \
                 `part`, `stall`, `fail`, `crash` or `drift`; did you mean `luggage`?\n    at 1s lugage (3,1) to (3,4)\n          ^^^^^^\n";
    assert!(text.contains(first), "{text}");
    assert!(text.contains("line 5 of the events is ignored: ") && !text.contains('\x1b'), "{text}");
    assert!(text.contains("ignores an event from outside, "), "{text}");
    let report = yard.report();
    assert_eq!(report["events"], serde_json::json!({ "ignored": 3, "taken": 2 }));
    assert_eq!(report["luggage"]["delivered"], 1);
}

#[test]
fn events_are_taken_as_they_come_and_the_end_of_input_is_no_end_of_the_run() {
    let yard = Yard::new();
    let mut child = yard.spawn(&["--events", "-", "--for", "60s", "--seed", "1"]);
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    let mut input = child.stdin.take().unwrap();
    assert!(lines.any(|line| line.contains("no scenario")));
    writeln!(input, "luggage (1,1) to (2,1)").unwrap();
    assert!(lines.any(|line| line.contains("deposited luggage 1000001")));
    writeln!(input, "luggage (1,2) to (2,2)").unwrap();
    drop(input);
    let rest: Vec<_> = lines.collect();
    assert!(child.wait().unwrap().success(), "{rest:?}");
    assert!(rest.iter().any(|line| line.contains("2 of 2 pieces of luggage delivered")), "{rest:?}");
}

#[test]
fn events_that_cannot_be_read_start_nothing() {
    let yard = Yard::new();
    for (arguments, expected) in [
        (
            &["--events", "nowhere.txt"][..],
            "error: the events cannot be read from `nowhere.txt`: there is no such file",
        ),
        (&["--events", "."], "error: the events cannot be read from `.`: is a directory"),
        (&["--events", "-", "-"], "error: composite and events cannot both be read from standard input"),
    ] {
        let (output, text) = yard.run(arguments, "");
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(text.is_empty() && error.starts_with(expected), "{error}");
    }
}

#[test]
fn why_leads_back_to_the_event() {
    let yard = Yard::new();
    yard.run(&["--virtual", "--events", "-", "--for", "10min"], LINES);
    let why = ["why", "Robot001", "--at", "2s", "--report", "report.json"];
    let text = stdout(&saoms_in(yard.folder.path(), &why));
    assert!(text.contains("(outside)") && text.contains("luggage (3,1) to (3,4)"), "{text}");
}

#[test]
fn faults_of_a_file_are_judged_before_anything_starts_and_played_by_the_seed() {
    let yard = Yard::new();
    let write = |text: &str| fs::write(yard.folder.path().join("faults.txt"), text).unwrap();
    let run = |seed: &str| {
        let arguments =
            ["run", "yard.composite", "--virtual", "--for", "30s", "--seed", seed, "--report", "report.json"];
        saoms_in(yard.folder.path(), &[&arguments[..], &["--faults", "faults.txt", "--short-report"]].concat())
    };
    write("at 1s lose 20 % on POSTOPICS\nlose 101 %\n# fine\nat 2s crash Robot1\nat 1s breakdown Robot001\n");
    let output = run("1");
    let told = String::from_utf8_lossy(&output.stderr);
    let expected = "error: faults.txt:1:20: the fleet has no topic `POSTOPICS`; did you mean `POSTOPIC`?
    at 1s lose 20 % on POSTOPICS
                       ^^^^^^^^^
error: faults.txt:2:6: found `101 %`, expected a part from 0 % to 100 %, or from 0 to 1
    lose 101 %
         ^^^^^
error: faults.txt:4:13: the fleet has no component `Robot1`; did you mean `Robot001`?
    at 2s crash Robot1
                ^^^^^^

3 errors: nothing was started
";
    assert_eq!(output.status.code(), Some(2));
    assert!(told.ends_with(expected), "{told}");
    write("at 0s lose 50 %\nat 5s..20s crash Robot001 restart 2s");
    let report = |seed: &str| {
        run(seed);
        let text = fs::read_to_string(yard.folder.path().join("report.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()
    };
    let (one, again, other) = (report("1"), report("1"), report("2"));
    assert_eq!(one["faults"]["applied"]["crash"], 1);
    assert_eq!(one["trace_hash"], again["trace_hash"]);
    assert_ne!(one["trace_hash"], other["trace_hash"]);
}
