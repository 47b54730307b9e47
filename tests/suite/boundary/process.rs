//! What code of libraries does to the process that it runs in: it is told by name, and no exit code says that all went
//! well where it did not.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::process::Command;

use super::build::c_library_of;
use super::hostile::{bad, ended, ended_with};
use super::run::{component, in_folder, property};
use crate::support::{PROGRAM, command, stderr, stdout, text};

/// The beginning of what is told of component `Bad`.
fn assert_named(does: &str, expected: &str) -> std::process::Output {
    let output = ended(does);
    let told = stderr(&output);
    let line = told.lines().find(|line| line.contains("component `Bad` of library `") && line.contains(expected));
    assert!(line.is_some(), "{does}: {expected} is missing in\n{}", text(&output));
    output
}

#[test]
fn an_end_of_the_process_is_a_failure_by_whatever_function() {
    for by in ["_exit", "_Exit", "quick_exit", "daemon"] {
        for (at, function) in [("", "`execute`"), ("made: ", "the constructor"), ("begins: ", "`initialize`")] {
            let expected = format!("ended the whole process, by `{by}` in {function}");
            assert_eq!(assert_named(&format!("{at}{by}"), &expected).status.code(), Some(1));
        }
    }
    let output = assert_named("cancels its thread", "ended the whole process, by `pthread_cancel` in `execute`");
    assert_eq!(output.status.code(), Some(1));
    let output = assert_named("ends its thread", "ended the whole process, by `pthread_exit` in `execute`");
    assert_eq!(output.status.code(), Some(1));
}

/// Nothing calls that code any more when a thread of the program ends.
#[test]
fn what_a_library_does_at_the_end_of_a_thread_is_told() {
    let of_local = " in the destructor of a thread-local variable";
    for (does, before, expected, signal) in [
        ("local exits", "error: library `", format!("ended the whole process, by `exit`{of_local}"), None),
        ("local crashes", "error: library `", format!("crashed{of_local}: SIGSEGV"), Some(libc::SIGSEGV)),
        ("key exits", "error: code of library `", "ended the whole process, by `exit`\n".to_owned(), None),
        ("key crashes", "error: code of library `", "crashed: SIGSEGV".to_owned(), Some(libc::SIGSEGV)),
    ] {
        // The program waits for the function that stops hardware, so that it sees the end of its thread.
        let output = ended_with(&bad("h.Motor", &format!("hangs in stop, {does}"), ""), &[]);
        let told = stderr(&output);
        let is_told = told.contains(before) && told.contains(&format!("libhostile.so` {expected}"));
        assert!(is_told, "{does}: {expected} is missing in\n{}", text(&output));
        assert_eq!((output.status.signal(), output.status.code() == Some(1)), (signal, signal.is_none()), "{does}");
    }
}

/// A run whose library does this to the process while it is loaded.
fn loaded(definition: &str) -> std::process::Output {
    ended_with(&bad("h.Actor", "", ""), &[definition])
}

#[test]
fn what_a_library_does_while_it_is_loaded_is_told() {
    for at in ["LOADS", "ENTERS"] {
        let output = loaded(&format!("{at}=\"crashes\""));
        let expected = "libhostile.so` crashed while it was loaded: SIGSEGV";
        assert!(
            stderr(&output).contains("error: library `") && stderr(&output).contains(expected),
            "{}",
            text(&output)
        );
        assert_eq!(output.status.signal(), Some(libc::SIGSEGV), "{}", text(&output));
        for by in ["_exit", "quick_exit"] {
            let output = loaded(&format!("{at}=\"{by}\""));
            let expected = format!("libhostile.so` ended the whole process, by `{by}` while it was loaded");
            assert!(stderr(&output).contains(&expected), "{}", text(&output));
            assert_eq!(output.status.code(), Some(1), "{}", text(&output));
        }
        let output = loaded(&format!("{at}=\"prints\""));
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        assert!(stderr(&output).contains("printed by a library\n"), "{}", text(&output));
        assert!(!stdout(&output).contains("printed by a library"), "{}", text(&output));
    }
}

