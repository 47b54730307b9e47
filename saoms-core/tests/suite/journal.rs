//! The journal of fleets whose loops talk to each other over topics.

mod actors;
mod live;

use std::path::Path;
use std::sync::Arc;

use saoms_core::journal::{Journal, LoopCounts, read};
use saoms_core::observe::JournalFile;
use saoms_core::report::{RunReport, RunStatus};
use saoms_core::schedule::{RunningFleet, Settings};

use crate::fleet::{simulated, unindent};

use actors::fleet;

fn run(text: &str, settings: Settings) -> RunReport {
    RunningFleet::start(fleet(text), settings, Vec::new()).unwrap().run_to_end()
}

/// The same with a file of the journal.
fn run_to_file(text: &str, settings: Settings, path: &Path) -> RunReport {
    RunningFleet::start(fleet(text), settings, vec![Arc::new(JournalFile::new(path))]).unwrap().run_to_end()
}

/// The records of a run in virtual time: number, cause, and the record itself.
fn records(journal: &Journal) -> String {
    let lines = journal.entries().iter().map(|entry| {
        let (id, cause) = (entry.id().0, entry.cause().0);
        let cause = if cause == 0 { String::new() } else { format!(" <- {cause}") };
        format!("{id}{cause} [{entry}]\n")
    });
    lines.collect()
}

const PAIR: &str = "Gate gate period=100 every=4
     Robot robot period=100 delay=50";

#[test]
fn a_chain_leads_through_messages_from_component_to_component() {
    let report = run(PAIR, simulated(400));
    assert_eq!(
        records(&report.journal),
        unindent(
            "1 [0.100 s Gate - symptom: piece 1 waits at (3,1)]
             2 <- 1 [0.150 s Robot Jobs symptom: hears of piece 1]
             3 <- 2 [0.150 s Robot Jobs decision: takes it]
             4 <- 3 [0.150 s Robot Jobs effect: goes on]
             5 <- 3 [0.150 s Robot Jobs effect: told: 0 -> 1]
             6 <- 3 [0.200 s Gate - effect: strikes piece 1 off its list]
            "
        ) + "\n"
    );
}

#[test]
fn who_passes_a_message_on_keeps_the_chain_together() {
    let report = run(
        "Gate gate period=100 every=4 rename=REQUESTS/FIRST
         Relay relay period=100 delay=10
         Robot robot period=100 delay=50",
        simulated(200),
    );
    let heard = report.journal.of("Robot").symptoms().last().unwrap();
    assert_eq!(report.journal.reasons(heard).0[0].text(), "piece 1 waits at (3,1)");
}

#[test]
fn a_loop_that_goes_on_as_before_writes_nothing_new() {
    let report = run(PAIR, simulated(10_000));
    let robot = report.journal.of("Robot").of_loop("Jobs");
    // 25 pieces in 100 executions: each is heard of, decided on and begun once.
    let count = |selection: saoms_core::journal::Selection<'_>| selection.len();
    assert_eq!(count(robot.clone().symptoms()), 25);
    assert_eq!(count(robot.clone().decisions()), 25);
    assert_eq!(count(robot.clone().effects().with("goes on")), 25);
    assert_eq!(count(robot.changes("told")), 25);
}

