//! The client of a rosbridge server: one thread connects, and connects again, and reads; another one writes.

use std::io::{BufReader, ErrorKind};
use std::net::TcpStream;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use saoms_transport::{Failure, Program, Topic, connect};
use serde_json::json;

use crate::handshake;
use crate::incoming::{Incoming, Said};
use crate::op::{Op, bare, publish};
use crate::session::Topics;
use crate::socket::{Socket, lock};

/// Longest time for the server to answer while the program joins.
const JOINING: Duration = Duration::from_millis(400);
/// Pause before the server is tried again.
const PAUSE: Duration = Duration::from_millis(200);

/// A client that has joined a server.
pub(crate) struct Client {
    shared: Arc<Shared>,
    thread: JoinHandle<()>,
}

struct Shared {
    address: String,
    program: Program,
    /// Held while something is sent, so that a server hears of a topic before its messages.
    topics: Mutex<Topics>,
    link: Mutex<Link>,
    changed: Condvar,
}

#[derive(Default)]
struct Link {
    socket: Option<Arc<Socket>>,
    is_closed: bool,
}

/// A connection that is joined.
struct Joined {
    socket: Arc<Socket>,
    from: BufReader<TcpStream>,
}

impl Client {
    pub(crate) fn open(address: &str, program: Program) -> Result<Client, Failure> {
        let joined = join(address)?;
        let (topics, changed) = Default::default();
        let link = Mutex::new(Link { socket: Some(Arc::clone(&joined.socket)), is_closed: false });
        let shared = Arc::new(Shared { address: address.to_owned(), program, topics, link, changed });
        let own = Arc::clone(&shared);
        let thread = thread::Builder::new().name("saoms-rosbridge".to_owned());
        let thread = thread.spawn(move || own.stay_joined(joined)).map_err(Failure::failed)?;
        Ok(Client { shared, thread })
    }

    pub(crate) fn advertise(&self, topic: &Topic, token: u64) -> Result<(), Failure> {
        let mut topics = lock(&self.shared.topics);
        topics.advertise(topic, token)?;
        self.shared.say(&advertise(&topic.name, &topic.kind, topic.state));
        Ok(())
    }

    pub(crate) fn subscribe(&self, topic: &Topic, token: u64) -> Result<(), Failure> {
        let mut topics = lock(&self.shared.topics);
        topics.subscribe(topic, token)?;
        self.shared.say(&subscribe(&topic.name, &topic.kind));
        Ok(())
    }

    pub(crate) fn publish(&self, token: u64, of: u64, message: &[u8]) -> Result<(), Failure> {
        let mut topics = lock(&self.shared.topics);
        let (name, form) = topics.published(token)?;
        let text: Arc<str> = form.to_json(message).map_err(Failure::failed)?.to_string().into();
        let Some(known) = topics.all.get_mut(&name) else { return Ok(()) };
        known.keep(of, &text);
        // What is said while the link is away waits in the program.
        let socket = lock(&self.shared.link).socket.clone().ok_or_else(Failure::full)?;
        if !socket.send(&publish(&format!("/{name}"), &text)) {
            return Err(Failure::full());
        }
        known.note_own(message);
        Ok(())
    }

    pub(crate) fn close(self) {
        self.shared.program.leave();
        let mut link = lock(&self.shared.link);
        link.is_closed = true;
        let socket = link.socket.take();
        drop(link);
        self.shared.changed.notify_all();
        if let Some(socket) = socket {
            socket.close();
            socket.finish(Instant::now());
        }
        let _ = self.thread.join();
    }
}

fn advertise(name: &str, kind: &str, is_state: bool) -> String {
    let (topic, id) = (format!("/{name}"), format!("saoms:advertise:{name}"));
    json!({"op": "advertise", "id": id, "topic": topic, "type": kind, "latch": is_state}).to_string()
}

fn subscribe(name: &str, kind: &str) -> String {
    let (topic, id) = (format!("/{name}"), format!("saoms:subscribe:{name}"));
    json!({"op": "subscribe", "id": id, "topic": topic, "type": kind}).to_string()
}

