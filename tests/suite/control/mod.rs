//! Commands that reach a running fleet, against real processes.

mod alert_kinds;
mod alerts;
mod by_hand;
mod changes;
mod crowd;
mod dashboard;
mod delivery;
mod emergency;
mod exposition;
mod hang;
mod hangup;
mod json;
mod metrics;
mod network;
mod orders;
mod places;
mod replay;
mod sites;
mod slow_clients;
mod status;
mod time;
mod top;
mod topics;
mod view;
mod web;
mod why;

use std::fs;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::{sleep, spawn};
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use crate::support::{command, stderr, stdout, text};

/// Time after which a command that does not end is killed.
const LONGEST: Duration = Duration::from_secs(120);

/// A fleet that runs until it is ended, in a folder of its own, with a folder for sockets that no other test uses.
pub(super) struct Running {
    child: Option<Child>,
    folder: TempDir,
}

impl Running {
    /// Starts `saoms run` on `fleet.composite` with this text.
    pub(super) fn start(composite: &str, arguments: &[&str]) -> Running {
        // The path of a socket has to be short.
        let folder = tempfile::tempdir().unwrap();
        Running::start_beside(folder, composite, arguments)
    }

    /// The same in a folder with other files.
    pub(super) fn start_beside(folder: TempDir, composite: &str, arguments: &[&str]) -> Running {
        fs::write(folder.path().join("fleet.composite"), composite).unwrap();
        Running::start_in(folder, arguments)
    }

    pub(super) fn start_in(folder: TempDir, arguments: &[&str]) -> Running {
        Running::start_with(folder, arguments, |_| {})
    }

    /// Starts `saoms run` on the composite in a folder, with what else its process is to have.
    pub(super) fn start_with(folder: TempDir, arguments: &[&str], more: impl FnOnce(&mut Command)) -> Running {
        let mut run = command(&[&["run", "fleet.composite"], arguments].concat());
        run.current_dir(folder.path()).env("XDG_RUNTIME_DIR", folder.path());
        run.stdout(Stdio::piped()).stderr(Stdio::piped());
        more(&mut run);
        let child = run.spawn().unwrap();
        let running = Running { child: Some(child), folder };
        // Until it listens.
        for _ in 0..1000 {
            if stdout(&running.ask(&["ps", "--format", "json"])).contains("\"pid\"") {
                return running;
            }
            sleep(Duration::from_millis(10));
        }
        panic!("the fleet cannot be reached");
    }

    /// The folder in which it runs.
    pub(super) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Runs another command beside it, which is killed if it does not end.
    pub(super) fn ask(&self, arguments: &[&str]) -> Output {
        let mut command = command(arguments);
        command.current_dir(self.folder()).env("XDG_RUNTIME_DIR", self.folder());
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let (pid, (ended, end)) = (child.id(), channel::<()>());
        spawn(move || {
            if end.recv_timeout(LONGEST) == Err(RecvTimeoutError::Timeout) {
                // SAFETY: no pointers; the process is not waited for to its end before `ended` is dropped.
                unsafe { libc::kill(pid as libc::pid_t, libc::SIGKILL) };
            }
        });
        let output = child.wait_with_output().unwrap();
        drop(ended);
        output
    }

    /// What a command says that is taken.
    #[track_caller]
    pub(super) fn told(&self, arguments: &[&str]) -> String {
        let output = self.ask(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output));
        stdout(&output)
    }

    /// What a command says that is refused.
    #[track_caller]
    pub(super) fn refused(&self, arguments: &[&str]) -> String {
        let output = self.ask(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output));
        stderr(&output)
    }

    /// A component in `saoms status`.
    #[track_caller]
    pub(super) fn component(&self, name: &str) -> Value {
        let answer: Value = serde_json::from_str(&self.told(&["status", name, "--format", "json"])).unwrap();
        answer["status"]["components"][0].clone()
    }

    /// Waits until a component is as it should be.
    #[track_caller]
    pub(super) fn until(&self, name: &str, is: impl Fn(&Value) -> bool) -> Value {
        for _ in 0..500 {
            let component = self.component(name);
            if is(&component) {
                return component;
            }
            sleep(Duration::from_millis(20));
        }
        panic!("it never comes to that: {}", self.component(name));
    }

    /// Its process.
    pub(super) fn pid(&self) -> u32 {
        self.child.as_ref().unwrap().id()
    }

    /// Its standard output, for who reads it or goes away.
    pub(super) fn take_output(&mut self) -> ChildStdout {
        self.child.as_mut().unwrap().stdout.take().unwrap()
    }

    /// Waits for the end of the run: its exit code and what it printed.
    pub(super) fn end(mut self) -> (Option<i32>, String) {
        self.wait()
    }

    /// The same, and its folder stays.
    pub(super) fn wait(&mut self) -> (Option<i32>, String) {
        let output = self.child.take().unwrap().wait_with_output().unwrap();
        (output.status.code(), text(&output))
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // A test that failed leaves no fleet behind.
        if let Some(child) = &mut self.child {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// A component of a composite.
pub(super) fn component(name: &str, class: &str, more: &str) -> String {
    format!(
        "<component name=\"{name}\"><implementation.java class=\"{class}\"/><property name=\"ID\">{name}</property>\
         <property name=\"period\">50</property>{more}</component>\n"
    )
}

/// A composite of these components.
pub(super) fn composite(components: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:example\" \
         name=\"fleet\">\n{components}</composite>\n"
    )
}

/// A world, a master and two robots, of which the second one waits to be started. Nothing brings work.
pub(super) fn fleet() -> String {
    let world = "<reference name=\"world\" target=\"World\"/>";
    composite(
        &[
            component("World", "saoms.World", ""),
            component("Master", "saoms.MasterEnvironment", ""),
            component("Robot1", "saoms.Robot", world),
            component("Robot2", "saoms.Robot", &format!("{world}<property name=\"runOnStartup\">false</property>")),
        ]
        .concat(),
    )
}
