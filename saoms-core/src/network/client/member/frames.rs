//! Frames that arrived, taken apart.

use saoms_api::Level;
use saoms_api::host::{cdr, shown};

use super::super::enter::answer;
use super::super::{ACCESS, ALIVE, ASK, BEGINS, CALL, CONTROL, COVERED, FIRST_OF_TOPICS, LOOK, REPLY, RUNS};
use super::Member;
use crate::network::Fleet;
use crate::network::control::{Ask, Asked};
use crate::network::key;
use crate::network::port::Frame;
use crate::network::rights::Granted;
use crate::network::transport::Delivered;

/// Versions of other programs that are told, at most.
const MOST_VERSIONS: usize = 8;
/// Messages of a topic that wait for room in the fleet, at most: then the topic is read no further, and its senders
/// keep what they have.
const MOST_UNDELIVERED: usize = 4_096;

impl<F: Fleet> Member<F> {
    pub(super) fn take_frame(&mut self, frame: &Frame, now: u64) {
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
            BEGINS => {
                if let Ok(begins) = cdr::decode(&frame.message) {
                    if let Some((session, runs)) =
                        self.session.as_ref().zip(self.exchange.answer_begin(&begins, self.settles()))
                    {
                        answer(session, begins.program, &runs);
                    }
                    self.exchange.note_begin(begins);
                }
            }
            RUNS => {
                if let Ok(begins) = cdr::decode(&frame.message) {
                    self.exchange.note_begin(begins);
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
            LOOK => {
                if let Ok(look) = cdr::decode(&frame.message) {
                    self.exchange.show(&look);
                }
            }
            FIRST_OF_TOPICS.. => {
                let Frame { token, key, message, attachment } = frame;
                self.take_messages(&Delivered { token: *token, key, message, attachment }, now);
            }
            _ => {}
        }
        self.carry_out();
    }

    /// Takes messages of a topic. True if some before them are missing.
    pub(super) fn take_messages(&mut self, delivered: &Delivered<'_>, now: u64) -> bool {
        let part = |place| delivered.key.split('/').nth(place);
        let kind = part(2);
        let Some(topic) = part(if kind == Some("topic") { 3 } else { 4 }).and_then(key::name) else { return false };
        // Senders keep what is dropped here, and send it again.
        if self.undelivered.get(topic.as_str()).is_some_and(|waiting| waiting.len() > MOST_UNDELIVERED) {
            return false;
        }
        match kind {
            Some("topic" | "again") => self.exchange.receive(&topic, delivered.message, delivered.attachment, now),
            _ => cdr::decode(delivered.message).is_ok_and(|around| self.exchange.see(around, now)),
        }
    }
}
