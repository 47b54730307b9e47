//! What ends a run from outside, and what becomes of output that nobody takes.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::thread;

use serde_json::Value;

use crate::support::{command, empty_folder, on_hangup, stderr};

/// A fleet of one robot that runs until it is stopped.
const ENDLESS: &str = r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" name="one" targetNamespace="urn:one">
  <component name="Robot001">
    <implementation.java class="robot.Robot001"/>
    <property name="ID">Robot001</property>
    <property name="period">20</property>
  </component>
</composite>
"#;

/// A run of the fleet, whose lines of the classic console do not end either.
fn endless(folder: &Path, arguments: &[&str]) -> Command {
    fs::write(folder.join("one.composite"), ENDLESS).unwrap();
    let mut run = command(&[&["run", "one.composite", "--console", "classic"], arguments].concat());
    run.current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    on_hangup(&mut run, libc::SIG_DFL);
    run
}

/// Reads up to the first execution, so that the fleet runs.
fn running(child: &mut Child) -> BufReader<ChildStdout> {
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let mut line = String::new();
    while !line.contains("Execution 1 of Robot001") {
        line.clear();
        assert_ne!(lines.read_line(&mut line).unwrap(), 0, "the robot never ran");
    }
    lines
}

/// A named pipe.
fn pipe(folder: &Path, name: &str) {
    assert!(Command::new("mkfifo").arg(folder.join(name)).status().unwrap().success());
}

fn send(child: &Child, signal: i32) {
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(i32::try_from(child.id()).unwrap(), signal) }, 0);
}

/// It ended with 0, and nothing was told of its output. A busy machine may have made it late.
#[track_caller]
fn assert_quiet_end(output: &Output) {
    let told = stderr(output);
    assert_eq!(output.status.code(), Some(0), "{told}");
    assert!(!told.contains("error") && !told.contains("panicked"), "{told}");
}

/// True if the process has a thread of this name.
fn has_thread(child: &Child, name: &str) -> bool {
    let threads = fs::read_dir(format!("/proc/{}/task", child.id())).into_iter().flatten().flatten();
    threads
        .into_iter()
        .any(|thread| fs::read_to_string(thread.path().join("comm")).is_ok_and(|text| text.trim() == name))
}

fn status(report: &Path) -> Value {
    let report: Value = serde_json::from_slice(&fs::read(report).unwrap()).unwrap();
    report["outcome"]["status"].clone()
}

#[test]
fn a_run_ends_while_its_events_wait_for_a_writer() {
    for clock in [&["--virtual"][..], &[]] {
        let folder = empty_folder("events");
        pipe(&folder, "events");
        let files = ["--events", "events", "--report", "report.json", "--journal", "journal"];
        let mut child = endless(&folder, &[clock, &files].concat()).spawn().unwrap();
        if clock.is_empty() {
            // The fleet runs before there is a writer.
            let _lines = running(&mut child);
        }
        // In virtual time nothing happens before all lines are read, but the fleet has started by then.
        while !has_thread(&child, "events") {
            assert_eq!(child.try_wait().unwrap(), None, "it has ended");
            thread::yield_now();
        }
        send(&child, libc::SIGTERM);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
        assert_eq!(status(&folder.join("report.json")), "interrupted");
    }
}

#[test]
fn events_come_from_writers_of_a_named_pipe() {
    let folder = empty_folder("pipe");
    pipe(&folder, "events");
    let arguments = ["--virtual", "--events", "events", "--report", "report.json", "--for", "1s"];
    let child = endless(&folder, &arguments).spawn().unwrap();
    fs::write(folder.join("events"), "nothing\n").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["events"]["ignored"], 1);
}

#[test]
fn a_report_whose_reader_is_gone_is_told() {
    let folder = empty_folder("report-pipe");
    pipe(&folder, "report");
    let mut child = endless(&folder, &["--report", "report"]).spawn().unwrap();
    drop(File::open(folder.join("report")).unwrap());
    let mut lines = running(&mut child);
    send(&child, libc::SIGTERM);
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    assert!(rest.contains("interrupted after"), "{rest}");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("error: the report could not be written to `report`: "), "{}", stderr(&output));
}

#[test]
fn a_hangup_ends_through_shutdown_and_writes_all_files() {
    let folder = empty_folder("hangup");
    let mut child = endless(&folder, &["--report", "report.json", "--journal", "journal"]).spawn().unwrap();
    let mut lines = running(&mut child);
    // The system and the shell tell of it one after the other.
    send(&child, libc::SIGHUP);
    send(&child, libc::SIGHUP);
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    assert!(rest.contains("interrupted after"), "{rest}");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(status(&folder.join("report.json")), "interrupted");
    assert!(fs::read_to_string(folder.join("journal")).unwrap().lines().last().unwrap().starts_with("{\"end\""));
}

