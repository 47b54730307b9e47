//! The thread of a program's part of a network.

mod enter;
mod link;
mod member;
#[cfg(test)]
mod tests;
mod unsent;
mod waits;

use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::{JoinHandle, sleep};
use std::time::Duration;

use saoms_api::host::contain::contained;

use super::fleet::{Fleet, Membership};
use super::key;
use super::port::{AtOnce, Port};
use super::topics::{TopicFleet, TopicMember, TopicMembership};
use super::transport::{Delivered, TopicSession, TransportSession};
pub use enter::{Entered, Entrance, Entry, Refused};
use member::{Linger, Member};

/// Tokens of subscriptions.
const ALIVE: u64 = 1;
const ASK: u64 = 2;
const COVERED: u64 = 3;
const ACCESS: u64 = 4;
const CALL: u64 = 5;
const REPLY: u64 = 6;
const CONTROL: u64 = 7;
const LOOK: u64 = 8;
const BEGINS: u64 = 9;
const RUNS: u64 = 10;
/// From here on those of topics.
const FIRST_OF_TOPICS: u64 = 16;

/// Time between two looks at what others say, in nanoseconds, after which the thread was held up, as by SIGSTOP: what
/// they said meanwhile has not arrived yet.
const HELD_UP: u64 = 500_000_000;

/// Time between two looks at whether a run has started that cannot go on.
const START_LOOK: Duration = Duration::from_millis(10);

/// A program's part of a network. Dropping it leaves the network.
#[derive(Debug)]
pub struct Client {
    port: Arc<Port>,
    /// Until others are to hear of the program, what lets its thread begin.
    gate: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Client {
    /// Prepares to take part in a network: no other program hears of this one before it [begins](Self::begin).
    ///
    /// # Errors
    /// The system refuses a thread: why.
    pub fn prepare(entered: Entered, membership: Membership, fleet: impl Fleet) -> Result<Client, String> {
        let Entered { session, port, settings } = entered;
        let member = Arc::new(Mutex::new(Member::new(session, &port, settings, membership, fleet)));
        let own = Arc::clone(&port);
        Client::with(port, move |begins| {
            if !begins {
                own.end();
                let session = lock(&member).take_session();
                return drop(session);
            }
            let at_once: Weak<Mutex<Member<_>>> = Arc::downgrade(&member);
            own.let_take(at_once);
            let ended = contained(|| run(&member, &own)).unwrap_or_else(|failure| Err(failure.to_string()));
            if let Err(failure) = ended {
                break_down(&member, &own, &failure);
            }
        })
    }

    /// Prepares to take part in a network of programs that do not speak our language, which delivers to the port.
    ///
    /// # Errors
    /// The system refuses a thread: why.
    pub fn prepare_topics(
        session: TopicSession,
        port: &Arc<Port>,
        membership: TopicMembership,
        fleet: impl TopicFleet,
    ) -> Result<Client, String> {
        let own = Arc::clone(port);
        let mut member = TopicMember::new(session, membership, fleet);
        Client::with(Arc::clone(port), move |begins| {
            if !begins {
                return own.end();
            }
            let Err(failure) = contained(|| member.run(&own)) else { return };
            own.end();
            let text = member.break_down(&failure.to_string());
            while !member.has_started() && !own.is_closed() {
                sleep(START_LOOK);
            }
            member.fail(text);
        })
    }

    /// A client whose thread does this: with false where the program does not begin, and leaves without a word.
    fn with(port: Arc<Port>, run: impl FnOnce(bool) + Send + 'static) -> Result<Client, String> {
        let (gate, is_open) = channel();
        let thread = std::thread::Builder::new().name("saoms-network".to_owned());
        let thread = thread.spawn(move || run(is_open.recv().is_ok())).map_err(|error| error.to_string())?;
        Ok(Client { port, gate: Some(gate), thread: Some(thread) })
    }

    /// Takes part in the network from now on.
    pub fn begin(&mut self) {
        if let Some(gate) = self.gate.take() {
            // Its thread waits for nothing else.
            let _ = gate.send(());
        }
    }
}

/// Subscribes to what programs say to this one beside the messages of components.
///
/// # Errors
/// The transport refuses it: why.
fn subscribe(session: &TransportSession, program: u64, membership: &Membership) -> Result<(), String> {
    // Those of other versions, too: they are told.
    session.subscribe(&key::alive_of_all(), ALIVE)?;
    session.subscribe(&key::ask(program), ASK)?;
    session.subscribe(&key::covered(program), COVERED)?;
    session.subscribe(&key::look(program), LOOK)?;
    if membership.has_calls {
        session.subscribe(&key::call(program), CALL)?;
        session.subscribe(&key::reply(program), REPLY)?;
    }
    session.subscribe(&key::control_of_all(), CONTROL)?;
    if membership.user.is_some() {
        session.subscribe(&key::access(), ACCESS)?;
    }
    Ok(())
}

impl Client {
    /// Begins to leave the network. Others receive what they lack before the client is dropped; of several networks,
    /// all at the same time.
    pub fn close(&self) {
        self.port.close(false);
    }

