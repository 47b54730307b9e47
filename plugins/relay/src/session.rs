//! The connections of a program: one to the relay, or, in the relay, one to each other program.

use std::collections::HashMap;
use std::io::{self, BufReader, BufWriter, Write};
use std::net::{Shutdown, TcpListener, TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use saoms_abi::{Bytes, Status, TransportEvents};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::boundary::Failure;
use crate::frame::{Frame, LONGEST, fits};

/// Bytes that wait for a connection, at most: what comes then is dropped, and the programs send it again.
const MOST_WAITING: usize = 64 << 20;
/// Pause before the relay is looked for again.
const PAUSE: Duration = Duration::from_millis(200);
/// Pause before a message is offered again for which the program had no room.
const ROOM_AGAIN: Duration = Duration::from_millis(1);
/// Longest time for an attempt to connect.
const PATIENCE: Duration = Duration::from_millis(900);
/// Time that the other ends have to take what waits for them when a session is closed.
const LINGER: Duration = Duration::from_secs(1);

/// What the program says when it opens a session.
#[derive(Debug, Deserialize)]
pub(crate) struct Settings {
    url: String,
    #[serde(default)]
    listen: bool,
    /// What a relay does not have: it lets everybody in, and encrypts nothing.
    user: Option<IgnoredAny>,
    users: Option<IgnoredAny>,
    access: Option<IgnoredAny>,
    tls: Option<IgnoredAny>,
}

impl Settings {
    /// The first setting that asks for what a relay does not have.
    pub(crate) fn unserved(&self) -> Option<&'static str> {
        let asked = [("user", &self.user), ("users", &self.users), ("access", &self.access), ("ca", &self.tls)];
        asked.into_iter().find(|(_, given)| given.is_some()).map(|(name, _)| name)
    }
}

/// Why a setting is refused.
pub(crate) const UNSERVED: &str = "a relay has neither users nor TLS: use a network of `tls://`";

