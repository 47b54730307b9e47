//! Libraries that do to the process, or ask of the program, what they must not: all is told by name, and the program
//! ends as it would without them.

use std::io::{BufRead, BufReader};
use std::process::{Command, Output, Stdio};

use super::build::{c_library_of, library};
use super::run::{Run, component, in_folder, property, second};
use crate::support::{PROGRAM, command, text};

pub(super) fn bad(class: &str, does: &str, inside: &str) -> String {
    component("Bad", class, &(property("does", does) + inside))
}

/// A second of virtual time with a component that does this, and one that does as it should.
fn run(class: &str, does: &str) -> Run {
    run_with(&bad(class, does, ""), &[])
}

fn run_with(components: &str, definitions: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let library = c_library_of("hostile", folder.path(), definitions);
    second(&(components.to_owned() + &component("Good", "h.Actor", "")), &[library])
}

fn assert_goes_on(run: &Run, expected: &str) {
    assert_eq!((run.code, &run.component("Good")["executions"]), (Some(1), &10.into()), "{}", run.text);
    assert!(run.reasons().contains("Bad") && run.reasons().contains(expected), "{}\n{}", run.reasons(), run.text);
}

#[test]
fn what_is_asked_without_end_is_refused() {
    for (class, does, expected) in [
        ("h.Actor", "subscribes without end", "topic `WORDS`: a component can subscribe at most 1000 times"),
        ("h.Motor", "registers without end", "can register at most 1000 functions that stop its hardware"),
        ("h.Motor", "a short view", "the `SaomsStopView` has 36 bytes, expected at least 40"),
    ] {
        let run = run(class, does);
        assert_eq!(run.code, Some(1), "{}", run.text);
        assert!(run.text.contains("component `Bad`") && run.text.contains(expected), "{}", run.text);
    }
}

#[test]
fn what_is_written_without_end_in_one_execution_is_a_failure() {
    for does in ["records without end", "names loops without end", "logs without end"] {
        let expected = "writes more in one execution than 100000 records of the journal or 100000 lines of the log";
        assert_goes_on(&run("h.Actor", does), expected);
    }
}

#[test]
fn what_makes_no_sense_is_a_failure_of_its_component() {
    for (does, expected) in [
        ("keeps null", "found null for 10 bytes"),
        ("a region without a block", "topic `WORDS`: its messages have no block"),
        ("a region of nobody", "this subscription belongs to no topic"),
        ("calls", "reference `callee` is not wired"),
    ] {
        assert_goes_on(&run("h.Actor", does), expected);
    }
    let provider = component("Provider", "h.Actor", "");
    let caller = bad("h.Actor", "calls", "<reference name=\"callee\" target=\"Provider/callee\"/>");
    let run = run_with(&(provider + &caller), &[]);
    assert_goes_on(&run, "component `Provider` could not serve the call: serves nobody");
}

#[test]
fn keys_that_a_state_topic_cannot_keep_are_told_and_counted() {
    let run = run("h.Actor", "keys without end");
    assert_goes_on(&run, "has published 100000 keys on topic `SPOTS`, the maximum");
    let bad = run.component("Bad");
    assert_eq!((&bad["dropped"], &bad["messages"]["sent"]), (&500.into(), &100_500.into()), "{}", run.text);
    assert_eq!(run.text.matches("the maximum: messages with other keys are lost").count(), 2, "{}", run.text);
}

#[test]
fn a_key_is_that_of_the_message() {
    for (does, expected) in [
        ("a foreign key", "topic `SPOTS`: the key 9 is given for a message `Spotted` whose field `number` is 7"),
        ("a key of no message", "topic `WORDS`: the key 3 is given for a message `Word`, which has none"),
    ] {
        assert_goes_on(&run("h.Actor", does), expected);
    }
}

#[test]
fn a_path_of_the_report_is_not_deeper_than_a_value() {
    let run = run("h.Actor", "reports deep");
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert!(run.text.contains("was left out of the report: it is more than 64 parts deep"), "{}", run.text);
    assert!(run.text.contains("has reported"), "{}", run.text);
}

#[test]
fn a_region_may_move_often() {
    assert_eq!(run("h.Actor", "moves a region").code, Some(0));
}

