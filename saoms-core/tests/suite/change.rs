//! Fleets that change while they run.

use std::fmt::Write;
use std::thread;
use std::time::Duration;

use saoms_api::Time;
use saoms_core::schedule::{ChangeError, ChangeOptions, Changed, Handle, Settings, Takeover};

use crate::fleet::{assembly, of, outcome, real, simulated, start, unindent};

fn at(milliseconds: u64) -> Time {
    Time::from_nanos(milliseconds * 1_000_000)
}

fn apply(handle: &Handle, fleet: &str) -> Result<Changed, ChangeError> {
    handle.apply(&assembly(fleet), ChangeOptions::allowing_loss())
}

/// Runs a fleet in virtual time that becomes another one at each of these times, and gives what was recorded and the
/// digest of the run.
fn run(fleet: &str, changes: &[(u64, &str)], limit: u64) -> (String, String) {
    let (fleet, diary) = start(fleet, simulated(limit));
    let fleet = fleet.unwrap();
    let mut results = String::new();
    for (time, wanted) in changes {
        fleet.run_until(at(*time));
        match apply(&fleet.handle(), wanted) {
            Ok(Changed { added, removed, replaced, .. }) => {
                let replaced: Vec<_> = replaced.iter().map(|(name, how)| format!("{name} {how:?}")).collect();
                let words = [added.join(" "), removed.join(" "), replaced.join(" ")];
                writeln!(results, "+[{}] -[{}] ~[{}]", words[0], words[1], words[2]).unwrap();
            }
            Err(error) => writeln!(results, "{error}").unwrap(),
        }
    }
    let report = fleet.run_to_end();
    (format!("{results}{}{}", diary.all_lines(), outcome(&report)), report.trace_hash.unwrap())
}

#[track_caller]
fn check(fleet: &str, changes: &[(u64, &str)], limit: u64, expected: &str) {
    let (told, hash) = run(fleet, changes, limit);
    assert_eq!(told.trim(), unindent(expected), "\n--- told:\n{told}");
    assert_eq!(run(fleet, changes, limit), (told, hash), "the same changes give the same run");
}

#[test]
fn components_that_are_removed_together_serve_each_other_until_their_own_end() {
    check(
        "A actor period=10 each=[number]
         B actor period=10 peer=C last=[must-ask one; log gone]
         C actor period=10 peer=D called=[must-ask two; log asked] last=[must-ask three; log gone]
         D callee called=[log asked] last=[log gone]",
        &[(22, "A actor period=10 each=[number]")],
        35,
        "+[] -[B C D] ~[]
         [0.000 s] A: started
         [0.000 s] B: started
         [0.000 s] C: started
         [0.000 s] D: started
         [0.000 s] A: A 0 every 10ms
         [0.010 s] A: A 1 every 10ms
         [0.020 s] A: A 2 every 10ms
         [0.022 s] D: asked
         [0.022 s] C: asked
         [0.022 s] B: gone
         [0.022 s] B: has shut down
         [0.022 s] D: asked
         [0.022 s] C: gone
         [0.022 s] C: has shut down
         [0.022 s] D: gone
         [0.022 s] D: has shut down
         [0.030 s] A: A 3 every 10ms
         [0.035 s] A: has shut down
         Elapsed after 0.035 s",
    );
}

#[test]
fn components_join_end_and_are_replaced_and_the_others_go_on() {
    check(
        "A actor period=10 each=[number]
         B actor period=10 publishes=TALK each=[say b] last=[log bye; say bye]
         C actor period=10 delay=5 subscribes=TALK each=[hear]",
        &[(
            22,
            "D actor period=10 delay=3 publishes=TALK first=[say d] each=[number]
             C actor period=10 delay=5 subscribes=TALK each=[hear; number]
             A actor period=10 each=[number]",
        )],
        40,
        "+[D] -[B] ~[C Began]
         [0.000 s] A: started
         [0.000 s] B: started
         [0.000 s] C: started
         [0.000 s] A: A 0 every 10ms
         [0.005 s] C: hears [b]
         [0.010 s] A: A 1 every 10ms
         [0.015 s] C: hears [b]
         [0.020 s] A: A 2 every 10ms
         [0.022 s] D: started
         [0.022 s] C: is replaced, and starts without the earlier state
         [0.022 s] B: bye
         [0.022 s] B: has shut down
         [0.025 s] C: hears [b, d, bye]
         [0.025 s] C: C 2 every 10ms
         [0.025 s] D: D 0 every 10ms
         [0.030 s] A: A 3 every 10ms
         [0.035 s] C: hears []
         [0.035 s] C: C 3 every 10ms
         [0.035 s] D: D 1 every 10ms
         [0.040 s] D: has shut down
         [0.040 s] C: has shut down
         [0.040 s] A: has shut down
         Elapsed after 0.04 s",
    );
}

