//! The thread of a program's part of a network.

mod link;

use std::collections::{BTreeSet, HashMap, VecDeque};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use saoms_api::Level;
use saoms_api::host::{cdr, shown};

use super::control::{Answer, Ask, Asked, Other, Requests};
use super::exchange::call::Outcome;
use super::exchange::{Action, Destination, Exchange, News, OwnMessage, Settings};
use super::fleet::{Fleet, FromNetwork, Membership};
use super::port::{Frame, FromRun, Port, Waiting};
use super::rights::{Granted, Rights};
use super::ticket::Ticket;
use super::told::told;
use super::transport::TransportSession;
use super::{FROM_OUTSIDE, key};
use link::Link;

/// Tokens of subscriptions.
const ALIVE: u64 = 1;
const ASK: u64 = 2;
const COVERED: u64 = 3;
const ACCESS: u64 = 4;
const CALL: u64 = 5;
const REPLY: u64 = 6;
const CONTROL: u64 = 7;
/// From here on each topic has two: one for its messages, one for those that this program asked for again.
const FIRST_OF_TOPICS: u64 = 16;

/// Versions of other programs that are told, at most.
const MOST_VERSIONS: usize = 8;
/// Longest sleep of the thread.
const LONGEST_SLEEP: Duration = Duration::from_millis(200);
/// Time of a sleep, in nanoseconds, after which the thread was held up, as by SIGSTOP: what others said meanwhile has
/// not arrived yet.
const HELD_UP: u64 = 500_000_000;
/// Time after which messages are offered again for which the fleet had no room.
const ROOM_AGAIN: Duration = Duration::from_millis(1);
/// Messages that wait for room in the fleet, at most: then the network is read no further, and its senders keep what
/// they have.
const MOST_UNDELIVERED: usize = 4_096;
/// Messages of components after which the network gets what they say, at most.
const MOST_AT_ONCE: usize = 1_024;
/// The kind of alerts of programs that give no sign of life.
const UNREACHABLE: &str = "unreachable";
/// Time from one word of a router about rights to the next.
const ACCESS_AGAIN: Duration = Duration::from_secs(1);
/// Time for which a program that ends waits until others have received its events.
const LINGER: Duration = Duration::from_secs(15);

/// A program's part of a network. Dropping it leaves the network.
#[derive(Debug)]
pub struct Client {
    port: Arc<Port>,
    thread: Option<JoinHandle<()>>,
}

impl Client {
    /// Takes part in a network that a transport has joined, and that delivers to the port.
    ///
    /// # Errors
    /// The transport refuses a subscription, or the system a thread: why.
    pub fn start(
        session: TransportSession,
        port: &Arc<Port>,
        settings: Settings,
        membership: Membership,
        fleet: impl Fleet,
    ) -> Result<Client, String> {
        let (program, patience, name) = (settings.program, settings.patience, settings.name.clone());
        // Those of other versions, too: they are told.
        session.subscribe(&key::alive_of_all(), ALIVE)?;
        session.subscribe(&key::ask(program), ASK)?;
        session.subscribe(&key::covered(program), COVERED)?;
        if membership.has_calls {
            session.subscribe(&key::call(program), CALL)?;
            session.subscribe(&key::reply(program), REPLY)?;
        }
        session.subscribe(&key::control_of_all(), CONTROL)?;
        if membership.user.is_some() {
            session.subscribe(&key::access(), ACCESS)?;
        }
        let member = Member {
            session,
            exchange: Exchange::new(settings),
            fleet,
            undelivered: VecDeque::new(),
            unsent: VecDeque::new(),
            start: Instant::now(),
            next: 0,
            program,
            patience,
            done_since: None,
            has_told_who_lacks: false,
            rights: membership.user.clone().map(|user| Rights::new(membership.url.clone(), user)),
            membership,
            granted_at: None,
            next_token: FIRST_OF_TOPICS,
            others: BTreeSet::new(),
            tickets: HashMap::new(),
            link: Link::default(),
            requests: Requests::default(),
            port: Arc::clone(port),
            name,
        };
        let own = Arc::clone(port);
        let thread = std::thread::Builder::new().name("saoms-network".to_owned());
        let thread = thread.spawn(move || member.run(&own)).map_err(|error| error.to_string())?;
        Ok(Client { port: Arc::clone(port), thread: Some(thread) })
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.port.close();
        if let Some(thread) = self.thread.take() {
            // Its panic was written to standard error.
            let _ = thread.join();
        }
    }
}

/// The key, the message and the envelope of something that is to be sent.
type Unsent = (String, Arc<[u8]>, Option<Arc<[u8]>>);

