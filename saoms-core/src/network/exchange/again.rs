//! Messages that are missing: they are asked for again, and answered.

use std::sync::Arc;

use saoms_api::host::cdr;

use super::incoming::Incoming;
use super::wire::{Again, Covered};
use super::{Action, Destination, Exchange, LATENESS, LONGEST_WAIT};

/// Messages that are sent again for one request, at most.
const MOST_AGAIN: usize = 1_024;
/// Bytes that are sent again for one request, at most, beside the last message.
const MOST_AGAIN_BYTES: usize = 1 << 20;

impl Exchange {
    /// Asks for what is missing. Gives the time at which that is due next.
    pub(super) fn ask(&mut self, now: u64) -> u64 {
        let mut next = u64::MAX;
        for (program, peer) in self.peers.iter_mut().filter(|(_, peer)| peer.is_reachable) {
            for (topic, incoming) in &mut peer.incoming {
                let Some(at) = incoming.ask_at else { continue };
                if at > now {
                    next = next.min(at);
                    continue;
                }
                let Some((first, last)) = incoming.missing() else {
                    incoming.ask_at = None;
                    continue;
                };
                // A part at a time: who is asked for all again and again has no time for what is new.
                let last = last.min(first + MOST_AGAIN as u64 - 1);
                incoming.asked_up_to = last;
                let again = Again { reader: self.settings.program, topic: topic.to_string(), first, last };
                let (to, bytes) = (Destination::Ask(*program), cdr::encode(&again).into());
                self.actions.push(Action::Put { to, bytes });
                let wait = ((2 * LATENESS) << incoming.asked.min(10)).min(LONGEST_WAIT);
                incoming.asked += 1;
                incoming.ask_at = Some(now + wait);
                next = next.min(now + wait);
            }
        }
        next
    }

    /// Another program asks for messages again.
    pub fn answer(&mut self, again: &Again) {
        let Some((topic, outgoing)) = self.outgoing.get_key_value(again.topic.as_str()) else { return };
        let (topic, is_state, newest) = (Arc::clone(topic), outgoing.is_state(), outgoing.last);
        let (mut size, mut last) = (0, again.last);
        let mut found = Vec::new();
        for sent in outgoing.between(again.first, again.last) {
            if found.len() == MOST_AGAIN || size > MOST_AGAIN_BYTES {
                last = sent.number - 1;
                break;
            }
            size += sent.bytes.len();
            found.push(sent.clone());
        }
        let numbers = found.iter().map(|sent| sent.number).collect();
        for sent in found {
            self.put_message(Destination::Again(again.reader, Arc::clone(&topic)), is_state, sent);
        }
        if is_state {
            let (program, last) = (self.settings.program, last.min(newest));
            let covered = Covered { program, topic: topic.to_string(), first: again.first, last, numbers };
            let to = Destination::Covered(again.reader);
            self.actions.push(Action::Put { to, bytes: cdr::encode(&covered).into() });
        }
    }

    /// Another program says which messages of a state topic are outdated.
    pub fn cover(&mut self, covered: &Covered, now: u64) {
        // No event is outdated.
        if self.reads.get(covered.topic.as_str()).is_none_or(|own| !own.is_state) {
            return;
        }
        let peer = self.peers.get_mut(&covered.program);
        let Some(incoming) = peer.and_then(|peer| peer.incoming.get_mut(covered.topic.as_str())) else { return };
        incoming.skip_outdated(covered);
        note_missing(incoming, now);
    }
}

/// Asks soon for what is missing. While what was asked for arrives, it is waited for; then the next part is asked for.
pub(super) fn note_missing(incoming: &mut Incoming, now: u64) {
    let before = std::mem::replace(&mut incoming.seen, incoming.next);
    if incoming.missing().is_none() {
        incoming.ask_at = None;
    } else if incoming.ask_at.is_none() {
        (incoming.asked, incoming.asked_up_to) = (0, 0);
        incoming.ask_at = Some(now + LATENESS);
    } else if incoming.next > before && incoming.asked_up_to > 0 {
        incoming.asked = 0;
        let is_over = incoming.next > incoming.asked_up_to;
        incoming.ask_at = Some(if is_over { now } else { now + 2 * LATENESS });
    }
}
