use saoms_core::schedule::{RunningFleet, StartError};

use crate::fleet::{assembly, check, of, outcome, run, simulated, start, unindent};

/// Events of a fleet that does not start.
fn refused(fleet: &str) -> String {
    let (fleet, diary) = start(fleet, simulated(1000));
    let error = fleet.unwrap_err();
    format!("{}{error}", diary.lines())
}

#[test]
fn providers_initialize_before_those_that_call_them_and_end_after_them() {
    let (report, diary) = run(
        "A actor peer=B first=[log first; ask a] each=[done] last=[log last; ask z]
         B callee peer=C first=[log first; ask b] last=[log last] called=[ask deeper]
         C callee first=[log first] last=[log last]
         D actor first=[log first] last=[log last]",
        simulated(1000),
    );
    assert_eq!(
        unindent(&diary.all_lines()),
        unindent(
            "[0.000 s] C: first
             [0.000 s] B: first
             [0.000 s] B: is told \"b from C\"
             [0.000 s] A: first
             [0.000 s] B: is told \"deeper from C\"
             [0.000 s] A: is told \"a from B\"
             [0.000 s] D: first
             [0.000 s] A: started
             [0.000 s] B: started
             [0.000 s] C: started
             [0.000 s] D: started
             [0.000 s] D: last
             [0.000 s] D: has shut down
             [0.000 s] A: last
             [0.000 s] B: is told \"deeper from C\"
             [0.000 s] A: is told \"z from B\"
             [0.000 s] A: has shut down
             [0.000 s] B: last
             [0.000 s] B: has shut down
             [0.000 s] C: last
             [0.000 s] C: has shut down"
        )
    );
    assert_eq!(outcome(&report), "Done after 0 s");
}

#[test]
fn if_one_fails_those_before_it_shut_down_in_reverse_order_and_nothing_starts() {
    assert_eq!(
        refused(
            "A actor first=[log first] last=[log last] each=[log never]
             B callee first=[log first] last=[log last]
             C actor startup=false first=[log never]
             D actor first=[log first; fail no wheels] last=[log never]
             E actor first=[log never]"
        ),
        unindent(
            "[0.000 s] A: first
             [0.000 s] B: first
             [0.000 s] D: first
             [0.000 s] B: last
             [0.000 s] A: last
             component `D` of class `actor` could not start: no wheels"
        )
    );
}

#[test]
fn values_that_do_not_fit_together_and_panics_are_named() {
    assert!(
        refused("A actor\nB actor made=[too big]").ends_with("component `B` of class `actor` could not start: too big")
    );
    let panics = refused("A actor first=[panic lost a screw]");
    assert!(panics.contains("component `A` of class `actor` could not start: panicked at "), "{panics}");
    assert!(panics.ends_with(": lost a screw"), "{panics}");
}

#[test]
fn a_provider_that_panics_when_called_is_the_one_that_is_named() {
    let told = refused(
        "A actor peer=B first=[ask a] last=[log last]
         B callee called=[panic short circuit] last=[log never]",
    );
    assert!(told.contains("component `B` of class `callee` could not start: component `B` failed: panicked"), "{told}");
}

#[test]
fn a_failing_shutdown_during_take_back_is_told() {
    assert_eq!(
        refused("A actor last=[fail jammed]\nB actor first=[fail no wheels]"),
        unindent(
            "[0.000 s] A: failed: could not shut down: jammed
             component `B` of class `actor` could not start: no wheels"
        )
    );
}

#[test]
fn what_initialize_sends_leaves_when_all_have_initialized() {
    check(
        "A actor publishes=TALK first=[say a] subscribes=TALK each=[hear]
         B actor publishes=TALK subscribes=TALK each=[hear] peer=C first=[say b; ask hello]
         C callee publishes=TALK called=[say c] first=[say before]",
        1,
        "[0.000 s] B: is told \"hello from C\"
         [0.000 s] A: hears [a, b, before, c]
         [0.000 s] B: hears [a, b, before, c]
         Elapsed after 0.001 s",
    );
}

#[test]
fn what_was_sent_by_those_taken_back_reaches_nobody() {
    let (fleet, diary) = start(
        "A actor publishes=TALK subscribes=TALK first=[say a] last=[say b]\nB actor first=[fail no]",
        simulated(9),
    );
    assert!(matches!(fleet.unwrap_err(), StartError::Component { component, .. } if component == "B"));
    assert_eq!(diary.lines(), "");
}

#[test]
fn components_that_do_not_run_on_startup_wait() {
    let (report, diary) = run("A actor each=[log a]\nB actor startup=false first=[log never]", simulated(10));
    assert_eq!(diary.lines(), "[0.000 s] A: a\n");
    assert_eq!(of(&report, "B").executions, 0);
}

#[test]
fn a_fleet_of_thousands_starts_and_ends() {
    let fleet: String = (0..3000).map(|n| format!("A{n} actor period=10 publishes=OWN subscribes=TALK\n")).collect();
    let fleet = RunningFleet::start(assembly(&fleet), simulated(20), Vec::new()).unwrap();
    let report = fleet.run_to_end();
    assert_eq!(report.periods, 6000);
    assert!(report.components.iter().all(|component| component.executions == 2));
}
