//! When the programs of a network agree that no work is left, and how one leaves.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::peer::Peer;
use super::wire::Vote;
use super::{Action, Exchange, News, OwnTopic};

impl Exchange {
    /// True if all other programs have received all events of this one, but for those that were missed for long.
    pub fn is_complete(&self) -> bool {
        self.lacking().all(|(peer, ..)| !peer.is_awaited(self.now, self.settings.linger))
    }

    /// The programs that are waited for since they lack events of this one: their names, the number of these, and
    /// whether they are there.
    pub fn awaited(&self) -> Vec<(Arc<str>, u64, bool)> {
        let mut all: BTreeMap<Arc<str>, (u64, bool)> = BTreeMap::new();
        for (peer, _, count) in self.lacking().filter(|(peer, ..)| peer.is_awaited(self.now, self.settings.linger)) {
            let one = all.entry(Arc::clone(&peer.name)).or_insert((0, true));
            *one = (one.0 + count, one.1 && peer.is_reachable);
        }
        all.into_iter().map(|(name, (count, is_there))| (name, count, is_there)).collect()
    }

    /// The programs that lack events of this one, with the topic and the number of these.
    fn lacking(&self) -> impl Iterator<Item = (&Peer, &Arc<str>, u64)> {
        let peers = self.peers.values().filter(|peer| !peer.is_given_up);
        peers.flat_map(move |peer| self.lacked_by(peer).map(move |(topic, count)| (peer, topic, count)))
    }

    /// Says whether the program sees work left.
    pub fn vote(&mut self, vote: Vote) {
        if std::mem::replace(&mut self.vote, vote) != vote {
            self.say_soon();
        }
    }

    /// The programs that no work can be done without, and that were never there, if nothing else is left to do.
    pub fn waits_for(&self) -> Option<&BTreeSet<String>> {
        Some(&self.unheard).filter(|unheard| !unheard.is_empty() && self.is_agreed())
    }

    /// True if some program has seen that all work is done, no program that is there sees work left, and all that the
    /// fleet needs have been there.
    pub fn is_done(&self) -> bool {
        self.unheard.is_empty() && self.is_agreed()
    }

    /// True if all events have arrived of which the programs that are there say that they sent them. A program says at
    /// once that it sees no work left, and what it sent before may still be on its way.
    pub fn has_received_all(&self) -> bool {
        let there = self.peers.values().filter(|peer| peer.is_reachable && !peer.is_over);
        let mut incoming = there.flat_map(|peer| &peer.incoming);
        incoming.all(|(topic, incoming)| incoming.missing().is_none() || !self.reads.get(topic).is_some_and(is_event))
    }

    /// Counts events as lost that programs have sent, are there, and did not send again for long.
    pub fn give_up_missing(&mut self) {
        let mut given_up = Vec::new();
        for (program, peer) in self.peers.iter_mut().filter(|(_, peer)| peer.is_reachable && !peer.is_over) {
            for (topic, incoming) in &mut peer.incoming {
                let Some(count) = incoming.lacks() else { continue };
                if self.reads.get(topic).is_some_and(is_event) {
                    let (_, ready) = incoming.skip_to(incoming.last + 1);
                    given_up.push((*program, Arc::clone(&peer.name), Arc::clone(topic), count, ready));
                }
            }
        }
        for (program, name, topic, count, ready) in given_up {
            self.actions.push(Action::Tell(News::Lost { program, name, topic: Arc::clone(&topic), count }));
            self.deliver(program, &topic, ready);
        }
    }

    fn is_agreed(&self) -> bool {
        // Who said that all is done, and vanished, has said so: its last sign of life may be lost.
        // One whose components run elsewhere by now is about to end.
        let counts = |peer: &&Peer| !peer.is_over && (peer.is_reachable || peer.vote == Vote::Done);
        let there = self.peers.values().filter(counts).map(|peer| peer.vote);
        let mut is_done = self.was_done;
        for vote in there.chain([self.vote]) {
            match vote {
                Vote::Silent => {}
                Vote::Open => return false,
                Vote::Done => is_done = true,
            }
        }
        is_done
    }

    /// The program leaves the network.
    pub fn leave(&mut self) {
        self.tell_overflow();
        let unreceived = self.lacking().map(|(peer, topic, count)| {
            let (name, topic) = (Arc::clone(&peer.name), Arc::clone(topic));
            Action::Tell(match self.settings.memory {
                Some(_) => News::Later { name, topic, count },
                None => News::Unreceived { name, topic, count },
            })
        });
        // What is kept no more for who was given up is in no state folder either.
        let given_up = self.peers.values().filter(|peer| peer.is_given_up);
        let not_kept = given_up.flat_map(|peer| self.lacked_by(peer).map(move |(topic, count)| (peer, topic, count)));
        let not_kept = not_kept.map(|(peer, topic, count)| {
            Action::Tell(News::Unreceived { name: Arc::clone(&peer.name), topic: Arc::clone(topic), count })
        });
        let unreceived: Vec<Action> = unreceived.chain(not_kept).collect();
        self.actions.extend(unreceived);
        self.remember();
        // What found no room counts as lost where this program is heard last.
        self.outgoing.values_mut().for_each(|outgoing| _ = outgoing.number_owed());
        let alive = self.sign_of_life(true);
        self.put_alive(&alive);
    }
}

/// True if a program waits for what it lacks of a topic.
fn is_event(topic: &OwnTopic) -> bool {
    !topic.is_state
}
