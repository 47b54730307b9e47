//! `saoms top`, also in a terminal.

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::process::{Child, Stdio};
use std::ptr;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{Running, component, composite, fleet};
use crate::support::command;

/// `saoms top` in a terminal of its own.
struct Watched {
    child: Child,
    terminal: File,
    /// The end of the terminal that the program has, too, so that its settings can be read.
    inner: OwnedFd,
    shown: String,
}

fn settings(terminal: &impl AsRawFd) -> (u32, u32, u32) {
    // SAFETY: zeros are settings, which the call overwrites.
    unsafe {
        let mut now: libc::termios = std::mem::zeroed();
        assert_eq!(libc::tcgetattr(terminal.as_raw_fd(), &raw mut now), 0);
        (now.c_lflag, now.c_iflag, now.c_oflag)
    }
}

impl Watched {
    fn start(running: &Running, arguments: &[&str], (rows, columns): (u16, u16)) -> Watched {
        let (mut outer, mut inner) = (0, 0);
        let size = libc::winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
        // SAFETY: both numbers and the size live until the call returns; the descriptors are new, and nobody else's.
        let (terminal, inner) = unsafe {
            assert_eq!(libc::openpty(&raw mut outer, &raw mut inner, ptr::null_mut(), ptr::null(), &raw const size), 0);
            (File::from_raw_fd(outer), OwnedFd::from_raw_fd(inner))
        };
        let end = || Stdio::from(inner.try_clone().unwrap());
        let mut top = command(&[&["top"], arguments].concat());
        top.current_dir(running.folder()).env("XDG_RUNTIME_DIR", running.folder()).env("TERM", "xterm");
        top.stdin(end()).stdout(end()).stderr(end());
        // SAFETY: both calls are safe between fork and exec: the terminal becomes that of the program.
        unsafe {
            top.pre_exec(|| {
                libc::setsid();
                libc::ioctl(0, libc::TIOCSCTTY, 0);
                Ok(())
            });
        }
        Watched { child: top.spawn().unwrap(), terminal, inner, shown: String::new() }
    }

    /// Reads what is shown until this is part of it.
    #[track_caller]
    fn until(&mut self, part: &str) {
        let since = Instant::now();
        while !self.shown.contains(part) {
            let mut asked = libc::pollfd { fd: self.terminal.as_raw_fd(), events: libc::POLLIN, revents: 0 };
            // SAFETY: the structure lives until the call returns.
            unsafe { libc::poll(&raw mut asked, 1, 1000) };
            assert!(
                since.elapsed() < Duration::from_secs(20),
                "{part:?} does not come after {:?}",
                self.shown.rsplit("\x1b[H").next()
            );
            if asked.revents & libc::POLLIN != 0 {
                let mut bytes = [0; 4096];
                let count = self.terminal.read(&mut bytes).unwrap();
                self.shown.push_str(&String::from_utf8_lossy(&bytes[..count]));
            }
        }
    }

    fn resize(&self, rows: u16, columns: u16) {
        let size = libc::winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
        // SAFETY: the size lives until the call returns.
        unsafe { assert_eq!(libc::ioctl(self.terminal.as_raw_fd(), libc::TIOCSWINSZ, &raw const size), 0) };
    }

    fn type_key(&mut self, key: &[u8]) {
        self.terminal.write_all(key).unwrap();
    }

    /// Waits for its end, with the terminal as it was before.
    #[track_caller]
    fn ends(mut self, before: (u32, u32, u32)) -> Option<i32> {
        self.until("\x1b[?7h\x1b[?25h\x1b[?1049l");
        let code = self.child.wait().unwrap().code();
        assert_eq!(settings(&self.inner), before);
        code
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_table_for_each_refresh_comes_where_there_is_no_terminal() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["executions"].as_u64() > Some(2));
    let text = running.told(&["top", "-n", "2", "--every", "100ms"]);
    assert_eq!(text.lines().filter(|line| line.starts_with("COMPONENT  STATE")).count(), 2, "{text}");
    for part in ["LATE P50", "MISSED", "DROPPED", "RESTARTS", "IN CODE", "Robot2", "idle", "free"] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    assert!(!text.contains('\x1b'), "{text:?}");

