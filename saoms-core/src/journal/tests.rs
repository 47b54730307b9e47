use std::sync::atomic::AtomicU64;

use saoms_api::host::Phase;
use saoms_api::{Cause, Time, Value, record};

use super::recorder::{Recorder, Stamp};
use super::{Journal, JournalReadError, read};

/// A recorder in its first execution, and the counter of its records.
fn recorder() -> (Recorder, AtomicU64) {
    let mut recorder = Recorder::default();
    recorder.begin(Cause::default());
    (recorder, AtomicU64::new(0))
}

fn stamp(ids: &AtomicU64) -> Stamp<'_> {
    Stamp { ids, component: 0, time: 1_000_000_000 }
}

/// Numbers and causes.
fn causes(recorder: &Recorder) -> Vec<(u64, u64)> {
    recorder.batch.heads().iter().map(|head| (head.id.0, head.cause.0)).collect()
}

#[test]
fn a_symptom_without_a_reason_follows_from_what_the_loop_senses() {
    let (mut recorder, ids) = recorder();
    let senses = ["battery".to_owned(), "busy".to_owned()];
    recorder.enter(Some(0), 0);
    recorder.changed(stamp(&ids), "battery", Value::Number(2.0), Value::Number(1.0));
    recorder.write(stamp(&ids), Phase::Symptom, &record!("luggage waits"), &senses);
    recorder.changed(stamp(&ids), "busy", Value::Bool(false), Value::Bool(true));
    recorder.changed(stamp(&ids), "next", Value::Pair(1, 1), Value::Pair(1, 2));
    recorder.enter(Some(1), 0);
    recorder.changed(stamp(&ids), "battery", Value::Number(1.0), Value::Number(0.5));
    recorder.write(stamp(&ids), Phase::Symptom, &record!("has a job"), &senses);
    assert_eq!(
        causes(&recorder).last(),
        Some(&(6, 3)),
        "neither its own change, nor what it does not sense, nor a measured value"
    );
    recorder.enter(Some(2), 0);
    recorder.because(Cause(2));
    recorder.write(stamp(&ids), Phase::Symptom, &record!("moves"), &senses);
    assert_eq!(causes(&recorder).last(), Some(&(7, 2)), "what the loop says itself counts more");
}

#[test]
fn a_value_that_is_no_number_is_the_same_value_again() {
    let (mut recorder, ids) = recorder();
    for execution in 0..3 {
        recorder.enter(Some(0), execution);
        recorder.write(stamp(&ids), Phase::Symptom, &record!("{level}", level = f64::NAN), &[]);
    }
    assert_eq!(recorder.batch.len(), 1);
    recorder.changed(stamp(&ids), "level", Value::Number(f64::NAN), Value::Number(f64::NAN));
    assert_eq!(recorder.batch.len(), 1);
}

#[test]
fn no_record_is_taken_for_a_change_of_what_is_named_alike() {
    let (mut recorder, ids) = recorder();
    recorder.changed(stamp(&ids), "level", Value::Integer(1), Value::Integer(2));
    recorder.write(stamp(&ids), Phase::Effect, &record!(level: "", before = 1, after = 2), &[]);
    let digests: Vec<_> = recorder.batch.heads().iter().map(|head| head.fingerprint).collect();
    assert_ne!(digests[0], digests[1]);
}

#[test]
fn a_loop_that_paused_begins_anew() {
    let (mut recorder, ids) = recorder();
    for execution in [0, 1, 3] {
        recorder.enter(Some(0), execution);
        recorder.write(stamp(&ids), Phase::Symptom, &record!("sees it"), &[]);
    }
    assert_eq!(recorder.batch.len(), 2);
}

