//! What a lost terminal leads to, with real processes: SIGHUP, and terminals that close.

use std::fs::{self, File};
use std::io::Read;
use std::os::fd::{FromRawFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::thread::sleep;
use std::time::Duration;

use super::{Running, component, composite, fleet};
use crate::boundary::build::library;
use crate::support::{command, on_hangup, text};

/// The fleet with a choice.
fn with(hangup: &str) -> String {
    chosen(&fleet(), hangup)
}

fn chosen(fleet: &str, hangup: &str) -> String {
    fleet.replacen(" name=\"fleet\"", &format!(" name=\"fleet\" xmlns:s=\"urn:saoms:1\" s:hangup=\"{hangup}\""), 1)
}

fn start(fleet: &str, arguments: &[&str]) -> Running {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fleet.composite"), fleet).unwrap();
    Running::start_with(folder, arguments, |run| on_hangup(run, libc::SIG_DFL))
}

fn send(pid: u32, signal: i32) {
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(i32::try_from(pid).unwrap(), signal) }, 0);
}

/// Waits for a line of the log.
#[track_caller]
fn until_logged(running: &Running, what: &str) {
    for _ in 0..1000 {
        if running.told(&["logs"]).contains(what) {
            return;
        }
        sleep(Duration::from_millis(10));
    }
    panic!("`{what}` is not in the log:\n{}", running.told(&["logs"]));
}

/// Waits until a robot has executed more often.
#[track_caller]
fn goes_on(running: &Running) {
    let executed = |robot: &serde_json::Value| robot["executions"].as_u64().unwrap();
    let now = executed(&running.component("Robot1"));
    running.until("Robot1", |robot| executed(robot) > now + 3);
}