fn join(address: &str) -> Result<Joined, Failure> {
    let stream = connect(address)?;
    stream.set_read_timeout(Some(JOINING)).map_err(Failure::unreachable)?;
    let from = handshake::ask(&stream, address).map_err(|error| match error.kind() {
        ErrorKind::InvalidData => Failure::failed(error),
        ErrorKind::WouldBlock | ErrorKind::TimedOut => {
            Failure::unreachable("it does not answer as a rosbridge server does: another program may have this port")
        }
        _ => Failure::unreachable("who listens there ends the connection"),
    })?;
    let socket = Arc::new(Socket::new(stream, true).map_err(Failure::unreachable)?);
    Ok(Joined { socket, from })
}

impl Shared {
    /// Reads, and connects again, until the session is closed.
    fn stay_joined(&self, first: Joined) {
        let mut joined = Some(first);
        let mut told = String::new();
        loop {
            if let Some(Joined { socket, from }) = joined.take() {
                let why = self.read(&socket, from);
                let mut link = lock(&self.link);
                if link.is_closed {
                    return;
                }
                link.socket = None;
                drop(link);
                self.program.link(false, &why);
                told = why;
            }
            let mut link = lock(&self.link);
            if !link.is_closed {
                link = self.changed.wait_timeout(link, PAUSE).unwrap_or_else(PoisonError::into_inner).0;
            }
            if link.is_closed {
                return;
            }
            drop(link);
            match join(&self.address) {
                Ok(again) => {
                    self.program.link(true, "");
                    joined = self.say_again(&again.socket).then_some(again);
                }
                Err(Failure { status, text }) => {
                    // That nobody listens goes without saying.
                    if status == saoms_transport::Status::FAILED && told != text {
                        self.program.link(false, &text);
                        told = text;
                    }
                }
            }
        }
    }

    /// Says all that a server has to know. False once the session is closed.
    fn say_again(&self, socket: &Arc<Socket>) -> bool {
        let topics = lock(&self.topics);
        for (name, known) in &topics.all {
            if known.is_published {
                socket.send(&advertise(name, &known.form.kind, known.is_state));
            }
            if known.read.is_some() {
                socket.send(&subscribe(name, &known.form.kind));
            }
            known.states.values().for_each(|message| _ = socket.send(&publish(&format!("/{name}"), message)));
        }
        let mut link = lock(&self.link);
        if !link.is_closed {
            link.socket = Some(Arc::clone(socket));
        }
        !link.is_closed
    }

    /// Says something while there is a link; else it is said when there is one.
    fn say(&self, text: &str) {
        if let Some(socket) = &lock(&self.link).socket {
            socket.send(text);
        }
    }

    /// Takes what the server says until the connection ends: why it does.
    fn read(&self, socket: &Arc<Socket>, from: BufReader<TcpStream>) -> String {
        thread::scope(|scope| {
            scope.spawn(|| socket.write());
            let mut incoming = Incoming::new(from, false);
            let why = loop {
                match incoming.next() {
                    Ok(Said::Text(text)) => self.hear(&text),
                    Ok(Said::Ping(content)) => socket.pong(&content),
                    Ok(Said::Nothing) => {}
                    Ok(Said::End) => break "the server ends the connection".to_owned(),
                    Err(error) => match error.kind() {
                        ErrorKind::WouldBlock | ErrorKind::TimedOut => break "the server says nothing".to_owned(),
                        ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset => break "the server is away".to_owned(),
                        _ => break error.to_string(),
                    },
                }
            };
            socket.cut();
            why
        })
    }

    fn hear(&self, text: &str) {
        let op = match serde_json::from_str::<Op>(text) {
            Ok(op) => op,
            Err(error) => return self.program.link(true, &format!("the server says what is no rosbridge: {error}")),
        };
        match op.op.as_str() {
            "publish" => self.take(op),
            "status" if !matches!(op.level.as_deref(), Some("info" | "none")) => {
                let said = op.msg.as_str().unwrap_or_default();
                self.program.link(true, &format!("the server says: {said}"));
            }
            _ => {}
        }
    }

    /// Takes a message of a topic.
    fn take(&self, op: Op) {
        let name = bare(&op.topic);
        let topics = lock(&self.topics);
        let known = topics.all.get(name).and_then(|known| Some((Arc::clone(&known.form), known.read?)));
        drop(topics);
        let Some((form, token)) = known else { return };
        match form.to_cdr(op.msg) {
            Ok(message) => {
                let is_own = lock(&self.topics).all.get_mut(name).is_some_and(|known| known.is_own(&message));
                if !is_own {
                    self.program.deliver(token, "", &message);
                }
            }
            Err(why) => self.program.refuse(token, "", &why),
        }
    }
}
