//! Which program each component runs in: one that is killed begins anew in another program, and none runs twice.
//!
//! Of two programs with a component, the one has it that *began* later: each program says when it began. It has asked
//! all others before, and heard nothing of the earlier one. So who did not answer then, as a program that was stopped,
//! is known as the earlier one by all, whomever they heard first, and ends when it hears of the later one.
//!
//! A program that is not there any more displaces none that is, whatever its date: it was killed, or has left.
//!
//! Dates of machines are compared that may differ. A program asks for half a second before it begins, and of two that
//! ask at once, one waits: clocks that agree within half a second are right. Where they do not, a date is still greater
//! than those of all programs with the same components of which anybody knew that answered (`latest` of [`Begins`]).

use std::collections::BTreeSet;
use std::sync::Arc;

use saoms_api::host::cdr;

use super::Exchange;
use super::action::{Action, Destination, News};
use super::hear::MOST_PROGRAMS;
use super::wire::{Begins, LARGEST_NUMBER};

/// Components that a program begins with, at most: more is no fleet.
const MOST_COMPONENTS: usize = 65_536;
/// Programs that a component ran in before which are remembered, at most.
const MOST_EARLIER: usize = 16;

/// The components with which a program has begun, or is about to, and when.
#[derive(Debug, Default)]
pub(super) struct Begun {
    components: BTreeSet<String>,
    began: u64,
}

/// The program that a component of another one runs in.
#[derive(Clone, Debug)]
pub(super) struct Owner {
    pub(super) program: u64,
    /// When that began.
    pub(super) began: u64,
    delivered: u64,
    /// Programs whose messages were ignored, or are from now on, and since when that is so.
    earlier: Vec<u64>,
    since: u64,
    /// True if it was told that the component runs in another program, too.
    is_told: bool,
}

impl Owner {
    fn new(program: u64, began: u64) -> Owner {
        Owner { program, began, delivered: 0, earlier: Vec::new(), since: 0, is_told: false }
    }

    fn ignore(&mut self, program: u64) {
        if !self.earlier.contains(&program) {
            if self.earlier.len() >= MOST_EARLIER {
                self.earlier.remove(0);
            }
            self.earlier.push(program);
        }
    }
}

impl Exchange {
    /// A program is about to begin with these components, or runs them.
    pub fn note_begin(&mut self, begins: Begins) {
        let Begins { program, components, began, .. } = begins;
        let is_sane = components.len() <= MOST_COMPONENTS && began <= LARGEST_NUMBER;
        if program == self.settings.program || components.is_empty() || !is_sane {
            return;
        }
        if self.begun_with.len() >= MOST_PROGRAMS && !self.begun_with.contains_key(&program) {
            let peers = &self.peers;
            self.begun_with.retain(|program, _| peers.contains_key(program));
            if self.begun_with.len() >= MOST_PROGRAMS {
                return;
            }
        }
        // An answer names some of them.
        let begun = self.begun_with.entry(program).or_default();
        let room = MOST_COMPONENTS.saturating_sub(begun.components.len());
        begun.components.extend(components.into_iter().take(room));
        begun.began = begun.began.max(began);
        if self.peers.contains_key(&program) {
            self.replace(program);
        }
    }

    /// What this program says to one that asks whether components run elsewhere before they begin; `settles` is the
    /// time within which others connect to this one. `None` if there is nothing to say.
    pub fn answer_begin(&self, begins: &Begins, settles: u64) -> Option<Begins> {
        if begins.program == self.settings.program {
            return None;
        }
        let both = begins.components.iter().filter(|one| self.settings.components.contains(*one));
        let others = self.begun_with.iter().filter(|(program, _)| **program != begins.program);
        let shares = |begun: &&Begun| begins.components.iter().any(|one| begun.components.contains(one));
        let latest = others.map(|(_, begun)| begun).filter(shares).map(|begun| begun.began).max().unwrap_or_default();
        let answer = Begins { components: both.cloned().collect(), latest, settles, ..self.settings.begins() };
        (!answer.components.is_empty() || latest > 0 || settles > 0).then_some(answer)
    }

