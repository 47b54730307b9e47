use std::time::Duration;

use saoms_core::observe::Occurrence;

use crate::fleet::{check, of, outcome, run, simulated};

#[test]
fn an_error_stops_the_component_and_fails_the_run_and_the_others_go_on() {
    check(
        "A actor period=10 each=[1: fail out of paper] last=[log never]
         B actor period=10 each=[2+: log b]",
        40,
        "[0.010 s] A: failed: out of paper
         [0.020 s] B: b
         [0.030 s] B: b
         Failed after 0.04 s
         - component `A` failed: out of paper",
    );
}

#[test]
fn a_panic_is_a_failure_with_its_place() {
    let (report, diary) = run("A actor period=10 each=[1: panic out of paper]\nB actor period=10", simulated(40));
    let told = diary.lines();
    assert!(told.starts_with("[0.010 s] A: failed: panicked at "), "{told}");
    assert!(told.contains("actor.rs:") && told.ends_with(": out of paper\n"), "{told}");
    assert!(outcome(&report).starts_with("Failed after 0.04 s\n- component `A` failed: panicked at "));
    assert_eq!((of(&report, "A").failures, of(&report, "A").executions), (1, 2));
    assert_eq!((of(&report, "B").failures, of(&report, "B").executions), (0, 4));
}

#[test]
fn messages_of_a_failed_execution_are_not_sent_and_that_is_said() {
    check(
        "A actor publishes=TALK each=[say one; say two; fail no]
         B actor subscribes=TALK each=[hear]",
        1,
        "[0.000 s] A: failed: no (messages of this execution that are not sent: 2)
         [0.000 s] B: hears []
         Failed after 0.001 s
         - component `A` failed: no (messages of this execution that are not sent: 2)",
    );
}

#[test]
fn a_failed_component_is_restarted_as_a_new_one_after_pauses_that_double() {
    check(
        "A actor period=10 delay=1 restart=20/3 first=[log born] each=[number; 1: fail again] last=[log never]
         B actor period=500",
        200,
        "[0.000 s] A: born
         [0.001 s] A: A 0 every 10ms
         [0.011 s] A: A 1 every 10ms
         [0.011 s] A: failed and is restarted in 20ms: again
         [0.031 s] A: born
         [0.031 s] A: restarted (1)
         [0.032 s] A: A 0 every 10ms
         [0.042 s] A: A 1 every 10ms
         [0.042 s] A: failed and is restarted in 40ms: again
         [0.082 s] A: born
         [0.082 s] A: restarted (2)
         [0.083 s] A: A 0 every 10ms
         [0.093 s] A: A 1 every 10ms
         [0.093 s] A: failed and is restarted in 80ms: again
         [0.173 s] A: born
         [0.173 s] A: restarted (3)
         [0.174 s] A: A 0 every 10ms
         [0.184 s] A: A 1 every 10ms
         [0.184 s] A: failed: again
         Failed after 0.2 s
         - component `A` failed: again",
    );
}

#[test]
fn a_restart_that_fails_counts_too() {
    let (report, diary) = run(
        "A actor period=10 publishes=TALK first=[say a] each=[fail once]  restart=10/2
         B actor period=1000 peer=A each=[0: log b]",
        simulated(100),
    );
    assert_eq!(of(&report, "A").restarts, 2);
    assert_eq!(of(&report, "A").failures, 3);
    assert_eq!(diary.count(|event| matches!(event.what, Occurrence::Restarted { .. })), 2);
    let pause = |event: &saoms_core::observe::RunEvent| match event.what {
        Occurrence::Failed { restart, .. } => restart,
        _ => None,
    };
    assert_eq!(diary.count(|event| pause(event) == Some(Duration::from_millis(20))), 1);
}

#[test]
fn a_restart_within_the_limit_does_not_fail_the_run() {
    let (report, _) = run("A actor period=10 restart=5/5 each=[2: fail once in a while]", simulated(100));
    assert_eq!(outcome(&report), "Elapsed after 0.1 s");
    assert_eq!(of(&report, "A").restarts, 3);
}

#[test]
fn events_that_come_while_a_component_is_restarted_wait_for_it() {
    check(
        "A actor period=10 publishes=[TALK TABLE] each=[say word; 0: put 1 1; 3: put 1 2]
         B actor period=10 restart=25/1 subscribes=[TALK TABLE] each=[hear; read; 1: fail once]",
        60,
        "[0.000 s] B: hears [word]
         [0.000 s] B: reads [1=1]
         [0.010 s] B: hears [word]
         [0.010 s] B: reads []
         [0.010 s] B: failed and is restarted in 25ms: once
         [0.035 s] B: restarted (1)
         [0.035 s] B: hears [word, word]
         [0.035 s] B: reads [1=2]
         [0.045 s] B: hears [word]
         [0.045 s] B: reads []
         [0.045 s] B: failed: once
         Failed after 0.06 s
         - component `B` failed: once",
    );
}

#[test]
fn a_new_instance_has_other_chances() {
    let (_, diary) = run("A actor period=10 restart=5/5 each=[random; fail again]\nB actor", simulated(40));
    let numbers: Vec<String> =
        diary.lines().lines().filter_map(|line| Some(line.split_once("chance ")?.1.to_owned())).collect();
    assert!(numbers.len() > 2, "{numbers:?}");
    assert!(numbers.windows(2).all(|pair| pair[0] != pair[1]), "{numbers:?}");
}

#[test]
fn a_failing_shutdown_fails_the_run() {
    check(
        "A actor last=[fail jammed]\nB actor last=[log b]",
        1,
        "[0.001 s] B: b
         [0.001 s] A: failed: could not shut down: jammed
         Failed after 0.001 s
         - component `A` failed: could not shut down: jammed",
    );
}

#[test]
fn when_nobody_is_left_the_run_ends() {
    check(
        "A actor period=10 each=[3: fail a]
         B actor period=10 each=[5: fail b]
         C actor startup=false",
        1000,
        "[0.030 s] A: failed: a
         [0.050 s] B: failed: b
         Failed after 0.05 s
         - component `A` failed: a
         - component `B` failed: b",
    );
}

#[test]
fn when_who_decides_about_the_end_is_gone_the_run_ends() {
    check(
        "World actor period=10 each=[0: open; 2: fail earthquake]
         A actor period=10",
        1000,
        "[0.020 s] World: failed: earthquake
         Failed after 0.02 s
         - component `World` failed: earthquake
         - component `World` ended before it reported that its work is done",
    );
}

#[test]
fn another_voter_may_still_end_the_run() {
    check(
        "A actor period=10 each=[0: open; 2: fail no]
         B actor period=10 each=[0: open; 4: done]",
        1000,
        "[0.020 s] A: failed: no
         Failed after 0.04 s
         - component `A` failed: no",
    );
}
