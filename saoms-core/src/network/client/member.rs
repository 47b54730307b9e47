//! The state of a program's part of a network.

mod actions;
mod frames;
mod linger;

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use saoms_api::Level;
use saoms_api::host::cdr;

use super::super::control::{Other, Requests};
use super::super::exchange;
use super::super::exchange::call::Outcome;
use super::super::exchange::{Exchange, Keys, OwnMessage, Settings};
use super::super::fleet::{Fleet, Membership, Undelivered};
use super::super::port::{FromRun, Port, Waiting};
use super::super::rights::Rights;
use super::super::ticket::Ticket;
use super::super::transport::{Delivered, TransportSession};
use super::super::{FROM_OUTSIDE, key};
use super::FIRST_OF_TOPICS;
use super::enter::{SETTLES, in_milliseconds};
use super::link::Link;
use super::unsent::UnsentQueue;
use super::waits::waits;
use linger::End;
pub(super) use linger::Linger;

/// Longest time between two looks at what is due, in nanoseconds.
const LONGEST_PAUSE: u64 = 200_000_000;
/// Time after which messages are offered again for which the fleet had no room.
const ROOM_AGAIN: Duration = Duration::from_millis(1);
/// Messages of components after which the network gets what they say, at most.
const MOST_AT_ONCE: usize = 1_024;
/// Time that it takes the thread of components to send their messages, in nanoseconds, if a transport does not let it
/// wait for room. What is left then is for the thread of the network.
const LONGEST_AT_ONCE: u64 = 300_000;
/// Time after a longer wait in which that thread sends nothing itself, in nanoseconds.
const CROWDED: u64 = 1_000_000_000;
/// Time from one word of a router about rights to the next.
const ACCESS_AGAIN: Duration = Duration::from_secs(1);

/// What is known and left to do. The thread of the network has it while it works; in between others do what cannot
/// wait.
pub(super) struct Member<F> {
    /// Until the end.
    session: Option<TransportSession>,
    pub(super) exchange: Exchange,
    pub(super) fleet: F,
    /// Messages for which the fleet had no room.
    undelivered: Undelivered,
    /// With a state folder, what was delivered before the mark that components are to pass.
    marked: Vec<exchange::Delivered>,
    /// What the transport had no room for.
    unsent: UnsentQueue,
    start: Instant,
    /// When the exchange has something to do.
    next: u64,
    /// While another thread sends, the time from which on what is left is for that of the network.
    hands_over_at: Option<u64>,
    /// Until when the thread of the network alone sends messages: the transport made another one wait for room.
    crowded_until: u64,
    program: u64,
    /// Time without a sign of life after which a program is missed, in nanoseconds: news are everywhere by then.
    pub(super) patience: u64,
    /// Time since which no program sees work left.
    done_since: Option<u64>,
    /// Since when nothing but events of others is missing.
    missing_since: Option<u64>,
    /// True if it was told that programs are waited for.
    has_told_who_lacks: bool,
    /// True if it was told that programs are waited for which lack events.
    has_told_awaited: bool,
    linger: Duration,
    pub(super) membership: Membership,
    /// True until it was told that this program has joined.
    is_joining: bool,
    /// What the user of this program may do.
    rights: Option<Rights>,
    /// When the router last said what users may do.
    granted_at: Option<Instant>,
    /// The token of the next subscription: no two have the same.
    next_token: u64,
    /// The tokens of the subscriptions of topics.
    tokens: HashMap<Keys, u64>,
    /// Versions of other programs that were told.
    others: BTreeSet<String>,
    /// Where the outcomes of calls go, by their lines and numbers.
    tickets: HashMap<(u64, u64), Arc<Ticket>>,
    pub(super) link: Link,
    /// Why the run has to end as failed, once it runs.
    pub(super) failure: Option<String>,
    /// The fault of what another thread did for that of the network.
    pub(super) broken: Option<String>,
    /// The requests of operators.
    requests: Requests,
    port: Arc<Port>,
    /// The name of the program for people.
    name: String,
}

