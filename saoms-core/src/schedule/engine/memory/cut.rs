//! The making of a cut: what is looked at while the engine is locked, and what the thread of the store makes of it.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::mem;
use std::sync::{Arc, PoisonError};

use saoms_api::host::{SharedMessage, TopicKind, cdr};
use saoms_api::{Message, Saved};

use super::forms::{
    COMPONENT, COUNTERS, ComponentForm, DELAYED, EVENTS, EventsForm, FAILED, HeldForm, INPUTS, InputsForm, KNOWN,
    MessageForm, NAMES, NAMES_ELSEWHERE, PAUSED, PRESENT, PartForm, RECEIVED, REPORT, RUN, ReceivedForm, RunForm,
    SAVED, SCHEMAS, STATES, StateForm, TEXTS, UnreadForm, WAITING,
};
use super::{CUT, Ending, Engine, NEVER, SharedText, Writing};
use crate::bus::TopicId;
use crate::hash::{fold, text_hash};
use crate::report::{PartOfReport, Sections};
use crate::schedule::engine::slot::{PendingRequest, SlotState};
use crate::schedule::inject::OUTSIDE;
use crate::store::{Batch, Change, Contents, LaterChanges};

/// A cut, as it is handed over to the thread of the store.
pub(super) struct Cut {
    run: RunForm,
    is_paused: bool,
    /// By their paths; `None` of those that are no part of the fleet any more.
    components: Vec<(Arc<str>, Option<ComponentCut>)>,
    states: Vec<(Arc<str>, Sent)>,
    messages: Vec<Sent>,
    unread: Vec<UnreadForm>,
    held: Vec<HeldForm>,
    inputs: InputsForm,
    report: Vec<(String, PartOfReport)>,
    /// Paths that no earlier cut has, by the names of their entries and their numbers.
    names: Vec<(&'static str, u64, String)>,
    /// By the urls of networks.
    received: Vec<(String, ReceivedForm)>,
    counters: Vec<(String, u64)>,
    texts: Vec<(String, String)>,
}

/// What is kept of a component.
struct ComponentCut {
    saved: Option<Arc<Saved>>,
    form: ComponentForm,
    /// The time of its first execution, while that is to come.
    delayed: Option<u64>,
    /// True if it has failed for good.
    has_failed: bool,
}

/// A message with the paths of the components that its header names by numbers.
struct Sent {
    sender: Arc<str>,
    to: Option<Arc<str>>,
    message: SharedMessage,
}

impl fmt::Debug for Cut {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Cut").field("run", &self.run).finish_non_exhaustive()
    }
}

/// Messages by their places, each once.
#[derive(Default)]
struct Messages {
    all: Vec<Sent>,
    places: HashMap<usize, u32>,
}

impl Engine {
    /// Makes a cut of the present moment, and hands it over to the store.
    pub(crate) fn cut(&mut self, sections: &mut Sections, now: u64) {
        let Some(queue) = self.memory.queue.clone() else { return };
        let mut messages = Messages::default();
        let mut with_inbox = mem::take(&mut self.memory.with_inbox);
        let unread = self.unread(&with_inbox, &mut messages);
        with_inbox.retain(|index| self.slots[*index as usize].body.as_ref().is_none_or(|body| body.has_unread()));
        self.memory.with_inbox = with_inbox;
        let held = self.held(&mut messages);
        let components = mem::take(&mut self.memory.differing);
        let components = components.into_iter().map(|index| self.component_cut(index, now)).collect();
        let inputs = match self.memory.last_inputs.take() {
            Some(mut inputs) => {
                // What belongs together came in part before the end began, and in part after that.
                inputs.inputs.extend(self.injected_inputs());
                self.injections.clear();
                inputs
            }
            None => self.waiting_inputs(),
        };
        let end = self.cause.map(|cause| format!("{cause:?}")).unwrap_or_default();
        let records = self.record_ids.load(std::sync::atomic::Ordering::Relaxed);
        let counters = self.memory.counters.iter().map(|(name, counter)| (name.clone(), counter.value()));
        let text = |text: &SharedText| text.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let texts = self.memory.texts.iter().map(|(name, shared)| (name.clone(), text(shared))).collect();
        let cut = Cut {
            texts,
            run: RunForm { time: now, records, end },
            is_paused: self.memory.is_paused,
            components,
            counters: counters.collect(),
            names: self.new_names(),
            received: self.newly_received(),
            states: self.changed_states(),
            messages: messages.all,
            unread,
            held,
            inputs,
            report: sections.take_changed(|component, code| {
                let slot = self.slots.get(component as usize);
                slot.is_some_and(|slot| slot.body.is_none() && slot.memory.code == code)
            }),
        };
        let memory = &mut self.memory;
        memory.made += 1;
        let changes = mem::take(&mut memory.changes);
        queue.put_announced(Batch { index: CUT, number: memory.made, changes, later: Some(Box::new(cut)) });
        memory.announced = 0;
        let (batches, outgoing) = (mem::take(&mut memory.waiting), mem::take(&mut memory.outgoing));
        memory.writing.push_back(Writing { cut: memory.made, batch: self.batches, batches, outgoing });
        (memory.wanted_since, memory.differs_since, memory.due_at_last) = (NEVER, NEVER, NEVER);
        if memory.ending == Ending::Due {
            memory.ending = Ending::Made;
        }
    }

