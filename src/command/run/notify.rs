//! What the service manager that started the program is told (`sd_notify` of systemd): that the fleet runs, that it is
//! alive, and that it ends.

use std::env;
use std::io;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_core::schedule::Handle;
use saoms_core::status::FleetPhase;

/// Time between two looks at the fleet, and between two lines of its status.
const LOOK: Duration = Duration::from_millis(250);
const STATUS: Duration = Duration::from_secs(5);

/// The socket of the manager.
struct Manager {
    socket: UnixDatagram,
    address: SocketAddr,
    /// True if it was told that the fleet ends.
    knows_end: AtomicBool,
}

/// Tells the manager how the fleet does, until this is dropped.
pub(super) struct Notifier {
    manager: Arc<Manager>,
    /// Dropped to end the thread.
    _end: Sender<()>,
}

impl Manager {
    /// The manager that `NOTIFY_SOCKET` names: a path, or an abstract name after `@`.
    fn of_environment() -> Option<io::Result<Manager>> {
        let name = env::var_os("NOTIFY_SOCKET").filter(|name| !name.is_empty())?;
        let connect = || {
            let address = match name.as_encoded_bytes().strip_prefix(b"@") {
                Some(name) => SocketAddr::from_abstract_name(name)?,
                None => SocketAddr::from_pathname(&name)?,
            };
            let socket = UnixDatagram::unbound()?;
            // A manager that reads nothing must not hold the fleet up.
            socket.set_nonblocking(true)?;
            Ok(Manager { socket, address, knows_end: AtomicBool::new(false) })
        };
        Some(connect())
    }

    /// Sends lines `NAME=value`. A manager that went away needs none.
    fn tell(&self, lines: &str) {
        let _ = self.socket.send_to_addr(lines.as_bytes(), &self.address);
    }

    fn tell_end(&self) {
        if !self.knows_end.swap(true, Ordering::Relaxed) {
            self.tell("STOPPING=1\nSTATUS=the fleet ends");
        }
    }
}

impl Notifier {
    /// Tells the manager, if there is one, that the fleet runs, and from then on how it does.
    pub(super) fn start(fleet: Handle) -> Option<Notifier> {
        let manager = Manager::of_environment()?;
        let started = manager.and_then(|manager| {
            let manager = Arc::new(manager);
            let (told, limit) = (Arc::clone(&manager), watchdog());
            let (end, ended) = mpsc::channel();
            let handle = fleet.clone();
            manager.tell(&format!("READY=1\n{}", status(&handle)));
            let watch =
                move || watch(&told, &handle, limit, |time| ended.recv_timeout(time) == Err(RecvTimeoutError::Timeout));
            thread::Builder::new().name("saoms-notify".to_owned()).spawn(watch)?;
            Ok(Notifier { manager, _end: end })
        });
        let told = |error: &io::Error| {
            fleet.note(Level::Warning, format!("the service manager cannot be notified that the fleet runs: {error}"));
        };
        started.inspect_err(told).ok()
    }
}

impl Drop for Notifier {
    fn drop(&mut self) {
        self.manager.tell_end();
    }
}

/// The time within which the manager wants a sign of life, if it wants any from this process.
fn watchdog() -> Option<Duration> {
    let number = |name: &str| env::var(name).ok()?.parse::<u64>().ok();
    let is_meant = number("WATCHDOG_PID").is_none_or(|pid| pid == u64::from(std::process::id()));
    number("WATCHDOG_USEC").filter(|limit| is_meant && *limit > 0).map(Duration::from_micros)
}

/// Looks at the fleet as long as `goes_on` after a time. The sign of life is given while the timer is alive: when it
/// hangs, the manager has to see that.
fn watch(manager: &Manager, fleet: &Handle, limit: Option<Duration>, goes_on: impl Fn(Duration) -> bool) {
    let every = limit.map_or(LOOK, |limit| (limit / 4).min(LOOK));
    let (mut pieces, mut told) = (0, Instant::now());
    while goes_on(every) {
        let sign = fleet.timer_sign();
        if let Some(limit) = limit
            && (sign.pieces != pieces || sign.overdue < limit / 2)
        {
            manager.tell("WATCHDOG=1");
        }
        pieces = sign.pieces;
        // The sign of life came before: a lock that hangs must not keep it back, nor give it.
        if matches!(fleet.phase(), FleetPhase::Ending | FleetPhase::Ended) {
            manager.tell_end();
        } else if told.elapsed() >= STATUS {
            told = Instant::now();
            manager.tell(&status(fleet));
        }
    }
}

/// The line of the status: `STATUS=12.3 s, 2 of 3 pieces delivered`.
fn status(fleet: &Handle) -> String {
    let progress = fleet.progress();
    let parts = std::iter::once(progress.time.to_string()).chain(progress.summaries);
    // A line ends the value.
    format!("STATUS={}", parts.collect::<Vec<_>>().join(", ").replace(['\n', '\r'], " "))
}