/// The state of the thread.
struct Member<F> {
    session: TransportSession,
    exchange: Exchange,
    fleet: F,
    /// Messages for which the fleet had no room.
    undelivered: VecDeque<FromNetwork>,
    /// What the transport had no room for.
    unsent: VecDeque<Unsent>,
    start: Instant,
    /// When the exchange has something to do.
    next: u64,
    program: u64,
    /// Time without a sign of life after which a program is missed, in nanoseconds: news are everywhere by then.
    patience: u64,
    /// Time since which no program sees work left.
    done_since: Option<u64>,
    /// True if it was told that programs are waited for.
    has_told_who_lacks: bool,
    membership: Membership,
    /// What the user of this program may do.
    rights: Option<Rights>,
    /// When the router last said what users may do.
    granted_at: Option<Instant>,
    /// The token of the next subscription: no two have the same.
    next_token: u64,
    /// Versions of other programs that were told.
    others: BTreeSet<String>,
    /// Where the outcomes of calls go, by their lines and numbers.
    tickets: HashMap<(u64, u64), Arc<Ticket>>,
    link: Link,
    /// The requests of operators.
    requests: Requests,
    port: Arc<Port>,
    /// The name of the program for people.
    name: String,
}

impl<F: Fleet> Member<F> {
    fn run(mut self, port: &Port) {
        let mut ending: Option<Instant> = None;
        loop {
            let before = self.now();
            let waiting = port.take(self.sleep(), ending.is_some());
            let slept = self.now() - before;
            if slept > HELD_UP {
                self.exchange.hold_up(slept);
            }
            let is_closed = waiting.is_closed;
            self.take(waiting);
            let now = self.now();
            self.next = self.exchange.tick(now);
            self.carry_out();
            self.grant();
            self.fleet.deliver(&mut self.undelivered);
            self.agree(now);
            self.watch_link(now);
            self.requests.forget(now);
            if is_closed {
                let since = *ending.get_or_insert_with(Instant::now);
                let is_complete = self.exchange.is_complete() && !self.exchange.awaits_answers();
                if is_complete && self.unsent.is_empty() || since.elapsed() > LINGER {
                    break;
                }
            }
        }
        self.exchange.leave();
        self.carry_out();
        port.end();
        self.tickets.drain().for_each(|(_, ticket)| ticket.fill(Outcome::Dropped));
    }

    /// Lets the run end when no program has seen work left for so long that messages on their way have arrived.
    fn agree(&mut self, now: u64) {
        self.exchange.vote(self.fleet.vote());
        if let Some(unheard) = self.exchange.waits_for()
            && !std::mem::replace(&mut self.has_told_who_lacks, true)
        {
            let names: Vec<String> = unheard.iter().map(|name| format!("`{name}`")).collect();
            let (nodes, have) = if names.len() == 1 { ("node", "has") } else { ("nodes", "have") };
            let text = format!(
                "no work is left, but {nodes} {} {have} not been there yet: the program waits for them",
                names.join(", ")
            );
            self.fleet.tell(Level::Warning, text);
        }
        let is_done = self.exchange.is_done() && self.exchange.is_complete() && self.undelivered.is_empty();
        let since = self.done_since.filter(|_| is_done);
        self.fleet.agree(since.is_some_and(|since| now - since >= self.patience));
        self.done_since = is_done.then(|| since.unwrap_or(now));
    }

    /// Tells, as the router, what users may do.
    fn grant(&mut self) {
        let Some(grants) = &self.membership.grants else { return };
        if self.granted_at.is_none_or(|at| at.elapsed() >= ACCESS_AGAIN) {
            self.granted_at = Some(Instant::now());
            self.put(&key::access(), &cdr::encode(grants), None);
        }
    }

    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    fn sleep(&self) -> Duration {
        if !self.undelivered.is_empty() || !self.unsent.is_empty() {
            return ROOM_AGAIN;
        }
        Duration::from_nanos(self.next.saturating_sub(self.now())).min(LONGEST_SLEEP)
    }

