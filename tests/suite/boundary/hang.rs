//! Code of libraries that does not return while a composite is checked and a fleet starts: told by name, and ended by a
//! signal.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tempfile::TempDir;

use super::build::{c_library, c_library_of};
use super::run::{component, in_folder, property};
use crate::support::command;

type Waiting = (Child, BufReader<std::process::ChildStderr>, String);

/// A command over a fleet whose component hangs, until it says so.
fn hanging(subcommand: &[&str], at: &str) -> Waiting {
    let folder = in_folder(&component("Bad", "c.Actor", &(property("at", at) + &property("does", "hang"))));
    let library = c_library(folder.path(), &[]);
    waiting(subcommand, &folder, &library)
}

fn started(subcommand: &[&str], folder: &TempDir, library: &Path) -> Command {
    let mut command = command(subcommand);
    command.current_dir(folder.path()).args(["t.composite", "--plugin"]).arg(library);
    command
}

fn waiting(subcommand: &[&str], folder: &TempDir, library: &Path) -> Waiting {
    let mut command = started(subcommand, folder, library);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("the program waits for") {
        line.clear();
        assert!(errors.read_line(&mut line).unwrap() > 0, "it ended without a word");
    }
    (child, errors, line)
}

fn signal(child: &Child, signal: i32) {
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(i32::try_from(child.id()).unwrap(), signal) }, 0);
}

/// Sends signals until the process has ended.
fn end(child: &mut Child) {
    signal(child, libc::SIGINT);
    // Two would be one if they came together.
    while child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
        signal(child, libc::SIGINT);
    }
}

#[test]
fn a_check_says_what_it_waits_for() {
    for (at, function) in [("construct", "the constructor"), ("destroy", "the destructor")] {
        for subcommand in [&["check"][..], &["run", "--virtual", "--for", "1s"]] {
            let (mut child, _, line) = hanging(subcommand, at);
            let expected = format!("warning: the program waits for {function} of component `Bad` of library `");
            assert!(line.starts_with(&expected) && line.contains("libactor.so`, which has not returned"), "{line}");
            signal(&child, libc::SIGTERM);
            assert_ne!(child.wait().unwrap().code(), Some(0));
        }
    }
}

#[test]
fn a_library_that_hangs_while_it_is_loaded_is_told() {
    let folder = in_folder(&component("Bad", "h.Actor", ""));
    for at in ["LOADS", "ENTERS"] {
        let library = c_library_of("hostile", folder.path(), &[&format!("{at}=\"hangs\"")]);
        let (mut child, _, line) = waiting(&["run"], &folder, &library);
        let expected = "warning: the program waits for the static constructors or the entry function of library `";
        assert!(line.starts_with(expected) && line.contains("libhostile.so`, which has not returned"), "{line}");
        signal(&child, libc::SIGTERM);
        assert_ne!(child.wait().unwrap().code(), Some(0));
    }
}

#[test]
fn a_start_that_hangs_ends_at_the_second_signal() {
    let (mut child, mut errors, line) = hanging(&["run", "--grace", "1h"], "initialize");
    assert!(line.contains("waits for `initialize` of component `Bad` of library `"), "{line}");
    end(&mut child);
    let mut last = String::new();
    while errors.read_line(&mut last).unwrap() > 0 {}
    assert_eq!(child.wait().unwrap().code(), Some(130), "{last}");
    assert!(last.contains("error: interrupted while the program waits for `initialize` of component `Bad`"), "{last}");
}

#[test]
fn a_component_that_hangs_is_told_at_the_second_signal() {
    let folder = in_folder(&component("Bad", "c.Actor", &(property("at", "execute") + &property("does", "hang"))));
    let library = c_library(folder.path(), &[]);
    let mut command = started(&["run", "--grace", "1h"], &folder, &library);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    let mut line = String::new();
    while !line.contains("an execution takes longer than") {
        line.clear();
        assert!(output.read_line(&mut line).unwrap() > 0, "it ended without a word");
    }
    end(&mut child);
    let told = std::io::read_to_string(child.stderr.take().unwrap()).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{told}");
    let expected = "error: interrupted while the program waits for `execute` of component `Bad` of library `";
    assert!(told.contains(expected), "{expected} is missing in\n{told}");
}

#[test]
fn a_start_that_hangs_ends_at_the_first_signal_after_the_grace() {
    let (mut child, ..) = hanging(&["run", "--grace", "10ms"], "initialize");
    signal(&child, libc::SIGINT);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