#[test]
fn a_child_that_returns_is_no_second_program() {
    let output = assert_named("fork", "forked the program in `execute`, and the child returned: it ends here");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    assert!(stderr(&output).contains("the child has ended with 1\n"), "{}", text(&output));
    assert_eq!(text(&output).matches("executions").count(), 1, "one summary: {}", text(&output));
    let output = ended("fork and exec");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    assert!(stderr(&output).contains("the child has ended with 7\n"), "{}", text(&output));
    assert!(!stderr(&output).contains("component `Bad` of library"), "{}", text(&output));
}

#[test]
fn a_signal_that_nobody_handles_is_told_and_ends_nothing() {
    for (does, signal) in [
        ("SIGUSR1", "SIGUSR1"),
        ("SIGQUIT", "SIGQUIT"),
        ("SIGTSTP", "SIGTSTP"),
        ("SIGXCPU", "SIGXCPU"),
        // The stack for signals has no room for all of them on top of each other.
        ("many signals", "SIGPROF"),
        ("SIGRTMAX", "SIGRTMIN or a later one"),
    ] {
        let output = assert_named(does, &format!("sent the signal {signal} in `execute`: it was ignored"));
        assert_eq!((output.status.signal(), output.status.code()), (None, Some(0)), "{}", text(&output));
    }
    for (does, expected) in [
        ("SIGUSR2 to all", "libhostile.so` sent the signal SIGUSR2: it was ignored"),
        ("alarm", "libhostile.so` let a timer or a limit send the signal SIGALRM: it was ignored"),
    ] {
        let output = ended(does);
        assert_eq!((output.status.signal(), output.status.code()), (None, Some(0)), "{}", text(&output));
        assert!(stderr(&output).contains("warning: code of library `"), "{}", text(&output));
        assert!(stderr(&output).contains(expected), "{expected} is missing in\n{}", text(&output));
    }
}

#[test]
fn a_library_that_ends_the_run_by_a_signal_is_told() {
    for (does, place) in [("SIGTERM", "`execute`"), ("made: SIGTERM", "the constructor")] {
        let output = assert_named(does, &format!("sent the signal SIGTERM in {place}: it ends the run"));
        assert_eq!(output.status.code(), Some(130), "{}", text(&output));
    }
    let output = ended("SIGINT to all");
    assert!(stderr(&output).contains("error: code of library `"), "{}", text(&output));
    assert!(stderr(&output).contains("sent the signal SIGINT: it ends the run"), "{}", text(&output));
    assert_eq!(output.status.code(), Some(130), "{}", text(&output));
}

#[test]
fn a_library_that_ends_a_check_by_a_signal_is_told() {
    let folder = in_folder(&bad("h.Actor", "made: SIGTERM", ""));
    let library = c_library_of("hostile", folder.path(), &[]);
    let composite = folder.path().join("t.composite");
    let output = command(&["check", "--plugin"]).arg(library).arg(composite).output().unwrap();
    let expected = "error: component `Bad` of library `";
    assert!(stderr(&output).contains(expected), "{}", text(&output));
    let expected = "sent the signal SIGTERM in the constructor: it ends the program";
    assert!(stderr(&output).contains(expected), "{}", text(&output));
    assert_eq!(output.status.signal(), Some(libc::SIGTERM), "{}", text(&output));
}

#[test]
fn files_that_are_written_have_the_modes_of_the_start() {
    let folder = in_folder(&bad("h.Actor", "made: forbids files", ""));
    let library = c_library_of("hostile", folder.path(), &[]);
    let line = format!(
        "umask 022; exec '{PROGRAM}' run t.composite --virtual --for 950ms --report r.json --journal j.jsonl --paths \
         p.svg --plugin '{}'",
        library.display()
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    for name in ["r.json", "j.jsonl", "p.svg"] {
        let mode = fs::metadata(folder.path().join(name)).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode, 0o644, "{name}: {mode:o}");
    }
}

/// As what some compilers link into libraries with `-ffast-math` does.
#[test]
fn the_rounding_of_numbers_that_a_library_changes_at_its_start_is_given_back_by_name() {
    for (does, place) in [("made: rounds up", "in the constructor"), ("begins: rounds up", "in `initialize`")] {
        let output =
            assert_named(does, &format!("changed how floating-point numbers are rounded or trapped {place}: it is"));
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        assert_eq!(stderr(&output).matches("component `Bad` of library").count(), 1, "once: {}", text(&output));
    }
    let output = loaded("LOADS=\"rounds up\"");
    let expected = "changed how floating-point numbers are rounded or trapped while it was loaded";
    assert!(stderr(&output).contains("warning: library `") && stderr(&output).contains(expected), "{}", text(&output));
}

