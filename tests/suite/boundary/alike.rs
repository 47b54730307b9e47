//! The same misbehaviour linked in and loaded: the same end of the run, the same exit code, the same words.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::Fleet;
use serde_json::Value;

use super::build::library;
use super::run::{component, composite, property, second};

#[allow(dead_code, missing_docs, unreachable_pub, missing_debug_implementations, clippy::all, clippy::pedantic)]
#[path = "../../plugins/bad/src/lib.rs"]
mod linked;

/// The outcome of a run, in words that both ways have.
#[derive(Debug, Default, PartialEq)]
struct Told {
    code: i32,
    /// The reasons of the outcome; what was said where nothing ran.
    reasons: String,
    /// Of each component.
    components: Vec<String>,
    /// What `bad.Actor` reported.
    reported: Value,
    journal: Value,
    trace: Value,
}

/// Without the library, which only one of them has, and the folder of the source.
fn plain(text: &str) -> String {
    let text = text.replace(&format!(" (library `{}`)", library("bad").display()), "");
    let mut parts = text.split("panicked at ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        let part = part.split_once("bad/src/").map_or(part, |(_, rest)| rest);
        text + "panicked at " + part
    })
}

fn told(code: i32, report: &Value) -> Told {
    let component = |one: &Value| {
        let numbers = ["executions", "failures", "restarts", "messages"].map(|name| format!("{name} {}", one[name]));
        format!("{}: {}", one["name"], numbers.join(", "))
    };
    Told {
        code,
        reasons: plain(&report["outcome"]["reasons"].to_string()),
        components: report["components"].as_array().unwrap().iter().map(component).collect(),
        reported: report["bad"].clone(),
        journal: report["journal"].clone(),
        trace: report["trace_hash"].clone(),
    }
}

/// What is said where nothing ran, without a picture of the composite.
fn nothing_ran(code: i32, text: &str) -> Told {
    let line = text.lines().find(|line| line.starts_with("error")).unwrap_or(text);
    let line = line.strip_prefix("error: ").unwrap_or(line);
    Told { code, reasons: plain(line), components: Vec::new(), ..Told::default() }
}

fn when_linked(components: &str) -> (Told, String) {
    let fleet = Fleet::of_text(composite(components));
    if fleet.diagnostics().lines().any(|line| line.starts_with("error")) {
        return (nothing_ran(2, &fleet.shown()), fleet.shown());
    }
    match catch_unwind(AssertUnwindSafe(|| fleet.run(0, Duration::from_millis(950)))) {
        Ok(run) => {
            let code = match run.outcome.status {
                RunStatus::Done | RunStatus::Elapsed | RunStatus::Stopped => 0,
                _ => 1,
            };
            (told(code, &serde_json::to_value(&*run).unwrap()), run.log())
        }
        Err(payload) => {
            let text = payload.downcast_ref::<String>().unwrap();
            (nothing_ran(1, text), text.clone())
        }
    }
}

fn when_loaded(components: &str) -> (Told, String) {
    let run = second(components, &[library("bad")]);
    let code = run.code.unwrap();
    match run.report.is_null() {
        true => (nothing_ran(code, &run.text), run.text),
        false => (told(code, &run.report), run.text),
    }
}

/// What is expected of a component that misbehaves in one place in one way.
fn expected(at: &str, does: &str) -> i32 {
    match (at, does) {
        ("new", _) => 2,
        ("drop", _) | ("", _) => 0,
        _ => 1,
    }
}

#[test]
fn each_misbehaviour_has_the_same_end_linked_and_loaded() {
    let mut cases = Vec::new();
    let restart = property("restart", "onFailure") + &property("restartBackoff", "1ms");
    for does in ["panic", "nasty", "fail"] {
        let does_it = |at: &str| property("at", at) + &property("does", does);
        for at in ["", "new", "initialize", "execute", "receive", "shutdown", "drop"] {
            cases.push((expected(at, does), component("Bad", "bad.Actor", &does_it(at))));
        }
        let caller = component("Caller", "bad.Actor", "<reference name=\"callee\" target=\"Bad/callee\"/>");
        // An answer that is an error fails the caller, a panic both.
        cases.push((1, component("Bad", "bad.Actor", &does_it("serve")) + &caller));
        let again = caller.replace("</component>", &format!("{restart}</component>"));
        cases.push((0, component("Bad", "bad.Actor", &(does_it("serve") + &restart)) + &again));
        cases.push((0, component("Bad", "bad.Actor", &(does_it("execute") + &restart))));
        for at in ["new", "initialize", "monitor", "analyze", "plan", "execute", "shutdown", "drop"] {
            let inside = format!("<saoms:loop name=\"Switch\">{}</saoms:loop>", does_it(at));
            cases.push((expected(at, does), component("Bad", "bad.Lamp", &inside)));
        }
    }
    for does in ["fail at length", "fail with signs", "panic with signs", "fail without words"] {
        cases.push((1, component("Bad", "bad.Actor", &(property("at", "execute") + &property("does", does)))));
    }
    for (does, code) in
        [("capacity", 1), ("index", 1), ("resume", 1), ("catch", 0), ("share", 0), ("forget", 0), ("environment", 0)]
    {
        cases.push((code, component("Bad", "bad.Actor", &(property("at", "execute") + &property("does", does)))));
    }
    for does in ["panic", "nasty", "fail"] {
        for (at, code) in
            [("react", 1), ("stop", 1), ("heartbeat", i32::from(does != "fail")), ("save", 1), ("late", 1)]
        {
            let restart = if at == "save" { &*restart } else { "" };
            let trigger = if at == "react" { property("trigger", "WORDS") } else { String::new() };
            let inside = property("at", at) + &property("does", does) + restart + &trigger;
            cases.push((code, component("Bad", "bad.Motor", &inside)));
        }
    }
    for at in ["unschedule", "unsubscribe", "raise"] {
        cases.push((0, component("Bad", "bad.Motor", &property("at", at))));
    }
    cases.push((1, component("Bad", "bad.Actor", &property("at", "undeclared"))));
    // What a message does when it is dropped concerns nobody.
    cases.push((0, component("Bad", "bad.Actor", &property("at", "message"))));
    cases.push((0, component("Bad", "bad.Actor", &property("at", "numbers"))));
    // Two that call each other are refused.
    let one = component("Bad", "bad.Actor", "<reference name=\"callee\" target=\"Other/callee\"/>");
    let other = component("Other", "bad.Actor", "<reference name=\"callee\" target=\"Bad/callee\"/>");
    cases.push((2, one + &other));
    let mut faults = Vec::new();
    for (code, components) in cases {
        let ((linked, linked_text), (loaded, loaded_text)) = (when_linked(&components), when_loaded(&components));
        if linked != loaded || loaded.code != code {
            let told = format!("{components}\nlinked:\n{linked:?}\n{linked_text}\nloaded:\n{loaded:?}\n{loaded_text}");
            faults.push(format!("expected {code}: {told}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}
