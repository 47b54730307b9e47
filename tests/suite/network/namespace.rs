//! A network of its own for programs, whose link can be taken down.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, Command, Stdio};

use crate::support::assert_namespace_tools_are_installed;

/// A network namespace, in which the loopback device is the only link. It ends with this.
pub(super) struct Namespace {
    holder: Child,
}

impl Namespace {
    /// A new one; `None`, with a word, where the system lets no user make one.
    pub(super) fn new() -> Option<Namespace> {
        let script = "ip link set lo up && echo ready && exec sleep 3600";
        let unshare = Command::new("unshare").args(["-rn", "sh", "-c", script]).stdout(Stdio::piped()).spawn();
        let mut holder = unshare.ok();
        let mut line = String::new();
        if let Some(out) = holder.as_mut().and_then(|holder| holder.stdout.take()) {
            let _ = BufReader::new(out).read_line(&mut line);
        }
        let namespace = holder.map(|holder| Namespace { holder });
        if line.trim() == "ready" {
            return namespace;
        }
        assert_namespace_tools_are_installed();
        let _ = writeln!(std::io::stderr(), "skipped: `unshare -rn` makes no network of its own here");
        None
    }

    fn enter(&self) -> Command {
        let mut command = Command::new("nsenter");
        command.args(["-t", &self.holder.id().to_string(), "-U", "-n", "--preserve-credentials"]);
        command
    }

    /// A command that does the same in it.
    pub(super) fn inside(&self, command: &Command) -> Command {
        let mut inside = self.enter();
        inside.arg(command.get_program()).args(command.get_args());
        if let Some(folder) = command.get_current_dir() {
            inside.current_dir(folder);
        }
        inside.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
        inside
    }

    /// Takes the link down, or up.
    pub(super) fn set_link(&self, is_up: bool) {
        self.ip(&["link", "set", "lo", if is_up { "up" } else { "down" }]);
    }

    /// Changes the network with `ip`.
    pub(super) fn ip(&self, arguments: &[&str]) {
        assert!(self.enter().arg("ip").args(arguments).status().unwrap().success(), "{arguments:?}");
    }
}

impl Drop for Namespace {
    fn drop(&mut self) {
        let _ = self.holder.kill();
        let _ = self.holder.wait();
    }
}