/// A session: the threads of its connections share the rest.
pub(crate) struct Session {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared {
    address: String,
    /// The functions of the program; `None` once the session is closed. Who calls one holds this for reading.
    events: RwLock<Option<Program>>,
    /// What the program itself wants, by token.
    own: Mutex<HashMap<u64, Arc<str>>>,
    links: Mutex<Vec<Arc<Link>>>,
    is_relay: bool,
    is_closed: AtomicBool,
}

#[derive(Clone, Copy)]
struct Program(TransportEvents);

// SAFETY: by the rules of the boundary, the functions may be called from any thread with the state that comes with
// them.
unsafe impl Send for Program {}
// SAFETY: the same.
unsafe impl Sync for Program {}

/// A connection.
struct Link {
    stream: TcpStream,
    /// Where frames wait for the thread that writes them; `None` once the session is closed.
    out: Mutex<Option<Sender<Frame>>>,
    /// The size of those that wait, in bytes.
    waiting: AtomicUsize,
    /// What the other end wants.
    wanted: Mutex<Vec<Arc<str>>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session {
    pub(crate) fn open(settings: &Settings, events: TransportEvents) -> Result<Session, Failure> {
        if settings.unserved().is_some() {
            return Err(Failure::failed(UNSERVED));
        }
        let address = settings.url.strip_prefix("relay://").unwrap_or(&settings.url).to_owned();
        let shared = Arc::new(Shared {
            address,
            events: RwLock::new(Some(Program(events))),
            own: Mutex::default(),
            links: Mutex::default(),
            is_relay: settings.listen,
            is_closed: AtomicBool::new(false),
        });
        let own = Arc::clone(&shared);
        let thread = if settings.listen {
            let listener = TcpListener::bind(&shared.address).map_err(Failure::failed)?;
            thread::spawn(move || own.accept(&listener))
        } else {
            let stream = shared.connect().map_err(Failure::unreachable)?;
            thread::spawn(move || own.stay_connected(stream))
        };
        Ok(Session { shared, threads: vec![thread] })
    }

    pub(crate) fn put(&self, key: &str, message: &[u8], attachment: &[u8]) -> Result<(), Failure> {
        if message.len().max(attachment.len()) > LONGEST {
            return Err(Failure::failed(format!("it is longer than {LONGEST} bytes")));
        }
        let put = Frame::Put { key: key.into(), message: message.into(), attachment: attachment.into() };
        for link in lock(&self.shared.links).iter() {
            link.send(key, &put, self.shared.is_relay);
        }
        Ok(())
    }

    pub(crate) fn subscribe(&self, keys: &str, token: u64) {
        let keys: Arc<str> = keys.into();
        lock(&self.shared.own).insert(token, Arc::clone(&keys));
        self.shared.say(&Frame::Subscribe { keys });
    }

    pub(crate) fn unsubscribe(&self, token: u64) {
        if let Some(keys) = lock(&self.shared.own).remove(&token) {
            self.shared.say(&Frame::Unsubscribe { keys });
        }
    }

    pub(crate) fn close(self) {
        let Session { shared, threads } = self;
        shared.is_closed.store(true, Ordering::SeqCst);
        // From here on no function of the program is called: a call that runs is waited for.
        *shared.events.write().unwrap_or_else(PoisonError::into_inner) = None;
        // The threads that write send what waits; then the other ends close the connections.
        lock(&shared.links).iter().for_each(|link| drop(lock(&link.out).take()));
        let begin = Instant::now();
        while !lock(&shared.links).is_empty() && begin.elapsed() < LINGER {
            thread::sleep(Duration::from_millis(2));
        }
        lock(&shared.links).iter().for_each(|link| link.cut());
        if shared.is_relay {
            // The thread that accepts connections looks up.
            let _ = TcpStream::connect(&shared.address);
        }
        for thread in threads {
            let _ = thread.join();
        }
    }
}

impl Shared {
    /// Waits for other programs.
    fn accept(self: &Arc<Self>, listener: &TcpListener) {
        for stream in listener.incoming() {
            if self.is_closed.load(Ordering::SeqCst) {
                return;
            }
            let Ok(stream) = stream else { continue };
            let own = Arc::clone(self);
            thread::spawn(move || own.serve(stream));
        }
    }