    /// Leaves the network, and waits for nobody: the run has not begun.
    pub fn abandon(self) {
        self.port.close(true);
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.gate = None;
        self.port.close(false);
        if let Some(thread) = self.thread.take() {
            // Its panic was written to standard error.
            let _ = thread.join();
        }
    }
}

/// What the thread of a network does.
///
/// # Errors
/// What another thread did for this one has failed: how.
fn run<F: Fleet>(shared: &Mutex<Member<F>>, port: &Port) -> Result<(), String> {
    let mut ending: Option<Linger> = None;
    let mut member = lock(shared);
    let mut looked = member.now();
    loop {
        let sleep = member.sleep();
        drop(member);
        port.wait(sleep, ending.is_some());
        member = lock(shared);
        if let Some(failure) = member.broken.take() {
            return Err(failure);
        }
        let before = std::mem::replace(&mut looked, member.now());
        if looked - before > HELD_UP {
            member.exchange.hold_up(looked - before, looked);
        }
        // What was left until it had started is taken, too.
        let has_started = member.is_joining() && member.fleet.has_started();
        let waiting = port.take();
        let (is_closed, is_abandoned) = (waiting.is_closed, waiting.is_abandoned);
        let has_time = waiting.has_no_more_than_messages();
        member.take(waiting);
        if has_started {
            member.tell_joined();
        }
        if !(has_time && member.has_time()) || is_closed {
            member.attend();
        }
        if is_closed {
            let ending = ending.get_or_insert_with(|| Linger::begin(&member));
            if is_abandoned || !member.lingers(ending) {
                break;
            }
        }
    }
    // Closing waits for what the transport delivers just now, which may want the member.
    let session = member.end();
    drop(member);
    drop(session);
    Ok(())
}

/// The thread of the network has failed, by a fault of this program: nothing more leaves or comes, and the run fails.
fn break_down<F: Fleet>(shared: &Mutex<Member<F>>, port: &Port, failure: &str) {
    port.end();
    let mut member = lock(shared);
    let text = member.break_down(failure);
    let session = member.take_session();
    drop(member);
    drop(session);
    // A run that starts cannot be ended yet.
    while !lock(shared).fleet.has_started() && !port.is_closed() {
        sleep(START_LOOK);
    }
    lock(shared).fleet.fail(text);
}

fn lock<F>(member: &Mutex<Member<F>>) -> MutexGuard<'_, Member<F>> {
    member.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<F: Fleet> AtOnce for Mutex<Member<F>> {
    fn take(&self, delivered: &Delivered<'_>) -> bool {
        if delivered.token < FIRST_OF_TOPICS {
            return false;
        }
        // Whoever has it may be about to put something, and the transport may deliver meanwhile.
        let Ok(mut member) = self.try_lock() else { return false };
        match contained(|| member.take_at_once(delivered)) {
            Ok(()) => true,
            Err(failure) => member.fail_at_once(failure.to_string()),
        }
    }

    fn send(&self) -> bool {
        let Ok(mut member) = self.try_lock() else { return false };
        // A fault of the exchange ends no component that sends.
        match contained(|| member.send_at_once()) {
            Ok(is_sent) => is_sent,
            Err(failure) => member.fail_at_once(failure.to_string()),
        }
    }
}
