//! Signs of life: what a program says of what it has sent and received, and what others say.

use std::sync::Arc;

use super::action::{Action, News};
use super::again::note_missing;
use super::cells::Cells;
use super::peer::{Peer, Reading};
use super::wire::{Alive, LARGEST_NUMBER, Reads, Received, Sends, Vote, Welcome};
use super::{Exchange, MILLISECOND, look};

/// Programs that are known at once, and topics of one of them, at most: more is no fleet.
pub(super) const MOST_PROGRAMS: usize = 4_096;
const MOST_TOPICS: usize = 4_096;
/// Each sign of life of so many says all that was received, the others what is new.
const FULL: u64 = 8;
/// Longest time without a sign of life that a program asks for, in milliseconds: three periods of a day.
const LONGEST_PATIENCE: u64 = 3 * 24 * 3_600_000;

impl Exchange {
    /// A sign of life of another program arrived.
    pub fn hear(&mut self, alive: &Alive, now: u64) {
        let program = alive.program;
        if program == self.settings.program || self.left.contains(&program) {
            return;
        }
        if !is_sane(alive) {
            return;
        }
        self.pass(now);
        let is_first = self.peers.get(&program).is_none_or(|peer| peer.is_recalled);
        if is_first && alive.leaves {
            // One that is known from an earlier start of this program has left meanwhile.
            if self.peers.contains_key(&program) {
                self.remove_peer(program);
                self.forget_received();
            }
            return;
        }
        if is_first && !self.meet(alive) {
            return;
        }
        let Some(peer) = self.peers.get_mut(&program).filter(|peer| alive.number > peer.sign) else { return };
        peer.vote = Vote::of(alive.vote);
        peer.signs = peer.signs.saturating_add(1);
        let signs = peer.signs;
        (peer.sign, peer.heard, peer.patience) = (alive.number, now, alive.patience.saturating_mul(MILLISECOND));
        if !std::mem::replace(&mut peer.is_reachable, true) {
            self.calls_at = 0;
            let name = Arc::clone(&peer.name);
            self.actions.push(Action::Tell(News::Back { program, name }));
            self.settle_owners(&[program]);
        }
        let is_over = self.peers.get(&program).is_some_and(|peer| peer.is_over);
        // What is said once may be lost, so that it is said ever more rarely; and one that was stopped for long does
        // not know yet that its components run here.
        if signs.is_power_of_two() || is_over && self.is_of_own(program) {
            self.introduce(program);
        }
        self.note_twice(program);
        self.hear_reader(alive);
        self.hear_sender(alive, now);
        if alive.leaves {
            self.remove(program);
        }
    }

    /// A program is heard first. False if it is not heard any further.
    fn meet(&mut self, alive: &Alive) -> bool {
        let (program, is_recalled) = (alive.program, self.peers.contains_key(&alive.program));
        if !is_recalled && self.peers.len() >= MOST_PROGRAMS && !self.give_up_one() {
            return false;
        }
        let name: Arc<str> = alive.name.as_str().into();
        if !is_recalled && alive.start != 0 && !self.succeed(alive) {
            return false;
        }
        let now = self.now;
        let goes_on = self.past.contains_key(&alive.origin);
        let peer = self.peers.entry(program).or_insert_with(|| Peer::new(&alive.name, now));
        (peer.name, peer.origin, peer.start) = (Arc::clone(&name), alive.origin, alive.start);
        (peer.began, peer.signs, peer.is_over) = (alive.began, 0, false);
        (peer.is_recalled, peer.is_reachable) = (false, true);
        self.unheard.remove(&alive.name);
        self.actions.push(Action::Tell(match goes_on {
            true => News::GoesOn { program, name },
            false => News::Joined { program, name },
        }));
        self.go_on(alive);
        self.go_on_reading(alive);
        self.replace(program);
        // Calls may wait for it, or for one before it.
        self.calls_at = 0;
        self.say_soon();
        true
    }

    /// Gives up the program that was missed first, as one that was killed: there are as many as can be known. False if
    /// all are there.
    fn give_up_one(&mut self) -> bool {
        let away = self.peers.iter().filter(|(_, peer)| !peer.is_reachable);
        let Some(program) = away.min_by_key(|(_, peer)| peer.heard).map(|(program, _)| *program) else { return false };
        if let Some(peer) = self.remove_peer(program) {
            // If it is there again after all, it begins anew.
            self.left.remove(&program);
            let count = self.lacked_by(&peer).map(|(_, count)| count).sum();
            self.actions.push(Action::Tell(News::GivenUp { program, name: peer.name, count }));
            self.forget_received();
        }
        true
    }

    /// What another program says as a reader of this one.
    fn hear_reader(&mut self, alive: &Alive) {
        let Some(peer) = self.peers.get_mut(&alive.program) else { return };
        let mut is_new = false;
        for Reads { topic } in &alive.reads {
            if !peer.reading.contains_key(topic.as_str()) {
                let outgoing = self.outgoing.get(topic.as_str());
                let first = outgoing.filter(|outgoing| !outgoing.is_state()).map_or(1, |outgoing| outgoing.last + 1);
                let reading = Reading { next: first, ..Reading::default() };
                peer.reading.insert(Arc::from(topic.as_str()), reading);
                is_new = true;
            }
        }
        let own = alive.received.iter().filter(|received| received.program == self.settings.program);
        for Received { topic, next, .. } in own {
            if let Some(reading) = peer.reading.get_mut(topic.as_str()) {
                reading.is_welcomed = true;
                reading.next = reading.next.max(*next);
            }
        }
        self.take_back(alive.program);
        if is_new {
            self.say_soon();
        }
        self.forget_received();
    }

