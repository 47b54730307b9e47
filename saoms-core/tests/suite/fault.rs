//! Faults that are put into a run on purpose.

use std::time::Duration;

use saoms_api::Time;
use saoms_api::event::fault::FaultCall;
use saoms_core::fault::TimedFault;
use saoms_core::report::RunReport;
use saoms_core::schedule::Settings;

use crate::fleet::{of, outcome, run, simulated, start, unindent};

const FLEET: &str = "A actor period=10 publishes=TALK each=[say a; number]
     B actor period=10 subscribes=TALK each=[hear]";

/// Faults from lines such as `10 lose 20 %`, with the millisecond at which they begin.
pub(crate) fn faults(lines: &[&str]) -> Vec<TimedFault> {
    let fault = |line: &&str| {
        let (at, call) = line.split_once(' ').unwrap();
        let at = Time::from_nanos(at.parse::<u64>().unwrap() * 1_000_000);
        TimedFault::new(at, FaultCall::read(call).unwrap())
    };
    lines.iter().map(fault).collect()
}

/// The report of a run for so many milliseconds, and what each component logged.
fn under(fleet: &str, lines: &[&str], milliseconds: u64) -> (RunReport, String) {
    let (report, diary) = run(fleet, Settings { faults: faults(lines), ..simulated(milliseconds) });
    (report, diary.lines())
}

/// What `B` hears in each execution.
fn heard_of(fleet: &str, lines: &[&str], verb: &str) -> String {
    let (_, told) = under(fleet, lines, 40);
    let of_b = told.lines().filter_map(|line| Some(line.split_once(&format!(" B: {verb} "))?.1.to_owned()));
    of_b.collect::<Vec<_>>().join(" ")
}

fn heard(lines: &[&str]) -> String {
    heard_of(FLEET, lines, "hears")
}

#[test]
fn messages_are_lost_late_or_doubled_in_their_time() {
    assert_eq!(heard(&[]), "[a] [a] [a] [a]");
    assert_eq!(heard(&["10 for 10ms violate 100 %"]), "[a] [] [a] [a]");
    assert_eq!(heard(&["10 for 10ms delay 5ms"]), "[a] [] [a, a] [a]");
    assert_eq!(heard(&["10 for 10ms delay 15ms"]), "[a] [] [] [a, a, a]", "those behind it stay behind it");
    assert_eq!(heard(&["10 for 10ms duplicate 100 %"]), "[a] [a, a] [a] [a]");
    assert_eq!(heard(&["10 for 10ms lose 100 %"]), "[a] [] [] [a, a, a]", "a lost event is sent again");
    assert_eq!(heard(&["0 cut A from B"]), "[a] [a] [a] [a]");
    assert_eq!(heard(&["0 for 25ms cut B from A"]), "[] [] [] [a, a, a, a]");
}

#[test]
fn of_a_state_topic_the_older_value_stays_and_late_readers_get_what_is_retained() {
    let fleet = "A actor period=10 publishes=TABLE each=[put 1 0; 1: put 1 1; 2: put 1 2; 3: put 1 3]
         B actor period=10 subscribes=TABLE each=[read]
         C actor period=10 startup=false subscribes=TABLE each=[read]
         D actor period=10 delay=15 task=C each=[0: schedule]";
    assert_eq!(heard_of(fleet, &[], "reads"), "[1=0] [1=1] [1=2] [1=3]");
    assert_eq!(heard_of(fleet, &["10 for 15ms lose 100 % on TABLE to B"], "reads"), "[1=0] [] [] [1=3]");
    let (_, told) = under(fleet, &["10 for 15ms lose 100 %"], 40);
    assert!(told.contains("[0.015 s] C: reads [1=1]"), "what is retained takes no way: {told}");
}

#[test]
fn a_value_that_was_not_read_is_not_lost_with_a_later_one() {
    let fleet = "A actor period=5 publishes=TABLE each=[0: put 1 0; 1: put 1 1; 2: put 1 2; 3: put 1 3]
         B actor period=10 delay=8 subscribes=TABLE each=[read]";
    assert_eq!(heard_of(fleet, &["5 for 5ms lose 100 %"], "reads"), "[1=0] [1=3] [] []");
}

