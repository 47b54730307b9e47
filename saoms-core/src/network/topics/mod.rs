//! The part of a program in a network of programs that do not speak its language: what its components send is published
//! there, and what others publish comes to its topics, by their names and types.
//!
//! Nobody there numbers, acknowledges or keeps anything. So nothing is asked for again: what found no room is counted.

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_api::host::SharedMessage;
use saoms_lang::ros::{RosType, ros_topic};

use super::exchange::Arrived;
use super::exchange::call::Outcome;
use super::fleet::{Fleet, Undelivered};
use super::port::{Frame, FromRun, Port, Waiting};
use super::transport::{TopicForm, TopicSession};
use super::{FROM_OUTSIDE, LINK};

/// Events that wait for room in the transport, at most, and messages of a topic that wait for room in the fleet.
const MOST_WAITING: usize = 65_536;
/// Longest time between two looks at what is due.
const LONGEST_PAUSE: Duration = Duration::from_millis(200);
/// Time after which is tried again what found no room.
const ROOM_AGAIN: Duration = Duration::from_millis(1);
/// Time for which the end waits for events that found no room.
const LAST_WORDS: Duration = Duration::from_secs(5);
/// Topics whose refused messages are told, at most.
const MOST_TOLD: usize = 16;

/// The fleet of a program, as its part of a network of other programs sees it.
pub trait TopicFleet: Fleet {
    /// The schema of a topic as its declaration has it, and whether it is a state topic.
    fn declared(&self, topic: &str) -> Option<(String, bool)>;

    /// Whether a message from outside is one of a topic, and speaks in the name of no component.
    ///
    /// # Errors
    /// It does not: why.
    fn judge(&self, topic: &str, message: &[u8]) -> Result<(), String>;

    /// Counts messages from outside that were refused, in the report.
    fn count_refused(&self, count: u64);
}

/// What a program is on such a network.
#[derive(Clone, Debug)]
pub struct TopicMembership {
    /// Where it is.
    pub url: String,
    /// True for a program at which others meet.
    pub listens: bool,
    /// Time after which a link that is down counts as lost.
    pub patience: Duration,
}

/// A topic that the program publishes.
#[derive(Clone, Copy, Debug)]
struct Published {
    token: u64,
    is_state: bool,
}

/// What is known and left to do.
pub(super) struct TopicMember<F> {
    session: TopicSession,
    fleet: F,
    membership: TopicMembership,
    /// Those that are advertised; `None` for one that cannot be.
    published: HashMap<Arc<str>, Option<Published>>,
    /// Those that are read, by their tokens.
    subscribed: HashMap<u64, Arc<str>>,
    /// Of each name that others know, the topic.
    names: BTreeMap<String, Arc<str>>,
    next_token: u64,
    /// What the transport had no room for: events in their order, and the newest of each state.
    events: VecDeque<(u64, SharedMessage)>,
    states: BTreeMap<(u64, u64), SharedMessage>,
    /// Messages for which the fleet had no room.
    undelivered: Undelivered,
    /// Of each topic, how many messages were refused.
    refused: BTreeMap<Arc<str>, u64>,
    down_since: Option<Instant>,
    is_lost: bool,
    is_joining: bool,
    /// Why the run has to end as failed, once it runs.
    failure: Option<String>,
}

impl<F: TopicFleet> TopicMember<F> {
    pub(super) fn new(session: TopicSession, membership: TopicMembership, fleet: F) -> Self {
        TopicMember {
            session,
            fleet,
            membership,
            published: HashMap::new(),
            subscribed: HashMap::new(),
            names: BTreeMap::new(),
            next_token: 1,
            events: VecDeque::new(),
            states: BTreeMap::new(),
            undelivered: Undelivered::new(),
            refused: BTreeMap::new(),
            down_since: None,
            is_lost: false,
            is_joining: true,
            failure: None,
        }
    }