#[test]
fn a_hangup_ends_nothing_that_is_to_outlive_it() {
    let folder = empty_folder("nohup");
    let mut run = endless(&folder, &["--report", "report.json"]);
    on_hangup(&mut run, libc::SIG_IGN);
    let mut child = run.spawn().unwrap();
    let mut lines = running(&mut child);
    send(&child, libc::SIGHUP);
    let mut line = String::new();
    for _ in 0..100 {
        line.clear();
        assert_ne!(lines.read_line(&mut line).unwrap(), 0, "it goes on");
    }
    send(&child, libc::SIGTERM);
    lines.lines().for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn a_run_that_only_prints_ends_with_its_reader() {
    let folder = empty_folder("reader");
    for arguments in [&["--virtual"][..], &[], &["--console", "plain"], &["--console", "plain", "--report", "-"]] {
        let mut run = endless(&folder, &[]);
        if arguments.contains(&"plain") {
            run = command(&[&["run", "one.composite"], arguments].concat());
            run.current_dir(&folder).stdout(Stdio::piped()).stderr(Stdio::piped());
        } else {
            run.args(arguments);
        }
        let mut child = run.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_quiet_end(&output);
    }
}

#[test]
fn a_run_with_a_file_goes_on_to_its_end_without_a_reader() {
    let folder = empty_folder("unseen");
    for clock in [&["--virtual", "--for", "3s"][..], &["--for", "300ms"]] {
        let files = ["--report", "report.json", "--journal", "journal"];
        let mut child = endless(&folder, &[clock, &files].concat()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_quiet_end(&output);
        assert_eq!(status(&folder.join("report.json")), "elapsed");
        assert!(fs::read_to_string(folder.join("journal")).unwrap().lines().last().unwrap().starts_with("{\"end\""));
    }
}

/// The reader keeps its end of the pipe and takes nothing from it.
#[test]
fn a_reader_that_stops_does_not_keep_a_run_from_its_end() {
    let folder = empty_folder("stopped");
    let arguments = ["--virtual", "--report", "report.json", "--journal", "journal", "--grace", "100ms"];
    let mut child = endless(&folder, &arguments).spawn().unwrap();
    let unread = running(&mut child);
    send(&child, libc::SIGTERM);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(status(&folder.join("report.json")), "interrupted");
    drop(unread);
}

/// The run ends by itself, and its lines do not fit into the pipe.
#[test]
fn a_reader_that_stops_does_not_keep_a_run_from_the_end_of_its_time() {
    let folder = empty_folder("stopped-in-time");
    let mut run = endless(&folder, &["--for", "2s", "--report", "report.json", "--grace", "100ms"]);
    fs::write(folder.join("one.composite"), ENDLESS.replace(">20<", ">1<")).unwrap();
    let mut child = run.spawn().unwrap();
    let unread = running(&mut child);
    let told = io::read_to_string(child.stderr.take().unwrap()).unwrap();
    child.wait().unwrap();
    assert!(told.contains("the reader of standard output read nothing for 100ms: the rest is not printed"), "{told}");
    assert_eq!(status(&folder.join("report.json")), "elapsed");
    drop(unread);
}

#[test]
fn a_full_disk_under_standard_output_is_told_once_by_every_command() {
    let folder = empty_folder("full");
    let arguments: &[&[&str]] = &[
        &["run", "composites/hall.composite", "--virtual"],
        &["run", "composites/hall.composite", "--virtual", "--quiet", "--report", "-"],
        &["check", "composites/hall.composite"],
        &["check", "composites/hall.composite", "--format", "json"],
        &["check", "composites/hall.composite", "--format", "sarif"],
        &["check", "composites/hall.composite", "--wiring"],
        &["expand", "composites/hall.composite"],
        &["graph", "composites/hall.composite"],
        &["components"],
        &["components", "saoms.Robot", "--format", "json"],
        &["schema", "-o", folder.to_str().unwrap()],
        &["fmt", "--check", "composites/manual/launchtasks.composite", "composites/manual/launchbroker.composite"],
        &["--help"],
        &["run", "--help"],
        &["--version"],
    ];
    let fails = |arguments: &[&str]| {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = command(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let told = "error: standard output cannot be written: No space left on device (os error 28)\n  = help: ";
        assert!(stderr(&output).starts_with(told), "{arguments:?}: {}", stderr(&output));
        assert_eq!(stderr(&output).matches("error").count(), 2, "{arguments:?}: {}", stderr(&output));
    };
    arguments.iter().for_each(|arguments| fails(arguments));
    let report = folder.join("report.json");
    let report = report.to_str().unwrap();
    let run = ["run", "composites/hall.composite", "--virtual", "--quiet", "--report", report];
    assert_eq!(command(&run).status().unwrap().code(), Some(0));
    fails(&["why", "Robot7", "--report", report]);
    let input = File::open("composites/hall.composite").unwrap();
    let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = command(&["fmt", "-"]).stdin(input).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stderr(&output).matches("standard output cannot be written").count(), 1);
}