    fn take(&mut self, waiting: Waiting) {
        let (reads, messages): (Vec<FromRun>, Vec<FromRun>) =
            waiting.from_run.into_iter().partition(|from_run| matches!(from_run, FromRun::Reads { .. }));
        if !reads.is_empty() {
            reads.into_iter().for_each(|reads| self.take_from_run(reads));
            // Who answers the first message has heard what this program reads.
            self.next = self.exchange.tick(self.now());
            self.carry_out();
        }
        for (place, message) in messages.into_iter().enumerate() {
            self.take_from_run(message);
            if place % MOST_AT_ONCE == MOST_AT_ONCE - 1 {
                self.carry_out();
            }
        }
        self.carry_out();
        if waiting.lost > 0 {
            let text =
                format!("{} messages were sent faster than the network could take them, and are lost", waiting.lost);
            self.fleet.tell(Level::Error, text);
        }
        for link in waiting.links {
            let now = self.now();
            self.link.note(link.is_up, now);
            let (level, what) = if link.is_up { (Level::Info, "is there") } else { (Level::Warning, "was lost") };
            let reason = if link.reason.is_empty() { String::new() } else { format!(": {}", link.reason) };
            self.fleet.tell(level, format!("the link to the network {what}{reason}"));
        }
        let now = self.now();
        for frame in waiting.frames {
            // Senders keep what is dropped here, and send it again.
            let is_full = self.undelivered.len() > MOST_UNDELIVERED;
            if !(is_full && frame.token >= FIRST_OF_TOPICS) {
                self.take_frame(&frame, now);
            }
        }
    }

    fn take_from_run(&mut self, from_run: FromRun) {
        match from_run {
            FromRun::Reads { topic, is_state, schema } => {
                let again = key::again(self.program, &topic);
                for keys in [key::of_topic(&topic), again] {
                    let token = self.next_token;
                    self.next_token += 1;
                    if let Err(error) = self.session.subscribe(&keys, token) {
                        let text = format!("topic `{topic}` cannot be read from the network: {error}");
                        self.fleet.tell(Level::Error, text);
                    }
                }
                let readers = self.membership.readers(&topic);
                if let Some(told) = self.rights.as_mut().and_then(|rights| rights.read(&topic, &readers)) {
                    self.fleet.tell(Level::Error, told);
                }
                self.exchange.read(&topic, is_state, schema);
            }
            FromRun::Call { call, ticket } => {
                if let Some(told) = self.rights.as_mut().and_then(|rights| rights.call(&call.caller)) {
                    self.fleet.tell(Level::Error, told);
                }
                let line = call.line;
                let number = self.exchange.call(call, self.now());
                self.tickets.insert((line, number), ticket);
            }
            FromRun::Beat { node, component, caller, period } => {
                self.exchange.beat(&node, &component, &caller, period);
            }
            FromRun::Reply { program, line, number, answer } => self.exchange.reply(program, line, number, answer),
            FromRun::Unserved { program, line, number } => self.exchange.unserved(program, line, number),
            FromRun::Answer { asker, answer } => {
                let others = self.exchange.others().map(|(program, name)| Other { program, name: name.to_string() });
                let answer = self.requests.answer(asker, answer, (self.program, &self.name), others.collect());
                answer.into_iter().for_each(|answer| self.put_answer(asker, &answer));
            }
            FromRun::Message { topic, mut component, to, is_state, schema, message } => {
                if let Some(told) = self.rights.as_mut().and_then(|rights| rights.write(&topic, &component)) {
                    self.fleet.tell(Level::Error, told);
                }
                if &*component == FROM_OUTSIDE {
                    // What comes from outside to two programs comes from two senders.
                    component = format!("{component} {:x}", self.program).into();
                }
                let sent = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
                self.exchange.send(OwnMessage {
                    topic: &topic,
                    is_state,
                    component: &component,
                    to,
                    key: message.key(),
                    sent: u64::try_from(sent).unwrap_or(u64::MAX),
                    schema,
                    cause: message.header().cause.0,
                    bytes: message.bytes(),
                });
            }
        }
    }