    /// What is kept of a component at this time; `None` if it is not part of the fleet any more.
    fn component_cut(&mut self, index: u32, now: u64) -> (Arc<str>, Option<ComponentCut>) {
        let slot = &mut self.slots[index as usize];
        slot.memory.differs = false;
        let name = Arc::clone(&slot.name);
        if slot.state == SlotState::Removed {
            return (name, None);
        }
        let period = slot.policy.period;
        // One that is to leave leaves in the next program: it may have something to say before.
        let has_to_leave = slot.policy.periodic && slot.has_to_leave();
        let form = ComponentForm {
            class: slot.spec.class.name().to_owned(),
            site: slot.spec.site.to_string(),
            is_scheduled: slot.is_scheduled()
                || has_to_leave
                || !slot.policy.periodic
                || matches!(slot.state, SlotState::Failed | SlotState::Leaving | SlotState::Abandoned),
            until: match slot.pending {
                _ if has_to_leave => slot.until.min(now),
                // It is to run again once it has left.
                PendingRequest::Return { lasting } => now.saturating_add(lasting),
                PendingRequest::None | PendingRequest::Leave => slot.until,
            },
            period,
            phase: if period > 0 && slot.due != NEVER { slot.due % period } else { 0 },
            is_stopped: slot.is_stopped(),
            has_voted: slot.sees_work.is_some(),
            sees_work: slot.sees_work.unwrap_or_default(),
            gave_up: slot.gave_up,
            instances: slot.instances,
            set: slot.memory.set.clone(),
            alerts: slot.memory.alerts.clone(),
        };
        let (saved, delayed) = (slot.memory.saved.clone(), slot.delayed_until());
        let has_failed = slot.state == SlotState::Failed && slot.last_due.is_some();
        (name, Some(ComponentCut { saved, form, delayed, has_failed }))
    }

    /// What was received of other programs since the last cut.
    fn newly_received(&mut self) -> Vec<(String, ReceivedForm)> {
        let new = mem::take(&mut self.memory.newly_received).into_iter();
        let form = |key: (String, Arc<str>, u64)| {
            let next = *self.memory.received.get(&key)?;
            let (url, topic, origin) = key;
            Some((url, ReceivedForm { topic: topic.to_string(), origin, next }))
        };
        new.filter_map(form).collect()
    }

    /// The paths of components that no cut has yet.
    fn new_names(&mut self) -> Vec<(&'static str, u64, String)> {
        let (own, elsewhere) = self.memory.named;
        let names = self.slots[own..].iter().map(|slot| slot.name.to_string());
        let names = (own as u64..).zip(names).map(|(number, name)| (NAMES, number, name));
        let others = self.networks.elsewhere.names().from(elsewhere);
        let others = (elsewhere as u64..).zip(others).map(|(number, name)| (NAMES_ELSEWHERE, number, name.to_owned()));
        let names: Vec<_> = names.chain(others).collect();
        let new_elsewhere = names.iter().filter(|(entry, ..)| *entry == NAMES_ELSEWHERE).count();
        self.memory.named = (self.slots.len(), elsewhere + new_elsewhere);
        names
    }