#[test]
fn a_change_that_cannot_be_prepared_leaves_everything_as_it_was() {
    let fleet = "A actor period=10 publishes=TALK each=[say a]
         B actor period=10 delay=5 subscribes=TALK each=[hear; number] last=[log bye]";
    let wanted = "A actor period=10 publishes=TALK each=[say changed]
         X actor period=10 first=[log hello] last=[log no]
         Y actor period=10 first=[fail no room]";
    let (before, hash) = run(fleet, &[], 50);
    let (told, changed) = run(fleet, &[(22, wanted)], 50);
    assert!(told.starts_with("component `Y` of class `actor` could not start: no room\n"), "\n--- told:\n{told}");
    let attempts = ["could not start", " X: hello", " X: no"];
    let rest = told.lines().filter(|line| !attempts.iter().any(|attempt| line.contains(attempt)));
    assert_eq!(rest.collect::<Vec<_>>(), before.lines().collect::<Vec<_>>());
    assert_eq!(changed, hash);
}

#[test]
fn components_that_did_not_join_are_not_in_the_report() {
    let (fleet, _) = start("A actor period=10", simulated(30));
    let fleet = fleet.unwrap();
    fleet.run_until(at(15));
    let wanted = "A actor period=10\nX actor period=10 made=nothing\nY actor period=10";
    assert!(apply(&fleet.handle(), wanted).is_err());
    assert!(fleet.handle().is_running("Y").is_err());
    assert!(fleet.handle().apply(&assembly("A actor period=10\nY actor period=10"), ChangeOptions::default()).is_ok());
    assert!(fleet.handle().is_running("Y").unwrap());
    let report = fleet.run_to_end();
    let names: Vec<_> = report.components.iter().map(|one| (one.name.as_str(), one.executions)).collect();
    assert_eq!(names, [("A", 3), ("Y", 2)]);
}

#[test]
fn new_components_call_each_other_and_those_that_are_replaced() {
    check(
        "P callee called=[log old]
         A actor period=10 peer=P each=[ask something]",
        &[(
            5,
            "A actor period=10 peer=Q each=[ask something]
             P callee called=[log new]
             Q callee peer=P first=[must-ask for me; log ready] called=[must-ask for it; log asked]",
        )],
        20,
        "+[Q] -[] ~[P Began A Began]
         [0.000 s] P: started
         [0.000 s] A: started
         [0.000 s] P: old
         [0.000 s] A: is told \"something from P\"
         [0.005 s] P: new
         [0.005 s] Q: ready
         [0.005 s] Q: started
         [0.005 s] P: is replaced, and starts without the earlier state
         [0.005 s] A: is replaced, and starts without the earlier state
         [0.010 s] P: new
         [0.010 s] Q: asked
         [0.010 s] A: is told \"something from Q\"
         [0.020 s] A: has shut down
         [0.020 s] Q: has shut down
         [0.020 s] P: has shut down
         Elapsed after 0.02 s",
    );
}

#[test]
fn a_component_of_another_class_begins_anew_and_its_callers_find_it() {
    check(
        "P callee last=[log end of p]
         A actor period=10 peer=P each=[ask something]
         B actor period=10 each=[1: log b]",
        &[(
            5,
            "P actor period=100
             A actor period=10 peer=P each=[ask something]
             B actor period=10 each=[1: log b]",
        )],
        20,
        "+[P] -[P] ~[A Began]
         [0.000 s] P: started
         [0.000 s] A: started
         [0.000 s] B: started
         [0.000 s] A: is told \"something from P\"
         [0.005 s] P: started
         [0.005 s] A: is replaced, and starts without the earlier state
         [0.005 s] P: end of p
         [0.005 s] P: has shut down
         [0.010 s] A: is told \"something from P\"
         [0.010 s] B: b
         [0.020 s] B: has shut down
         [0.020 s] A: has shut down
         [0.020 s] P: has shut down
         Elapsed after 0.02 s",
    );
}

