//! Code of libraries that ends the process: one line says whose, and the exit code is never 0.

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Output, Stdio};

use super::build::{c_library, library};
use super::run::{component, in_folder, property};
use crate::support::{PROGRAM, saoms_in, stderr, text};

/// A second of virtual time with an actor that does this there, without a core dump.
fn run(at: &str, does: &str) -> Output {
    let folder = in_folder(&component("Bad", "c.Actor", &(property("at", at) + &property("does", does))));
    let library = c_library(folder.path(), &[]);
    let line = format!(
        "ulimit -c 0; exec '{PROGRAM}' run t.composite --virtual --for 950ms --journal journal.jsonl --plugin '{}'",
        library.display()
    );
    Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap()
}

fn assert_told(output: &Output, does: &str, function: &str, expected: &str) {
    let text = text(output);
    let line = text.lines().find(|line| line.contains("of library `")).unwrap_or_else(|| panic!("{does}: {text}"));
    assert!(line.starts_with("error: component `Bad` of library `") && line.contains("libactor.so` "), "{line}");
    assert!(line.contains(function) && line.contains(expected), "{does} in {function}: {line}");
}

#[test]
fn a_crash_is_told_with_component_library_and_function() {
    for (does, signal, expected) in [
        ("segv", libc::SIGSEGV, "SIGSEGV: it accessed memory that is not its own"),
        ("overflow", libc::SIGSEGV, "SIGSEGV: its stack overflowed"),
        ("bus", libc::SIGBUS, "SIGBUS"),
        ("ill", libc::SIGILL, "SIGILL"),
        ("fpe", libc::SIGFPE, "SIGFPE"),
        ("abort", libc::SIGABRT, "SIGABRT: it called `abort`, or threw an exception that nobody caught"),
    ] {
        let output = run("execute", does);
        assert_told(&output, does, " crashed in `execute`: ", expected);
        assert_eq!(output.status.signal(), Some(signal), "{does}: {}", text(&output));
    }
    for (at, function) in [
        ("construct", "the constructor"),
        ("initialize", "`initialize`"),
        ("shutdown", "`shutdown`"),
        ("destroy", "the destructor"),
    ] {
        let output = run(at, "segv");
        assert_told(&output, at, function, "SIGSEGV");
        assert_eq!(output.status.signal(), Some(libc::SIGSEGV), "{}", text(&output));
    }
}

/// Nothing in the process can go on after that: it is no panic any more.
#[test]
fn a_panic_while_a_panic_unwinds_is_told_as_a_crash() {
    for (at, function) in [("new", "the constructor"), ("execute", "`execute`"), ("drop", "the destructor")] {
        let folder =
            in_folder(&component("Bad", "bad.Actor", &(property("at", at) + &property("does", "panic twice"))));
        let line = format!(
            "ulimit -c 0; exec '{PROGRAM}' run t.composite --virtual --for 950ms --plugin '{}'",
            library("bad").display()
        );
        let output = Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap();
        let line = text(&output);
        let line = line.lines().find(|line| line.starts_with("error: component `Bad` of library `"));
        let line = line.unwrap_or_else(|| panic!("{at}: {}", text(&output)));
        assert!(line.contains(function) && line.contains("SIGABRT: it called `abort`"), "{at}: {line}");
        assert_eq!(output.status.signal(), Some(libc::SIGABRT), "{at}: {}", text(&output));
    }
}

#[test]
fn an_exit_of_a_library_is_told_and_is_a_failure() {
    for (at, function) in [("construct", "the constructor"), ("execute", "`execute`"), ("shutdown", "`shutdown`")] {
        let output = run(at, "exit");
        assert_told(&output, at, " ended the whole process, by `exit` in ", function);
        assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    }
    let output = run("execute", "exit on a thread");
    assert!(text(&output).contains("libactor.so` ended the whole process, by `exit`"), "{}", text(&output));
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
}

#[test]
fn a_library_that_is_written_over_goes_on() {
    let folder = in_folder(&component("Good", "c.Actor", &property("does", "speak")).replace(">100<", ">5<"));
    let library = c_library(folder.path(), &[]);
    let mut run = Command::new(PROGRAM);
    run.args(["run", "t.composite", "--for", "1h", "--plugin"]).arg(&library).current_dir(folder.path());
    let mut child = run.stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("speaks")));
    // Its pages are those of the file, where it was loaded itself.
    fs::OpenOptions::new().write(true).truncate(true).open(&library).unwrap();
    assert_eq!(lines.by_ref().filter(|line| line.contains("speaks")).take(5).count(), 5);
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(i32::try_from(child.id()).unwrap(), libc::SIGTERM) }, 0);
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let left = fs::read_dir(folder.path()).unwrap().map(|one| one.unwrap().file_name()).collect::<Vec<_>>();
    assert_eq!(left.len(), 2, "the copy is gone: {left:?}");
}

#[test]
fn the_report_of_a_crash_is_rebuilt_from_the_journal() {
    let folder = in_folder(
        &(component("Bad", "c.Actor", &(property("at", "execute") + &property("does", "record, then abort")))),
    );
    let library = c_library(folder.path(), &[]);
    let mut run = Command::new(PROGRAM);
    run.args(["run", "t.composite", "--for", "1h", "--journal", "journal.jsonl", "--plugin"]).arg(&library);
    assert_eq!(run.current_dir(folder.path()).output().unwrap().status.signal(), Some(libc::SIGABRT));
    let output = saoms_in(folder.path(), &["report", "--from-journal", "journal.jsonl"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["journal"]["entries"][0]["text"], "it is hot", "{report:#}");
    assert_eq!(report["components"][0]["name"], "Bad");
}

#[test]
fn what_a_library_prints_is_in_no_report() {
    let folder = in_folder(&component("Good", "c.Actor", &(property("at", "execute") + &property("does", "print"))));
    let library = c_library(folder.path(), &[]);
    let library = library.to_str().unwrap();
    for report in ["-", "/dev/stdout"] {
        let run =
            ["run", "t.composite", "--virtual", "--for", "1s", "--quiet", "--report", report, "--plugin", library];
        let output = saoms_in(folder.path(), &run);
        let report: serde_json::Value =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", text(&output)));
        assert_eq!(report["outcome"]["status"], "elapsed");
        assert!(stderr(&output).contains("printed by a library\n"), "{}", text(&output));
    }
}
