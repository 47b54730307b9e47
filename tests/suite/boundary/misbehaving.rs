//! Components of plugins that do what they must not: the program and all other components continue, and the faults are
//! reported by name.

use std::path::PathBuf;

use saoms_api::Saved;
use saoms_api::host::PropertyValue;
use saoms_api::host::contain::contained;
use saoms_core::plugin::Plugin;
use saoms_lang::registry::Registry;

use super::build::library;
use super::run::{Run, component, fleet, property, second};

/// A component that does as it should.
fn honest() -> String {
    component("Honest", "good.Sender", "")
}

fn libraries() -> Vec<PathBuf> {
    ["good", "bad", "raw"].map(library).to_vec()
}

/// A second of virtual time with an honest component in front of these and one behind them, which both do all their
/// work.
fn beside_honest(components: &str) -> Run {
    let behind = component("Behind", "good.Reader", "");
    let run = second(&(honest() + components + &behind), &libraries());
    for name in ["Honest", "Behind"] {
        let (executions, failures) = (&run.component(name)["executions"], &run.component(name)["failures"]);
        assert_eq!((executions, failures), (&10.into(), &0.into()), "{name}\n{}", run.text);
    }
    assert_eq!(run.component("Behind")["messages"]["received"], 10, "{}", run.text);
    run
}

/// Asserts that the run failed because of component `Bad`.
fn assert_fails(run: &Run, expected: &[&str]) {
    assert_eq!((run.code, run.component("Bad")["failures"].as_u64()), (Some(1), Some(1)), "{}", run.text);
    for expected in ["Bad"].iter().chain(expected) {
        assert!(run.reasons().contains(expected), "{expected} is missing in {}\n{}", run.reasons(), run.text);
    }
}

fn acts(at: &str, does: &str) -> String {
    component("Bad", "bad.Actor", &(property("at", at) + &property("does", does)))
}

#[test]
fn a_failure_is_told_with_the_library() {
    let of_library = format!(" (library `{}`)", library("bad").display());
    for does in ["fail", "panic"] {
        for at in ["new", "initialize", "execute", "receive", "shutdown"] {
            let run = second(&(honest() + &acts(at, does)), &libraries());
            let line = run.text.lines().find(|line| line.contains("Bad") && line.contains(at));
            assert!(line.is_some_and(|line| line.ends_with(&of_library)), "{of_library} is missing in\n{}", run.text);
        }
        let inside = format!("<saoms:loop name=\"Switch\">{}</saoms:loop>", property("at", "plan"));
        let run = second(&(honest() + &component("Bad", "bad.Lamp", &inside)), &libraries());
        assert!(run.reasons().contains("loop `Switch`: ") && run.reasons().contains(&of_library), "{}", run.text);
        // A caller that passes on what its provider answers fails in its own code.
        let caller = component("Caller", "bad.Actor", "<reference name=\"callee\" target=\"Bad/callee\"/>");
        let run = second(&(honest() + &acts("serve", does) + &caller), &libraries());
        assert!(run.reasons().contains("Caller") && run.reasons().contains(&of_library), "{}", run.text);
    }
}

#[test]
fn a_panic_in_execute_receive_or_shutdown_is_a_failure_of_its_component() {
    for at in ["execute", "receive", "shutdown"] {
        for (does, expected) in [("panic", format!("no more of {at}")), ("nasty", "without a message".to_owned())] {
            assert_fails(&beside_honest(&acts(at, does)), &["panicked", &expected]);
        }
    }
}

#[test]
fn a_panic_in_a_constructor_or_initialize_starts_nothing() {
    for (at, code) in [("new", 2), ("initialize", 1)] {
        for does in ["panic", "nasty"] {
            let run = second(&(honest() + &acts(at, does)), &libraries());
            assert_eq!(run.code, Some(code), "{}", run.text);
            assert!(run.text.contains("panicked") && run.text.contains("Bad"), "{}", run.text);
            assert!(run.text.contains("nothing was started") || run.text.contains("nothing runs"), "{}", run.text);
        }
    }
}

#[test]
fn a_panic_while_it_is_dropped_does_no_harm() {
    for does in ["panic", "nasty"] {
        let run = beside_honest(&acts("drop", does));
        assert_eq!(run.code, Some(0), "{}", run.text);
        assert_eq!(run.component("Bad")["executions"], 10, "{}", run.text);
    }
}

#[test]
fn a_component_that_panics_is_restarted_as_the_composite_says() {
    let restart = property("restart", "onFailure") + &property("restartBackoff", "1ms");
    let run = beside_honest(&component("Bad", "bad.Actor", &(property("at", "execute") + &restart)));
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert_eq!(run.component("Bad")["failures"], run.component("Bad")["restarts"], "{}", run.text);
    assert!(run.component("Bad")["restarts"].as_u64() > Some(0), "{}", run.text);
}