    /// What another program says as a sender.
    fn hear_sender(&mut self, alive: &Alive, now: u64) {
        let program = alive.program;
        let mut ready = Vec::new();
        let Some(peer) = self.peers.get_mut(&program) else { return };
        for Sends { topic, last, oldest, by_cells, since, cells, .. } in &alive.sends {
            let Some((topic, own)) = self.reads.get_key_value(topic.as_str()) else { continue };
            let incoming = peer.incoming.entry(Arc::clone(topic)).or_default();
            incoming.is_by_cells = *by_cells;
            if let Some(wanted) = own.cells.as_ref().filter(|_| *by_cells) {
                let around = incoming.around.get_or_insert_with(|| look::read(wanted));
                around.hear(*last, *since, cells);
                around.settle(now);
                continue;
            }
            incoming.last = incoming.last.max(*last);
            let (count, late) = incoming.skip_to(*oldest);
            if count > 0 {
                let (name, topic) = (Arc::clone(&peer.name), Arc::clone(topic));
                self.actions.push(Action::Tell(News::Lost { program, name, topic, count }));
            }
            ready.push((Arc::clone(topic), late));
        }
        for Welcome { topic, first, .. } in alive.welcomes.iter().filter(|one| one.reader == self.settings.program) {
            let Some((topic, _)) = self.reads.get_key_value(topic.as_str()) else { continue };
            let incoming = peer.incoming.entry(Arc::clone(topic)).or_default();
            self.has_news |= incoming.next == 0;
            ready.push((Arc::clone(topic), incoming.welcome(*first)));
        }
        for incoming in peer.incoming.values_mut() {
            note_missing(incoming, now);
        }
        for (topic, ready) in ready {
            self.deliver(program, &topic, ready);
        }
    }

    pub(super) fn sign_of_life(&mut self, leaves: bool) -> Alive {
        self.sign += 1;
        self.note_sign();
        let memory = self.settings.memory.as_ref();
        let sends = self.outgoing.iter().map(|(topic, outgoing)| {
            let (since, cells) = outgoing.cells.as_ref().map(Cells::news).unwrap_or_default();
            Sends {
                topic: topic.to_string(),
                is_state: outgoing.is_state(),
                last: outgoing.last,
                oldest: outgoing.oldest(),
                before: outgoing.before,
                by_cells: outgoing.cells.is_some(),
                since,
                cells,
            }
        });
        let is_full = self.sign.is_multiple_of(FULL);
        let mut received = Vec::new();
        for (program, peer) in &mut self.peers {
            for (topic, incoming) in &mut peer.incoming {
                let is_state = self.reads.get(topic).is_some_and(|own| own.is_state);
                if let Some(next) = incoming.say_received(is_state, memory.is_some(), is_full) {
                    received.push(Received { program: *program, topic: topic.to_string(), next });
                }
            }
        }
        let welcomes = self.peers.iter().flat_map(|(reader, peer)| {
            let new = peer.reading.iter().filter(|(_, reading)| !reading.is_welcomed);
            new.map(|(topic, reading)| Welcome { reader: *reader, topic: topic.to_string(), first: reading.next })
        });
        Alive {
            program: self.settings.program,
            origin: memory.map_or(self.settings.program, |memory| memory.origin),
            start: memory.map_or(0, |memory| memory.start),
            began: self.settings.began,
            name: self.settings.name.clone(),
            number: self.sign,
            patience: self.settings.patience / MILLISECOND,
            sends: sends.collect(),
            reads: self.reads.keys().map(|topic| Reads { topic: topic.to_string() }).collect(),
            received,
            welcomes: welcomes.collect(),
            vote: self.vote as u8,
            leaves,
        }
    }

    fn remove(&mut self, program: u64) {
        if let Some(mut peer) = self.remove_peer(program) {
            self.was_done |= peer.vote == Vote::Done;
            for (topic, incoming) in &peer.incoming {
                if let Some(count) =
                    incoming.lacks().filter(|_| self.reads.get(topic).is_some_and(|topic| !topic.is_state))
                {
                    let (name, topic) = (Arc::clone(&peer.name), Arc::clone(topic));
                    // What a state folder keeps comes with the next start.
                    self.actions.push(Action::Tell(match peer.start {
                        0 => News::Lost { program, name, topic, count },
                        _ => News::Stays { name, topic, count },
                    }));
                }
            }
            self.remember_past(program, &mut peer);
            self.actions.push(Action::Tell(News::Left { program, name: peer.name }));
            self.settle_owners(&[program]);
            self.forget_received();
        }
    }
}

/// True if a sign of life is one that a program of a fleet says: who says others cannot make this one count beyond its
/// numbers, or keep more than it has room for.
fn is_sane(alive: &Alive) -> bool {
    let sends = alive.sends.iter().flat_map(|sends| [sends.last, sends.oldest, sends.since, sends.before]);
    let cells = alive.sends.iter().flat_map(|sends| sends.cells.iter().map(|cell| cell.last));
    let welcomes = alive.welcomes.iter().map(|welcome| welcome.first);
    let received = alive.received.iter().map(|received| received.next);
    alive.patience <= LONGEST_PATIENCE
        && alive.reads.len() <= MOST_TOPICS
        && alive.sends.len() <= MOST_TOPICS
        && alive.began <= LARGEST_NUMBER
        && sends.chain(cells).chain(welcomes).chain(received).all(|number| number <= LARGEST_NUMBER)
}
