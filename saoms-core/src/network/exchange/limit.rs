//! What is kept for others, and for whom it is kept no more when it is too much.
//!
//! A message that is lost counts once for each program that is given up, when it is forgotten, and once for all others.

use std::cmp::Reverse;
use std::sync::Arc;

use super::Exchange;
use super::action::{Action, News};
use super::outgoing::Outgoing;
use super::peer::{Peer, Reading};

impl Exchange {
    /// Forgets events that all readers have received. Where none is left, they learn of those that found no room.
    pub(super) fn forget_received(&mut self) {
        let mut has_numbered = false;
        for (topic, outgoing) in &mut self.outgoing {
            let needed = self.peers.values().filter_map(|peer| peer.needs(topic)).min();
            if let Some(cells) = &mut outgoing.cells {
                // Who is away looks when it is back.
                let there = self.peers.values().filter(|peer| peer.is_reachable);
                let needed = there.filter_map(|peer| peer.needs(topic)).min().unwrap_or(outgoing.last + 1);
                cells.forget(needed.saturating_sub(1));
            }
            outgoing.forget_before(needed.unwrap_or(outgoing.last + 1));
            // A number behind kept events would be asked for, and a sign of life overtakes those that are on their way.
            has_numbered |= outgoing.size == 0 && outgoing.number_owed();
        }
        if has_numbered {
            self.say_soon();
        }
    }

    /// Gives up programs that are away, and then events, when too much is kept.
    pub(super) fn keep_within_limit(&mut self) {
        loop {
            let size: usize = self.outgoing.values().filter(|one| !one.is_state()).map(|outgoing| outgoing.size).sum();
            if size <= self.settings.limit {
                return;
            }
            if let Some(program) = self.most_kept_for() {
                self.give_up(program);
                continue;
            }
            let all = self.outgoing.iter_mut().filter(|(_, outgoing)| !outgoing.is_state());
            let Some((topic, outgoing)) = all.max_by_key(|(_, outgoing)| outgoing.size) else { return };
            let count = outgoing.forget_before(outgoing.oldest() + 1);
            *self.overflow.entry(Arc::clone(topic)).or_default() += count;
            if count == 0 {
                return;
            }
        }
    }

    /// The program for which most is kept, of those that are away and for which something is kept that no program needs
    /// which is there.
    fn most_kept_for(&self) -> Option<u64> {
        let away = self.peers.iter().filter(|(_, peer)| !peer.is_reachable);
        let kept = away.map(|(program, peer)| ((self.kept_for(peer), Reverse(peer.heard)), *program));
        kept.filter(|((size, _), _)| *size > 0).max().map(|(_, program)| program)
    }

    /// Bytes of the events that are kept for a program, but for none that is there.
    fn kept_for(&self, peer: &Peer) -> usize {
        let events = self.outgoing.iter().filter(|(_, outgoing)| !outgoing.is_state());
        let kept = events.map(|(topic, outgoing)| {
            let Some(first) = peer.needs(topic) else { return 0 };
            let there = self.peers.values().filter(|peer| peer.is_reachable).filter_map(|peer| peer.needs(topic)).min();
            outgoing.size_between(first, there.unwrap_or(outgoing.last + 1))
        });
        kept.sum()
    }

    /// Keeps nothing for a program any more that is away. What is still kept for others may reach it when it is back.
    fn give_up(&mut self, program: u64) {
        let oldest = |exchange: &Exchange, topic: &str| exchange.outgoing.get(topic).map_or(1, Outgoing::oldest);
        let Some(peer) = self.peers.get_mut(&program) else { return };
        peer.is_given_up = true;
        let (name, topics) = (Arc::clone(&peer.name), peer.reading.keys().cloned().collect::<Vec<_>>());
        let before: Vec<u64> = topics.iter().map(|topic| oldest(self, topic)).collect();
        self.forget_received();
        let mut count = 0;
        for (topic, before) in topics.iter().zip(before) {
            let lost_before = oldest(self, topic);
            let Some(reading) = self.peers.get_mut(&program).and_then(|peer| peer.reading.get_mut(topic)) else {
                continue;
            };
            reading.counted = lost_before;
            count += lost_before.saturating_sub(reading.next.max(before));
        }
        self.actions.push(Action::Tell(News::GivenUp { program, name, count }));
    }

    /// A program is there again, and has said what it has received: if it was given up, it lacks what is not kept any
    /// more.
    pub(super) fn take_back(&mut self, program: u64) {
        let Some(peer) = self.peers.get_mut(&program).filter(|peer| peer.is_given_up) else { return };
        peer.is_given_up = false;
        let mut count = 0;
        for (topic, reading) in &mut peer.reading {
            let Some(outgoing) = self.outgoing.get(topic).filter(|outgoing| !outgoing.is_state()) else { continue };
            let oldest = outgoing.oldest();
            count += oldest.saturating_sub(reading.next.max(reading.counted));
            reading.next = reading.next.max(oldest);
        }
        if count > 0 {
            let name = Arc::clone(&peer.name);
            self.actions.push(Action::Tell(News::NotKept { name, count }));
        }
    }

    /// Tells which events were lost for want of room: all since the last time together, since they can be many.
    pub(super) fn tell_overflow(&mut self) {
        let lost = std::mem::take(&mut self.overflow).into_iter().filter(|(_, count)| *count > 0);
        self.actions.extend(lost.map(|(topic, count)| Action::Tell(News::Overflow { topic, count })));
    }

    /// Of each topic the number of events that a program lacks, and that were not counted as lost.
    pub(super) fn lacked_by<'a>(&'a self, peer: &'a Peer) -> impl Iterator<Item = (&'a Arc<str>, u64)> {
        let events = self.outgoing.iter().filter(|(_, outgoing)| !outgoing.is_state());
        events.filter_map(|(topic, outgoing)| {
            let Reading { next, counted, .. } = peer.reading.get(topic).filter(|_| !peer.is_over)?;
            // What was forgotten for want of room before it was given up has been counted for all.
            let first = if peer.is_given_up { *counted } else { outgoing.oldest() };
            let count = (outgoing.last + 1).saturating_sub(first.max(*next));
            (count > 0).then_some((topic, count))
        })
    }
}
