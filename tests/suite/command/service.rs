//! A fleet as a service: what its manager is told, and the units of packages.

use std::fs;
use std::io::ErrorKind;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::{PROGRAM, command, project, text};

/// A manager with a socket, and the fleet that it started.
struct Manager {
    socket: UnixDatagram,
    child: Child,
}

impl Manager {
    /// Starts the hall in real time, with this socket.
    fn start(socket: UnixDatagram, name: &str, arguments: &[&str]) -> Manager {
        socket.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let mut run =
            command(&[&["run", "composites/hall.composite", "--control", "none", "--quiet"], arguments].concat());
        run.env("NOTIFY_SOCKET", name).env("WATCHDOG_USEC", "1000000");
        let child = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        Manager { socket, child }
    }

    /// The next message.
    fn next(&self) -> String {
        let mut message = [0; 4096];
        let length = self.socket.recv(&mut message).unwrap();
        String::from_utf8(message[..length].to_vec()).unwrap()
    }

    /// Waits for a message with this line.
    fn until(&self, line: &str) -> String {
        loop {
            let message = self.next();
            if message.lines().any(|found| found == line) {
                return message;
            }
        }
    }

    fn signal(&self, signal: i32) {
        // SAFETY: the call takes no pointers, and the process is a child that has not been waited for.
        assert_eq!(unsafe { libc::kill(i32::try_from(self.child.id()).unwrap(), signal) }, 0);
    }

    fn end(mut self) -> Option<i32> {
        let status = self.child.wait().unwrap();
        status.code()
    }
}

impl Drop for Manager {
    fn drop(&mut self) {
        // A test that failed leaves no fleet behind.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn the_manager_knows_that_the_fleet_runs_lives_and_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notify");
    let manager = Manager::start(UnixDatagram::bind(&path).unwrap(), path.to_str().unwrap(), &["--stay"]);
    let ready = manager.next();
    assert!(ready.starts_with("READY=1\nSTATUS=0."), "{ready}");
    for _ in 0..3 {
        assert_eq!(manager.next(), "WATCHDOG=1");
    }
    manager.signal(libc::SIGTERM);
    manager.until("STOPPING=1");
    assert_eq!(manager.end(), Some(130));
}

#[test]
fn an_abstract_socket_and_an_end_by_itself_are_told_as_well() {
    let name = format!("saoms-test-{}", std::process::id());
    let address = SocketAddr::from_abstract_name(&name).unwrap();
    let manager = Manager::start(UnixDatagram::bind_addr(&address).unwrap(), &format!("@{name}"), &["--virtual"]);
    manager.until("READY=1");
    manager.until("STOPPING=1");
    assert_eq!(manager.end(), Some(0));
}

#[test]
fn a_manager_that_is_not_there_hinders_nothing() {
    for socket in ["/nowhere/notify", "@", ""] {
        let mut run = command(&["run", "composites/hall.composite", "--virtual", "--quiet"]);
        let output = run.env("NOTIFY_SOCKET", socket).env("WATCHDOG_USEC", "x").output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    }
}

/// The thread of a process with this name.
fn thread(pid: u32, name: &str) -> i32 {
    let threads = fs::read_dir(format!("/proc/{pid}/task")).unwrap().map(|entry| entry.unwrap().path());
    let is_it = |path: &Path| fs::read_to_string(path.join("comm")).is_ok_and(|found| found.trim() == name);
    let mut found = threads.filter(|path| is_it(path));
    found.next().unwrap().file_name().unwrap().to_str().unwrap().parse().unwrap()
}

#[test]
fn a_timer_that_hangs_gives_no_sign_of_life() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notify");
    let manager = Manager::start(UnixDatagram::bind(&path).unwrap(), path.to_str().unwrap(), &["--stay"]);
    manager.until("WATCHDOG=1");
    let timer = thread(manager.child.id(), "saoms-timer");
    let trace = |request: libc::c_uint| {
        // SAFETY: these requests read and write no memory of this process.
        unsafe { libc::ptrace(request, timer, 0, 0) }
    };
    if trace(libc::PTRACE_SEIZE) != 0 {
        return println!("skipped: a thread cannot be stopped here: {}", std::io::Error::last_os_error());
    }
    assert_eq!(trace(libc::PTRACE_INTERRUPT), 0);
    // The manager would end it when there is no sign for a second. There are messages on their way, and the time for
    // which the timer may be late.
    let is_quiet_for = |time: Duration| {
        manager.socket.set_read_timeout(Some(time)).unwrap();
        let received = manager.socket.recv(&mut [0; 4096]);
        received.is_err_and(|error| matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut))
    };
    let start = Instant::now();
    while !is_quiet_for(Duration::from_millis(1500)) {
        assert!(start.elapsed() < Duration::from_secs(60), "it says that it lives");
    }
    // It goes on when the timer does.
    assert_eq!(trace(libc::PTRACE_DETACH), 0);
    manager.socket.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    manager.until("WATCHDOG=1");
    manager.signal(libc::SIGTERM);
    assert_eq!(manager.end(), Some(130));
}