/// Comparing each effect with all of the execution before would take 10^10 steps here.
#[test]
fn as_many_effects_as_an_execution_may_have_are_found_again_whatever_their_order() {
    const EFFECTS: i64 = 100_000;
    let (mut recorder, ids) = recorder();
    let effect = |number: i64| record!(acts: "acts {number}", number);
    recorder.enter(Some(0), 0);
    for number in (0..EFFECTS).chain([7, 7]) {
        recorder.write(stamp(&ids), Phase::Effect, &effect(number), &[]);
    }
    assert_eq!(recorder.batch.len(), 100_002, "within an execution each is an effect of its own");
    recorder.enter(Some(0), 1);
    for number in (0..EFFECTS).rev() {
        recorder.write(stamp(&ids), Phase::Effect, &effect(number), &[]);
        assert_eq!(recorder.cause(), Cause(number as u64 + 1), "the oldest of equal ones");
    }
    assert_eq!(recorder.batch.len(), 100_002);
    recorder.write(stamp(&ids), Phase::Effect, &effect(EFFECTS), &[]);
    assert_eq!(recorder.batch.len(), 100_003, "a new one");
}

/// Code of a library may name as many entries as an execution may have records.
#[test]
fn the_newest_change_is_found_among_as_many_entries_as_an_execution_may_name() {
    let (mut recorder, ids) = recorder();
    let names: Vec<&'static str> = (0..100_000).map(|number| &*format!("entry {number}").leak()).collect();
    recorder.enter(Some(0), 0);
    recorder.write(stamp(&ids), Phase::Symptom, &record!("looks"), &[]);
    for name in names.iter().chain(&names) {
        recorder.changed(stamp(&ids), name, Value::Integer(1), Value::Integer(2));
    }
    recorder.enter(Some(1), 0);
    let senses = [names[0].to_owned(), names[3].to_owned(), "another".to_owned()];
    recorder.write(stamp(&ids), Phase::Symptom, &record!("has a job"), &senses);
    assert_eq!(causes(&recorder).last(), Some(&(200_002, 100_005)), "the second change of the fourth entry");
}

const HEAD: &str = r#"{"journal":1,"seed":7,"clock":"virtual","components":[{"name":"A","id":"1"}]}"#;

