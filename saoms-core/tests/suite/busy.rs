//! Components that call others whose code is running.

use std::time::Duration;

use saoms_core::schedule::Settings;

use crate::fault::faults;
use crate::fleet::{check, of, outcome, run, simulated, start, unindent};

/// Settings under which an execution of `component` at 10 ms takes this long.
fn slow(component: &str, milliseconds: u64, limit: u64) -> Settings {
    Settings { faults: faults(&[&format!("10 for {milliseconds}ms stall {component}")]), ..simulated(limit) }
}

fn check_slow(fleet: &str, settings: Settings, expected: &str) {
    let (report, diary) = run(fleet, settings);
    assert_eq!(format!("{}{}", diary.lines(), outcome(&report)), unindent(expected));
}

#[test]
fn an_execution_that_finds_its_provider_busy_is_skipped_and_its_events_come_again() {
    let fleet = "A actor period=10 peer=B subscribes=TALK each=[must-ask one; hear]
         B actor period=10
         C actor period=10 publishes=TALK each=[0: say a; 1: say b; 2: say c; 3: say d; 4: say e]";
    let expected = "[0.000 s] A: hears []
         [0.010 s] A: hears [a]
         [0.020 s] A: component `B`, which it calls, is busy: tries again in each period
         [0.040 s] A: hears [b]
         [0.050 s] A: hears [c, d, e]
         Elapsed after 0.06 s";
    check_slow(fleet, slow("B", 25, 60), expected);
    let (report, _) = run(fleet, slow("B", 25, 60));
    assert_eq!((of(&report, "A").busy, of(&report, "A").failures, of(&report, "A").messages.received), (2, 0, 5));
    assert_eq!((of(&report, "B").executions, of(&report, "B").missed), (5, 1));
}

#[test]
fn of_a_state_topic_the_newest_message_comes_after_the_skipped_executions() {
    check_slow(
        "A actor period=10 peer=B subscribes=TABLE each=[must-ask one; read]
         B actor period=10
         C actor period=10 publishes=TABLE each=[put 7 1; 2: put 7 2; 3: put 7 3]",
        slow("B", 25, 50),
        "[0.000 s] A: reads []
         [0.010 s] A: reads [7=1]
         [0.020 s] A: component `B`, which it calls, is busy: tries again in each period
         [0.040 s] A: reads [7=3]
         Elapsed after 0.05 s",
    );
}

#[test]
fn a_provider_that_waits_for_another_one_is_busy_for_its_caller() {
    check_slow(
        "A actor period=10 peer=B each=[must-ask one]
         B callee peer=C called=[must-ask two]
         C actor period=10",
        slow("C", 15, 40),
        "[0.020 s] A: component `C`, which it calls, is busy: tries again in each period
         Elapsed after 0.04 s",
    );
}

#[test]
fn a_start_that_finds_a_provider_busy_is_tried_again() {
    check_slow(
        "A actor period=10 startup=false peer=B first=[must-ask one] each=[log runs]
         B actor period=10
         C actor period=100 delay=15 task=A each=[schedule]",
        slow("B", 25, 50),
        "[0.015 s] A: component `B`, which it calls, is busy: tries again in each period
         [0.035 s] A: runs
         [0.045 s] A: runs
         Elapsed after 0.05 s",
    );
}

#[test]
fn a_shutdown_that_finds_a_provider_busy_is_tried_again() {
    check_slow(
        "A actor period=10 peer=B last=[must-ask goodbye; log gone]
         B actor period=10
         C actor period=100 delay=15 task=A each=[unschedule]",
        slow("B", 25, 50),
        "[0.015 s] A: component `B`, which it calls, is busy: tries again in each period
         [0.035 s] A: gone
         Elapsed after 0.05 s",
    );
}

#[test]
fn a_cycle_of_calls_is_a_failure_since_nobody_becomes_free() {
    check(
        "A actor peer=B each=[must-ask one]
         B callee peer=A called=[must-ask two]
         C actor",
        1,
        "[0.000 s] A: failed: component `A` is in the middle of an execution and cannot be called
         Failed after 0.001 s
         - component `A` failed: component `A` is in the middle of an execution and cannot be called",
    );
}

#[test]
fn who_is_asked_for_its_status_keeps_the_events_of_a_skipped_execution() {
    let fleet = "A actor period=10 peer=B subscribes=TALK each=[must-ask one; hear]
         B actor period=10
         C actor period=10 publishes=TALK each=[0: say a; 1: say b; 2: say c]";
    let (fleet, diary) = start(fleet, slow("B", 25, 60));
    let fleet = fleet.unwrap();
    let handle = fleet.handle();
    handle.pause().unwrap();
    let run = std::thread::spawn(move || fleet.run_to_end());
    let between = handle.step(Some(Duration::from_millis(25))).unwrap();
    while handle.progress().time != between {
        std::thread::yield_now();
    }
    handle.status();
    handle.resume().unwrap();
    run.join().unwrap();
    let heard = "[0.000 s] paused
         [0.000 s] A: hears []
         [0.010 s] A: hears [a]
         [0.020 s] A: component `B`, which it calls, is busy: tries again in each period
         [0.025 s] resumed
         [0.040 s] A: hears [b]
         [0.050 s] A: hears [c]";
    assert_eq!(diary.lines().trim_end(), unindent(heard).trim_end());
}