#[test]
fn hold_stops_the_robots_until_the_release() {
    let running = start(&with("hold"), &["--stay", "--journal", "run.ndjson"]);
    send(running.pid(), libc::SIGHUP);
    // The system and the shell tell one after the other.
    send(running.pid(), libc::SIGHUP);
    running.until("Robot1", |robot| robot["values"]["state"] == "stopped");
    until_logged(&running, "emergency stop by lost-terminal: Robot1, Robot2");
    until_logged(&running, "the terminal is lost: all that moves is stopped until `saoms release`");
    assert!(running.told(&["alerts"]).contains("emergency_stop: "));
    goes_on(&running);
    running.told(&["release"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    running.told(&["down"]);
    let mut running = running;
    let (code, printed) = running.wait();
    assert_eq!(code, Some(0), "{printed}");
    assert_eq!(printed.matches("emergency stop by lost-terminal").count(), 1, "{printed}");
    let journal = fs::read_to_string(running.folder().join("run.ndjson")).unwrap();
    assert!(journal.contains("estop by lost-terminal"), "{journal}");

    // What was journaled happens again.
    let again = [
        "run", "fleet.composite", "--virtual", "--for", "1min", "--events", "run.ndjson", "--stay", "--control", "none",
    ];
    let output = command(&again).current_dir(running.folder()).output().unwrap();
    assert!(text(&output).contains("emergency stop by lost-terminal"), "{}", text(&output));
}

#[test]
fn sigterm_ends_a_run_that_holds() {
    let running = start(&with("hold"), &["--stay"]);
    send(running.pid(), libc::SIGHUP);
    running.until("Robot1", |robot| robot["values"]["state"] == "stopped");
    send(running.pid(), libc::SIGTERM);
    let (code, printed) = running.end();
    assert_eq!(code, Some(130), "{printed}");
}

#[test]
fn go_on_goes_on_until_sigterm() {
    let running = start(&with("goOn"), &["--stay"]);
    send(running.pid(), libc::SIGHUP);
    until_logged(&running, "the terminal is lost: the fleet goes on");
    goes_on(&running);
    assert_eq!(running.component("Robot1")["emergency_stop"], false);
    send(running.pid(), libc::SIGTERM);
    let (code, printed) = running.end();
    assert_eq!(code, Some(130), "{printed}");
}

#[test]
fn a_lost_terminal_ends_a_run_that_chose_so_or_chose_nothing() {
    for fleet in [with("end"), fleet()] {
        let running = start(&fleet, &["--stay"]);
        send(running.pid(), libc::SIGHUP);
        let (code, printed) = running.end();
        assert_eq!(code, Some(130), "{printed}");
    }
}

#[test]
fn a_reader_that_goes_away_with_the_terminal_ends_nothing() {
    for hangup in ["hold", "goOn"] {
        for is_reader_first in [true, false] {
            let mut running = start(&with(hangup), &["--stay"]);
            let reader = running.take_output();
            let pid = running.pid();
            if is_reader_first {
                drop(reader);
                send(pid, libc::SIGHUP);
            } else {
                send(pid, libc::SIGHUP);
                until_logged(&running, "the terminal is lost");
                drop(reader);
            }
            until_logged(&running, "the terminal is lost");
            // Longer than a signal is waited for.
            sleep(Duration::from_millis(1500));
            goes_on(&running);
            running.told(&["down"]);
            let (code, printed) = running.wait();
            assert_eq!(code, Some(0), "{hangup}: {printed}");
        }
    }
}

#[test]
fn a_reader_that_goes_away_alone_ends_the_run() {
    let mut running = start(&with("hold"), &["--stay"]);
    drop(running.take_output());
    let (code, printed) = running.wait();
    assert_eq!(code, Some(0), "{printed}");
}

#[test]
fn what_hangs_while_the_fleet_starts_is_stopped_too_and_can_be_ended() {
    let plugin = library("bad");
    let values = "<property name=\"at\">initialize</property><property name=\"does\">never</property>";
    let text = composite(&component("Hangs", "bad.Actor", values));
    let running = start(&chosen(&text, "hold"), &["--plugin", plugin.to_str().unwrap(), "--grace", "300ms"]);
    send(running.pid(), libc::SIGHUP);
    until_logged(&running, "the terminal is lost");
    assert!(running.told(&["ps"]).contains("fleet"));
    send(running.pid(), libc::SIGTERM);
    let (code, printed) = running.end();
    assert_eq!(code, Some(130), "{printed}");
}

/// A pseudo-terminal: the side of the user, and that of programs.
fn terminal() -> (File, OwnedFd) {
    let (mut user, mut programs) = (0, 0);
    // SAFETY: both pointers lead to integers that are written; the others may be null.
    let opened = unsafe {
        libc::openpty(&raw mut user, &raw mut programs, std::ptr::null_mut(), std::ptr::null(), std::ptr::null())
    };
    assert_eq!(opened, 0);
    // SAFETY: `user` is open.
    assert_eq!(unsafe { libc::fcntl(user, libc::F_SETFD, libc::FD_CLOEXEC) }, 0);
    // SAFETY: both descriptors are new, and nobody else has them.
    unsafe { (File::from_raw_fd(user), OwnedFd::from_raw_fd(programs)) }
}

/// A run on a terminal of its own, and what it shows there as long as that is open.
fn on_terminal(hangup: &str) -> (Running, File) {
    let (user, programs) = terminal();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fleet.composite"), with(hangup)).unwrap();
    // A terminal that nobody reads holds up who writes.
    let mut reader = user.try_clone().unwrap();
    let running = Running::start_with(folder, &["--stay"], move |run| {
        run.stdin(programs.try_clone().unwrap()).stdout(programs.try_clone().unwrap()).stderr(programs);
        run.env("TERM", "xterm");
        on_hangup(run, libc::SIG_DFL);
        // SAFETY: the calls between fork and exec are ones that signal handlers may make.
        unsafe {
            run.pre_exec(|| {
                if libc::setsid() < 0 || libc::ioctl(0, libc::TIOCSCTTY, 0) < 0 {
                    return Err(std::io::Error::last_os_error());
                }
                Ok(())
            });
        }
    });
    let mut shown = [0; 64];
    assert!(reader.read(&mut shown).unwrap() > 0, "it shows nothing");
    drop(reader);
    (running, user)
}

#[test]
fn a_run_outlives_a_terminal_that_closes_and_a_disk_is_not_to_blame() {
    for (hangup, what) in [("hold", "all that moves is stopped"), ("goOn", "the fleet goes on")] {
        let (mut running, user) = on_terminal(hangup);
        drop(user);
        until_logged(&running, what);
        goes_on(&running);
        // Something to print.
        running.told(&["estop"]);
        running.told(&["release"]);
        goes_on(&running);
        running.told(&["down"]);
        assert_eq!(running.wait().0, Some(0), "{hangup}");
    }
}

#[test]
fn a_run_ends_with_its_terminal_unless_it_chose_otherwise() {
    let (mut running, user) = on_terminal("end");
    drop(user);
    assert_ne!(running.wait().0, Some(0));
}