    /// The states that changed since the last cut, but for those of other programs, which send them again.
    fn changed_states(&mut self) -> Vec<(Arc<str>, Sent)> {
        let topics: Vec<TopicId> =
            self.bus.topics().filter(|topic| self.bus.kind(*topic) == TopicKind::State).collect();
        let (mut states, mut changed) = (Vec::new(), Vec::new());
        for topic in topics {
            let place = topic.number() as usize;
            if self.memory.topics.len() <= place {
                self.memory.topics.resize(place + 1, 0);
            }
            self.bus.changed_states(topic, &mut self.memory.topics[place], &mut changed);
            for message in changed.drain(..) {
                if let Some(sent) = self.sent(message) {
                    states.push((Arc::clone(self.bus.name(topic)), sent));
                }
            }
        }
        states
    }

    /// A message with names; `None` if a component of another program sent it, which says it again.
    fn sent(&self, message: SharedMessage) -> Option<Sent> {
        if message.header().sender == OUTSIDE {
            return Some(self.sent_or_outside(&message));
        }
        let sender = Arc::clone(&self.slots.get(message.header().sender as usize)?.name);
        let to = message.to().and_then(|to| self.name_of(to));
        Some(Sent { sender, to, message })
    }

    fn unread(&self, with_inbox: &[u32], messages: &mut Messages) -> Vec<UnreadForm> {
        let mut unread: HashMap<(u32, TopicId), Vec<u32>> = HashMap::new();
        let mut note = |component: u32, topic: TopicId, message: &SharedMessage| {
            if message.to().is_none_or(|to| to == component) {
                let place = messages.place(message, |message| self.sent_or_outside(message));
                let places = unread.entry((component, topic)).or_default();
                if !places.contains(&place) {
                    places.push(place);
                }
            }
        };
        // The oldest first: what was heard in vain, what the code has or has left, and what waits.
        let runs = self.out > 0 || self.memory.ending != Ending::Running;
        for (index, slot) in (0..).zip(&self.slots).filter(|_| runs) {
            for (topic, events) in &slot.memory.reading {
                events.iter().for_each(|message| note(index, *topic, message));
            }
        }
        for index in with_inbox {
            let Some(body) = &self.slots[*index as usize].body else { continue };
            for (topic, events) in body.part.lasting.unread() {
                events.iter().for_each(|message| note(*index, *topic, message));
            }
            let inboxes = body.part.subscriptions.iter().zip(&body.inboxes);
            for (subscription, inbox) in inboxes.chain(body.part.subscriptions.iter().zip(&body.reactions)) {
                let topic = self.bus.topic_of(subscription);
                if self.bus.kind(topic) == TopicKind::Event {
                    inbox.iter().for_each(|message| note(*index, topic, message));
                }
            }
        }
        for topic in self.bus.topics() {
            self.bus.unread(topic, |component, message| note(component, topic, message));
        }
        let mut all: Vec<_> = unread.into_iter().collect();
        all.sort_unstable_by_key(|((component, topic), _)| (*component, *topic));
        let form = |((component, topic), messages): ((u32, TopicId), Vec<u32>)| {
            let component = self.slots.get(component as usize)?.name.to_string();
            Some(UnreadForm { component, topic: self.bus.name(topic).to_string(), messages })
        };
        all.into_iter().filter_map(form).collect()
    }

    /// The messages that wait for the commit of what their component kept.
    fn held(&self, messages: &mut Messages) -> Vec<HeldForm> {
        let mut held = Vec::new();
        for slot in self.slots.iter().filter(|_| self.uncommitted > 0) {
            for (topic, message) in slot.uncommitted.iter().flat_map(|one| &one.messages) {
                let message = messages.place(message, |message| self.sent_or_outside(message));
                let topic = self.bus.name(*topic).to_string();
                held.push(HeldForm { component: slot.name.to_string(), topic, message });
            }
        }
        held
    }

    /// A message with names, whoever sent it.
    fn sent_or_outside(&self, message: &SharedMessage) -> Sent {
        let sender = self.name_of(message.header().sender).unwrap_or_else(|| Arc::from(crate::network::FROM_OUTSIDE));
        let to = message.to().and_then(|to| self.name_of(to));
        Sent { sender, to, message: message.clone() }
    }
}

impl Messages {
    /// The place of a message.
    fn place(&mut self, message: &SharedMessage, sent: impl FnOnce(&SharedMessage) -> Sent) -> u32 {
        let next = u32::try_from(self.all.len()).unwrap_or(u32::MAX);
        *self.places.entry(message.address()).or_insert_with(|| {
            self.all.push(sent(message));
            next
        })
    }
}

