use std::io::{self, Write};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use saoms_control::{Client, ClientError};
use serde_json::Value;

/// Asks a fleet for its status on a thread of its own: a fleet that does not answer keeps nobody from ending.
pub(super) struct Feed {
    asks: Sender<()>,
    answers: Receiver<Result<Value, ClientError>>,
    /// Gets a byte with each answer, for who waits for more than answers.
    wake: UnixStream,
    pub(super) woken: UnixStream,
}

impl Feed {
    /// A feed of this client.
    ///
    /// # Errors
    /// The system has no thread or no descriptor left.
    pub(super) fn of(client: Client) -> io::Result<Feed> {
        let (wake, woken) = UnixStream::pair()?;
        // Who is awake already needs no further byte.
        wake.set_nonblocking(true)?;
        woken.set_nonblocking(true)?;
        let (asks, asked) = channel();
        let (sender, answers) = channel();
        let mut other = wake.try_clone()?;
        thread::Builder::new().name("saoms-top".to_owned()).spawn(move || {
            while asked.recv().is_ok() {
                let answer = client.request("GET", "/v1/status", "").and_then(saoms_control::Response::json);
                if sender.send(answer).is_err() {
                    return;
                }
                let _ = other.write(&[0]);
            }
        })?;
        Ok(Feed { asks, answers, wake, woken })
    }

    /// What wakes who waits, for signals.
    pub(super) fn wake(&self) -> io::Result<UnixStream> {
        self.wake.try_clone()
    }

    /// Asks for the next answer.
    pub(super) fn ask(&self) {
        // The thread lives as long as this.
        let _ = self.asks.send(());
    }

    /// Waits for the answer.
    pub(super) fn wait(&self) -> Result<Value, ClientError> {
        self.answers.recv().unwrap_or_else(|_| Err(ClientError::Malformed("nobody asks any more".to_owned())))
    }

    /// The answer, if it is there.
    pub(super) fn next(&self) -> Option<Result<Value, ClientError>> {
        self.answers.try_recv().ok()
    }
}