/// The units that packages have, in the order of the page that shows them.
const UNITS: [&str; 2] = ["saoms@.service", "saoms-postgres@.service"];

#[test]
fn the_page_shows_the_units_that_packages_have() {
    let page = project("docs/service.md");
    let shown: Vec<&str> = page.split("```ini\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert_eq!(shown, UNITS.map(|unit| project(&format!("packages/{unit}"))));
}

#[test]
fn systemd_finds_nothing_wrong_with_the_units() {
    let folder = tempfile::tempdir().unwrap();
    for unit in UNITS {
        // The fleet `hall`, by a program that there is.
        let text_of_unit = project(&format!("packages/{unit}"));
        let programs = ["/usr/bin/saoms-postgres", "/usr/bin/saoms"];
        assert!(programs.iter().any(|program| text_of_unit.contains(program)), "{text_of_unit}");
        let program = format!("ExecStart={PROGRAM} ");
        let own =
            programs.iter().fold(text_of_unit, |unit, path| unit.replace(&format!("ExecStart={path} "), &program));
        let file = folder.path().join(unit.replace('@', "@hall"));
        fs::write(&file, own).unwrap();
        let mut verify = Command::new("systemd-analyze");
        match verify.args(["verify", "--man=no"]).arg(&file).output() {
            Ok(output) => assert!(output.status.success() && text(&output).is_empty(), "{}", text(&output)),
            // A test cannot install it.
            Err(error) => println!("skipped: systemd-analyze is missing: {error}"),
        }
    }
}

#[test]
fn the_command_line_of_the_unit_is_one_that_there_is() {
    let unit = project("packages/saoms@.service");
    for wanted in ["Type=notify", "SuccessExitStatus=130", "Restart=on-failure", "WatchdogSec="] {
        assert!(unit.lines().any(|line| line.starts_with(wanted)), "{wanted}");
    }
    let line = unit.lines().find_map(|line| line.strip_prefix("ExecStart=/usr/bin/saoms ")).unwrap();
    // What it restarts goes on, and the service beside it reads what it writes.
    assert!(line.contains(" --state /var/lib/saoms/%i/"), "{line}");
    let (_, history) = line.split_once(" --history ").unwrap();
    let history = history.split(' ').next().unwrap();
    assert!(project("packages/saoms-postgres@.service").contains(&format!("saoms-postgres {history} ")), "{history}");
    let folder = tempfile::tempdir().unwrap();
    let here = |line: String, place: &str| line.replace(place, folder.path().to_str().unwrap());
    let line = line.replace("/etc/saoms/%i.composite", "composites/hall.composite");
    let line = ["/run/saoms/%i", "/var/lib/saoms/%i", "/var/log/saoms/%i"].into_iter().fold(line, here);
    // Options of a fleet come last.
    let words: Vec<&str> = line.strip_suffix(" $SAOMS_OPTIONS").unwrap().split(' ').collect();
    let output = command(&[&words[..], &["--for", "50ms"]].concat()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
}