    fn take_frame(&mut self, frame: &Frame, now: u64) {
        let topic = |place: usize| frame.key.split('/').nth(place).and_then(key::name);
        // What is not what it should be comes from somebody who speaks another language: it is nothing to this program.
        match frame.token {
            ALIVE if key::version(&frame.key) != Some(key::VERSION) => {
                let version = key::version(&frame.key).unwrap_or_default().to_owned();
                if self.others.len() < MOST_VERSIONS && self.others.insert(version.clone()) {
                    let text = format!(
                        "a program on the network `{}` speaks version {} of its language, and this one version {}: they do \
                         not hear each other; build both from one version",
                        self.membership.url,
                        shown(version.as_bytes()),
                        key::VERSION
                    );
                    self.fleet.tell(Level::Error, text);
                }
            }
            ACCESS => {
                let Some((rights, granted)) = self.rights.as_mut().zip(cdr::decode::<Granted>(&frame.message).ok())
                else {
                    return;
                };
                let membership = &self.membership;
                let told = rights.hear(&granted, |topic| membership.readers(topic));
                told.into_iter().for_each(|text| self.fleet.tell(Level::Error, text));
            }
            ALIVE => {
                if let Ok(alive) = cdr::decode(&frame.message) {
                    self.exchange.hear(&alive, now);
                }
            }
            ASK => {
                if let Ok(again) = cdr::decode(&frame.message) {
                    self.exchange.answer(&again);
                }
            }
            COVERED => {
                if let Ok(covered) = cdr::decode(&frame.message) {
                    self.exchange.cover(&covered, now);
                }
            }
            CALL => {
                if let Ok(request) = cdr::decode(&frame.message) {
                    self.exchange.take_request(request, now);
                }
            }
            REPLY => {
                if let Ok(reply) = cdr::decode(&frame.message) {
                    self.exchange.take_reply(reply, now);
                }
            }
            CONTROL => {
                let Ok(ask) = cdr::decode::<Ask>(&frame.message) else { return };
                let asker = ask.asker;
                match self.requests.take(ask, self.program, &self.port, now) {
                    None => {}
                    Some(Asked::New(request, reply)) => self.fleet.control(request, reply),
                    Some(Asked::Again(answers)) => {
                        answers.iter().for_each(|answer| self.put_answer(asker, answer));
                    }
                }
            }
            FIRST_OF_TOPICS.. => {
                let is_again = !(frame.token - FIRST_OF_TOPICS).is_multiple_of(2);
                if let Some(topic) = topic(if is_again { 4 } else { 3 }) {
                    self.exchange.receive(&topic, &frame.message, &frame.attachment, now);
                }
            }
            _ => {}
        }
        self.carry_out();
    }

    fn carry_out(&mut self) {
        while let Some((key, bytes, envelope)) = self.unsent.pop_front() {
            if !self.put(&key, &bytes, envelope.as_deref()) {
                self.unsent.push_front((key, bytes, envelope));
                break;
            }
        }
        for action in self.exchange.take_actions() {
            match action {
                Action::Put { to, bytes } => self.put_or_keep(&to, bytes, None),
                Action::Send { to, frame } => {
                    let (bytes, envelope) = frame.encode();
                    self.put_or_keep(&to, bytes, Some(envelope));
                }
                Action::Deliver { topic, arrived, .. } => self.undelivered.push_back(FromNetwork { topic, arrived }),
                Action::Serve(request) => self.fleet.serve(request),
                Action::Answered { line, number, outcome } => {
                    if let Some(ticket) = self.tickets.remove(&(line, number)) {
                        ticket.fill(outcome);
                    }
                }
                Action::Tell(news) => {
                    if let News::Unreachable { name, .. } | News::Left { name, .. } = &news {
                        self.fleet.misses(name);
                    }
                    let (level, text) = told(&news);
                    match &news {
                        News::Unreachable { name, .. } => self.fleet.alert(UNREACHABLE, name, Some(text)),
                        News::Back { name, .. } | News::Left { name, .. } => {
                            self.fleet.alert(UNREACHABLE, name, None);
                            self.fleet.tell(level, text);
                        }
                        _ => self.fleet.tell(level, text),
                    }
                }
            }
        }
    }

    fn put_or_keep(&mut self, to: &Destination, bytes: Arc<[u8]>, envelope: Option<Arc<[u8]>>) {
        let key = match to {
            Destination::Topic(topic, component) => key::topic(topic, component),
            Destination::Again(program, topic) => key::again(*program, topic),
            Destination::Alive(program) => key::alive(*program),
            Destination::Ask(program) => key::ask(*program),
            Destination::Covered(program) => key::covered(*program),
            Destination::Call(program) => key::call(*program),
            Destination::Reply(program) => key::reply(*program),
        };
        if !self.unsent.is_empty() || !self.put(&key, &bytes, envelope.as_deref()) {
            self.unsent.push_back((key, bytes, envelope));
        }
    }

    fn put_answer(&self, asker: u64, answer: &Answer) {
        // It is asked for again if there is no room for it.
        self.put(&key::controlled(asker), &cdr::encode(answer), None);
    }

    /// Puts something on the network; false if there is no room for it.
    fn put(&self, key: &str, bytes: &[u8], envelope: Option<&[u8]>) -> bool {
        match self.session.put(key, bytes, envelope.unwrap_or_default(), envelope.is_none()) {
            Ok(is_put) => is_put,
            // It is sent again when somebody lacks it.
            Err(error) => {
                self.fleet.tell(Level::Warning, format!("the network did not take `{key}`: {error}"));
                true
            }
        }
    }
}