#[test]
fn one_that_was_removed_can_come_again_and_a_new_period_counts_from_the_last_execution() {
    let fleet = "A actor period=10 each=[time]\nB actor period=10 startup=false";
    let (fleet, diary) = start(fleet, simulated(60));
    let fleet = fleet.unwrap();
    fleet.run_until(at(15));
    apply(&fleet.handle(), "B actor period=10 startup=false").unwrap();
    assert!(fleet.handle().is_running("A").is_err());
    fleet.run_until(at(35));
    apply(&fleet.handle(), "A actor period=10 each=[time]").unwrap();
    assert!(fleet.handle().is_running("B").is_err());
    fleet.run_until(at(36));
    let done = apply(&fleet.handle(), "A actor period=4 each=[time]").unwrap();
    assert_eq!(done.replaced, [("A".to_owned(), Takeover::Began)]);
    let report = fleet.run_to_end();
    let times: Vec<_> = diary.lines().lines().filter_map(|line| Some(line.split_once("due ")?.1.to_owned())).collect();
    let expected = ["0.000", "0.010", "0.035", "0.039", "0.043", "0.047", "0.051", "0.055", "0.059"];
    assert_eq!(times, expected.map(|time| format!("{time} s")));
    assert_eq!(of(&report, "A").executions, 9);
    assert_eq!(report.components.len(), 2);
}

#[test]
fn a_fleet_becomes_nothing_and_something_again() {
    let (fleet, _) = start("A actor peer=B\nB callee", Settings::default());
    let fleet = fleet.unwrap();
    assert_eq!(apply(&fleet.handle(), "").unwrap().removed, ["A", "B"]);
    assert_eq!(apply(&fleet.handle(), "C callee\nA actor period=5").unwrap().added, ["C", "A"]);
    // However busy the machine is.
    while fleet.handle().progress().periods < 3 {
        fleet.run_until(fleet.handle().progress().time + Duration::from_millis(5));
    }
    fleet.handle().stop();
    assert!(of(&fleet.run_to_end(), "A").executions >= 3);
}

#[test]
fn a_component_whose_code_runs_is_waited_for_and_nothing_changes_when_it_does_not_return() {
    let (fleet, _) = start("A actor period=1s each=[sleep 1500]\nB actor period=5", Settings::default());
    let fleet = fleet.unwrap();
    fleet.run_until(at(50));
    let handle = fleet.handle();
    let why = "its code has not returned yet".to_owned();
    let expected = ChangeError::NotNow { component: "A".to_owned(), why };
    assert_eq!(apply(&handle, "B actor period=5"), Err(expected));
    assert!(handle.is_running("A").unwrap() && handle.is_running("B").unwrap());
    let long = "A actor period=1s each=[sleep 1500]\nB actor period=6";
    assert_eq!(apply(&handle, long).unwrap().replaced.len(), 1);
    handle.stop();
    assert_eq!(fleet.run_to_end().components.len(), 2);
    assert_eq!(apply(&handle, ""), Err(ChangeError::Ending));
}

#[test]
fn a_component_keeps_its_place_when_one_of_another_class_cannot_take_it() {
    let (fleet, _) = start("A actor period=10\nB actor period=10", simulated(30));
    let fleet = fleet.unwrap();
    fleet.run_until(at(15));
    let failed = apply(&fleet.handle(), "A callee first=[fail no room]\nB actor period=10").unwrap_err();
    assert_eq!(failed.to_string(), "component `A` of class `callee` could not start: no room");
    // It is found by its path.
    assert!(fleet.handle().is_running("A").unwrap());
    fleet.handle().unschedule("A").unwrap();
    let report = fleet.run_to_end();
    assert_eq!((of(&report, "A").executions, of(&report, "B").executions), (2, 3));
}

#[test]
fn one_that_did_not_run_does_not_start_in_the_middle_of_a_change() {
    let (fleet, diary) = start("A actor period=2 startup=false each=[log old]\nB actor period=2", real(60_000));
    let fleet = fleet.unwrap();
    let handle = fleet.handle();
    let wanted = "A actor period=2 startup=false each=[log new]\nB actor period=2\nX actor period=2 first=[sleep 300]";
    thread::scope(|scope| {
        let changed = scope.spawn(|| apply(&fleet.handle(), wanted));
        while handle.is_running("X").is_err() {
            thread::sleep(Duration::from_millis(1));
        }
        handle.schedule("A").unwrap();
        assert_eq!(changed.join().unwrap().unwrap().replaced, [("A".to_owned(), Takeover::Awaited)]);
    });
    while !diary.lines().contains("A: new") {
        thread::sleep(Duration::from_millis(1));
    }
    assert!(!diary.lines().contains("A: old"), "{}", diary.lines());
    handle.stop();
    fleet.run_to_end();
}