    /// Says to a program what runs in this one.
    pub(super) fn introduce(&mut self, program: u64) {
        if self.settings.components.is_empty() {
            return;
        }
        let runs = Begins { components: self.settings.components.iter().cloned().collect(), ..self.settings.begins() };
        self.actions.push(Action::Put { to: Destination::Runs(program), bytes: cdr::encode(&runs).into() });
    }

    /// When a program began, in the order in which components pass from one to another.
    fn start_of(&self, program: u64) -> (u64, u64) {
        (self.peers.get(&program).map_or(0, |peer| peer.began), program)
    }

    fn own_start(&self) -> (u64, u64) {
        (self.settings.began, self.settings.program)
    }

    /// True if components of a program are those of this one.
    pub(super) fn is_of_own(&self, program: u64) -> bool {
        let begun = self.begun_with.get(&program);
        begun.is_some_and(|begun| !begun.components.is_disjoint(&self.settings.components))
    }

    /// A program has begun: those that began before it with components of it are over, or it would not have, and
    /// nothing is kept for them. It may itself be one of these: one that was stopped, and returns. Only who is there
    /// displaces others.
    pub(super) fn replace(&mut self, program: u64) {
        let start = self.start_of(program);
        let Some(begun) = self.begun_with.get(&program) else { return };
        let own = begun.components.iter().find(|one| self.settings.components.contains(*one));
        if let Some(component) = own.cloned().filter(|_| start > self.own_start()) {
            self.tell_superseded(&component, program);
        }
        let is_there = self.is_there(program);
        let both = self.peers.iter().filter(|(other, _)| **other != program && self.shares(program, **other));
        let over = both.filter_map(|(other, peer)| match self.start_of(*other) < start {
            true => is_there.then_some(*other),
            false => peer.is_reachable.then_some(program),
        });
        let mut over: BTreeSet<u64> = over.collect();
        if self.is_of_own(program) && start < self.own_start() {
            over.insert(program);
        }
        for other in over {
            let Some(peer) = self.peers.get_mut(&other).filter(|peer| !peer.is_over) else { continue };
            peer.is_over = true;
            let name = Arc::clone(&peer.name);
            self.actions.push(Action::Tell(News::Replaced { name }));
            // Calls may be for another one of its name.
            self.calls_at = 0;
        }
        self.forget_received();
    }

    /// These programs are not there any more, or one is there again: others may have their components, or not any more.
    pub(super) fn settle_owners(&mut self, programs: &[u64]) {
        let peers = &self.peers;
        let is_there = |program: &u64| peers.get(program).is_some_and(|peer| peer.is_reachable);
        for owner in self.owners.values_mut().filter(|owner| !is_there(&owner.program)) {
            owner.earlier.retain(|earlier| !is_there(earlier));
        }
        let is_concerned =
            |program: &u64| programs.iter().any(|other| other == program || self.shares(*program, *other));
        let there = self.peers.iter().filter(|(_, peer)| peer.is_reachable).map(|(program, _)| *program);
        let concerned: Vec<u64> = there.filter(is_concerned).collect();
        for program in &concerned {
            if !self.is_displaced(*program)
                && let Some(peer) = self.peers.get_mut(program)
                && std::mem::take(&mut peer.is_over)
            {
                // Calls may be for it.
                self.calls_at = 0;
            }
        }
        concerned.into_iter().for_each(|program| self.replace(program));
    }

    fn is_there(&self, program: u64) -> bool {
        self.peers.get(&program).is_some_and(|peer| peer.is_reachable)
    }

    /// True if both programs have begun with a component.
    fn shares(&self, program: u64, other: u64) -> bool {
        let both = self.begun_with.get(&program).zip(self.begun_with.get(&other));
        both.is_some_and(|(one, other)| !one.components.is_disjoint(&other.components))
    }

