//! Alerts as a command: the shell runs it, with the change on its standard input and in its environment.

use std::ffi::CStr;
use std::fs::File;
use std::io::{self, Seek, Write};
use std::os::fd::FromRawFd;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::delivery::{Delivery, End, Failed};

/// Time for a command; then it ends, with all that it started.
const PATIENCE: Duration = Duration::from_secs(30);
/// Time between two looks at whether it has ended.
const LOOK: Duration = Duration::from_millis(10);

/// Runs the command; `Err` says how it failed.
pub(super) fn run(line: &str, folder: &Path, delivery: &Delivery, end: &End) -> Result<(), Failed> {
    let alert = &delivery.alert;
    let mut command = Command::new("/bin/sh");
    // A group of its own: Ctrl-C at the terminal is meant for the fleet.
    command.arg("-c").arg(line).process_group(0).stdout(Stdio::null());
    if folder != Path::new("") {
        command.current_dir(folder);
    }
    for (name, value) in [
        ("FLEET", &*delivery.fleet),
        ("EVENT", delivery.event),
        ("ID", &alert.id.to_string()),
        ("KIND", &alert.kind),
        ("COMPONENT", alert.component.as_deref().unwrap_or_default()),
        ("SUBJECT", &alert.subject),
        ("TEXT", &alert.text),
    ] {
        // What the environment cannot hold.
        command.env(format!("SAOMS_ALERT_{name}"), value.replace('\0', "\u{fffd}"));
    }
    let spawned = input(&format!("{}\n", delivery.json())).and_then(|input| command.stdin(input).spawn());
    let mut child = spawned.map_err(|error| Failed::ForNow(format!("it cannot be started: {error}")))?;
    wait(&mut child, end).map_err(Failed::ForNow)
}

/// A text to be read. It is in memory, so that nobody waits for a command that reads nothing.
fn input(text: &str) -> io::Result<File> {
    const NAME: &CStr = c"saoms-alert";
    // SAFETY: the name ends with a zero byte and lives as long as the program.
    let descriptor = unsafe { libc::memfd_create(NAME.as_ptr(), libc::MFD_CLOEXEC) };
    if descriptor < 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: the descriptor is new, and nobody else has it.
    let mut file = unsafe { File::from_raw_fd(descriptor) };
    file.write_all(text.as_bytes())?;
    file.rewind()?;
    Ok(file)
}

/// Waits until a command has ended; `Err` says how it failed.
pub(super) fn wait(child: &mut Child, run: &End) -> Result<(), String> {
    let begun = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) if status.success() => return Ok(()),
            Ok(Some(status)) => return Err(format!("it ended with {status}")),
            Ok(None) if begun.elapsed() >= PATIENCE => {
                end(child);
                return Err(format!("it did not end within {} s", PATIENCE.as_secs()));
            }
            Ok(None) if run.deadline().is_some_and(|deadline| Instant::now() >= deadline) => {
                end(child);
                return Err("it did not end before the run did".to_owned());
            }
            Ok(None) => thread::sleep(LOOK),
            // It has ended, and other code of the process has taken its status: nobody knows it.
            Err(error) if error.raw_os_error() == Some(libc::ECHILD) => return Ok(()),
            Err(error) => return Err(error.to_string()),
        }
    }
}

/// Ends a command and what it started.
fn end(child: &mut Child) {
    if let Ok(group) = libc::pid_t::try_from(child.id()) {
        // SAFETY: a signal to a group of processes touches no memory of this one. The group is that of the child, which
        // was not waited for, so that its number belongs to nobody else.
        unsafe { libc::kill(-group, libc::SIGKILL) };
    }
    // It has ended by now.
    let _ = child.wait();
}
