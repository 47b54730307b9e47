//! `saoms why` as a user meets it, and the example of its documentation.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::support::{command, root, saoms_in, stdout};

/// A folder with the composites, and report and journal of the hall.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("why").join(test);
    fs::create_dir_all(folder.join("composites")).unwrap();
    let shipped = root().join("composites/hall.composite");
    fs::copy(shipped, folder.join("composites/hall.composite")).unwrap();
    let run = ["run", "composites/hall.composite", "--virtual", "--quiet", "--report", "report.json"];
    let output = saoms_in(&folder, &[&run[..], &["--journal", "journal.jsonl"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// The message when there is no answer.
#[track_caller]
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = saoms_in(folder, &[&["why"], arguments].concat());
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn the_example_of_the_documentation_is_real() {
    let page = fs::read_to_string(root().join("docs/journal.md")).unwrap();
    let block = page.split("```console\n").nth(1).unwrap().split("```").next().unwrap();
    let (command, expected) = block.split_once("report.json\nRobot7 ").unwrap();
    let command = command.rsplit_once("$ saoms ").unwrap().1;
    let arguments: Vec<&str> = command.split_whitespace().chain(["report.json"]).collect();
    let output = saoms_in(&folder("docs"), &arguments);
    assert_eq!(stdout(&output), format!("Robot7 {expected}"));
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn report_and_file_and_standard_input_give_the_same_answer() {
    let folder = folder("same");
    for at in ["1s", "1100", "2.5s"] {
        let of = |file: &str| stdout(&saoms_in(&folder, &["why", "Robot7", "--at", at, "--report", file]));
        let answer = of("report.json");
        assert!(answer.contains("Robot7"), "{answer}");
        assert_eq!(of("journal.jsonl"), answer);
    }
    let output = command(&["why", "Robot7", "--journal", "-"])
        .stdin(fs::File::open(folder.join("journal.jsonl")).unwrap())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(stdout(&output), stdout(&saoms_in(&folder, &["why", "Robot7", "--report", "report.json"])));
}

#[test]
fn json_holds_the_chain_back_to_its_root() {
    let arguments = ["why", "Robot7", "--at", "1s", "--report", "report.json", "--format", "json"];
    let answer: Value = serde_json::from_str(&stdout(&saoms_in(&folder("json"), &arguments))).unwrap();
    assert_eq!(answer["component"], "Robot7");
    assert_eq!(answer["time_s"], 1.0);
    let reasons = answer["chains"][0]["reasons"].as_array().unwrap();
    let root = reasons.last().unwrap();
    assert_eq!(root["component"], "Environment");
    assert_eq!(root["values"]["from"], serde_json::json!([3, 1]));
    assert_eq!(answer["chains"][0]["missing"], Value::Null);
    assert!(answer["knowledge"].as_array().unwrap().iter().any(|known| known["entry"] == "busy"));
}

#[test]
fn what_several_reasons_have_in_common_is_told_once() {
    let answer = stdout(&saoms_in(&folder("once"), &["why", "Robot7", "--at", "1100", "--report", "report.json"]));
    let root = "luggage 1 waits at (3,1) to go to (3,10)";
    assert_eq!(answer.matches(root).count(), 1, "{answer}");
    assert!(answer.contains("     ... and so on as above ...\n"), "{answer}");
}

/// The file of a run that was killed may end with a part of a character; that of a machine without power with anything.
#[test]
fn a_journal_that_is_cut_off_is_read_up_to_its_last_whole_record() {
    let folder = folder("cut");
    let whole = fs::read(folder.join("journal.jsonl")).unwrap();
    let (records, _end) = whole.split_at(whole[..whole.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1);
    let of = |file: &str| stdout(&saoms_in(&folder, &["why", "Robot7", "--at", "2s", "--report", file]));
    let tails: [&[u8]; 5] =
        [b"{\"id\":99999,\"text\":\"5 \xc2", b"{\"id\":9999", b"", &[0; 5000], b"{\"id\":\xff\xfe\xffx"];
    for tail in tails {
        fs::write(folder.join("cut.jsonl"), [records, tail].concat()).unwrap();
        assert_eq!(of("cut.jsonl"), of("journal.jsonl"), "{tail:?}");
    }
    fs::write(folder.join("cut.jsonl"), [records, b"\xff\n", records].concat()).unwrap();
    assert!(refused(&folder, &["Robot7", "--report", "cut.jsonl"]).contains("`cut.jsonl` is not text"));
}

#[test]
fn wrong_questions_are_told() {
    let folder = folder("wrong");
    let report = ["--report", "report.json"];
    let ask = |robot: &str, more: &[&str]| refused(&folder, &[&[robot], &report[..], more].concat());
    assert_eq!(ask("Robot8", &[]), "error: the fleet of this run had no component `Robot8`: did you mean `Robot7`?\n");
    assert!(ask("Nobody", &[]).contains("its components are `World`, `Environment`, `Master`, `Robot7`"));
    assert!(ask("", &[]).contains("no component ``"));
    assert_eq!(
        ask("Robot7", &["--at", "1h"]),
        "error: the run had ended at 3.400 s, before 3600s: ask for a time up to then\n"
    );
    assert!(ask("Robot7", &["--at", "-1s"]).contains("negative"));
    let nobody = tempfile::tempdir().unwrap();
    let unasked = command(&["why", "Robot7"]).env("XDG_RUNTIME_DIR", nobody.path()).output().unwrap();
    assert_eq!(unasked.status.code(), Some(2));
    let unasked = String::from_utf8(unasked.stderr).unwrap();
    assert!(unasked.starts_with("error: no fleet runs") && unasked.contains("--report FILE"), "{unasked}");
    assert!(refused(&folder, &["Robot7", "--report", "none.json"]).contains("`none.json` cannot be read"));
    let composite = "composites/hall.composite";
    assert!(refused(&folder, &["Robot7", "--report", composite]).contains("is neither a report"));
    fs::write(folder.join("binary"), [0xff, 0xfe]).unwrap();
    assert!(refused(&folder, &["Robot7", "--report", "binary"]).contains("`binary` is not text"));
    let mut value: Value = serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap();
    value.as_object_mut().unwrap().remove("journal");
    fs::write(folder.join("old.json"), value.to_string()).unwrap();
    assert!(refused(&folder, &["Robot7", "--report", "old.json"]).contains("`old.json` contains no journal"));
}

#[test]
fn a_component_that_did_nothing_is_an_answer() {
    let output = saoms_in(&folder("nothing"), &["why", "Master", "--report", "report.json"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).starts_with("Master has no records in the journal of this run"));
}

/// The report of a run whose oldest records were overwritten, made from a whole one.
#[test]
fn what_was_overwritten_is_said() {
    let folder = folder("overwritten");
    let mut value: Value = serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap();
    let entries = value["journal"]["entries"].as_array_mut().unwrap();
    let root = entries.iter().find(|entry| entry["component"] == "Environment").unwrap()["id"].clone();
    entries.retain(|entry| entry["component"] != "Environment");
    fs::write(folder.join("part.json"), value.to_string()).unwrap();
    let output = saoms_in(&folder, &["why", "Robot7", "--at", "1s", "--report", "part.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stdout(&output).contains("... earlier causes are not in the journal any more ..."));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains(&format!("record {root}, which led to this, was overwritten.")), "{told}");
    assert!(told.contains("run with `--journal FILE`"), "{told}");
    let told = refused(&folder, &["Environment", "--report", "part.json"]);
    assert!(
        told.contains("the causes of the action of `Environment` are unknown: what it did then was overwritten"),
        "{told}"
    );
}

#[test]
fn the_journal_needs_a_file_of_its_own() {
    let folder = folder("places");
    for (journal, mentions) in [
        ("no/such/folder/j", "the journal cannot be written to `no/such/folder/j`"),
        ("-", "cannot be written to `-`: standard output is for the lines of the run"),
        ("report.json", "cannot both be written to `report.json`"),
    ] {
        let run = ["run", "composites/hall.composite", "--virtual", "--report", "report.json", "--journal", journal];
        let output = saoms_in(&folder, &run);
        assert_eq!(output.status.code(), Some(2));
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains(mentions) && told.contains("nothing was started"), "{told}");
    }
}

#[test]
fn a_safe_robot_knows_that_it_goes_to_its_charger_and_is_in_charge() {
    let scenario = "at 1s luggage (3,1) to (10,9); at 3s luggage (9,9) to (3,9); at 30s end";
    let component = |name: &str, class: &str, inside: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"{class}\"/><property name=\"ID\">{name}</property><property name=\"period\">100</property>{inside}</component>\n"
        )
    };
    let text = component("World", "saoms.World", "")
        + &component("Master", "saoms.MasterEnvironment", "")
        + &component("Environment", "saoms.Environment", &format!("<property name=\"scenario\">{scenario}</property>"))
        + &component("Robot1", "saoms.Robot", "<reference name=\"world\" target=\"World\"/>");
    let start =
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">";
    let run = saoms_testkit::Fleet::of_text(format!("{start}\n{text}</composite>"))
        .run(1, std::time::Duration::from_secs(60));
    let journal: String = run.journal().entries().iter().map(|entry| format!("{entry}\n")).collect();
    for change in ["inCharge", "reachingCharge", "readyToGoUnderCharge"] {
        let changes = journal.lines().filter(|line| line.contains(change)).count();
        assert!(changes >= 2, "{change} {changes}:\n{journal}");
    }
}

#[test]
fn a_report_without_records_says_so() {
    let folder = folder("short");
    let run = ["run", "composites/hall.composite", "--virtual", "--quiet", "--report", "short.json", "--short-report"];
    assert_eq!(saoms_in(&folder, &run).status.code(), Some(0));
    let told = refused(&folder, &["Robot7", "--report", "short.json"]);
    assert!(told.contains("`short.json` is a report without the records of the journal"), "{told}");
    assert!(told.contains("`--short-report`") && !told.contains("overwritten"), "{told}");
}