#[test]
fn a_type_of_messages_that_contradicts_itself_is_refused() {
    for (definition, expected) in [
        ("PLACE=\"where\"", "the place of `Spotted` is `where`, which is not one of its fields"),
        (
            "PLACE=\"number\"",
            "the place of `Spotted` is `number`, which is not a message with two fields of type int32",
        ),
        ("PLACE=7", "invalid type: integer `7`, expected a string"),
        ("KEY=\"nobody\"", "the key of `Spotted` is `nobody`, which is not one of its fields"),
        ("KEY=\"spot\"", "the key of `Spotted` is `spot`, which is not a number"),
    ] {
        let run = run_with("", &[definition]);
        assert_eq!(run.code, Some(2), "{}", run.text);
        assert!(run.text.contains("class `h.Actor` is malformed: the schema of topic `SPOTS`: "), "{}", run.text);
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
}

#[test]
fn a_function_that_a_declaration_asks_for_is_there() {
    for (definition, expected) in [
        (
            "SAYS=\"saves\":true,",
            "`save` in its `SaomsComponentTable` of class `h.Motor` is null, but its metadata say",
        ),
        ("LIVE=true", "`update` in its `SaomsComponentTable` of class `h.Actor` is null, but its metadata say"),
        ("SAYS=\"saves\":7,", "`h.Motor` is malformed: invalid type: integer `7`, expected a boolean"),
        ("LIVE=\"yes\"", "`h.Actor` is malformed: invalid type: string \"yes\", expected a boolean"),
    ] {
        let run = run_with("", &[definition]);
        assert_eq!(run.code, Some(2), "{}", run.text);
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
}

#[test]
fn a_constructor_that_finds_something_refuses_also_if_it_says_that_it_made_a_component() {
    let run = run("h.Actor", "finds something and goes on");
    assert_eq!(run.code, Some(2), "{}", run.text);
    assert!(run.text.contains("component `Bad`") && run.text.contains("is not what a component does"), "{}", run.text);
    assert_eq!(run.text.matches("what found something is destroyed").count(), 1, "{}", run.text);
}

#[test]
fn findings_without_end_are_told_up_to_a_bound() {
    let run = run("h.Actor", "finds without end");
    assert_eq!(run.code, Some(2), "{}", run.text);
    assert!(run.text.contains("component `Bad`: found more than 10000 faults: the others"), "{}", run.text);
}

#[test]
fn texts_for_people_have_a_bound() {
    let failed = run("h.Actor", "fails at length");
    assert_goes_on(&failed, "x… (20000 more bytes)");
    let logged = run("h.Actor", "logs at length");
    assert!(logged.code == Some(0) && logged.text.contains("x… (20000 more bytes)"), "{}", logged.text);
    let missing = run("h.Actor", "logs what is not there");
    let expected = "warning: a line of the log was left out: found null for 10 bytes";
    assert!(missing.code == Some(0) && missing.text.contains(expected), "{}", missing.text);
    let reported = run("h.Actor", "reports at length");
    assert_eq!(reported.code, Some(0), "{}", reported.text);
    assert_eq!(reported.text.matches("xxx` and more were left out of the report").count(), 1, "{}", reported.text);
}

#[test]
fn a_topic_is_used_as_its_class_declares_it() {
    for (does, expected) in [
        ("another schema", "event messages `Word` with the schema {\"name\": \"Spotted\""),
        ("another kind", "state messages `Word` with the schema {\"name\": \"Word\""),
    ] {
        let bad = bad("h.Actor", does, "");
        let good = component("Before", "h.Actor", "");
        // As the first user of the topic, and as a later one.
        for run in [run("h.Actor", does), run_with(&(good.clone() + &bad), &[])] {
            assert_eq!(run.code, Some(1), "{}", run.text);
            assert!(
                run.text.contains("component `Bad` of class `h.Actor` could not start: topic `WORDS`"),
                "{}",
                run.text
            );
            assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
        }
    }
}

#[test]
fn a_component_that_is_busy_with_nobody_fails() {
    assert_goes_on(&run("h.Actor", "is busy with nobody"), "answered that a component is busy, but not which");
}

#[test]
fn what_a_failed_execution_counted_is_taken_back_however_much_it_was() {
    let restart = property("restart", "onFailure") + &property("restartBackoff", "1ms");
    let run = run_with(&bad("h.Saver", "counts down and fails", &restart), &[]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert_eq!(run.component("Good")["executions"], 10, "{}", run.text);
    assert!(run.component("Bad")["restarts"].as_u64() > Some(0), "{}", run.text);
}

#[test]
fn hardware_that_is_never_released_holds_up_no_end() {
    assert_goes_on(&run("h.Motor", "hangs in release"), "could not stop its hardware");
}

/// Each component that executes fails, also one of another library: the library is that of the hardware.
#[test]
fn a_heartbeat_that_fails_is_told_with_the_library_of_the_hardware() {
    let caller = component("Caller", "bad.Actor", "<reference name=\"callee\" target=\"Bad/callee\"/>");
    let folder = tempfile::tempdir().unwrap();
    let hostile = c_library_of("hostile", folder.path(), &["INTERFACE=\"bad.Callee\""]);
    let of_library = format!("the line is dead (library `{}`)", hostile.display());
    let run = second(&(caller + &bad("h.Motor", "fails to beat", "")), &[hostile, library("bad")]);
    assert_eq!(run.code, Some(1), "{}", run.text);
    for name in ["Caller", "Bad"] {
        let expected =
            format!("component `{name}` failed: the heartbeat of the hardware of component `Bad`: {of_library}");
        assert!(run.reasons().contains(&expected), "{expected} is missing in\n{}\n{}", run.reasons(), run.text);
    }
    assert!(!run.text.contains(&library("bad").display().to_string()), "{}", run.text);
}

#[test]
fn a_report_is_written_where_it_was_asked_for() {
    let run = run("h.Actor", "goes elsewhere");
    assert_eq!((run.code, &run.component("Bad")["executions"]), (Some(0), &10.into()), "{}", run.text);
}

/// The command in a process of its own, without a core dump.
pub(super) fn ended(does: &str) -> Output {
    ended_with(&bad("h.Actor", does, ""), &[])
}

/// The same with these components and definitions.
pub(super) fn ended_with(components: &str, definitions: &[&str]) -> Output {
    let folder = in_folder(components);
    let library = c_library_of("hostile", folder.path(), definitions);
    let line = format!(
        "ulimit -c 0; exec '{PROGRAM}' run t.composite --virtual --for 950ms --report r.json --plugin '{}'",
        library.display()
    );
    Command::new("timeout").args(["60", "sh", "-c", &line]).current_dir(folder.path()).output().unwrap()
}

#[test]
fn the_end_of_a_library_is_not_that_of_the_program() {
    for does in ["at the end exits", "at the end crashes", "at the end hangs"] {
        let output = ended(does);
        assert_eq!(output.status.code(), Some(1), "{does}: {}", text(&output));
        assert!(text(&output).contains("component `Bad` failed: fails before"), "{does}: {}", text(&output));
    }
}

#[test]
fn a_crash_on_a_thread_of_a_library_is_told_with_the_library() {
    let output = ended("crashes on a thread");
    let expected = "libhostile.so` crashed: SIGSEGV: it accessed memory that is not its own";
    assert!(text(&output).contains("error: a thread of library `"), "{}", text(&output));
    assert!(text(&output).contains(expected), "{}", text(&output));
    assert_ne!(output.status.code(), Some(0), "{}", text(&output));
    let output = ended("traps");
    assert!(text(&output).contains("component `Bad` of library `"), "{}", text(&output));
    assert!(text(&output).contains("crashed in `execute`: SIGTRAP"), "{}", text(&output));
}

#[test]
fn a_library_that_takes_signals_over_keeps_no_run_from_its_end() {
    let folder = in_folder(&bad("h.Actor", "takes signals", "").replace(">100<", ">5<"));
    let library = c_library_of("hostile", folder.path(), &[]);
    let mut command = command(&["run", "t.composite", "--for", "1h", "--plugin"]);
    command.arg(library).current_dir(folder.path()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("took over the signal SIGTERM")), "it ended without a word");
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(i32::try_from(child.id()).unwrap(), libc::SIGINT) }, 0);
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