fn refused(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

#[test]
fn files_that_are_no_journal_are_told_apart() {
    assert_eq!(read(""), Err(JournalReadError::Other));
    assert_eq!(read("[1]"), Err(JournalReadError::Other));
    assert_eq!(read(r#"{"time_s": 1.0, "components": []}"#), Err(JournalReadError::NoJournal));
    assert_eq!(
        refused("{\n\"a\": 1"),
        "line 2, column 6: this is neither a complete report of `saoms run --report` nor a file of `saoms run \
        --journal`: \
         EOF while parsing an object"
    );
    let newer = HEAD.replace("\"journal\":1", "\"journal\":2");
    assert_eq!(refused(&newer), "line 1: this file has the format 2, which a newer version of the program writes");
}

#[test]
fn a_wrong_record_is_told_at_its_line() {
    let record = r#"{"id":1,"time_s":1.0,"component":"A","phase":"effect","text":"acts"}"#;
    assert_eq!(read(&format!("{HEAD}\n{record}\n")).unwrap().journal.entries().len(), 1);
    let cases = [
        (
            record.replace("effect", "affect"),
            "line 2, column 53: this is not a record of a journal: unknown variant `affect`",
        ),
        (record.replace("1.0", "-1.0"), "line 2: this is not a record of a journal: `-1` is not a time in seconds"),
        (
            record.replace("\"text\"", "\"cause\":1,\"text\""),
            "line 2: this is not a record of a journal: record 1 cannot follow",
        ),
        (record.replace("}", ""), "line 2, column 67: this is not a record of a journal: EOF"),
        (format!("{record}\n{record}"), "line 1: there are two records with the number 1"),
    ];
    for (lines, expected) in cases {
        let found = refused(&format!("{HEAD}\n{lines}\n"));
        assert!(found.starts_with(expected), "{found}\ninstead of\n{expected}");
    }
}

#[test]
fn the_file_of_a_run_that_goes_on_may_end_in_the_middle_of_a_record() {
    let text = format!(
        "{HEAD}\n{}\n{}",
        r#"{"id":1,"time_s":1.0,"component":"A","phase":"effect","text":"acts"}"#, r#"{"id":2,"ti"#
    );
    let document = read(&text).unwrap();
    assert_eq!((document.journal.records, document.end), (1, None));
}

#[test]
fn records_that_are_missing_in_a_file_are_counted() {
    let text =
        format!("{HEAD}\n{}\n", r#"{"id":3,"time_s":1.0,"component":"A","phase":"effect","text":"acts","cause":2}"#);
    let journal = read(&text).unwrap().journal;
    assert_eq!((journal.records, journal.lost), (3, 2));
    let why = journal.why("A", None).unwrap();
    assert_eq!(why.chains[0].missing, Some(Cause(2)));
}

#[test]
fn records_of_earlier_versions_have_their_text_as_the_id() {
    let old = r#"{"id":1,"time_s":1.0,"component":"A","phase":"effect","text":"acts"}"#;
    let new = r#"{"id":2,"time_s":1.0,"component":"A","phase":"effect","record":"acts_well","text":"acts"}"#;
    let change = r#"{"id":3,"time_s":1.0,"component":"A","phase":"effect","entry":"acts","text":"acts: 1 -> 2"}"#;
    let journal = read(&format!("{HEAD}\n{old}\n{new}\n{change}\n")).unwrap().journal;
    let ids: Vec<_> = journal.entries().iter().map(super::JournalEntry::record_id).collect();
    assert_eq!(ids, ["acts", "acts_well", "acts"]);
    assert_eq!(journal.all().of_record("acts").len(), 1, "a change is no record");
    assert_eq!(journal.all().changes("acts").len(), 1);
}

fn journal(entries: &str) -> Journal {
    serde_json::from_str(&format!(r#"{{"records": 9, "entries": [{entries}]}}"#)).unwrap()
}

#[test]
fn what_was_done_for_one_reason_is_one_chain_and_what_was_known_is_told() {
    let journal = journal(
        r#"{"id":1,"time_s":1,"component":"B","phase":"symptom","text":"calls"},
           {"id":2,"time_s":1,"component":"A","phase":"effect","entry":"battery","text":"battery: 9 -> 8","values":{"before":9,"after":8}},
           {"id":3,"time_s":2,"component":"A","loop":"L","phase":"symptom","text":"hears","cause":1},
           {"id":4,"time_s":2,"component":"A","loop":"L","phase":"decision","text":"goes","cause":3},
           {"id":5,"time_s":2,"component":"A","loop":"L","phase":"effect","entry":"next","text":"next: none -> (1,2)","values":{"before":null,"after":[1,2]},"cause":4},
           {"id":6,"time_s":2,"component":"A","loop":"L","phase":"effect","text":"lights up","cause":4},
           {"id":7,"time_s":2,"component":"A","loop":"M","phase":"decision","text":"rests"},
           {"id":8,"time_s":3,"component":"A","loop":"M","phase":"symptom","text":"sees something"},
           {"id":9,"time_s":4,"component":"A","phase":"effect","entry":"battery","text":"battery: 8 -> 7","values":{"before":8,"after":7}}"#,
    );
    let told = |at: Option<u64>| {
        let why = journal.why("A", at.map(|at| Time::from_nanos(at * 1_000_000_000))).unwrap();
        let texts =
            |entries: &[&super::JournalEntry]| entries.iter().map(|entry| entry.text()).collect::<Vec<_>>().join(", ");
        let chains: Vec<_> =
            why.chains.iter().map(|chain| format!("{} <- {}", texts(&chain.acts), texts(&chain.reasons))).collect();
        let known: Vec<_> = why.knowledge.iter().map(|known| format!("{}={}", known.entry, known.shown())).collect();
        format!("{:?}: {} | {}", why.time.map(|time| time.as_secs_f64()), chains.join("; "), known.join(" "))
    };
    let acts = "Some(2.0): next: none -> (1,2), lights up <- goes, hears, calls; rests <- ";
    assert_eq!(told(None), format!("{acts} | battery=7 next=(1,2)"));
    assert_eq!(told(Some(3)), format!("{acts} | battery=8 next=(1,2)"));
    assert_eq!(told(Some(1)), "Some(1.0): battery: 9 -> 8 <-  | battery=8 next=none");
    assert_eq!(told(Some(0)), "None:  | battery=9 next=none");
}