    let lines = running.told(&["top", "-n", "3", "--every", "100ms", "--sort", "name", "--format", "json"]);
    let answers: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers.len(), 3, "{lines}");
    let names = |answer: &Value| {
        let components = answer["status"]["components"].as_array().unwrap();
        components.iter().map(|one| one["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names(&answers[0]), ["Master", "Robot1", "Robot2", "World"]);
    assert!(answers[2]["status"]["time_s"].as_f64() > answers[0]["status"]["time_s"].as_f64(), "{lines}");
    assert!(running.refused(&["top", "--every", "10ms"]).contains("at least 100ms"));
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn the_components_that_start_latest_or_miss_most_come_first() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["executions"].as_u64() > Some(2));
    for (sort, places) in [("late", ["late_us", "p99"].as_slice()), ("missed", &["missed"])] {
        let line = running.told(&["top", "-n", "1", "--sort", sort, "--format", "json"]);
        let answer: Value = serde_json::from_str(&line).unwrap();
        let components = answer["status"]["components"].as_array().unwrap();
        let numbers = components.iter().map(|one| places.iter().fold(one, |one, place| &one[place]).as_u64().unwrap());
        assert!(numbers.is_sorted_by(|one, other| one >= other), "{sort}: {line}");
    }
}

#[test]
fn a_terminal_shows_what_fits_and_is_as_before_at_each_end() {
    let running = Running::start(&fleet(), &["--stay"]);
    let arguments = ["--every", "100ms"];
    for end in ["q", "\x03"] {
        let mut top = Watched::start(&running, &arguments, (20, 100));
        let before = settings(&top.inner);
        // The alternate screen, without cursor, from its start.
        top.until("\x1b[?1049h\x1b[?25l\x1b[?7l");
        top.until("\x1b[H");
        top.until("Robot2");
        assert_ne!(settings(&top.inner).0, before.0, "keys come at once");
        top.shown.clear();
        top.resize(5, 30);
        top.until("... 3 more components");
        let picture = top.shown.rsplit("\x1b[H").next().unwrap();
        let longest =
            picture.lines().map(|line| line.replace("\x1b[K", "").replace("\x1b[J", "").trim_end().len()).max();
        assert!(longest <= Some(30), "{picture:?}");
        top.resize(20, 100);
        top.until("Robot2");
        top.type_key(b"x");
        top.type_key(end.as_bytes());
        assert_eq!(top.ends(before), Some(0), "{end:?}");
    }
    let mut top = Watched::start(&running, &arguments, (20, 100));
    let before = settings(&top.inner);
    top.until("Robot2");
    // SAFETY: no pointers; the process is not waited for yet.
    unsafe { assert_eq!(libc::kill(top.child.id() as libc::pid_t, libc::SIGTERM), 0) };
    assert_eq!(top.ends(before), Some(130));

    let mut top = Watched::start(&running, &["-n", "2", "--every", "100ms"], (20, 100));
    let before = settings(&top.inner);
    top.until("Robot2");
    assert_eq!(top.ends(before), Some(0));

    let mut top = Watched::start(&running, &arguments, (20, 100));
    let before = settings(&top.inner);
    top.until("Robot2");
    running.told(&["down"]);
    top.until("the fleet has ended");
    assert_eq!(top.ends(before), Some(0));
}

#[test]
fn names_steer_no_terminal() {
    let hostile = composite(&component("Wor&#x9b;ld", "saoms.World", ""));
    let running = Running::start(&hostile, &["--stay"]);
    let text = running.told(&["top", "-n", "1"]);
    assert!(text.contains("Wor\\u{9b}ld") && !text.contains('\u{9b}'), "{text:?}");
    let line = running.told(&["top", "-n", "1", "--format", "json"]);
    let answer: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(answer["status"]["components"][0]["name"], "Wor\u{9b}ld");
    assert!(!line.contains('\u{9b}'), "{line:?}");
}