#[test]
fn a_panic_in_a_service_fails_the_provider_and_its_caller_hears_of_it() {
    let callee = component("Bad", "bad.Actor", &property("at", "serve"));
    let caller = component("Caller", "bad.Actor", "<reference name=\"callee\" target=\"Bad/callee\"/>");
    let run = beside_honest(&(callee + &caller));
    assert_eq!(run.code, Some(1), "{}", run.text);
    assert!(run.reasons().contains("no more of serve"), "{}\n{}", run.reasons(), run.text);
    assert!(run.reasons().contains("Caller") && run.reasons().contains("Bad"), "{}", run.reasons());
}

#[test]
fn a_panic_that_no_call_contains_names_the_library() {
    let of_library = format!("of library `{}` panicked", library("bad").display());
    let run = beside_honest(&acts("execute", "thread panics"));
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert_eq!(run.text.matches(&format!("warning: a thread {of_library}\n")).count(), 1, "{}", run.text);
    let run = second(&acts("execute", "local of a thread"), &libraries());
    let expected = format!(
        "warning: library `{}` panicked in the destructor of a thread-local variable\n",
        library("bad").display()
    );
    assert!(run.text.contains(&expected), "{}", run.text);
    assert!(run.text.contains("` crashed in the destructor of a thread-local variable: SIGABRT"), "{}", run.text);
    assert_ne!(run.code, Some(0), "{}", run.text);
    // Of a thread of the program, which ends at the end of the run.
    let run = second(&acts("execute", "local"), &libraries());
    assert!(run.text.contains("` crashed in the destructor of a thread-local variable: SIGABRT"), "{}", run.text);
    assert_ne!(run.code, Some(0), "{}", run.text);
    // One that does not return is not waited for without end.
    let run = second(&acts("execute", "endless local"), &libraries());
    let expected = format!(
        "warning: library `{}` has not returned in the destructor of a thread-local variable\n",
        library("bad").display()
    );
    assert!(run.text.contains(&expected), "{}", run.text);
    // What a call contains is told by its failure alone.
    assert!(!beside_honest(&acts("execute", "panic")).text.contains(&of_library));
}

#[test]
fn a_panic_in_what_a_reload_calls_is_a_failure() {
    let mut registry = Registry::new();
    Plugin::open(&library("bad")).unwrap().register(&mut registry).unwrap();
    let made = |at: &str| {
        let values = [("at", at), ("does", "panic")];
        let values = values.map(|(name, value)| (name.into(), PropertyValue::from(value)));
        registry.get("bad.Actor").unwrap().construct(&values).unwrap()
    };
    let failure = contained(|| made("save").save().map(drop)).unwrap_err();
    assert!(failure.message().ends_with("no more of save"), "{failure}");
    let failure = contained(|| made("restore").restore(&Saved::default())).unwrap_err();
    assert!(failure.message().ends_with("no more of restore"), "{failure}");
}

#[test]
fn a_panic_in_any_phase_of_a_loop_is_a_failure_of_its_component() {
    let lamp = |at: &str| {
        let inside = format!("<saoms:loop name=\"Switch\">{}</saoms:loop>", property("at", at));
        component("Bad", "bad.Lamp", &inside)
    };
    for at in ["monitor", "analyze", "plan", "execute", "shutdown"] {
        assert_fails(&beside_honest(&lamp(at)), &["panicked", &format!("no more of {at}")]);
    }
    for (at, code) in [("new", 2), ("initialize", 1)] {
        let run = second(&(honest() + &lamp(at)), &libraries());
        assert_eq!(run.code, Some(code), "{}", run.text);
        assert!(run.text.contains(&format!("no more of {at}")), "{}", run.text);
    }
    let run = beside_honest(&lamp("drop"));
    assert_eq!(run.code, Some(0), "{}", run.text);
}

#[test]
fn a_topic_that_is_not_declared_is_refused() {
    let run = second(&(honest() + &acts("undeclared", "")), &libraries());
    assert_eq!(run.code, Some(1), "{}", run.text);
    assert!(run.text.contains("SECRETS") && run.text.contains("Bad"), "{}", run.text);
}