    fn connect(&self) -> io::Result<TcpStream> {
        let mut last = io::Error::new(io::ErrorKind::NotFound, "the name has no address");
        for address in self.address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, PATIENCE) {
                Ok(stream) => return Ok(stream),
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Connects again whenever the connection to the relay ends.
    fn stay_connected(self: Arc<Self>, first: TcpStream) {
        let mut stream = Some(first);
        while !self.is_closed.load(Ordering::SeqCst) {
            match stream.take().map_or_else(|| self.connect(), Ok) {
                Ok(stream) => {
                    self.tell(true, "connected");
                    self.serve(stream);
                    self.tell(false, "the connection ended");
                }
                Err(_) => thread::sleep(PAUSE),
            }
        }
    }

    /// Serves a connection until it ends.
    fn serve(&self, stream: TcpStream) {
        let _ = stream.set_nodelay(true);
        let (out, waiting) = channel();
        let (Ok(for_reading), Ok(for_writing)) = (stream.try_clone(), stream.try_clone()) else { return };
        let out = Mutex::new(Some(out));
        let link = Arc::new(Link { stream, out, waiting: AtomicUsize::new(0), wanted: Mutex::default() });
        let own = Arc::clone(&link);
        let writer = thread::spawn(move || match own.write_all(&for_writing, &waiting) {
            Ok(()) => for_writing.shutdown(Shutdown::Write),
            Err(_) => for_writing.shutdown(Shutdown::Both),
        });
        lock(&self.links).push(Arc::clone(&link));
        for keys in lock(&self.own).values() {
            link.say(&Frame::Subscribe { keys: Arc::clone(keys) });
        }
        if self.is_closed.load(Ordering::SeqCst) {
            link.cut();
        }
        let mut reader = BufReader::new(for_reading);
        while let Ok(frame) = Frame::read(&mut reader) {
            match frame {
                Frame::Put { ref key, ref message, ref attachment } => {
                    if self.is_relay {
                        let links = lock(&self.links).clone();
                        links
                            .iter()
                            .filter(|other| !Arc::ptr_eq(other, &link))
                            .for_each(|other| other.send(key, &frame, true));
                    }
                    self.deliver(key, message, attachment);
                }
                Frame::Subscribe { keys } => lock(&link.wanted).push(keys),
                Frame::Unsubscribe { keys } => {
                    let mut wanted = lock(&link.wanted);
                    if let Some(place) = wanted.iter().position(|one| *one == keys) {
                        wanted.swap_remove(place);
                    }
                }
            }
        }
        link.cut();
        drop(lock(&link.out).take());
        lock(&self.links).retain(|other| !Arc::ptr_eq(other, &link));
        let _ = writer.join();
    }

    fn say(&self, frame: &Frame) {
        for link in lock(&self.links).iter() {
            link.say(frame);
        }
    }

    /// Delivers a message to the program. As long as that has no room for it, nothing more is read of the connection,
    /// so that who sends on it slows down.
    fn deliver(&self, key: &str, message: &[u8], attachment: &[u8]) {
        let tokens: Vec<u64> =
            lock(&self.own).iter().filter(|(_, keys)| fits(key, keys)).map(|(token, _)| *token).collect();
        for token in tokens {
            while self.offer(token, key, message, attachment) == Status::FULL {
                thread::sleep(ROOM_AGAIN);
            }
        }
    }

    /// Offers a message to the program, which wants none any more once the session is closed.
    fn offer(&self, token: u64, key: &str, message: &[u8], attachment: &[u8]) -> Status {
        let events = self.events.read().unwrap_or_else(PoisonError::into_inner);
        let Some(Program(events)) = *events else { return Status::OK };
        let (key, message, attachment) = (Bytes::text(key), Bytes::lend(message), Bytes::lend(attachment));
        // SAFETY: the session is open, so that the state is valid; the bytes live until the call returns.
        unsafe { (events.deliver)(events.state, token, key, message, attachment) }
    }

    fn tell(&self, is_up: bool, reason: &str) {
        let events = self.events.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(Program(events)) = *events {
            // SAFETY: the session is open, so that the state is valid; the text is constant.
            unsafe { (events.link)(events.state, u32::from(is_up), Bytes::text(reason)) };
        }
    }
}

impl Link {
    /// Sends a message, in a relay only to who wants it.
    fn send(&self, key: &str, frame: &Frame, asks: bool) {
        if !asks || lock(&self.wanted).iter().any(|keys| fits(key, keys)) {
            self.leave(frame);
        }
    }

    /// Says what the other end has to know: a connection on which there is no room for it is made again.
    fn say(&self, frame: &Frame) {
        if !self.leave(frame) {
            self.cut();
        }
    }

    /// Leaves a frame for the thread that writes; false if too much waits for it.
    fn leave(&self, frame: &Frame) -> bool {
        let has_room = self.waiting.load(Ordering::Relaxed) < MOST_WAITING;
        if let Some(out) = lock(&self.out).as_ref().filter(|_| has_room) {
            self.waiting.fetch_add(frame.size(), Ordering::Relaxed);
            let _ = out.send(frame.clone());
        }
        has_room
    }

    /// Ends the connection now.
    fn cut(&self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }

    /// Writes frames as they come, many at once where many wait.
    fn write_all(&self, stream: &TcpStream, waiting: &Receiver<Frame>) -> io::Result<()> {
        let mut out = BufWriter::new(stream);
        let write = |frame: &Frame, out: &mut BufWriter<_>| {
            self.waiting.fetch_sub(frame.size(), Ordering::Relaxed);
            frame.write(out)
        };
        while let Ok(frame) = waiting.recv() {
            write(&frame, &mut out)?;
            while let Ok(frame) = waiting.try_recv() {
                write(&frame, &mut out)?;
            }
            out.flush()?;
        }
        Ok(())
    }
}
