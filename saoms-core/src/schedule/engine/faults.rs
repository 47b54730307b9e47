//! Faults that are put into the run: how they begin, and how messages take their ways under them.

use std::sync::Arc;

use saoms_api::event::fault::{FaultCall, FaultKind, names_component};
use saoms_api::extension::{ConcernedComponent, ConcernedTopic};
use saoms_api::host::{SharedMessage, TopicKind};
use saoms_api::{Cause, Level};
use saoms_lang::assembly::{ComponentSpec, Restart};

use super::Engine;
use super::slot::Slot;
use crate::bus::{Link, TopicId};
use crate::fault::{Arrival, End, FaultPlay, OnLink};
use crate::observe::Occurrence;
use crate::schedule::networks::Networks;
use crate::schedule::settings::nanos;

fn end(number: u32, slot: &Slot) -> End<'_> {
    End { number, path: &slot.name, site: &slot.spec.site, node: &slot.spec.fault_node }
}

/// The same for one of this program or of another node.
fn any_end<'e>(slots: &'e [Slot], networks: &'e Networks, number: u32) -> Option<End<'e>> {
    if let Some(slot) = slots.get(number as usize) {
        return Some(end(number, slot));
    }
    let (spec, _) = networks.elsewhere.get(number)?;
    Some(End { number, path: &spec.path, site: &spec.site, node: &spec.fault_node })
}

/// True if a fault of components of a site names this one; an empty site is all.
fn is_named(spec: &ComponentSpec, call: &FaultCall, site: &str) -> bool {
    (site.is_empty() || spec.site == site)
        && call.to.iter().any(|word| names_component(&word.text, &spec.path, &spec.fault_node))
}

/// A component as observers of a fault hear of it.
fn concerned(spec: &ComponentSpec) -> ConcernedComponent {
    let publishes = spec.publishes().map(|declared| ConcernedTopic {
        name: spec.topic(&declared.name).into_owned(),
        message: declared.message.clone(),
    });
    let restarts = spec.task.as_ref().is_some_and(|task| task.restart == Restart::OnFailure);
    ConcernedComponent { path: spec.path.clone(), publishes: publishes.collect(), restarts }
}

impl Engine {
    /// The components that a fault of components names, everywhere.
    fn concerned_by(&self, call: &FaultCall, site: &str) -> Vec<ConcernedComponent> {
        let named = self.members_everywhere().filter(|(_, spec)| spec.task.is_some() && is_named(spec, call, site));
        named.map(|(_, spec)| concerned(&spec)).collect()
    }

    fn end_of(&self, number: u32) -> Option<End<'_>> {
        any_end(&self.slots, &self.networks, number)
    }

    /// Begins a fault, which the journal has as the record `cause`.
    #[cold]
    pub(crate) fn begin_fault(&mut self, (call, cause): (&FaultCall, Cause), site: &str, now: u64) {
        let restart = if let FaultKind::Crash { restart } = call.kind { restart } else { None };
        if let Some(time) = call.lasting.max(restart) {
            self.standstill.note_fault(now.saturating_add(nanos(time)));
        }
        let concerned = if call.kind.is_of_messages() { Vec::new() } else { self.concerned_by(call, site) };
        self.note(now, Occurrence::Fault { call: call.clone(), concerned });
        if call.kind.is_of_messages() {
            self.faults.begin_messages(call, site, now);
            let topics: Vec<TopicId> = self.bus.topics().collect();
            topics.into_iter().for_each(|topic| self.link(topic));
            return;
        }
        let is_meant = |slot: &Slot| slot.is_member() && slot.policy.periodic && is_named(&slot.spec, call, site);
        let named = (0..).zip(&self.slots).filter(|(_, slot)| is_meant(slot)).map(|(number, _)| number);
        self.faults.begin_tasks((call, cause), named, now);
        self.note_faults_elsewhere(call, site, now);
    }

    /// Tells of components of other nodes that a fault names: it acts in the program that plays it.
    fn note_faults_elsewhere(&mut self, call: &FaultCall, site: &str, now: u64) {
        let named = self.networks.elsewhere.specs().map(|(_, spec)| spec);
        let mut named = named.filter(|spec| is_named(spec, call, site));
        let Some(first) = named.next() else { return };
        let text = format!(
            "the fault `{call}` does not reach `{}`, which runs in node `{}`: give that program `--faults`",
            first.path, first.node
        );
        drop(named);
        self.note(now, Occurrence::Note { level: Level::Info, text });
    }

    /// Gives the readers of a topic that faults concern links of their own.
    pub(crate) fn link(&mut self, topic: TopicId) {
        let name = Arc::clone(self.bus.name(topic));
        let (faults, slots) = (&mut self.faults, &self.slots);
        let mut concerned: Vec<u32> = Vec::new();
        for reader in self.bus.readers(topic) {
            let Some(slot) = slots.get(reader as usize) else { continue };
            if faults.concerns_reader((topic, &name), end(reader, slot)) {
                concerned.push(reader);
            }
        }
        self.bus.link(topic, |reader| concerned.contains(&reader));
    }

    /// Sends a message to the readers of a topic, to each with a link on its own way.
    #[cold]
    pub(super) fn send_with_faults(&mut self, topic: TopicId, message: SharedMessage, now: u64) {
        let links: Vec<Link> = self.bus.links(topic).to_vec();
        if links.is_empty() {
            return self.publish(topic, message, now);
        }
        let sender = message.header().sender;
        self.publish(topic, message.clone(), now);
        for link in links {
            // What a component hears of itself takes no way, and what comes from outside has no sender.
            if sender == link.component || self.end_of(sender).is_none() {
                self.publish(link.topic, message.clone(), now);
                continue;
            }
            for Arrival { at, is_on_its_way } in self.arrivals(topic, &link, sender, now) {
                if is_on_its_way {
                    self.injections.hold_up(at, link.topic, message.clone());
                    self.look_at = self.look_at.min(at);
                    self.wake |= at < self.roles.asleep_until;
                } else {
                    self.publish(link.topic, message.clone(), now);
                }
            }
        }
    }

    fn arrivals(&mut self, topic: TopicId, link: &Link, sender: u32, now: u64) -> Vec<Arrival> {
        let Engine { faults, bus, slots, networks, .. } = self;
        let ends = any_end(slots, networks, sender).zip(any_end(slots, networks, link.component));
        let Some((from, to)) = ends else { return Vec::new() };
        let on_link = OnLink {
            topic: (topic, bus.name(topic)),
            link: link.topic,
            is_event: bus.kind(topic) == TopicKind::Event,
            from,
            to,
        };
        FaultPlay::arrivals(faults, &on_link, now)
    }

    /// Lets a message arrive that was on its way.
    pub(crate) fn arrive(&mut self, link: TopicId, message: SharedMessage, now: u64) {
        self.faults.arrive(link, message.header().sender);
        self.publish(link, message, now);
    }
}
