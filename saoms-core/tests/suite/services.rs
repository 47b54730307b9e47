use crate::fleet::{check, of, run, simulated};

#[test]
fn a_call_runs_at_once_in_the_provider_and_what_it_sends_leaves_before_the_callers_messages() {
    check(
        "A actor peer=B publishes=TALK each=[say before; ask one; say after]
         B actor startup=true delay=1s publishes=TALK called=[time; log serving; say inside]
         C actor subscribes=TALK each=[hear]",
        1,
        "[0.000 s] B: now 0.000 s due 0.000 s
         [0.000 s] B: serving
         [0.000 s] A: is told \"one from B\"
         [0.000 s] C: hears [inside, before, after]
         Elapsed after 0.001 s",
    );
}

#[test]
fn passive_components_are_called_too() {
    check(
        "A actor period=10 peer=B each=[ask one]
         B callee called=[time]",
        20,
        "[0.000 s] B: now 0.000 s due 0.000 s
         [0.000 s] A: is told \"one from B\"
         [0.010 s] B: now 0.010 s due 0.010 s
         [0.010 s] A: is told \"one from B\"
         Elapsed after 0.02 s",
    );
}

#[test]
fn a_cycle_of_calls_is_told_who_is_busy() {
    check(
        "A actor peer=B each=[ask one] called=[log never]
         B callee peer=C called=[ask two]
         C callee peer=A called=[ask three]",
        1,
        "[0.000 s] C: is told nothing: component `A` is in the middle of an execution and cannot be called
         [0.000 s] B: is told \"two from C\"
         [0.000 s] A: is told \"one from B\"
         Elapsed after 0.001 s",
    );
    check(
        "A actor peer=A each=[ask myself]",
        1,
        "[0.000 s] A: is told nothing: component `A` is in the middle of an execution and cannot be called
         Elapsed after 0.001 s",
    );
}

#[test]
fn who_does_not_run_cannot_be_called() {
    check(
        "A actor period=10 peer=B each=[ask one]
         B actor period=10 startup=false
         C actor period=10 task=B each=[0: schedule; 1: unschedule]",
        30,
        "[0.000 s] A: is told nothing: component `B` is not running
         [0.010 s] A: is told \"one from B\"
         [0.020 s] A: is told nothing: component `B` is not running
         Elapsed after 0.03 s",
    );
}

#[test]
fn a_reference_without_a_target_is_an_error_when_called_only() {
    check(
        "A actor each=[wired; ask one; schedule; running]
         B callee first=[wired] peer=A",
        1,
        "[0.000 s] B: wired true
         [0.000 s] A: wired false
         [0.000 s] A: is told nothing: reference `peer` is not wired: give it a target in the composite, or do not call it
         [0.000 s] A: cannot: reference `task` is not wired: give it a target in the composite, or do not call it
         [0.000 s] A: cannot: reference `task` is not wired: give it a target in the composite, or do not call it
         Elapsed after 0.001 s",
    );
}

#[test]
fn an_error_of_the_provider_is_an_answer_and_no_failure_of_it() {
    check(
        "A actor period=10 peer=B each=[ask one]
         B callee publishes=TALK called=[say lost; fail no paper] last=[log still here]",
        15,
        "[0.000 s] A: is told nothing: component `B` could not serve the call: no paper
         [0.010 s] A: is told nothing: component `B` could not serve the call: no paper
         [0.015 s] B: still here
         Elapsed after 0.015 s",
    );
}

#[test]
fn a_panic_of_the_provider_is_its_failure_and_an_answer_for_the_caller() {
    let fleet = "A actor period=10 peer=B each=[ask one]
                 B actor period=10 delay=5 restart=12/3 called=[panic short circuit] each=[log b]";
    let (report, diary) = run(fleet, simulated(30));
    let told: Vec<String> =
        diary.lines().lines().map(|line| line.split(" panicked").next().unwrap().to_owned()).collect();
    assert_eq!(
        told,
        [
            "[0.000 s] B: failed and is restarted in 12ms:",
            "[0.000 s] A: is told nothing: component `B` could not serve the call:",
            "[0.010 s] A: is told nothing: component `B` is not running",
            "[0.012 s] B: restarted (1)",
            "[0.017 s] B: b",
            "[0.020 s] B: failed and is restarted in 24ms:",
            "[0.020 s] A: is told nothing: component `B` could not serve the call:",
        ]
    );
    assert_eq!((of(&report, "B").failures, of(&report, "B").restarts), (2, 2));
    assert_eq!(of(&report, "A").failures, 0);
}

#[test]
fn an_unanswered_call_may_be_the_callers_failure() {
    check(
        "A actor peer=B each=[must-ask one]
         B callee called=[fail no paper]
         C actor",
        1,
        "[0.000 s] A: failed: component `B` could not serve the call: no paper
         Failed after 0.001 s
         - component `A` failed: component `B` could not serve the call: no paper",
    );
}

#[test]
fn a_chain_of_calls_has_an_end() {
    let callee = |place: usize| format!("C{place} callee peer=C{} called=[must-ask {place}]", place + 1);
    let chain = |length: usize| {
        let callees: Vec<_> = (1..length).map(callee).collect();
        let fleet = format!("A actor peer=C1 each=[ask one]\n{}\nC{length} callee", callees.join("\n"));
        run(&fleet, simulated(1)).1.lines()
    };
    assert!(chain(64).ends_with("A: is told \"one from C1\"\n"), "{}", chain(64));
    let told = chain(65);
    assert!(
        told.contains("component `C65` could not serve the call: it is the end of a chain of more than 64 calls"),
        "{told}"
    );
}
