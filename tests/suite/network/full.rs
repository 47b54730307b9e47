//! A program that has no room for what its transport delivers.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

use saoms_core::network::transport::{Delivered, Opened, Receiver, SessionSettings, Transport, TransportSession};

use super::programs::free_port;
use crate::plugins::library;

/// Longest time for something that has to happen.
const LONGEST: Duration = Duration::from_secs(60);
/// Messages of ten kilobytes: more than the system keeps for a connection.
const MESSAGES: u32 = 2_000;

/// A program that has room only when it is told so.
#[derive(Default)]
struct Program {
    has_room: AtomicBool,
    /// True once it has heard the message that has no number, for which there is always room.
    is_joined: AtomicBool,
    /// The numbers of the messages that it was offered, and of those that it has taken.
    offered: Mutex<Vec<u32>>,
    taken: Mutex<Vec<u32>>,
}

impl Receiver for Program {
    fn deliver(&self, delivered: Delivered<'_>) -> bool {
        let number = u32::from_le_bytes(delivered.message[..4].try_into().unwrap());
        if number == 0 {
            self.is_joined.store(true, Ordering::SeqCst);
            return true;
        }
        self.offered.lock().unwrap().push(number);
        let has_room = self.has_room.load(Ordering::SeqCst);
        if has_room {
            self.taken.lock().unwrap().push(number);
        }
        has_room
    }

    fn link(&self, _is_up: bool, _reason: &str) {}
}

fn open(url: &str, listen: bool, program: &Arc<Program>) -> TransportSession {
    let transport = Transport::find(url, &[library("saoms_relay")]).unwrap();
    let (account, users, access, tls) = (None, Vec::new(), Vec::new(), None);
    let settings = SessionSettings { url: url.to_owned(), listen, peer: None, account, users, access, tls };
    match TransportSession::open(transport, &settings, Arc::clone(program) as Arc<_>).unwrap() {
        Opened::Session(session) => session,
        Opened::Unreachable(why) => panic!("{why}"),
    }
}

/// A relay whose program has no room, to which another one has sent all messages.
fn full() -> (Arc<Program>, TransportSession, TransportSession) {
    let url = format!("relay://127.0.0.1:{}", free_port());
    let program = Arc::<Program>::default();
    let relay = open(&url, true, &program);
    relay.subscribe("numbers/*", 1).unwrap();
    let sender = open(&url, false, &Arc::default());
    until("the relay hears the sender", || {
        sender.put("numbers/all", &[0; 4], &[], false).unwrap() && program.is_joined.load(Ordering::SeqCst)
    });
    for number in 1..=MESSAGES {
        let mut message = number.to_le_bytes().to_vec();
        message.resize(10_000, 0);
        assert!(sender.put("numbers/all", &message, &[], false).unwrap());
    }
    until("the first message is offered again and again", || program.offered.lock().unwrap().len() > 20);
    (program, relay, sender)
}

#[track_caller]
fn until(what: &str, is: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is() {
        assert!(begin.elapsed() < LONGEST, "{what}");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_relay_reads_no_more_until_its_program_has_room_and_loses_nothing() {
    let (program, relay, sender) = full();
    assert!(program.offered.lock().unwrap().iter().all(|number| *number == 1), "nothing more was read");
    program.has_room.store(true, Ordering::SeqCst);
    until("all are taken", || program.taken.lock().unwrap().len() >= MESSAGES as usize);
    // Each once, and in order: nobody has to ask for one again.
    let taken = program.taken.lock().unwrap().clone();
    assert!(taken.iter().copied().eq(1..=MESSAGES), "{taken:?}");
    drop((sender, relay));
}

#[test]
fn a_relay_whose_program_has_no_room_can_be_closed() {
    let (program, relay, sender) = full();
    let (closed, is_closed) = channel();
    spawn(move || {
        drop((relay, sender));
        closed.send(()).unwrap();
    });
    is_closed.recv_timeout(LONGEST).unwrap();
    assert!(program.taken.lock().unwrap().is_empty());
}
