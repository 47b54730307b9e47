use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

/// The wish of a person, or of the machine, that the program ends.
pub(crate) struct Stop {
    is_asked: Arc<AtomicBool>,
    told: Receiver<()>,
}

impl Stop {
    /// Waits for SIGTERM, Ctrl-C and SIGHUP from now on. The second one ends the program at once, as a server may not
    /// answer.
    ///
    /// # Errors
    /// The system refuses to tell of signals.
    pub(crate) fn on_signals() -> io::Result<Stop> {
        let mut signals = Signals::new([SIGTERM, SIGINT, SIGHUP])?;
        let (tell, told) = channel();
        let is_asked = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&is_asked);
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            for signal in signals.forever() {
                if asked.swap(true, Ordering::Relaxed) {
                    std::process::exit(128 + signal);
                }
                // Nobody waits any more at the very end.
                let _ = tell.send(());
            }
        })?;
        Ok(Stop { is_asked, told })
    }

    pub(crate) fn is_asked(&self) -> bool {
        self.is_asked.load(Ordering::Relaxed)
    }

    /// Waits for a time, or for the wish.
    pub(crate) fn wait(&self, time: Duration) {
        if !self.is_asked() {
            // Either outcome ends the time.
            let _ = self.told.recv_timeout(time);
        }
    }
}
