//! Clients of a fleet: some follow events, some read nothing, others ask for the status.

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, JoinHandle, sleep};
use std::time::{Duration, Instant};

use saoms_control::Client;
use serde::Serialize;

/// Threads that ask for the status.
const ASKING: u32 = 4;

/// What clients got.
#[derive(Clone, Copy, Default, Serialize)]
pub(crate) struct Asked {
    pub(crate) answers: u64,
    pub(crate) slowest_ms: f64,
    pub(crate) events: u64,
}

/// Clients that run until they are ended.
pub(crate) struct Clients {
    ended: Arc<AtomicBool>,
    events: Arc<AtomicU64>,
    asking: Vec<JoinHandle<(u64, Duration)>>,
    stuck: Vec<UnixStream>,
}

/// Follows the log, or a topic on which all robots publish.
fn path(number: u32) -> &'static str {
    if number.is_multiple_of(2) { "/v1/logs?follow=true" } else { "/v1/topics/RLMSTOPIC/messages" }
}

impl Clients {
    /// Connects the clients. Those that ask for the status do so `requests` times a second together.
    pub(crate) fn start(socket: &Path, followers: u32, stuck: u32, requests: u32) -> Clients {
        let (ended, events) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
        for number in stuck..followers {
            follow(socket, path(number), &events);
        }
        let stuck = (0..stuck).filter_map(|_| reads_nothing(socket).ok()).collect();
        let asking = (0..ASKING).map(|_| {
            let (socket, ended) = (socket.to_owned(), Arc::clone(&ended));
            thread::spawn(move || ask(socket, &ended, Duration::from_secs(1) * ASKING / requests.max(1)))
        });
        Clients { asking: asking.collect(), ended, events, stuck }
    }

    /// Ends them, and says what they got.
    pub(crate) fn end(self) -> Asked {
        self.ended.store(true, Ordering::Relaxed);
        let mut asked = Asked { events: self.events.load(Ordering::Relaxed), ..Asked::default() };
        for (answers, slowest) in self.asking.into_iter().filter_map(|thread| thread.join().ok()) {
            asked.answers += answers;
            asked.slowest_ms = asked.slowest_ms.max(slowest.as_secs_f64() * 1e3);
        }
        drop(self.stuck);
        asked
    }
}

/// Follows events on a thread that ends with the fleet, and counts them.
pub(crate) fn follow(socket: &Path, path: &'static str, events: &Arc<AtomicU64>) {
    let (socket, events) = (socket.to_owned(), Arc::clone(events));
    thread::spawn(move || {
        if let Ok(response) = Client::new(socket).request("GET", path, "") {
            for _ in response.events() {
                events.fetch_add(1, Ordering::Relaxed);
            }
        }
    });
}

/// A client that follows a topic and reads nothing of it.
fn reads_nothing(socket: &Path) -> std::io::Result<UnixStream> {
    let mut stream = UnixStream::connect(socket)?;
    stream.write_all(format!("GET {} HTTP/1.1\r\nHost: localhost\r\n\r\n", path(1)).as_bytes())?;
    Ok(stream)
}

/// Asks for the status once in each interval. Gives the number of answers, and the time of the slowest one.
fn ask(socket: PathBuf, ended: &AtomicBool, every: Duration) -> (u64, Duration) {
    let (mut answers, mut slowest, mut next) = (0, Duration::ZERO, Instant::now());
    while !ended.load(Ordering::Relaxed) {
        let asked = Instant::now();
        let mut answer = Vec::new();
        let whole = UnixStream::connect(&socket).and_then(|mut stream| {
            stream.write_all(b"GET /v1/status HTTP/1.0\r\n\r\n")?;
            stream.read_to_end(&mut answer)
        });
        if whole.is_ok() && answer.starts_with(b"HTTP/1.0 200") {
            answers += 1;
            slowest = slowest.max(asked.elapsed());
        }
        next += every;
        sleep(next.saturating_duration_since(Instant::now()));
    }
    (answers, slowest)
}