    /// What the thread of the network does, until the end.
    pub(super) fn run(&mut self, port: &Port) {
        let mut ending: Option<Instant> = None;
        loop {
            port.wait(self.pause(), ending.is_some());
            let has_started = self.is_joining && self.fleet.has_started();
            let waiting = port.take();
            let (is_closed, is_abandoned) = (waiting.is_closed, waiting.is_abandoned);
            self.take(waiting);
            self.attend(has_started);
            if is_closed {
                let until = *ending.get_or_insert_with(|| Instant::now() + LAST_WORDS);
                let is_sent = self.events.is_empty() && self.states.is_empty();
                if is_sent || is_abandoned || self.fleet.is_interrupted() || Instant::now() >= until {
                    break;
                }
            }
        }
        port.end();
        let count = self.events.len() as u64;
        if count > 0 {
            let text = format!("{} had no room for {count} messages before the end", self.network());
            self.fleet.count_lost(count, &text);
        }
        for (topic, count) in std::mem::take(&mut self.refused) {
            if count > 1 {
                let text = format!("{count} messages from outside on topic `{topic}` were refused in all");
                self.fleet.tell(Level::Warning, text);
            }
        }
    }

    /// The thread has failed, by a fault of this program.
    pub(super) fn break_down(&self, failure: &str) -> String {
        let text = format!(
            "an error of the program itself has ended its part of {}: nothing is published and received there any \
             more: {failure}",
            self.network()
        );
        self.fleet.tell(Level::Error, text.clone());
        self.fleet.count_lost(1, &text);
        text
    }

    /// True once its components are there.
    pub(super) fn has_started(&self) -> bool {
        self.fleet.has_started()
    }

    /// Ends the run as failed.
    pub(super) fn fail(&self, reason: String) {
        self.fleet.fail(reason);
    }

    fn network(&self) -> String {
        format!("the network `{}`", self.membership.url)
    }

    fn pause(&self) -> Duration {
        let has_to_try = !self.undelivered.is_empty() || !self.events.is_empty() || !self.states.is_empty();
        if has_to_try { ROOM_AGAIN } else { LONGEST_PAUSE }
    }

    /// Takes what waited at the port.
    fn take(&mut self, waiting: Waiting) {
        for from_run in waiting.from_run {
            self.take_from_run(from_run);
        }
        if waiting.lost > 0 {
            self.lose(waiting.lost, "were sent faster than the network could take them");
        }
        for link in waiting.links {
            let (level, text) = match (link.is_up, link.reason.as_str()) {
                (true, "") => (Level::Info, format!("the link to {} is there", self.network())),
                (true, said) => (Level::Warning, format!("{}: {said}", self.network())),
                (false, why) => (Level::Warning, format!("the link to {} was lost: {why}", self.network())),
            };
            self.fleet.tell(level, text);
            self.down_since = (!link.is_up).then(|| self.down_since.unwrap_or_else(Instant::now));
        }
        waiting.frames.into_iter().for_each(|frame| self.take_frame(frame));
    }

    /// Counts messages that are lost.
    fn lose(&mut self, count: u64, how: &str) {
        let text = format!("{count} messages {how}, and are lost");
        self.fleet.count_lost(count, &text);
        self.fleet.tell(Level::Error, text);
    }

    fn take_from_run(&mut self, from_run: FromRun) {
        match from_run {
            FromRun::Publishes { topic } => _ = self.published(&topic),
            FromRun::Reads { topic, .. } => self.subscribe(&topic),
            FromRun::Message { topic, component, to: None, message, .. } => {
                let Some(Published { token, is_state }) = self.published(&topic) else { return };
                if is_state {
                    self.states.insert((token, of(&component, message.key())), message);
                } else if self.events.len() < MOST_WAITING {
                    self.events.push_back((token, message));
                } else {
                    self.lose(1, &format!("of topic `{topic}` found no room in {}", self.network()));
                }
                self.publish();
            }
            FromRun::Skipped { topic, count, .. } => {
                self.lose(count, &format!("of topic `{topic}` were sent faster than the network could take them"));
            }
            FromRun::Call { ticket, .. } => ticket.fill(Outcome::Dropped),
            // Nobody there is a component, knows cells, or asks anything.
            FromRun::Message { .. } | FromRun::Wants { .. } | FromRun::Beat { .. } | FromRun::Reply { .. } => {}
            FromRun::Unserved { .. } | FromRun::Answer { .. } => {}
        }
    }

    /// A topic that the program publishes, which is advertised.
    fn published(&mut self, topic: &Arc<str>) -> Option<Published> {
        if let Some(known) = self.published.get(topic) {
            return *known;
        }
        let known = self.form(topic).and_then(|form| {
            let token = self.token();
            self.session.advertise(&form, token).map(|()| Published { token, is_state: form.state })
        });
        let known = known.map_err(|error| self.refuse(topic, "publish", &error)).ok();
        self.published.insert(Arc::clone(topic), known);
        known
    }

