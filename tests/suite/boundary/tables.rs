//! Libraries in C whose tables have holes, and code in C that gives null where it must not.

use super::build::{c_library, library};
use super::run::{Run, component, property, second};

/// A second of virtual time with an actor of a library that was built with these definitions.
fn run(definitions: &[&str], inside: &str) -> Run {
    let folder = tempfile::tempdir().unwrap();
    // Another one of the same library is no reason to say it twice.
    let components = component("Bad", "c.Actor", inside) + &component("Good", "c.Actor", "");
    second(&components, &[c_library(folder.path(), definitions)])
}

/// Nothing starts, with one message that names the library and says this.
fn assert_refused(run: &Run, expected: &[&str]) {
    assert_eq!(run.code, Some(2), "{}", run.text);
    let errors: Vec<&str> = run.text.lines().filter(|line| line.starts_with("error")).collect();
    assert_eq!(errors.len(), 1, "{}", run.text);
    assert!(!run.text.contains("describes its properties"), "{}", run.text);
    for expected in ["libactor.so` (actor) cannot be loaded: "].iter().chain(expected) {
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
}

#[test]
fn a_library_is_whole_without_what_may_be_null() {
    let run = run(&[], "");
    assert_eq!((run.code, &run.component("Bad")["messages"]["sent"]), (Some(0), &10.into()), "{}", run.text);
}

#[test]
fn a_null_function_is_refused_by_its_name() {
    for function in ["initialize", "execute", "shutdown", "serve", "destroy"] {
        let run = run(&[&format!("HOLES=.{function}=NULL")], "");
        let expected = format!("`{function}` in its `SaomsComponentTable` of class `c.Actor` is null: set it, ");
        assert_refused(&run, &[&expected, "a function that does nothing where there is nothing to do"]);
    }
    assert_refused(&run(&["CONSTRUCT=NULL"], ""), &["`construct` in its `SaomsClassTable` of class `c.Actor` is null"]);
    for function in ["effect", "entries", "initialize", "monitor", "adapt", "shutdown", "destroy"] {
        let run = run(&[&format!("LOOP_HOLES=.{function}=NULL")], "");
        assert_refused(&run, &[&format!("`{function}` in its `SaomsLoopTable` of loop `c.Step` is null: set it")]);
    }
}

#[test]
fn a_null_or_short_table_is_refused_by_its_name() {
    for (definition, expected) in [
        ("CLASS=NULL", "its `SaomsClassTable` of class `c.Actor` is null: set it in the tables"),
        ("CLASSES=NULL", "its list of `SaomsClassTable`s is null, expected 1 class"),
        ("COMPONENT=NULL", "`component` in its `SaomsClassTable` of class `c.Actor` is null"),
        ("LOOPING=NULL", "`looping` in its `SaomsLoopClassTable` of loop `c.Step` is null"),
        ("SIZE=12", "its `SaomsComponentTable` of class `c.Actor` has 12 bytes, expected at least "),
    ] {
        assert_refused(&run(&[definition], ""), &[expected]);
    }
}

#[test]
fn a_library_that_cannot_be_loaded_is_told_once_also_where_values_are_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let library = c_library(folder.path(), &["CLASS=NULL"]);
    let unknown = property("nothing", "1");
    let run = second(&(component("Bad", "c.Actor", &unknown) + &component("Worse", "c.Actor", &unknown)), &[library]);
    assert_eq!((run.code, run.text.matches("cannot be loaded").count()), (Some(2), 1), "{}", run.text);
    assert!(!run.text.contains("describes its properties"), "{}", run.text);
}

#[test]
fn a_function_that_nobody_has_is_missing_when_the_library_is_loaded() {
    // Called in an execution alone, and in none of this run.
    let run = run(&["UNBOUND"], "");
    assert_refused(&run, &["undefined symbol: turn_the_wheels: link it with the file that defines this"]);
}