#[test]
fn limits_that_a_library_lowers_are_given_back_by_name() {
    for (does, limits) in [
        ("limits memory", "RLIMIT_AS, RLIMIT_DATA"),
        ("limits descriptors", "RLIMIT_NOFILE"),
        ("limits files", "RLIMIT_FSIZE"),
    ] {
        for (at, place) in [("made: ", "the constructor"), ("begins: ", "`initialize`")] {
            let output = assert_named(&format!("{at}{does}"), &format!("lowered {limits} of the process in {place}:"));
            assert_eq!(output.status.code(), Some(0), "{}", text(&output));
            assert_eq!(stderr(&output).matches(limits).count(), 1, "once: {}", text(&output));
        }
    }
    // What is found out at the end of the run is given back before the report is written.
    for (does, limit) in [("limits descriptors", "RLIMIT_NOFILE"), ("limits files", "RLIMIT_FSIZE")] {
        let output = ended(does);
        assert!(
            stderr(&output).contains(&format!("libhostile.so` lowered {limit} of the process:")),
            "{}",
            text(&output)
        );
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    }
}

/// A library is never unloaded, also where it tries.
#[test]
fn a_library_that_closes_itself_goes_on() {
    let output = ended("closes itself");
    assert_eq!((output.status.signal(), output.status.code()), (None, Some(0)), "{}", text(&output));
}

#[test]
fn signals_that_a_library_takes_over_or_blocks_at_its_start_are_given_back_by_name() {
    for (does, expected) in [
        ("made: takes SIGINT", "took over the signal SIGINT in the constructor: it ends the run again"),
        ("begins: takes SIGINT", "took over the signal SIGINT in `initialize`: it ends the run again"),
        (
            "made: resets SIGSEGV",
            "took over the signal SIGSEGV in the constructor: crashes are reported with the name of the library again",
        ),
        ("made: resets SIGPIPE", "took over the signal SIGPIPE in the constructor: it is ignored again"),
        (
            "made: ignores SIGCHLD",
            "took over the signal SIGCHLD in the constructor: the ends of commands are heard again",
        ),
        (
            "made: takes SIGSEGV",
            "took over the signal SIGSEGV in the constructor: a crash may not be reported with the name of the library",
        ),
        ("made: blocks signals", "blocked the signals SIGINT, SIGTERM, SIGHUP, SIGSEGV"),
    ] {
        let output = assert_named(does, expected);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        assert_eq!(stderr(&output).matches("component `Bad` of library").count(), 1, "once: {}", text(&output));
    }
}

#[test]
fn closed_descriptors_are_told_on_what_is_left() {
    for does in ["closes 1", "closes 2"] {
        let output = ended(does);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        assert!(text(&output).contains("executions"), "the summary is there: {}", text(&output));
    }
    assert_named("begins: closes others", "closed descriptors of the program in `initialize`");
    let output = ended("closes others");
    assert!(stderr(&output).contains("libhostile.so` closed descriptors of the program"), "{}", text(&output));
    for does in ["begins: closes others", "closes others", "closes all"] {
        assert_eq!(ended(does).status.code(), Some(1), "{does}");
    }
}

#[test]
fn an_exception_of_another_language_is_told_with_its_thrower() {
    for (at, function) in [("", "`execute`"), ("made: ", "the constructor"), ("begins: ", "`initialize`")] {
        let output = assert_named(&format!("{at}throws"), &format!("crashed in {function}: SIGABRT"));
        assert_eq!(output.status.signal(), Some(libc::SIGABRT), "{}", text(&output));
    }
}

#[test]
fn a_crash_that_nobody_is_to_blame_for_ends_with_its_own_signal() {
    // The stack for signals of a thread of the program is small.
    let output = ended("aborts later");
    assert_eq!(output.status.signal(), Some(libc::SIGABRT), "{}", text(&output));
    // The program finds out what was done to its memory, in its own code.
    assert!(stderr(&output).contains("libhostile.so` "), "{}", text(&output));
    assert!(stderr(&output).contains(": SIGABRT"), "{}", text(&output));
}

