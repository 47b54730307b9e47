//! What the exchange wants, carried out.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use saoms_api::Level;
use saoms_api::host::cdr;

use super::super::unsent::Unsent;
use super::Member;
use crate::network::control::Answer;
use crate::network::exchange::{Action, Destination, Keys, News};
use crate::network::told::told;
use crate::network::{Fleet, key};

/// The kind of alerts of programs that give no sign of life.
const UNREACHABLE: &str = "unreachable";

/// How often the last sign of life is put, and the time between. It goes as data does, which a transport that has no
/// room for it drops; nobody asks for it again, and who hears it twice has heard it.
const LAST_SIGNS: usize = 3;
const BETWEEN_LAST_SIGNS: Duration = Duration::from_millis(5);

impl<F: Fleet> Member<F> {
    pub(super) fn carry_out(&mut self) {
        if self.hands_over_at.is_some() {
            // What another thread had no time for is for that of the network.
            return self.act();
        }
        self.put_unsent();
        self.act();
    }

    fn put_unsent(&mut self) {
        let mut unsent = std::mem::take(&mut self.unsent);
        unsent.put(|Unsent { key, bytes, envelope, is_urgent }| self.put(key, bytes, envelope.as_deref(), *is_urgent));
        self.unsent = unsent;
    }

    /// Does what the exchange wants.
    pub(super) fn act(&mut self) {
        for action in self.exchange.take_actions() {
            match action {
                Action::Subscribe(keys) => self.subscribe(keys),
                Action::Unsubscribe(keys) => self.unsubscribe(&keys),
                Action::Put { to, bytes } => {
                    self.put_or_keep(&to, Arc::clone(&bytes), None);
                    if matches!(to, Destination::Leaves(_)) {
                        for _ in 1..LAST_SIGNS {
                            sleep(BETWEEN_LAST_SIGNS);
                            self.put_unsent();
                            self.put_or_keep(&to, Arc::clone(&bytes), None);
                        }
                    }
                }
                Action::Send { to, frame } => {
                    let (bytes, envelope) = frame.encode();
                    self.put_or_keep(&to, bytes, Some(envelope));
                }
                Action::Deliver { topic, arrived, .. } => self.undelivered.entry(topic).or_default().push_back(arrived),
                Action::Serve(request) => self.fleet.serve(request),
                Action::Answered { line, number, outcome } => {
                    if let Some(ticket) = self.tickets.remove(&(line, number)) {
                        ticket.fill(outcome);
                    }
                }
                Action::Remember(changes) => self.fleet.remember(changes),
                Action::Tell(news) => {
                    if let News::Unreachable { name, .. } | News::Left { name, .. } = &news {
                        self.fleet.misses(name);
                    }
                    let (level, text) = told(&news, &self.membership, &self.name);
                    if matches!(news, News::Superseded { .. }) {
                        self.failure = Some(text.clone());
                    }
                    if news.lost() > 0 {
                        self.fleet.count_lost(news.lost(), &text);
                    }
                    match &news {
                        News::Unreachable { name, .. } => self.fleet.alert(UNREACHABLE, name, Some(text)),
                        News::Back { name, .. } | News::GoesOn { name, .. } | News::Left { name, .. } => {
                            self.fleet.alert(UNREACHABLE, name, None);
                            self.fleet.tell(level, text);
                        }
                        _ => self.fleet.tell(level, text),
                    }
                }
            }
        }
    }

    fn subscribe(&mut self, keys: Keys) {
        let Some(session) = &self.session else { return };
        let token = self.next_token;
        self.next_token += 1;
        if let Err(error) = session.subscribe(&key::asked(&keys, self.program), token) {
            let text = format!("topic `{}` cannot be read from the network: {error}", keys.topic());
            self.fleet.tell(Level::Error, text);
        }
        self.tokens.insert(keys, token);
    }

    fn unsubscribe(&mut self, keys: &Keys) {
        let Some(session) = &self.session else { return };
        if let Some(token) = self.tokens.remove(keys)
            && let Err(error) = session.unsubscribe(token)
        {
            // It goes on to hear what it does not need.
            self.fleet.tell(Level::Warning, format!("topic `{}` is read still: {error}", keys.topic()));
        }
    }

    fn put_or_keep(&mut self, to: &Destination, bytes: Arc<[u8]>, envelope: Option<Arc<[u8]>>) {
        let key = match to {
            Destination::Topic(topic, component, cell) => key::topic(topic, component, *cell),
            Destination::Again(program, topic) => key::again(*program, topic),
            Destination::Alive(program) | Destination::Leaves(program) => key::alive(*program),
            Destination::Ask(program) => key::ask(*program),
            Destination::Runs(program) => key::runs(*program),
            Destination::Covered(program) => key::covered(*program),
            Destination::Look(program) => key::look(*program),
            Destination::Around(program, topic) => key::around(*program, topic),
            Destination::Call(program) => key::call(*program),
            Destination::Reply(program) => key::reply(*program),
        };
        // The last sign of life overtakes no state.
        let is_urgent = envelope.is_none() && !matches!(to, Destination::Leaves(_));
        let is_late = self.hands_over_at.is_some_and(|at| self.now() > at);
        if is_late || !self.unsent.is_empty() || !self.put(&key, &bytes, envelope.as_deref(), is_urgent) {
            self.unsent.push(Unsent { key, bytes, envelope, is_urgent });
        }
    }

    pub(super) fn put_answer(&self, asker: u64, answer: &Answer) {
        // It is asked for again if there is no room for it.
        self.put(&key::controlled(asker), &cdr::encode(answer), None, true);
    }

    /// Puts something on the network; false if there is no room for it.
    pub(super) fn put(&self, key: &str, bytes: &[u8], envelope: Option<&[u8]>, is_urgent: bool) -> bool {
        let Some(session) = &self.session else { return true };
        match session.put(key, bytes, envelope.unwrap_or_default(), is_urgent) {
            Ok(is_put) => is_put,
            // It is sent again when somebody lacks it.
            Err(error) => {
                self.fleet.tell(Level::Warning, format!("the network did not take `{key}`: {error}"));
                true
            }
        }
    }
}