#[test]
fn links_are_chosen_by_sender_reader_and_topic_and_nobody_loses_its_own_words() {
    let fleet = "A actor period=10 publishes=TALK subscribes=TALK each=[say a; hear]
         B actor period=10 publishes=TALK subscribes=TALK each=[say b; hear]
         C actor period=10 subscribes=TALK each=[hear]";
    let all = "[0.000 s] A: hears []
         [0.000 s] B: hears [a]
         [0.000 s] C: hears [a, b]
         [0.010 s] A: hears [a, b]";
    let cut = "[0.000 s] A: hears []
         [0.000 s] B: hears []
         [0.000 s] C: hears [b]
         [0.010 s] A: hears [a, b]";
    let none = "[0.000 s] A: hears []
         [0.000 s] B: hears []
         [0.000 s] C: hears []
         [0.010 s] A: hears [a]";
    let one = "[0.000 s] A: hears []
         [0.000 s] B: hears [a]
         [0.000 s] C: hears [b]
         [0.010 s] A: hears [a, b]";
    for (fault, expected) in [
        ("0 violate 100 % on TABLE", all),
        ("0 violate 100 % from A", cut),
        ("0 violate 100 % on T*K from A, C", cut),
        ("0 violate 100 %", none),
        ("0 violate 100 % from A to C", one),
        ("0 cut C from A", one),
        ("0 part A from C", one),
    ] {
        let (_, told) = under(fleet, &[fault], 11);
        let first: Vec<&str> = told.lines().take(4).collect();
        assert_eq!(first.join("\n"), unindent(expected), "{fault}");
    }
}

#[test]
fn a_reaction_comes_when_its_message_does() {
    let fleet = "A actor period=100 publishes=TALK each=[say a]
         B actor period=100 delay=50 trigger=TALK subscribes=TALK reacts=[hear]";
    let (_, told) = under(fleet, &["0 delay 7ms"], 90);
    assert_eq!(told, "[0.007 s] B: hears [a]\n");
}

#[test]
fn a_run_does_not_end_before_a_late_message_is_read() {
    let fleet = "A actor period=10 publishes=TALK each=[0: say a; done]
         B actor period=10 subscribes=TALK each=[hear]";
    let (report, told) = under(fleet, &["0 delay 70ms"], 1000);
    assert!(told.contains("[0.070 s] B: hears [a]"), "{told}");
    assert_eq!(outcome(&report), "Done after 0.1 s");
}