impl Sent {
    fn form(&self) -> MessageForm {
        let (header, mut bytes) = (self.message.header(), Vec::new());
        self.message.encode_into(&mut bytes);
        MessageForm {
            sender: self.sender.to_string(),
            to: self.to.as_deref().unwrap_or_default().to_owned(),
            sent: header.sent.as_nanos(),
            cause: header.cause.0,
            bytes,
        }
    }
}

/// Collects changes, but those to what is there already.
struct Differences<'a> {
    changes: &'a mut Vec<Change>,
    known: &'a Contents,
    /// The types that were put; and their hashes, by the places of their texts in memory.
    schemas: HashSet<u64>,
    hashes: HashMap<(usize, usize), u64>,
}

impl Differences<'_> {
    fn put(&mut self, entry: &str, key: u64, bytes: Option<&[u8]>) {
        let known = self.known.of(entry).and_then(|entries| entries.get(&key));
        if known.map(|bytes| &**bytes) != bytes {
            self.changes.push(Change { component: entry.into(), key, bytes: bytes.map(Arc::from) });
        }
    }

    fn put_form(&mut self, entry: &str, key: u64, form: &impl Message) {
        self.put(entry, key, Some(&cdr::encode(form)));
    }
}

impl LaterChanges for Cut {
    fn add_to(&self, changes: &mut Vec<Change>, known: &Contents) {
        let mut differences = Differences { changes, known, schemas: HashSet::new(), hashes: HashMap::new() };
        differences.put_form(RUN, PRESENT, &self.run);
        differences.put(RUN, PAUSED, self.is_paused.then_some(&[1]));
        for (name, component) in &self.components {
            let entry = format!("{COMPONENT}{name}");
            let Some(ComponentCut { saved, form, delayed, has_failed }) = component else {
                [SAVED, KNOWN, DELAYED, FAILED].into_iter().for_each(|key| differences.put(&entry, key, None));
                continue;
            };
            differences.put_form(&entry, KNOWN, form);
            let delayed = delayed.map(u64::to_le_bytes);
            differences.put(&entry, DELAYED, delayed.as_ref().map(|bytes| &bytes[..]));
            differences.put(&entry, FAILED, has_failed.then_some(&[1][..]));
            match saved.as_ref().filter(|saved| !saved.is_nothing()) {
                Some(saved) => differences.put_saved(&entry, saved),
                None => differences.put(&entry, SAVED, None),
            }
        }
        for (topic, sent) in &self.states {
            let entry = format!("{STATES}{topic}\n{}", sent.sender);
            differences.put_form(&entry, sent.message.key().unwrap_or_default(), &sent.form());
        }
        let events = EventsForm {
            messages: self.messages.iter().map(Sent::form).collect(),
            unread: self.unread.clone(),
            held: self.held.clone(),
        };
        differences.put_form(WAITING, EVENTS, &events);
        differences.put_form(WAITING, INPUTS, &self.inputs);
        for (path, part) in &self.report {
            let form = PartForm { path: path.clone(), is_count: part.is_count, value: part.value.to_string() };
            differences.put_form(REPORT, text_hash(path), &form);
        }
        for (entry, number, name) in &self.names {
            differences.put(entry, *number, Some(name.as_bytes()));
        }
        for (url, form) in &self.received {
            let key = fold(text_hash(&form.topic), form.origin);
            differences.put_form(&format!("{RECEIVED}{url}"), key, form);
        }
        for (name, value) in &self.counters {
            differences.put(&format!("{COUNTERS}{name}"), 0, Some(&value.to_le_bytes()));
        }
        for (name, text) in &self.texts {
            differences.put(&format!("{TEXTS}{name}"), 0, Some(text.as_bytes()).filter(|bytes| !bytes.is_empty()));
        }
    }
}

impl Differences<'_> {
    /// Puts what a component saved, and the type of it once for all components.
    fn put_saved(&mut self, entry: &str, saved: &Saved) {
        let Some((schema, message)) = saved.parts() else {
            // It cannot be read by anybody.
            return self.put(entry, SAVED, None);
        };
        let hash = match &schema {
            // The text is long, and stays where it is.
            Cow::Borrowed(text) => {
                *self.hashes.entry((text.as_ptr().addr(), text.len())).or_insert_with(|| text_hash(text))
            }
            Cow::Owned(text) => text_hash(text),
        };
        if self.schemas.insert(hash) {
            self.put(SCHEMAS, hash, Some(schema.as_bytes()));
        }
        self.put_form(entry, SAVED, &StateForm { schema: hash, message: message.into_owned() });
    }
}