#[test]
fn another_decision_for_the_same_reason_is_new() {
    // The battery is empty from execution 3 on: what the loop for jobs finds stays, what it decides does not.
    let report = run(
        "Gate gate period=100 every=4
         Robot robot period=100 delay=50 charge=4",
        simulated(700),
    );
    assert_eq!(
        report.journal.of("Robot").to_string(),
        unindent(
            "0.150 s Robot Battery symptom: 2 left
             0.150 s Robot Battery decision: would charge
             0.150 s Robot Jobs symptom: hears of piece 1
             0.150 s Robot Jobs decision: takes it
             0.150 s Robot Jobs effect: goes on
             0.150 s Robot Jobs effect: told: 0 -> 1
             0.250 s Robot Battery symptom: 1 left
             0.250 s Robot Battery decision: would charge
             0.350 s Robot Battery symptom: 0 left
             0.350 s Robot Battery decision: would charge
             0.450 s Robot Battery symptom: -1 left
             0.450 s Robot Battery decision: would charge
             0.550 s Robot Battery symptom: -2 left
             0.550 s Robot Battery decision: would charge
             0.550 s Robot Jobs symptom: hears of piece 2
             0.650 s Robot Battery symptom: -3 left
             0.650 s Robot Battery decision: would charge"
        ) + "\n"
    );
    let counts = |name: Option<&str>, symptoms, decisions, effects, without_effect| LoopCounts {
        component: if name.is_some() { "Robot" } else { "Gate" }.to_owned(),
        loop_name: name.map(str::to_owned),
        symptoms,
        decisions,
        effects,
        without_effect: Some(without_effect),
    };
    assert_eq!(
        report.journal.loops,
        [counts(None, 2, 0, 1, 0), counts(Some("Battery"), 6, 6, 0, 6), counts(Some("Jobs"), 2, 1, 2, 0)]
    );
}

#[test]
fn what_was_decided_before_a_failure_is_kept() {
    let report = run(
        "Gate gate period=100 every=4
         Robot robot period=100 delay=50 fails=1 restart=50/1",
        simulated(900),
    );
    assert_eq!(report.outcome.status, RunStatus::Failed);
    let texts = report.journal.of("Robot").decisions().texts();
    // The first instance fails when it has decided; the second one, which knows nothing of that, in its second
    // execution.
    assert_eq!(texts, ["takes it"]);
    // Its message never left.
    assert!(report.journal.of("Gate").effects().is_empty());
}

#[test]
fn the_same_seed_gives_the_same_journal_and_another_journal_another_digest() {
    let one = run(PAIR, simulated(3000));
    let same = run(PAIR, simulated(3000));
    assert_eq!(one.journal, same.journal);
    assert_eq!(one.trace_hash, same.trace_hash);
    // This robot does and says the same, but its battery loop writes records.
    let other = run(&PAIR.replace("delay=50", "delay=50 charge=32"), simulated(3000));
    assert_ne!(one.trace_hash, other.trace_hash);
}

#[test]
fn the_oldest_records_of_each_component_are_overwritten_and_counted() {
    let settings = Settings { journal: 0, ..simulated(100_000) };
    let report = run(&PAIR.replace("every=4", "every=2"), settings);
    let journal = &report.journal;
    assert!(journal.overwritten > 1000);
    assert_eq!(journal.entries().len() as u64 + journal.overwritten, journal.records);
    assert_eq!(journal.loops.iter().map(LoopCounts::records).sum::<u64>(), journal.records);
    for component in ["Gate", "Robot"] {
        let left = journal.of(component);
        assert!((65..=128).contains(&left.len()), "{component}: {}", left.len());
        assert_eq!(left.last().map(|entry| entry.time() > saoms_api::Time::from_nanos(99_000_000_000)), Some(true));
    }
    let early = saoms_api::Time::from_nanos(1_000_000_000);
    let error = journal.why("Robot", Some(early)).unwrap_err();
    assert!(error.to_string().starts_with("what it did then was overwritten: its journal reaches back to "), "{error}");
}

/// A folder and the path of a file in it.
fn place() -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    (folder, path)
}

