//! Which program each component runs in: one that is killed begins anew in another program, and none runs twice.

use std::sync::Arc;

use super::Exchange;
use super::action::{Action, News};
use super::hear::MOST_PROGRAMS;
use super::peer::Peer;
use super::wire::Begins;

/// Components that a program begins with, at most: more is no fleet.
const MOST_COMPONENTS: usize = 65_536;

/// The program that a component of another one runs in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Owner {
    pub(super) program: u64,
    delivered: u64,
    /// The program that it ran in before, and when that was over.
    before: Option<(u64, u64)>,
    /// True if it was told that the component runs in another program, too.
    is_told: bool,
}

impl Exchange {
    /// A program is about to begin with these components, or runs them.
    pub fn note_begin(&mut self, begins: Begins) {
        if begins.program == self.settings.program || begins.components.len() > MOST_COMPONENTS {
            return;
        }
        if self.begun_with.len() >= MOST_PROGRAMS && !self.begun_with.contains_key(&begins.program) {
            let peers = &self.peers;
            self.begun_with.retain(|program, _| peers.contains_key(program));
            if self.begun_with.len() >= MOST_PROGRAMS {
                return;
            }
        }
        self.begun_with.insert(begins.program, begins.components.into_iter().collect());
        if self.peers.contains_key(&begins.program) {
            self.replace(begins.program);
        }
    }

    /// A program has begun: those that were there before it with components of it are over, or it would not have, and
    /// nothing is kept for them.
    pub(super) fn replace(&mut self, program: u64) {
        let Some((components, since)) =
            self.begun_with.get(&program).zip(self.peers.get(&program).map(|peer| peer.since))
        else {
            return;
        };
        let is_over = |other: &u64, peer: &Peer| {
            let others = self.begun_with.get(other).filter(|_| peer.since < since);
            others.is_some_and(|others| !others.is_disjoint(components))
        };
        let over = self.peers.iter().filter(|(other, peer)| is_over(other, peer)).map(|(other, _)| *other);
        let over: Vec<u64> = over.collect();
        for other in over {
            let Some(peer) = self.peers.get_mut(&other).filter(|peer| !peer.is_given_up) else { continue };
            peer.is_given_up = true;
            let name = Arc::clone(&peer.name);
            self.actions.push(Action::Tell(News::Replaced { name }));
        }
        self.forget_received();
    }

    /// True if the messages of a component count that come from this program: the one in which it began last. A program
    /// that was killed and begins anew is heard before the old one is missed.
    pub(super) fn is_of(&mut self, program: u64, component: &str) -> bool {
        let now = self.now;
        if self.settings.components.contains(component) {
            // Messages of an earlier start of this program may be on their way.
            if now > self.begun + self.settings.patience {
                self.tell_twice(program, component);
            }
            return false;
        }
        let Some(owner) = self.owners.get_mut(component) else {
            self.owners.insert(component.to_owned(), Owner { program, delivered: 1, before: None, is_told: false });
            return true;
        };
        if owner.program == program {
            owner.delivered += 1;
            return true;
        }
        if owner.before.is_some_and(|(before, _)| before == program) {
            return false;
        }
        let (before, after) = (owner.program, owner.delivered);
        *owner = Owner { program, delivered: 1, before: Some((before, now)), is_told: false };
        let name = self.name_of(program);
        self.actions.push(Action::Tell(News::Anew { component: component.into(), program, name, after }));
        true
    }

    /// A program is there: components of it that have begun anew elsewhere, some time ago, run twice.
    pub(super) fn note_twice(&mut self, program: u64) {
        let (now, patience) = (self.now, self.settings.patience);
        let is_twice =
            |owner: &Owner| owner.before.is_some_and(|(before, at)| before == program && now > at + patience);
        let twice = self.owners.iter().filter(|(_, owner)| is_twice(owner) && !owner.is_told);
        let twice: Vec<String> = twice.map(|(component, _)| component.clone()).collect();
        twice.iter().for_each(|component| self.tell_twice(program, component));
    }

    /// Tells once that a component runs in this program, too.
    fn tell_twice(&mut self, program: u64, component: &str) {
        let fresh = || Owner { program, delivered: 0, before: None, is_told: false };
        let owner = self.owners.entry(component.to_owned()).or_insert_with(fresh);
        if !std::mem::replace(&mut owner.is_told, true) {
            let name = self.name_of(program);
            self.actions.push(Action::Tell(News::Twice { component: component.into(), program, name }));
        }
    }
}
