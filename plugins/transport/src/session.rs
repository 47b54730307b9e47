//! A session at a broker of others: one thread connects, and connects again, and reads; another one writes.

use std::hash::{BuildHasher as _, RandomState};
use std::io::BufReader;
use std::marker::PhantomData;
use std::sync::{Arc, Condvar, Mutex, PoisonError, RwLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use saoms_abi::{Bytes, Status, TransportEvents};

use crate::connect::{ACTIVE_MQ, Greeting, connect, is_active_mq};
use crate::language::{Ended, Heard, Language, Message, fits, not_read};
use crate::link::{Connected, Incoming, Link, broken, lock};
use crate::waiting::{BATCH, Queue, Subscription, Subscriptions};
use crate::{Failure, Settings, Transport};

#[cfg(test)]
mod tests;

/// Longest time for the broker to answer while a program opens a network of a fleet, which has a second for that and
/// tries again.
const OPENING: Duration = Duration::from_millis(400);
/// The same where nobody waits for it, or may wait longer: a broker that asks a directory for an account, or hashes its
/// password, takes its time, and so does a long link.
const JOINING: Duration = Duration::from_secs(5);
/// Time for which a greeting is waited for.
const GREETING: Duration = Duration::from_millis(100);
/// Pause before the broker is tried again.
const PAUSE: Duration = Duration::from_millis(200);
/// The same where it has refused the program.
const REFUSED: Duration = Duration::from_secs(1);
/// Time between two signs of life, which the broker answers, or gives signs of its own.
const BEAT: Duration = Duration::from_secs(1);
/// Time without a word of the broker after which the connection is given up.
const QUIET: Duration = Duration::from_secs(5);
/// Bytes that wait to be written, at most: what comes then finds no room.
const MOST_WAITING: usize = 4 << 20;
/// The same for the urgent ones, which are few.
const MOST_URGENT: usize = 1 << 20;
/// Pause before a message is offered again for which the program had no room.
const ROOM_AGAIN: Duration = Duration::from_millis(1);
/// Time for what waits, and for the broker to end the connection, when a session is closed.
const LINGER: Duration = Duration::from_secs(1);

/// A session at a broker that speaks a language. Dropping it leaves the network: who hears it is not called any more.
pub struct Session<L> {
    shared: Arc<Shared>,
    /// There until it is dropped.
    thread: Option<JoinHandle<()>>,
    language: PhantomData<fn() -> L>,
}

struct Shared {
    settings: Settings,
    /// The name of this session at the broker.
    name: String,
    /// The program; `None` once the session is closed. Who calls it holds this for reading.
    listener: RwLock<Option<Box<dyn Listener>>>,
    subscriptions: Mutex<Subscriptions>,
    queue: Mutex<Queue>,
    /// Something in the queue has changed.
    changed: Condvar,
    /// What was said last of the link.
    told: Mutex<(bool, String)>,
}

/// Who hears what comes over a session, from threads of that.
pub trait Listener: Send + Sync {
    /// A message of the subscription with this token. False: there is no room for it now, and it comes again.
    fn deliver(&self, token: u64, message: Message<'_>) -> bool;

    /// The link was lost, or is there again, with a reason for people.
    fn link(&self, is_up: bool, reason: &str);
}

/// A program behind the boundary.
struct Program(TransportEvents);

// SAFETY: by the rules of the boundary, the functions may be called from any thread with the state that comes with
// them.
unsafe impl Send for Program {}
// SAFETY: the same.
unsafe impl Sync for Program {}

impl Listener for Program {
    fn deliver(&self, token: u64, Message { key, message, attachment }: Message<'_>) -> bool {
        let Program(events) = self;
        let (key, message, attachment) = (Bytes::text(key), Bytes::lend(message), Bytes::lend(attachment));
        // SAFETY: the session is open, so that the state is valid; the bytes live until the call returns.
        unsafe { (events.deliver)(events.state, token, key, message, attachment) != Status::FULL }
    }

    fn link(&self, is_up: bool, reason: &str) {
        let Program(events) = self;
        // SAFETY: the session is open, so that the state is valid; the text lives until the call returns.
        unsafe { (events.link)(events.state, u32::from(is_up), Bytes::text(reason)) };
    }
}

/// A connection that is joined.
struct Joined<L> {
    link: Arc<Link>,
    from: BufReader<Incoming>,
    language: L,
}

impl<L: Language> Session<L> {
    /// Joins a broker.
    ///
    /// # Errors
    /// It cannot be joined, now or at all.
    pub fn join(settings: Settings, listener: Box<dyn Listener>) -> Result<Self, Failure> {
        if let Some((_, text)) = settings.judge::<L>().into_iter().next() {
            return Err(Failure::failed(text));
        }
        let patience = if settings.is_of_fleet { OPENING } else { JOINING };
        let shared = Arc::new(Shared {
            settings,
            name: format!("saoms{:016x}", RandomState::new().hash_one(std::process::id())),
            listener: RwLock::new(Some(listener)),
            subscriptions: Mutex::default(),
            queue: Mutex::default(),
            changed: Condvar::new(),
            told: Mutex::new((true, String::new())),
        });
        let joined = shared.join::<L>(patience)?;
        let own = Arc::clone(&shared);
        let thread = thread::Builder::new().name(format!("saoms-{}", L::NAME.to_ascii_lowercase()));
        // From here on messages are sent, even if the thread begins later.
        shared.connected::<L>(&joined);
        let thread = thread.spawn(move || own.stay_joined(joined)).map_err(Failure::failed)?;
        Ok(Session { shared, thread: Some(thread), language: PhantomData })
    }
}

impl<L: Language> Transport for Session<L> {
    fn open(settings: &str, events: TransportEvents) -> Result<Self, Failure> {
        Session::join(Settings::read(settings)?, Box::new(Program(events)))
    }

    fn judge(settings: &str) -> Result<Vec<(&'static str, String)>, Failure> {
        Ok(Settings::read(settings)?.judge::<L>())
    }

    fn put(&self, key: &str, message: &[u8], attachment: &[u8], is_urgent: bool) -> Result<(), Failure> {
        let frame = L::put(&self.shared.name, Message { key, message, attachment }).map_err(Failure::failed)?;
        let mut queue = lock(&self.shared.queue);
        if queue.link.is_none() {
            // What is said while the link is away is lost, as over any transport.
            return Ok(());
        }
        if frame.len() > queue.longest {
            let longest = queue.longest;
            return Err(Failure::failed(format!("the broker takes no message above {longest} bytes")));
        }
        let (lane, most) = match is_urgent {
            true => (&mut queue.urgent, MOST_URGENT),
            false => (&mut queue.usual, MOST_WAITING),
        };
        if lane.bytes > most {
            return Err(Failure::full());
        }
        lane.add(frame);
        drop(queue);
        self.shared.changed.notify_all();
        Ok(())
    }

    fn subscribe(&self, keys: &str, token: u64) -> Result<(), Failure> {
        let mut subscriptions = lock(&self.shared.subscriptions);
        if let Some(known) = subscriptions.all.get_mut(keys) {
            known.tokens.push(token);
            return Ok(());
        }
        let number = subscriptions.free().ok_or_else(|| Failure::failed("there are too many subscriptions"))?;
        let frame = L::subscribe(number, keys).map_err(Failure::failed)?;
        subscriptions.all.insert(keys.into(), Subscription { number, tokens: vec![token] });
        // Others are asked in the order in which the program does it.
        self.shared.say(frame);
        Ok(())
    }

    fn unsubscribe(&self, token: u64) -> Result<(), Failure> {
        let mut subscriptions = lock(&self.shared.subscriptions);
        let Some((keys, number)) = subscriptions.remove(token) else { return Ok(()) };
        self.shared.say(L::unsubscribe(number, &keys));
        Ok(())
    }

    fn close(self) {
        drop(self);
    }
}

impl<L> Drop for Session<L> {
    fn drop(&mut self) {
        let shared = &self.shared;
        // From here on the program is not called: a call that runs is waited for.
        *shared.listener.write().unwrap_or_else(PoisonError::into_inner) = None;
        let mut queue = lock(&shared.queue);
        queue.is_closed = true;
        shared.changed.notify_all();
        if let Some(joining) = queue.joining.take() {
            joining.cut();
        }
        // The thread that writes sends what waits; then the broker ends the connection.
        let begin = Instant::now();
        while !queue.has_ended {
            let Some(rest) = LINGER.checked_sub(begin.elapsed()) else { break };
            queue = shared.changed.wait_timeout(queue, rest).unwrap_or_else(PoisonError::into_inner).0;
        }
        if let Some(link) = &queue.link {
            link.cut();
        }
        drop(queue);
        if let Some(thread) = self.thread.take() {
            // Its panic was written to standard error.
            let _ = thread.join();
        }
    }
}

fn greets_as_active_mq(settings: &Settings) -> bool {
    connect(settings.address()).is_ok_and(|stream| Greeting::of(&stream, GREETING) == Greeting::ActiveMq)
}

/// Who listens there, as far as what is said there tells.
fn foreign<L: Language>(bytes: &[u8], settings: &Settings) -> String {
    match bytes {
        _ if is_active_mq(bytes) => format!(
            "an ActiveMQ broker listens there, over OpenWire, which is for programs in Java: name the port of its \
             connector for STOMP, such as `stomp://{}:61613`",
            settings.host()
        ),
        // An alert, or a greeting, of TLS.
        [0x15 | 0x16, 3, ..] => {
            format!("who listens there speaks TLS: write `{}://{}`", L::WITH_TLS, settings.address())
        }
        _ => format!("who listens there does not speak {}: another program has this port", L::NAME),
    }
}

impl Shared {
    /// Connects, and joins; a broker that says nothing for so long is given up.
    fn join<L: Language>(&self, patience: Duration) -> Result<Joined<L>, Failure> {
        let settings = &self.settings;
        let link = Link::connect(settings)?;
        let mut queue = lock(&self.queue);
        if queue.is_closed {
            return Err(Failure::unreachable("the session is closed"));
        }
        // Who closes the session does not wait for the broker.
        queue.joining = Some(link.cutter()?);
        drop(queue);
        let joined = self.join_over(link, patience);
        lock(&self.queue).joining = None;
        joined
    }

    fn join_over<L: Language>(&self, link: Connected, patience: Duration) -> Result<Joined<L>, Failure> {
        let settings = &self.settings;
        let link = link.open::<L>(settings, patience)?;
        let mut from = BufReader::with_capacity(BATCH, link.incoming());
        let language = L::join(settings, &self.name, &mut from, &link).map_err(|ended| match ended {
            // One that ends what it does not understand may have a greeting for who says nothing.
            Ended::Broken(_) if !settings.is_tls::<L>() && greets_as_active_mq(settings) => {
                Failure::failed(foreign::<L>(ACTIVE_MQ, settings))
            }
            Ended::Broken(error) => broken::<L>(&error, settings, patience),
            Ended::Refused(text) => Failure::failed(text),
            Ended::NotRead(number) => Failure::failed(self.not_read(number)),
            Ended::NotNow(text) => Failure::unreachable(text),
            Ended::Foreign(bytes) => Failure::failed(foreign::<L>(&bytes, settings)),
        })?;
        link.set_patience(QUIET).map_err(Failure::unreachable)?;
        Ok(Joined { link, from, language })
    }

    /// What is said where the broker does not let the program read the keys of a subscription.
    fn not_read(&self, number: u16) -> String {
        let subscriptions = lock(&self.subscriptions);
        let keys = subscriptions.all.iter().find(|(_, one)| one.number == number).map_or("", |(keys, _)| keys);
        not_read(&self.settings, keys)
    }

    /// Serves a connection until it ends, and connects again.
    fn stay_joined<L: Language>(self: Arc<Self>, first: Joined<L>) {
        let mut joined = Some(first);
        while !lock(&self.queue).is_closed {
            let one = match joined.take().map_or_else(|| self.join::<L>(JOINING), Ok) {
                Ok(one) => one,
                Err(failure) => {
                    let is_refused = failure.status == Status::FAILED;
                    if is_refused {
                        // That nobody listens goes without saying.
                        self.tell(false, &failure.text);
                    }
                    self.pause(if is_refused { REFUSED } else { PAUSE });
                    continue;
                }
            };
            self.connected::<L>(&one);
            self.tell(true, "");
            let reason = self.serve(one);
            self.tell(false, &reason);
            self.pause(PAUSE);
        }
        lock(&self.queue).has_ended = true;
        self.changed.notify_all();
    }

    /// What waited before is gone, and the broker is asked for all that the program wants.
    fn connected<L: Language>(&self, joined: &Joined<L>) {
        let subscriptions = lock(&self.subscriptions);
        let mut queue = lock(&self.queue);
        if queue.link.as_ref().is_some_and(|link| Arc::ptr_eq(link, &joined.link)) {
            return;
        }
        queue.link = Some(Arc::clone(&joined.link));
        queue.longest = joined.language.longest();
        for (keys, Subscription { number, .. }) in &subscriptions.all {
            // It could be said before.
            if let Ok(frame) = L::subscribe(*number, keys) {
                queue.urgent.add(frame);
            }
        }
    }

    /// Serves a connection until it ends: why it did.
    fn serve<L: Language>(self: &Arc<Self>, joined: Joined<L>) -> String {
        let Joined { link, mut from, mut language } = joined;
        let (own, to) = (Arc::clone(self), Arc::clone(&link));
        let writer = thread::spawn(move || match own.write(&to, L::BEAT, L::BYE) {
            Ok(()) => to.end(),
            Err(_) => to.cut(),
        });
        let ended = loop {
            match language.hear(&self.name, &mut from) {
                Ok(Heard::Message { number, key, bytes, attachment }) => {
                    let (message, attachment) = bytes.split_at(bytes.len() - attachment.min(bytes.len()));
                    self.deliver(number, Message { key: &key, message, attachment });
                }
                Ok(Heard::Other) => {}
                Err(ended) => break ended,
            }
        };
        link.cut();
        let mut queue = lock(&self.queue);
        *queue = Queue { is_closed: queue.is_closed, ..Queue::default() };
        drop(queue);
        self.changed.notify_all();
        let _ = writer.join();
        match ended {
            Ended::Refused(text) | Ended::NotNow(text) => text,
            Ended::NotRead(number) => self.not_read(number),
            Ended::Broken(_) | Ended::Foreign(_) => "the broker is away".to_owned(),
        }
    }

    /// Writes what waits, and signs of life, until the connection or the session ends.
    fn write(&self, link: &Arc<Link>, beat: &[u8], bye: &[u8]) -> std::io::Result<()> {
        let mut due = Instant::now() + BEAT;
        loop {
            let mut queue = lock(&self.queue);
            if !queue.link.as_ref().is_some_and(|one| Arc::ptr_eq(one, link)) {
                return Ok(());
            }
            let mut batch = queue.take();
            let now = Instant::now();
            if now >= due {
                batch.extend_from_slice(beat);
                due = now + BEAT;
            }
            if batch.is_empty() && !queue.is_closed {
                drop(self.changed.wait_timeout(queue, due - now));
                continue;
            }
            let is_last = queue.is_closed && queue.is_empty();
            drop(queue);
            if is_last {
                batch.extend_from_slice(bye);
            }
            link.write_all(&batch)?;
            if is_last {
                return Ok(());
            }
        }
    }

    /// Says what the broker has to know, where there is a connection.
    fn say(&self, frame: Vec<u8>) {
        let mut queue = lock(&self.queue);
        if queue.link.is_some() {
            queue.urgent.add(frame);
            self.changed.notify_all();
        }
    }

    fn pause(&self, time: Duration) {
        let queue = lock(&self.queue);
        if !queue.is_closed {
            drop(self.changed.wait_timeout_while(queue, time, |queue| !queue.is_closed));
        }
    }

    /// Delivers a message to the program. As long as that has no room for it, nothing more is read of the connection,
    /// so that the broker keeps or drops what comes.
    fn deliver(&self, number: u16, message: Message<'_>) {
        let subscriptions = lock(&self.subscriptions);
        let wanted = subscriptions.all.iter().filter(|(keys, one)| match number {
            0 => fits(message.key, keys),
            number => one.number == number,
        });
        let tokens: Vec<u64> = wanted.flat_map(|(_, one)| one.tokens.iter().copied()).collect();
        drop(subscriptions);
        for token in tokens {
            while !self.offer(token, message) {
                thread::sleep(ROOM_AGAIN);
            }
        }
    }

    /// Offers a message to the program, which wants none any more once the session is closed.
    fn offer(&self, token: u64, message: Message<'_>) -> bool {
        let listener = self.listener.read().unwrap_or_else(PoisonError::into_inner);
        listener.as_ref().is_none_or(|listener| listener.deliver(token, message))
    }

    /// Tells that the link is there or not, unless that was said.
    fn tell(&self, is_up: bool, reason: &str) {
        let mut told = lock(&self.told);
        if *told == (is_up, reason.to_owned()) {
            return;
        }
        *told = (is_up, reason.to_owned());
        let listener = self.listener.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(listener) = listener.as_ref() {
            listener.link(is_up, reason);
        }
    }
}