#[test]
fn null_in_place_of_a_view_or_an_answer_is_a_failure() {
    for (does, code, expected) in [
        ("null finding", 2, "found null for a finding"),
        ("null topic", 1, "found null for a topic"),
        ("null index", 1, "found null for the place of the index"),
        ("null reference", 1, "found null for the place of the index"),
    ] {
        let run = run(&[], &property("does", does));
        assert_eq!(run.code, Some(code), "{does}: {}", run.text);
        assert!(run.text.contains(expected) && run.text.contains("Bad"), "{does}: {}", run.text);
    }
    let run = run(&[], &property("does", "null views"));
    assert_eq!(run.code, Some(0), "{}", run.text);
    for expected in
        ["null for the value", "null for the record", "null for the values", "null for a value of the entry"]
    {
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
}

#[test]
fn null_in_a_loop_is_a_failure_of_its_component() {
    let run = |definitions: &[&str], does: &str| {
        let folder = tempfile::tempdir().unwrap();
        let looping = format!("<saoms:loop name=\"Step\" class=\"c.Step\">{}</saoms:loop>", property("does", does));
        let remove = "<saoms:loop name=\"Switch\" remove=\"true\"/>";
        let components = component("Bad", "bad.Lamp", &format!("{remove}{looping}"));
        let libraries = [c_library(folder.path(), definitions), library("bad")];
        second(&components, &libraries)
    };
    for (definitions, does, expected) in [
        (&[][..], "null value", "found null for the value of an entry"),
        (&[], "null place", "nothing was got"),
        (&[], "null loop", "found null for the place of a loop"),
        (&["NULL_ENTRIES=0"], "", "found null for the table of functions of its entries"),
        (&["NULL_ENTRIES=1"], "", "`declaration` in its `SaomsEntriesFunctions` is null"),
    ] {
        let run = run(definitions, does);
        assert_eq!(run.code, Some(1), "{does}: {}", run.text);
        assert!(run.text.contains(expected) && run.text.contains("Bad"), "{does}: {}", run.text);
    }
    assert_eq!(run(&[], "").code, Some(0));
    let endless = run(&["LOOP_HOLES=.effect=effect_for_ever"], "");
    assert_eq!(endless.code, Some(2), "{}", endless.text);
    for expected in ["loop `Step`", "names more than 1000 entries that it changes"] {
        assert!(endless.text.contains(expected), "{expected} is missing in\n{}", endless.text);
    }
}

#[test]
fn a_record_has_the_id_that_it_was_given_or_its_text() {
    let run = run(&[], &property("does", "records"));
    let entries = run.report["journal"]["entries"].as_array().unwrap();
    let shown =
        |place: usize| [&entries[place]["record"], &entries[place]["text"]].map(|value| value.as_str().unwrap());
    assert_eq!(shown(0), ["piece_waits", "1 piece waits"], "{}", run.text);
    assert_eq!(shown(1), ["{n} {n:piece waits|pieces wait}", "1 piece waits"], "{}", run.text);
}

#[test]
fn a_motor_in_c_hears_heartbeats_is_stopped_and_released() {
    let run = run(&["STOPS=true"], "");
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert_eq!(run.text.matches("the motor hears: 100000000\n").count(), 20, "{}", run.text);
    assert_eq!(run.text.matches("the motor is released\n").count(), 2, "{}", run.text);
    let (stopped, released) = (run.text.find("the motor is stopped"), run.text.find("the motor is released"));
    assert!(stopped.is_some() && stopped < released, "{}", run.text);
}

#[test]
fn a_motor_in_c_that_cannot_be_stopped_or_is_null_is_told_by_name() {
    let run = |does| run(&["STOPS=true"], &property("does", does));
    let dead = run("dead line");
    assert_eq!(dead.code, Some(1), "{}", dead.text);
    assert!(dead.text.contains("component `Bad` could not stop its hardware: the line is dead"), "{}", dead.text);
    let heart = run("dead heart");
    assert_eq!(heart.code, Some(1), "{}", heart.text);
    let expected =
        "component `Bad` failed: the heartbeat of the hardware of component `Bad`: the heart is dead (library `";
    assert!(heart.text.contains(expected), "{}", heart.text);
    for does in ["null stop", "null motor"] {
        let null = run(does);
        let expected = "found null for the function that stops the hardware, expected ";
        assert!(null.code == Some(1) && null.text.contains(expected) && null.text.contains("Bad"), "{}", null.text);
    }
    let undeclared = self::run(&["STOPS=false"], "");
    assert!(undeclared.text.contains("does not declare that it stops hardware"), "{}", undeclared.text);
}

#[test]
fn an_actor_in_c_reacts_to_messages() {
    let run = |definitions: &[&str], inside: &str| run(&[&["REACTS=true"], definitions].concat(), inside);
    let trigger = property("trigger", "WORDS");
    let told = run(&[], &trigger);
    assert_eq!(told.code, Some(0), "{}", told.text);
    assert!(told.text.contains("reacts to 1 at 0\n"), "{}", told.text);
    let crash = run(&[], &(trigger + &property("at", "react") + &property("does", "segv")));
    assert!(crash.text.contains("crashed in `react`: SIGSEGV"), "{}", crash.text);
    let null = run(&["REACT=NULL"], "");
    let expected = "`react` in its `SaomsComponentTable` of class `c.Actor` is null, but its metadata say";
    assert_refused(&null, &[expected]);
    // Half a function is none.
    assert_refused(&run(&["SIZE=offsetof(SaomsComponentTable,react)+4"], ""), &[expected]);
}