#[test]
fn a_component_that_blocks_holds_up_nobody_else() {
    let components = component("Quick", "good.Sender", "").replace(">100<", ">5<") + &acts("receive", "block");
    let run = fleet(&components, &libraries(), &["--for", "800ms"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert!(run.component("Bad")["slow"].as_u64() >= Some(1), "{}", run.report);
    assert!(run.component("Quick")["executions"].as_u64() > Some(20), "{}", run.report);
}

#[test]
fn a_component_that_never_returns_is_left_behind_and_named() {
    let components = component("Quick", "good.Sender", "").replace(">100<", ">5<") + &acts("receive", "never");
    let run = fleet(&components, &libraries(), &["--for", "400ms", "--grace", "100ms"]);
    assert_eq!(run.code, Some(1), "{}", run.text);
    assert!(run.reasons().contains("Bad"), "{}\n{}", run.reasons(), run.text);
    assert!(run.component("Quick")["executions"].as_u64() > Some(20), "{}", run.report);
}

#[test]
fn hardware_whose_stop_function_never_returns_is_told_with_the_library() {
    let motor = component("Bad", "bad.Motor", &(property("at", "stop") + &property("does", "never")));
    let run = fleet(&motor, &libraries(), &["--for", "200ms", "--grace", "100ms"]);
    let of_library = format!("has not returned (library `{}`)", library("bad").display());
    assert_eq!(run.code, Some(1), "{}", run.text);
    assert!(run.reasons().contains(&of_library), "{}\n{}", run.reasons(), run.text);
}

#[test]
fn hardware_that_is_stopped_since_code_hangs_is_told_with_the_library() {
    let motor = component("Bad", "bad.Motor", &(property("at", "late") + &property("does", "never")));
    let run = fleet(&motor, &libraries(), &["--for", "900ms", "--grace", "100ms"]);
    let line = run.text.lines().find(|line| line.contains("has not returned for "));
    let expected = format!(": its hardware is stopped (library `{}`)", library("bad").display());
    assert!(line.is_some_and(|line| line.ends_with(&expected)), "{expected} is missing in\n{}", run.text);
}

fn raw(does: &str) -> String {
    component("Bad", "raw.Actor", &property("does", does))
}

#[test]
fn wrong_bytes_and_lengths_are_failures() {
    let run = beside_honest(&raw(""));
    assert_eq!((run.code, &run.component("Bad")["messages"]["sent"]), (Some(0), &10.into()), "{}", run.text);
    for (does, expected) in [
        ("sends noise", "WORDS"),
        ("sends nothing", "WORDS"),
        ("sends too much", "expected at most 67108864"),
        ("sends nowhere", "publisher"),
        ("fails in bytes", "\u{fffd}\u{fffd}x"),
        ("fails at length", "failed without a message"),
        ("answers nonsense", "unknown status 77"),
    ] {
        assert_fails(&beside_honest(&raw(does)), &[expected]);
    }
    for (does, expected) in [("publishes bytes", "not UTF-8"), ("publishes a secret", "SECRETS")] {
        let run = second(&(honest() + &raw(does)), &libraries());
        assert_eq!(run.code, Some(1), "{}", run.text);
        assert!(run.text.contains("Bad") && run.text.contains(expected), "{}", run.text);
    }
}

#[test]
fn what_cannot_be_read_is_left_out_of_log_report_and_journal() {
    let run = beside_honest(&raw("says bytes"));
    assert_eq!(run.code, Some(0), "{}", run.text);
    for expected in [
        "a value for the report was left out: found values in values, more than 64 deep",
        "a count for the report was left out: found text that is not UTF-8",
        "a record was left out",
        "a changed entry was left out",
    ] {
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
}

#[test]
fn a_context_is_refused_to_other_threads_and_after_the_call() {
    let expected = "from another thread, after the call, or by code that it called: this was refused";
    assert_fails(&beside_honest(&raw("uses a thread")), &[expected]);
    let other = component("Other", "raw.Actor", &property("does", "uses what another kept"));
    let run = beside_honest(&(raw("keeps") + &other));
    assert_fails(&run, &[expected]);
    assert_eq!(run.component("Other")["failures"], 0, "{}", run.text);
    assert!(run.report.get("raw").is_none(), "a stray call counted: {}", run.report);
    assert!(!run.text.contains("from where it must not come"), "{}", run.text);
}

#[test]
fn a_provider_cannot_use_its_callers_context() {
    let provider = component("Provider", "raw.Actor", &property("does", "uses the caller's"));
    let caller = component(
        "Bad",
        "raw.Actor",
        &(property("does", "calls") + "<reference name=\"callee\" target=\"Provider/callee\"/>"),
    );
    let run = beside_honest(&(provider + &caller));
    assert_fails(&run, &["or by code that it called: this was refused"]);
    assert!(run.report.get("raw").is_none(), "a call of another's context counted: {}", run.report);
}

#[test]
fn wrong_replies_are_failures_of_the_call() {
    for (does, expected) in
        [("replies too much", "more than 67108864 bytes"), ("replies nonsense", "\u{fffd}\u{fffd}x")]
    {
        let provider = component("Provider", "raw.Actor", &property("does", does));
        let caller = component(
            "Bad",
            "raw.Actor",
            &(property("does", "calls") + "<reference name=\"callee\" target=\"Provider/callee\"/>"),
        );
        let run = beside_honest(&(provider + &caller));
        assert_eq!(run.code, Some(1), "{}", run.text);
        assert!(run.reasons().contains(expected), "{expected} is missing in {}", run.reasons());
    }
}