#[test]
fn faults_are_counted_by_their_kind() {
    let lines = ["0 for 25ms lose 100 %", "0 delay 1ms", "5 for 1ms stall B", "30 crash A"];
    let (report, _) = under(FLEET, &lines, 100);
    let applied = &report.sections["faults"]["applied"];
    assert_eq!(applied.to_string(), r#"{"crash":1,"delay":3,"lose":3,"stall":1}"#);
    assert!(!run(FLEET, simulated(100)).0.sections.contains_key("faults"));
}

#[test]
fn components_fail_and_are_handled_as_ever() {
    let fleet = FLEET.replace("publishes", "restart=20/3 publishes");
    let (report, told) = under(&fleet, &["5 fail A, B"], 40);
    let failed = "[0.010 s] A: failed and is restarted in 20ms: this execution fails by fault injection\n";
    assert!(told.contains(failed), "{told}");
    assert!(told.contains("[0.030 s] A: restarted (1)\n"), "{told}");
    assert!(told.contains("[0.010 s] B: failed: this execution fails by fault injection\n"), "{told}");
    assert_eq!((of(&report, "A").failures, of(&report, "B").failures), (1, 1));
    assert!(outcome(&report).starts_with("Failed"), "{}", outcome(&report));
}

#[test]
fn a_crash_has_a_restart_of_its_own_and_is_no_failure_of_the_run() {
    let fleet = FLEET.replace("publishes", "restart=1/9 publishes");
    let (report, told) = under(&fleet, &["5 crash B restart 15ms", "25 crash A"], 60);
    assert!(told.contains("[0.010 s] B: failed and is restarted in 15ms: it crashes by fault injection\n"), "{told}");
    assert!(told.contains("[0.025 s] B: restarted (1)\n"), "{told}");
    assert!(told.contains("[0.030 s] A: failed: it crashes by fault injection\n"), "{told}");
    assert_eq!((of(&report, "A").executions, outcome(&report).as_str()), (4, "Elapsed after 0.06 s"));
}

#[test]
fn a_clock_that_is_too_fast_has_shorter_periods_for_a_time() {
    let executions = |fault: &[&str]| of(&under("A actor period=10\nB actor period=10", fault, 1000).0, "A").executions;
    assert_eq!(executions(&[]), 100);
    assert_eq!(executions(&["0 drift A 25 %"]), 125);
    assert_eq!(executions(&["0 for 500ms drift A -50 %"]), 75);
}

#[test]
fn a_component_that_stalls_runs_apart() {
    let settings = Settings {
        faults: faults(&["5 for 30ms stall A"]),
        limit: Some(Duration::from_millis(80)),
        ..Settings::default()
    };
    let (report, _) = run("A actor period=10\nB actor period=10", settings);
    assert!(outcome(&report).starts_with("Elapsed"), "{}", outcome(&report));
    assert!(of(&report, "A").slow > 0 && of(&report, "A").missed > 0);
}

#[test]
fn in_real_time_a_message_is_late_too() {
    let fleet = "A actor period=5 publishes=TALK each=[0: say a; 1: say b]
         B actor period=1s delay=900 trigger=TALK subscribes=TALK reacts=[hear]";
    let settings =
        Settings { faults: faults(&["0 delay 20ms"]), limit: Some(Duration::from_millis(400)), ..Settings::default() };
    let (report, diary) = run(fleet, settings);
    let told = diary.lines();
    assert!(told.contains("B: hears [a") && told.contains("b]"), "{told}");
    assert_eq!(report.sections["faults"]["applied"].to_string(), r#"{"delay":2}"#);
}

#[test]
fn the_same_seed_has_the_same_faults() {
    let fleet = "A actor period=10 publishes=[TALK TABLE] each=[say-random; put 1 2]
         B actor period=7 subscribes=[TALK TABLE] each=[hear-from; read]
         C actor period=9 subscribes=[TALK TABLE] each=[hear-from; read]";
    let lines =
        ["0 lose 30 %", "0 delay 1ms to 30ms", "10 duplicate 20 %", "20 reorder 20 % by 15ms", "50 drift B 3 %"];
    let told = |seed| {
        let settings =
            Settings { faults: faults(&lines), limit: Some(Duration::from_millis(400)), ..Settings::simulated(seed) };
        let (report, diary) = run(fleet, settings);
        (report.trace_hash.unwrap(), diary.lines(), report.sections["faults"].to_string())
    };
    assert_eq!(told(1), told(1));
    assert_ne!(told(1).1, told(2).1);
}

#[test]
fn a_fault_comes_to_a_running_fleet_unless_it_names_what_is_not_there() {
    let (fleet, diary) = start(FLEET, simulated(40));
    let fleet = fleet.unwrap();
    fleet.run_until(Time::from_nanos(10_000_000));
    let disturb = |line: &str| {
        let call = FaultCall::read(line).unwrap();
        fleet.handle().disturb("", &call, None, line.to_owned()).map_err(|error| error.to_string())
    };
    assert_eq!(disturb("for 10ms violate 100 % to B"), Ok(()));
    assert_eq!(disturb("cut B from AA"), Err("the fleet has no component `AA`; did you mean `A`?".to_owned()));
    let topic = "the fleet has no topic `TALKS`; did you mean `TALK`?";
    assert_eq!(disturb("lose 1 % on TALKS"), Err(topic.to_owned()));
    fleet.run_to_end();
    assert!(diary.lines().contains("[0.010 s] B: hears []"), "{}", diary.lines());
}