    /// True if a program that is there has begun with a component of this one later.
    fn is_displaced(&self, program: u64) -> bool {
        let start = self.start_of(program);
        let is_later = |other: u64| self.start_of(other) > start && self.shares(program, other);
        self.is_of_own(program) && start < self.own_start()
            || self.peers.iter().any(|(other, peer)| peer.is_reachable && is_later(*other))
    }

    /// True if the messages of a component count that come from this program: of those that run it, the one that began
    /// last. A program that was killed and begins anew is heard before the old one is missed.
    pub(super) fn is_of(&mut self, program: u64, component: &str) -> bool {
        if self.settings.components.contains(component) {
            // Messages of an earlier start of this program may be on their way.
            if self.now > self.begun + self.settings.patience {
                self.tell_twice(program, component);
            }
            return false;
        }
        let start = self.start_of(program);
        let (is_first, is_later) = match self.owners.get_mut(component) {
            Some(owner) if owner.program == program => {
                owner.delivered += 1;
                return true;
            }
            Some(owner) => {
                let is_there = self.peers.get(&owner.program).is_some_and(|peer| peer.is_reachable);
                let is_free = !is_there && !owner.earlier.contains(&program);
                (false, is_free || start > (owner.began, owner.program))
            }
            None => (true, true),
        };
        let counts = is_later && !self.has_begun_later(program, component);
        let now = self.now;
        if counts {
            let mut owner = Owner { delivered: 1, since: now, ..Owner::new(program, start.0) };
            if let Some(before) = self.owners.remove(component) {
                owner.earlier = before.earlier;
                owner.earlier.retain(|earlier| *earlier != program);
                if before.delivered > 0 {
                    let (component, name, after) = (component.into(), self.name_of(program), before.delivered);
                    self.actions.push(Action::Tell(News::Anew { component, program, name, after }));
                    owner.ignore(before.program);
                } else {
                    owner.is_told = before.is_told;
                }
            }
            self.owners.insert(component.to_owned(), owner);
        } else if is_first {
            self.tell_twice(program, component);
            self.owners.get_mut(component).into_iter().for_each(|owner| owner.ignore(program));
        } else if let Some(owner) = self.owners.get_mut(component) {
            owner.ignore(program);
            if now > owner.since + self.settings.patience {
                self.tell_twice(program, component);
            }
        }
        counts
    }

    /// True if a program that is there has begun with a component later than this one.
    fn has_begun_later(&self, program: u64, component: &str) -> bool {
        let start = self.start_of(program);
        let has_begun = |other: u64| self.begun_with.get(&other).is_some_and(|one| one.components.contains(component));
        let mut there = self.peers.iter().filter(|(_, peer)| peer.is_reachable).map(|(other, _)| *other);
        there.any(|other| other != program && self.start_of(other) > start && has_begun(other))
    }

    /// A program is there: components of it that have begun anew elsewhere, some time ago, run twice.
    pub(super) fn note_twice(&mut self, program: u64) {
        let (now, patience) = (self.now, self.settings.patience);
        let is_twice = |owner: &Owner| owner.earlier.contains(&program) && now > owner.since + patience;
        let twice = self.owners.iter().filter(|(_, owner)| !owner.is_told && is_twice(owner));
        let twice: Vec<String> = twice.map(|(component, _)| component.clone()).collect();
        twice.iter().for_each(|component| self.tell_twice(program, component));
    }

    /// Tells once that a component runs in this program, too.
    fn tell_twice(&mut self, program: u64, component: &str) {
        let owner = self.owners.entry(component.to_owned()).or_insert_with(|| Owner::new(0, 0));
        if !std::mem::replace(&mut owner.is_told, true) {
            let name = self.name_of(program);
            self.actions.push(Action::Tell(News::Twice { component: component.into(), program, name }));
        }
    }

    /// Tells once that a component of this program runs in one that began later.
    fn tell_superseded(&mut self, component: &str, program: u64) {
        if !std::mem::replace(&mut self.is_superseded, true) {
            let name = self.name_of(program);
            self.actions.push(Action::Tell(News::Superseded { component: component.into(), name }));
        }
    }
}
