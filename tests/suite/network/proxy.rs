//! A bad line: a proxy between a program and its broker.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

/// What a line does to the bytes on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Line {
    /// How late they come.
    pub(super) delay: Duration,
    /// How many come at once, with a pause after them; 0: all.
    pub(super) few: usize,
}

/// The proxy. Its connections end with it.
pub(super) struct Proxy {
    /// The port at which it listens.
    pub(super) port: u16,
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    streams: Mutex<Vec<TcpStream>>,
    /// Whether the present connections are dead.
    are_dead: Mutex<Arc<AtomicBool>>,
    is_over: AtomicBool,
    /// Bytes that came from the far end, and from the near one.
    received: Arc<AtomicU64>,
    sent: Arc<AtomicU64>,
}

impl Proxy {
    /// A line to the program that listens at this port.
    pub(super) fn to(port: u16, line: Line) -> Proxy {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let own = listener.local_addr().unwrap().port();
        let shared = Arc::<Shared>::default();
        let of_thread = Arc::clone(&shared);
        spawn(move || {
            for near in listener.incoming() {
                if of_thread.is_over.load(Ordering::SeqCst) {
                    return;
                }
                // Where nobody listens, the connection ends at once.
                let (Ok(near), Ok(far)) = (near, TcpStream::connect(("127.0.0.1", port))) else { continue };
                for stream in [&near, &far] {
                    stream.set_nodelay(true).unwrap();
                    of_thread.streams.lock().unwrap().push(stream.try_clone().unwrap());
                }
                let is_dead = Arc::clone(&of_thread.are_dead.lock().unwrap());
                let (from, to) = (near.try_clone().unwrap(), far.try_clone().unwrap());
                carry(from, to, line, Arc::clone(&is_dead), Arc::clone(&of_thread.sent));
                carry(far, near, line, is_dead, Arc::clone(&of_thread.received));
            }
        });
        Proxy { port: own, shared }
    }

    /// Bytes that came from the program that it leads to.
    pub(super) fn received(&self) -> u64 {
        self.shared.received.load(Ordering::SeqCst)
    }

    /// Bytes that went to that program.
    pub(super) fn sent(&self) -> u64 {
        self.shared.sent.load(Ordering::SeqCst)
    }

    /// Ends all connections.
    pub(super) fn cut(&self) {
        *self.shared.are_dead.lock().unwrap() = Arc::default();
        for stream in self.shared.streams.lock().unwrap().drain(..) {
            let _ = stream.shutdown(Shutdown::Both);
        }
    }

    /// Swallows what comes on the present connections, in both directions, and nobody notices.
    pub(super) fn swallow(&self) {
        self.shared.are_dead.lock().unwrap().store(true, Ordering::SeqCst);
    }
}

impl Drop for Proxy {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::SeqCst);
        self.cut();
        let _ = TcpStream::connect(("127.0.0.1", self.port));
    }
}

/// Carries bytes in one direction.
fn carry(mut from: TcpStream, mut to: TcpStream, line: Line, is_dead: Arc<AtomicBool>, count: Arc<AtomicU64>) {
    let (late, due) = channel::<(Instant, Vec<u8>)>();
    spawn(move || {
        let mut bytes = vec![0; 64 << 10];
        while let Ok(size @ 1..) = from.read(&mut bytes) {
            count.fetch_add(size as u64, Ordering::SeqCst);
            if !is_dead.load(Ordering::SeqCst) {
                let _ = late.send((Instant::now() + line.delay, bytes[..size].to_owned()));
            }
        }
    });
    spawn(move || {
        for (at, bytes) in due {
            sleep(at.saturating_duration_since(Instant::now()));
            for some in bytes.chunks(if line.few == 0 { bytes.len() } else { line.few }) {
                if to.write_all(some).is_err() {
                    return;
                }
                if line.few > 0 {
                    sleep(Duration::from_micros(50));
                }
            }
        }
        // The other end said its last.
        let _ = to.shutdown(Shutdown::Write);
    });
}