    fn subscribe(&mut self, topic: &Arc<str>) {
        if self.subscribed.values().any(|known| known == topic) {
            return;
        }
        let token = self.token();
        self.subscribed.insert(token, Arc::clone(topic));
        let form = self.form(topic).and_then(|form| self.session.subscribe(&form, token));
        if let Err(error) = form {
            self.refuse(topic, "read", &error);
        }
    }

    fn token(&mut self) -> u64 {
        self.next_token += 1;
        self.next_token
    }

    /// A topic as others know it.
    fn form(&mut self, topic: &Arc<str>) -> Result<TopicForm, String> {
        let (schema, state) = self.fleet.declared(topic).ok_or("the fleet does not have it")?;
        let RosType { name: kind, text, description, schema, .. } =
            RosType::of(&schema).map_err(|error| error.to_string())?;
        let name = ros_topic(topic);
        let known = self.names.entry(name.clone()).or_insert_with(|| Arc::clone(topic));
        if known != topic {
            return Err(format!("others know `{known}` by the same name, `{name}`: rename one with `topicRename`"));
        }
        Ok(TopicForm { topic: name, kind, definition: text, description, schema, state })
    }

    /// A topic cannot be used: the run fails.
    fn refuse(&mut self, topic: &str, verb: &str, error: &str) {
        let text = format!("{} cannot {verb} topic `{topic}`: {error}", self.network());
        self.failure.get_or_insert(text);
    }

    /// Publishes what waits, as long as there is room.
    fn publish(&mut self) {
        while let Some((token, message)) = self.events.front() {
            match self.session.publish(*token, 0, message.bytes()) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => self.lose(1, &format!("could not be published: {error}")),
            }
            self.events.pop_front();
        }
        while let Some(((token, of), message)) = self.states.first_key_value() {
            match self.session.publish(*token, *of, message.bytes()) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => self.lose(1, &format!("could not be published: {error}")),
            }
            self.states.pop_first();
        }
    }

    /// Takes a message from outside.
    fn take_frame(&mut self, frame: Frame) {
        let Some(topic) = self.subscribed.get(&frame.token).cloned() else { return };
        let judged = match frame.attachment.as_slice() {
            [] => self.fleet.judge(&topic, &frame.message),
            why => Err(String::from_utf8_lossy(why).into_owned()),
        };
        if let Err(why) = judged {
            self.fleet.count_refused(1);
            let is_room = self.refused.len() < MOST_TOLD;
            let count = self.refused.entry(Arc::clone(&topic)).or_default();
            *count += 1;
            if *count == 1 && is_room {
                let text = format!("a message from {} on topic `{topic}` is refused: {why}", self.network());
                self.fleet.tell(Level::Warning, text);
            }
            return;
        }
        let waiting = self.undelivered.entry(Arc::clone(&topic)).or_default();
        if waiting.len() >= MOST_WAITING {
            return self.lose(1, &format!("from outside on topic `{topic}` came faster than its readers read them"));
        }
        let component = match frame.key.as_str() {
            "" => FROM_OUTSIDE.into(),
            who => format!("{FROM_OUTSIDE} {who}").into(),
        };
        waiting.push_back(Arrived {
            component,
            to: String::new(),
            key: None,
            sent: 0,
            cause: 0,
            bytes: frame.message,
            origin: 0,
            number: 0,
        });
    }

    /// Does what is due.
    fn attend(&mut self, has_started: bool) {
        if has_started {
            self.is_joining = false;
            if !self.membership.listens {
                self.fleet
                    .tell(Level::Info, format!("the program has joined the network at `{}`", self.membership.url));
            }
        }
        self.publish();
        self.fleet.deliver(&mut self.undelivered);
        let is_lost = self.down_since.is_some_and(|since| since.elapsed() > self.membership.patience);
        if std::mem::replace(&mut self.is_lost, is_lost) != is_lost {
            let text = format!("the link to {} is lost", self.network());
            self.fleet.alert(LINK, &self.membership.url, is_lost.then_some(text));
            if is_lost {
                self.fleet.lose();
            }
        }
        if self.failure.is_some() && self.fleet.has_started() {
            self.failure.take().into_iter().for_each(|reason| self.fleet.fail(reason));
        }
    }
}

/// The number of a state: one for each component and key.
fn of(component: &str, key: Option<u64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    (component, key).hash(&mut hasher);
    hasher.finish()
}