#[test]
fn hardware_stops_before_code_of_a_library_ends_the_process() {
    for (does, signal) in [
        ("exit", None),
        ("_exit", None),
        ("quick_exit", None),
        ("crashes", Some(libc::SIGSEGV)),
        ("aborts", Some(libc::SIGABRT)),
        ("frees twice", Some(libc::SIGABRT)),
    ] {
        let motor = component("Motor", "h.Motor", "");
        let output = ended_with(&(motor + &bad("h.Actor", does, "")), &[]);
        assert_eq!(stderr(&output).matches("the hardware stops\n").count(), 1, "{does}: {}", text(&output));
        let line = stderr(&output).find("component `Bad` of library").unwrap();
        assert!(line < stderr(&output).find("the hardware stops").unwrap(), "{does}: {}", text(&output));
        assert_eq!((output.status.signal(), output.status.code() == Some(1)), (signal, signal.is_none()), "{does}");
        // Nobody waits for hardware without end.
        let output = ended_with(&bad("h.Motor", &format!("hangs in stop, {does}"), ""), &[]);
        let expected = "error: the hardware of component `Bad` may still move: its stop function has not returned";
        let told = stderr(&output);
        let line = told.lines().find(|line| line.starts_with(expected));
        assert!(line.is_some_and(|line| line.ends_with("libhostile.so`)")), "{does}: {}", text(&output));
        assert_eq!((output.status.signal(), output.status.code() == Some(1)), (signal, signal.is_none()), "{does}");
    }
}

/// Those who stop all hardware before the end call it again, on other threads.
#[test]
fn a_crash_in_a_stop_function_is_told_once() {
    let output = ended_with(&bad("h.Motor", "crashes in stop", ""), &[]);
    let told = stderr(&output);
    let expected = "libhostile.so` crashed in the function that stops its hardware: SIGSEGV";
    assert!(told.contains("error: component `Bad` of library `"), "{}", text(&output));
    assert_eq!(told.matches(expected).count(), 1, "{}", text(&output));
    assert_eq!(told.matches(" crashed").count(), 1, "{}", text(&output));
    assert_eq!(told.matches("error: the hardware of component `Bad` may still move").count(), 1, "{}", text(&output));
    assert_eq!(output.status.signal(), Some(libc::SIGSEGV), "{}", text(&output));
}

#[test]
fn a_jump_out_of_a_call_is_told_with_component_and_library() {
    for definitions in [&[][..], &["_FORTIFY_SOURCE=2"]] {
        let output = ended_with(&bad("h.Actor", "jumps to an earlier call", ""), definitions);
        assert_jumps(&output, "jumped out of its call, by `longjmp` in `execute`: it may only jump within one call");
        let caller = "<reference name=\"callee\" target=\"Bad/callee\"/>";
        let caller = component("Caller", "h.Actor", &(property("does", "calls and is left") + caller));
        let output = ended_with(&(bad("h.Actor", "leaves its caller", "") + &caller), definitions);
        assert_jumps(&output, "jumped out of its call, by `longjmp` in a service: it may only jump within one call");
        let caller = bad("h.Actor", "leaves a reply", "<reference name=\"callee\" target=\"Callee/callee\"/>");
        let output = ended_with(&(caller + &component("Callee", "h.Actor", &property("does", "replies"))), definitions);
        assert_jumps(&output, "jumped out of its call, by `longjmp` in `execute`: it may only jump within one call");
    }
}

fn assert_jumps(output: &std::process::Output, expected: &str) {
    let told = stderr(output);
    let line = told.lines().find(|line| line.starts_with("error: component `Bad` of library `"));
    assert!(line.is_some_and(|line| line.ends_with(&format!("libhostile.so` {expected}"))), "{}", text(output));
    assert_eq!((output.status.signal(), output.status.code()), (None, Some(1)), "{}", text(output));
}

#[test]
fn a_jump_within_a_call_and_between_stacks_of_a_library_goes_on() {
    for (does, expected) in [
        ("jumps within its call", "has jumped within its call\n"),
        ("continues a part", "the part with its own stack continues\n"),
    ] {
        let output = ended(does);
        assert_eq!((output.status.signal(), output.status.code()), (None, Some(0)), "{does}: {}", text(&output));
        assert!(stderr(&output).contains(expected), "{does}: {}", text(&output));
    }
}
