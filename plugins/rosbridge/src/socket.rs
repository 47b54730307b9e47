//! The end of a WebSocket that is written: frames wait in a queue, and one thread writes them.

use std::collections::VecDeque;
use std::hash::{BuildHasher as _, RandomState};
use std::io::{self, Write as _};
use std::net::{Shutdown, TcpStream};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Bytes that wait to be written, at most: what comes then finds no room.
const MOST_WAITING: usize = 16 << 20;
/// Time between two signs of life, which the other end answers.
const BEAT: Duration = Duration::from_secs(2);
/// Time without a word of the other end after which the connection is given up, and for it to take what is written.
pub(crate) const QUIET: Duration = Duration::from_secs(10);
/// Time for what waits when a connection is closed.
const LINGER: Duration = Duration::from_secs(1);

/// What a frame is (RFC 6455, 5.2).
pub(crate) const CONTINUATION: u8 = 0;
pub(crate) const TEXT: u8 = 1;
pub(crate) const BINARY: u8 = 2;
pub(crate) const CLOSE: u8 = 8;
pub(crate) const PING: u8 = 9;
pub(crate) const PONG: u8 = 10;

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A connection, as those see it that send something.
pub(crate) struct Socket {
    stream: TcpStream,
    /// Chance for masks, which a client has to use.
    masks: Option<RandomState>,
    queue: Mutex<Queue>,
    /// Something in the queue has changed.
    changed: Condvar,
}

#[derive(Default)]
struct Queue {
    frames: VecDeque<Vec<u8>>,
    bytes: usize,
    count: u64,
    is_closed: bool,
    /// True once the thread that writes has ended.
    has_ended: bool,
}

impl Socket {
    pub(crate) fn new(stream: TcpStream, is_client: bool) -> io::Result<Socket> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(QUIET))?;
        stream.set_write_timeout(Some(QUIET))?;
        let masks = is_client.then(RandomState::new);
        Ok(Socket { stream, masks, queue: Mutex::default(), changed: Condvar::new() })
    }

    /// Sends a text. False: there is no room for it now.
    pub(crate) fn send(&self, text: &str) -> bool {
        self.put(TEXT, text.as_bytes())
    }

    /// Answers a sign of life.
    pub(crate) fn pong(&self, content: &[u8]) {
        self.put(PONG, content);
    }

    fn put(&self, kind: u8, content: &[u8]) -> bool {
        let mut queue = lock(&self.queue);
        if queue.is_closed {
            return true;
        }
        if queue.bytes > MOST_WAITING {
            return false;
        }
        queue.count += 1;
        let mask = self.masks.as_ref().map(|masks| (masks.hash_one(queue.count) as u32).to_le_bytes());
        let frame = frame(kind, content, mask);
        queue.bytes += frame.len();
        queue.frames.push_back(frame);
        drop(queue);
        self.changed.notify_all();
        true
    }

    /// Writes what waits, until the connection is closed or broken.
    pub(crate) fn write(&self) {
        // Whoever reads the connection notices that it is broken.
        let _ = self.write_all();
        lock(&self.queue).has_ended = true;
        self.changed.notify_all();
        let _ = self.stream.shutdown(Shutdown::Both);
    }

    fn write_all(&self) -> io::Result<()> {
        let mut due = Instant::now() + BEAT;
        loop {
            let mut queue = lock(&self.queue);
            let frame = queue.frames.pop_front();
            queue.bytes -= frame.as_ref().map_or(0, Vec::len);
            if let Some(frame) = frame {
                drop(queue);
                (&self.stream).write_all(&frame)?;
                continue;
            }
            if queue.is_closed {
                drop(queue);
                let mask = self.masks.as_ref().map(|_| [0; 4]);
                return (&self.stream).write_all(&frame_of_end(mask));
            }
            let now = Instant::now();
            if now >= due {
                drop(queue);
                self.put(PING, &[]);
                due = now + BEAT;
                continue;
            }
            drop(self.changed.wait_timeout(queue, due - now));
        }
    }

    /// Says that nothing more is sent.
    pub(crate) fn close(&self) {
        lock(&self.queue).is_closed = true;
        self.changed.notify_all();
    }

    /// Waits until what was sent is written, for a second at most, and ends the connection.
    pub(crate) fn finish(&self, begin: Instant) {
        let mut queue = lock(&self.queue);
        while !queue.has_ended {
            let Some(rest) = LINGER.checked_sub(begin.elapsed()) else { break };
            queue = self.changed.wait_timeout(queue, rest).unwrap_or_else(PoisonError::into_inner).0;
        }
        drop(queue);
        self.cut();
    }

    /// Ends the connection now.
    pub(crate) fn cut(&self) {
        let mut queue = lock(&self.queue);
        queue.is_closed = true;
        queue.frames.clear();
        queue.bytes = 0;
        drop(queue);
        self.changed.notify_all();
        let _ = self.stream.shutdown(Shutdown::Both);
    }
}

/// A frame that is whole.
pub(crate) fn frame(kind: u8, content: &[u8], mask: Option<[u8; 4]>) -> Vec<u8> {
    let mut frame = Vec::with_capacity(content.len() + 14);
    frame.push(0x80 | kind);
    let masked = if mask.is_some() { 0x80 } else { 0 };
    match content.len() {
        length @ ..126 => frame.push(masked | length as u8),
        length @ ..0x1_0000 => {
            frame.push(masked | 126);
            frame.extend_from_slice(&(length as u16).to_be_bytes());
        }
        length => {
            frame.push(masked | 127);
            frame.extend_from_slice(&(length as u64).to_be_bytes());
        }
    }
    match mask {
        None => frame.extend_from_slice(content),
        Some(mask) => {
            frame.extend_from_slice(&mask);
            frame.extend(content.iter().zip(mask.iter().cycle()).map(|(byte, mask)| byte ^ mask));
        }
    }
    frame
}

/// The last frame: a usual end.
fn frame_of_end(mask: Option<[u8; 4]>) -> Vec<u8> {
    frame(CLOSE, &1000_u16.to_be_bytes(), mask)
}