#[test]
fn the_file_holds_every_record_in_the_form_of_the_report() {
    let (_folder, path) = place();
    let settings = Settings { journal: 0, ..simulated(100_000) };
    let text = PAIR.replace("every=4", "every=2");
    let report = run_to_file(&text, settings, &path);
    let whole = run(&text, Settings { journal: 1_000_000, ..simulated(100_000) });
    let document = read(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert_eq!(document.journal.entries(), whole.journal.entries());
    assert_eq!(document.journal.records, report.journal.records);
    assert_eq!((document.journal.lost, report.journal.lost), (0, 0));
    assert_eq!(document.end, Some(saoms_api::Time::from_nanos(100_000_000_000)));
    let names: Vec<_> = document.components.iter().map(|one| (one.name.as_str(), one.id.as_deref())).collect();
    assert_eq!(names, [("Gate", Some("Gate")), ("Robot", Some("Robot"))]);
    let report = serde_json::to_string_pretty(&whole).unwrap();
    let document = read(&report).unwrap();
    assert_eq!(document.journal, whole.journal);
    // One line for each record, however the rest is laid out.
    assert!(report.lines().count() < whole.journal.entries().len() + 100);
}

#[test]
fn the_file_is_whole_in_real_time_too() {
    let (_folder, path) = place();
    let text = PAIR.replace("period=100", "period=2").replace("delay=50", "delay=1");
    let report = run_to_file(&text, crate::fleet::real(60), &path);
    let document = read(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert_eq!(document.journal.entries(), report.journal.entries());
    assert!(report.journal.records > 10, "{}", report.journal.records);
}

#[test]
fn a_file_that_is_cut_off_anywhere_is_read_up_to_its_last_whole_line() {
    let (_folder, path) = place();
    run_to_file(PAIR, simulated(400), &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let (head, rest) = text.split_at(text.find('\n').unwrap() + 1);
    let rest = format!("{rest}{{\"joined\":{{\"name\":\"Late\",\"id\":null}}}}\n");
    for end in 0..rest.len() {
        let (cut, whole) = (&rest[..end], rest[..end].matches('\n').count());
        let entries = rest.lines().take(whole).filter(|line| line.starts_with("{\"id\"")).count();
        let document = read(&format!("{head}{cut}")).unwrap_or_else(|error| panic!("{cut}: {error}"));
        // A line that lacks nothing but its end is whole as well.
        let found = document.journal.entries().len();
        assert!(found == entries || found == entries + 1 && cut.ends_with('}'), "{cut}");
    }
}

#[test]
fn a_file_that_takes_nothing_fails_the_run_and_says_why() {
    let full = Arc::new(JournalFile::new("/dev/full"));
    let error = RunningFleet::start(fleet(PAIR), simulated(1000), vec![full]).unwrap_err();
    assert_eq!(error.to_string(), "the journal cannot be written: No space left on device (os error 28)");
}

#[test]
fn a_call_follows_from_what_its_caller_does() {
    let report = run(
        "Asker asker period=100 peer=Helper
         Helper helper",
        simulated(100),
    );
    assert_eq!(
        records(&report.journal),
        "1 [0.000 s Asker - symptom: does not know]\n2 <- 1 [0.000 s Asker - decision: asks]\n\
         3 <- 2 [0.000 s Helper - effect: answers]\n"
    );
    assert_eq!(report.journal.loops[0].without_effect, Some(0), "the call is what followed");
}

#[test]
fn the_hash_of_a_run_takes_ids_and_values_and_no_words() {
    let hash = |record: &str| run(&format!("A speaker period=100 record={record}"), simulated(200)).trace_hash.unwrap();
    let plain = hash("plain");
    assert_eq!(hash("reworded"), plain);
    let others = ["other-id", "other-value", "plain-text", "other-text"].map(hash);
    assert!(!others.contains(&plain), "{plain}: {others:?}");
    assert_ne!(others[2], others[3], "without an id the text is the id");
}

#[test]
fn records_are_found_by_their_ids() {
    let report = run("A speaker period=100 record=plain\nB speaker period=100 record=other-text", simulated(100));
    assert_eq!(report.journal.all().of_record("low_battery").texts(), ["has 34 % left"]);
    assert_eq!(report.journal.all().of_record("battery is at {battery} %").texts(), ["battery is at 34 %"]);
    let json = serde_json::to_string(&report.journal.entries()[0]).unwrap();
    assert_eq!(
        json,
        r#"{"id":1,"time_s":0.0,"component":"A","phase":"symptom","record":"low_battery","text":"has 34 % left","values":{"battery":34}}"#
    );
}