impl<F: Fleet> Member<F> {
    /// A member that is about to begin.
    pub(super) fn new(
        session: TransportSession,
        port: &Arc<Port>,
        settings: Settings,
        membership: Membership,
        fleet: F,
    ) -> Member<F> {
        Member {
            session: Some(session),
            fleet,
            undelivered: Undelivered::new(),
            marked: Vec::new(),
            unsent: UnsentQueue::default(),
            start: Instant::now(),
            next: 0,
            hands_over_at: None,
            crowded_until: 0,
            program: settings.program,
            patience: settings.patience,
            done_since: None,
            missing_since: None,
            has_told_who_lacks: false,
            has_told_awaited: false,
            linger: Duration::from_nanos(settings.linger),
            rights: membership.user.clone().map(|user| Rights::new(membership.url.clone(), user)),
            membership,
            is_joining: true,
            granted_at: None,
            next_token: FIRST_OF_TOPICS,
            tokens: HashMap::new(),
            others: BTreeSet::new(),
            tickets: HashMap::new(),
            link: Link::default(),
            failure: None,
            broken: None,
            requests: Requests::default(),
            port: Arc::clone(port),
            name: settings.name.clone(),
            exchange: Exchange::new(settings),
        }
    }

    /// True until it was told that this program has joined.
    pub(super) fn is_joining(&self) -> bool {
        self.is_joining
    }

    /// Tells that this program has joined: all that its components read from the start on is subscribed. A router
    /// has told that it listens.
    pub(super) fn tell_joined(&mut self) {
        self.is_joining = false;
        if self.session.as_ref().is_some_and(|session| !session.is_router()) {
            let text = format!("the program has joined the network at `{}`", self.membership.url);
            self.fleet.tell(Level::Info, text);
        }
    }

    /// True if nothing is due yet beside messages of components.
    pub(super) fn has_time(&self) -> bool {
        self.sleep() > ROOM_AGAIN && !self.exchange.has_to_speak()
    }

    /// Does what is due.
    pub(super) fn attend(&mut self) {
        let now = self.now();
        self.next = self.exchange.tick(now).min(now + LONGEST_PAUSE);
        self.carry_out();
        self.grant();
        self.fleet.deliver(&mut self.undelivered);
        self.confirm();
        self.agree(now);
        self.watch_link(now);
        self.look_for_peers(now);
        self.requests.forget(now);
        if self.failure.is_some() && self.fleet.has_started() {
            self.failure.take().into_iter().for_each(|reason| self.fleet.fail(reason));
        }
    }

    /// Lets others forget events that components have carried out.
    fn confirm(&mut self) {
        if !self.marked.is_empty() && self.fleet.has_passed_mark() {
            self.exchange.note_done(std::mem::take(&mut self.marked));
        }
        if self.marked.is_empty() && self.undelivered.is_empty() {
            self.marked = self.exchange.delivered();
            if !self.marked.is_empty() {
                self.fleet.mark();
            }
        }
    }

    /// Takes messages of a topic on the thread that brings them: to wake another one would take longer than all else.
    pub(super) fn take_at_once(&mut self, delivered: &Delivered<'_>) {
        let now = self.now();
        let is_missing = self.take_messages(delivered, now);
        self.act();
        self.fleet.deliver(&mut self.undelivered);
        if is_missing || !self.undelivered.is_empty() {
            self.port.nudge();
        }
    }

    /// Sends messages of components on the thread that executes these, for the same reason. False if the thread of the
    /// network has to, since more than that is to be done.
    pub(super) fn send_at_once(&mut self) -> bool {
        if self.session.is_none() || !self.unsent.is_empty() {
            return false;
        }
        let begin = self.now();
        if begin < self.crowded_until {
            return false;
        }
        let Some(waiting) = self.port.take_short() else { return false };
        let before = waits();
        self.hands_over_at = Some(begin + LONGEST_AT_ONCE);
        self.take(waiting);
        self.hands_over_at = None;
        let end = self.now();
        // A thread that had to leave the processor to another one takes long as well, and did not wait for the network.
        if end - begin > LONGEST_AT_ONCE && waits() > before {
            self.crowded_until = end + CROWDED;
        }
        if !self.has_time() || !self.unsent.is_empty() {
            self.port.nudge();
        }
        true
    }

    /// What another thread did has failed: that of the network ends. False, since nothing was done.
    pub(super) fn fail_at_once(&mut self, failure: String) -> bool {
        self.broken = Some(failure);
        self.port.nudge();
        false
    }

    /// A fault of this program has ended the thread of the network: tells it, and gives what was told.
    pub(super) fn break_down(&mut self, failure: &str) -> String {
        let text = format!(
            "an error of the program itself has ended its part of the network `{}`: nothing is sent and received any more: \
             {failure}",
            self.membership.url
        );
        self.fleet.tell(Level::Error, text.clone());
        // How many messages others lack is not known any more.
        self.fleet.count_lost(1, &text);
        self.tickets.drain().for_each(|(_, ticket)| ticket.fill(Outcome::Dropped));
        text
    }

    /// The session, which is to be closed.
    pub(super) fn take_session(&mut self) -> Option<TransportSession> {
        self.session.take()
    }

    /// Leaves the network. Gives the session, which is to be closed.
    pub(super) fn end(&mut self) -> Option<TransportSession> {
        self.exchange.leave();
        self.carry_out();
        self.port.end();
        self.tickets.drain().for_each(|(_, ticket)| ticket.fill(Outcome::Dropped));
        self.session.take()
    }

    /// Lets the run end when no program has seen work left for so long that messages on their way have arrived, and all
    /// have that were lost on it.
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
        let is_agreed = self.exchange.is_done();
        if is_agreed {
            self.tell_awaited(End::Agreed, false);
        }
        let is_quiet = is_agreed && self.exchange.is_complete() && self.undelivered.is_empty();
        let missing_since = self.missing_since.unwrap_or(now);
        self.missing_since = (is_quiet && !self.exchange.has_received_all()).then_some(missing_since);
        if self.missing_since.is_some() && now - missing_since >= self.exchange.settings().linger {
            self.exchange.give_up_missing();
            self.missing_since = None;
        }
        // What has just arrived is to be read before the end.
        let is_done = is_quiet && self.missing_since.is_none();
        let since = self.done_since.filter(|_| is_done);
        self.fleet.agree(since.is_some_and(|since| now - since >= self.patience));
        self.done_since = is_done.then(|| since.unwrap_or(now));
    }

    /// Tells, as the router, what users may do.
    fn grant(&mut self) {
        let Some(grants) = &self.membership.grants else { return };
        if self.granted_at.is_none_or(|at| at.elapsed() >= ACCESS_AGAIN) {
            self.granted_at = Some(Instant::now());
            self.put(&key::access(), &cdr::encode(grants), None, true);
        }
    }

    /// Of a router, the time within which others connect to it, in milliseconds: it has just begun. With components of
    /// its own it has waited for that.
    fn settles(&self) -> u64 {
        let is_router = self.session.as_ref().is_some_and(TransportSession::is_router);
        if is_router && self.exchange.settings().components.is_empty() {
            in_milliseconds(SETTLES.saturating_sub(self.start.elapsed()))
        } else {
            0
        }
    }

    pub(super) fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// Time for which there is nothing to do.
    pub(super) fn sleep(&self) -> Duration {
        if !self.undelivered.is_empty() || !self.unsent.is_empty() {
            return ROOM_AGAIN;
        }
        Duration::from_nanos(self.next.saturating_sub(self.now()))
    }

    /// Takes what waited at the port.
    pub(super) fn take(&mut self, waiting: Waiting) {
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
            self.fleet.count_lost(waiting.lost, &text);
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
            self.take_frame(&frame, now);
        }
    }

    fn take_from_run(&mut self, from_run: FromRun) {
        match from_run {
            FromRun::Reads { topic, is_state, schema } => {
                let readers = self.membership.readers(&topic);
                if let Some(told) = self.rights.as_mut().and_then(|rights| rights.read(&topic, &readers)) {
                    self.fleet.tell(Level::Error, told);
                }
                self.exchange.read(&topic, is_state, schema);
            }
            // Who reads says so.
            FromRun::Publishes { .. } => {}
            FromRun::Skipped { topic, count, last } => self.exchange.skip(&topic, count, last),
            FromRun::Wants { topic, cells } => self.exchange.want(&topic, cells.as_ref(), self.now()),
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
            FromRun::Message { topic, mut component, to, is_state, schema, number, message } => {
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
                    place: message.place(),
                    sent: u64::try_from(sent).unwrap_or(u64::MAX),
                    schema,
                    cause: message.header().cause.0,
                    number,
                    bytes: message.bytes(),
                });
            }
        }
    }
}
