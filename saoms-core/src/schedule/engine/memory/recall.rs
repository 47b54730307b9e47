//! The start of a fleet that goes on from what an earlier program left.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use saoms_api::host::{SharedMessage, TopicKind, cdr};
use saoms_api::{Cause, Header, Level, Message, Saved, Time};
use saoms_lang::assembly::ComponentSpec;
use serde_json::Value;

use super::forms::{
    COMPONENT, COUNTERS, ComponentForm, DELAYED, EVENTS, EventsForm, FAILED, INPUTS, InputsForm, KNOWN, MessageForm,
    NAMES, NAMES_ELSEWHERE, PAUSED, PRESENT, PartForm, RECEIVED, REPORT, RUN, ReceivedForm, RunForm, SAVED, SCHEMAS,
    STATES, SavedForm, StateForm, TEXTS, WAITING,
};
use super::{Counter, Engine, NEVER, SetForm, SharedText};
use crate::bus::TopicId;
use crate::hash::text_hash;
use crate::observe::Occurrence;
use crate::report::{PartOfReport, Sections};
use crate::schedule::change;
use crate::schedule::component::body::Body;
use crate::schedule::component::estate::Estate;
use crate::schedule::component::stored::Stored;
use crate::schedule::engine::slot::Slot;
use crate::schedule::engine::votes::Ballot;
use crate::schedule::inject::{OUTSIDE, OUTSIDE_NAME};
use crate::schedule::networks::NO_NETWORK;
use crate::schedule::stop::{STOPPED, hears_stops};
use crate::store::{Contents, Entries, StoreQueue};

/// What an earlier program left.
#[derive(Debug, Default)]
pub(crate) struct Recalled {
    run: RunForm,
    is_paused: bool,
    components: HashMap<String, RecalledComponent>,
    /// The paths of components by their numbers: of this program, and of others.
    pub(in crate::schedule) names: Vec<String>,
    elsewhere: Vec<String>,
    /// By the topics.
    states: Vec<(String, MessageForm)>,
    events: EventsForm,
    inputs: InputsForm,
}

#[derive(Debug)]
struct RecalledComponent {
    form: ComponentForm,
    saved: Option<Arc<Saved>>,
    /// The time of its first execution, if that is to come.
    delayed: Option<u64>,
    /// True if it had failed for good.
    has_failed: bool,
}

/// What is told of a state that a fleet goes on from.
#[derive(Clone, Debug)]
pub(crate) struct Recollection {
    pub(crate) time: u64,
    pub(crate) components: usize,
    /// True if the run had ended since its work was done.
    pub(crate) was_done: bool,
    /// True if an operator had paused it.
    pub(crate) is_paused: bool,
}

/// The form under a key.
fn form<M: Message>(entries: Option<&Entries>, key: u64) -> Option<M> {
    cdr::decode(entries?.get(&key)?).ok()
}

/// The texts of an entry, by their numbers.
fn texts(found: &Contents, entry: &str) -> Vec<String> {
    let all = found.of(entry).into_iter().flatten();
    all.map(|(_, bytes)| String::from_utf8_lossy(bytes).into_owned()).collect()
}

impl Recalled {
    /// What a state folder has of the memory, if it has any.
    fn read(found: &Contents) -> Option<Recalled> {
        let run = form(found.of(RUN), PRESENT)?;
        let schemas: BTreeMap<u64, String> = found
            .of(SCHEMAS)
            .into_iter()
            .flatten()
            .map(|(hash, bytes)| (*hash, String::from_utf8_lossy(bytes).into_owned()))
            .collect();
        let mut recalled = Recalled {
            run,
            is_paused: found.of(RUN).is_some_and(|entries| entries.contains_key(&PAUSED)),
            names: texts(found, NAMES),
            elsewhere: texts(found, NAMES_ELSEWHERE),
            events: form(found.of(WAITING), EVENTS).unwrap_or_default(),
            inputs: form(found.of(WAITING), INPUTS).unwrap_or_default(),
            ..Recalled::default()
        };
        for entry in found.components() {
            let entries = found.of(entry);
            if let Some(path) = entry.strip_prefix(COMPONENT) {
                let Some(known) = form::<ComponentForm>(entries, KNOWN) else { continue };
                let saved = form::<StateForm>(entries, SAVED).and_then(|state| {
                    let schema = schemas.get(&state.schema)?.clone();
                    let saved = SavedForm { schema, message: state.message };
                    Some(Arc::new(Saved::from_bytes(cdr::encode(&saved))))
                });
                let delayed = entries.and_then(|entries| entries.get(&DELAYED)?[..].try_into().ok());
                let delayed = delayed.map(u64::from_le_bytes);
                let has_failed = entries.is_some_and(|entries| entries.contains_key(&FAILED));
                let component = RecalledComponent { form: known, saved, delayed, has_failed };
                recalled.components.insert(path.to_owned(), component);
            } else if let Some(rest) = entry.strip_prefix(STATES) {
                let topic = rest.split('\n').next().unwrap_or_default();
                let states = entries.into_iter().flatten().filter_map(|(_, bytes)| cdr::decode(bytes).ok());
                recalled.states.extend(states.map(|state| (topic.to_owned(), state)));
            }
        }
        recalled.states.sort_by_key(|(_, state)| state.sent);
        Some(recalled)
    }

    /// The time of the run.
    pub(in crate::schedule) fn time(&self) -> u64 {
        self.run.time
    }

    /// The paths of the components that it knows.
    pub(in crate::schedule) fn components(&self) -> impl Iterator<Item = &str> {
        self.components.keys().map(String::as_str)
    }
}

/// Puts back what components contributed to the report.
pub(crate) fn recall_report(found: &Contents, sections: &mut Sections) {
    for (_, bytes) in found.of(REPORT).into_iter().flatten() {
        let Ok(PartForm { path, is_count, value }) = cdr::decode(bytes) else { continue };
        let value: Value = serde_json::from_str(&value).unwrap_or_default();
        sections.recall(path, PartOfReport { is_count, value });
    }
    sections.note_changes();
}

/// The hash of the value that a composite gives a property.
pub(in crate::schedule) fn value_hash(spec: &ComponentSpec, property: &str) -> u64 {
    let value = spec.values.iter().find(|(known, _)| known == property);
    text_hash(&value.map(|(_, value)| format!("{value:?}")).unwrap_or_default())
}

impl Engine {
    /// Uses a memory from now on, and goes on from what is there. Before the fleet starts.
    pub(crate) fn use_memory(&mut self, found: &Contents, queue: Arc<StoreQueue>) -> Option<Recollection> {
        self.memory.queue = Some(queue);
        for entry in found.components().filter(|entry| entry.starts_with(COUNTERS)) {
            let value = found.of(entry).and_then(|entries| entries.get(&0)?[..].try_into().ok());
            let value = Counter::Set(value.map_or(0, u64::from_le_bytes));
            self.memory.counters.insert(entry[COUNTERS.len()..].to_owned(), value);
        }
        let recalled = Recalled::read(found)?;
        self.record_ids.store(recalled.run.records, Ordering::Relaxed);
        self.limit = self.limit.saturating_add(recalled.time());
        self.networks.elsewhere.names().recall(&recalled.elsewhere);
        self.memory.named.1 = recalled.elsewhere.len();
        let recollection = Recollection {
            time: recalled.time(),
            components: recalled.components.len(),
            was_done: recalled.run.end == "Done",
            is_paused: recalled.is_paused,
        };
        self.memory.recalled = Some(Box::new(recalled));
        Some(recollection)
    }

    /// What was received of other programs over a network: the first start of each, the topic, and the number of the
    /// first event that was not.
    pub(in crate::schedule) fn recall_received(&mut self, url: &str) -> Vec<(u64, Arc<str>, u64)> {
        let found = self.found.of(&format!("{RECEIVED}{url}")).into_iter().flatten();
        let forms = found.filter_map(|(_, bytes)| cdr::decode::<ReceivedForm>(bytes).ok());
        let all: Vec<(u64, Arc<str>, u64)> =
            forms.map(|form| (form.origin, Arc::from(form.topic.as_str()), form.next)).collect();
        for (origin, topic, next) in &all {
            self.memory.received.insert((url.to_owned(), Arc::clone(topic), *origin), *next);
        }
        all
    }

    /// The specification of a component with the values that operators have set, unless the composite has other ones
    /// than then.
    pub(in crate::schedule) fn with_recalled_values(&mut self, mut spec: ComponentSpec) -> ComponentSpec {
        let known = self.memory.recalled.as_mut().and_then(|recalled| recalled.components.get_mut(&spec.path));
        let Some(known) = known.filter(|known| known.form.class == spec.class.name()) else { return spec };
        let stopped = SetForm { property: STOPPED.to_owned(), value: "true".to_owned(), instead_of: 0 };
        let stopped = Some(&stopped).filter(|_| known.form.is_stopped && hears_stops(&spec));
        // What was set in place of another value than that of the composite is over.
        known.form.set.retain(|set| value_hash(&spec, &set.property) == set.instead_of);
        for set in known.form.set.iter().chain(stopped) {
            if let Ok(changed) = change::changed(&spec, &set.property, &set.value) {
                spec = changed;
            }
        }
        spec
    }

    /// What components of an earlier program kept, for those of their class and site: the fleet may be another one.
    pub(in crate::schedule) fn left_by_earlier_program(&self) -> Estate {
        let Some(recalled) = &self.memory.recalled else { return Estate::default() };
        let numbers: HashMap<&str, u32> = recalled.names.iter().map(String::as_str).zip(0..).collect();
        let kept = recalled.components.iter().filter_map(|(path, RecalledComponent { form, .. })| {
            let entries = self.found.of(path).filter(|entries| !entries.is_empty())?;
            let number = *numbers.get(path.as_str())?;
            Some((number, form.class.clone(), form.site.clone(), Stored::new(entries.clone())))
        });
        let mut kept: Vec<_> = kept.collect();
        kept.sort_unstable_by_key(|(number, ..)| *number);
        Estate::of_earlier_program(kept.into_iter())
    }

    /// Gives a new slot what an earlier program knew of its component.
    pub(in crate::schedule) fn recall_component(&mut self, number: u32) {
        let Some(recalled) = &mut self.memory.recalled else { return };
        let slot = &mut self.slots[number as usize];
        let Some(known) = recalled.components.get(&*slot.name) else { return };
        if known.form.until != NEVER {
            slot.until = known.form.until;
        }
        if known.form.class != slot.spec.class.name() {
            slot.memory.begins_anew = true;
            return;
        }
        slot.instances = known.form.instances;
        slot.set_stopped(known.form.is_stopped);
        let is_unchanged = |set: &&SetForm| {
            let now = slot.spec.values.iter().find(|(known, _)| *known == set.property.as_str());
            now.is_some()
        };
        slot.memory.set = known.form.set.iter().filter(is_unchanged).cloned().collect();
        match (&known.saved, &mut slot.body) {
            (Some(saved), Some(body)) if slot.spec.class.declaration().saves => {
                body.part.lasting.recall(Arc::clone(saved));
                body.part.alerts.clone_from(&known.form.alerts);
                slot.memory.saved = Some(Arc::clone(saved));
                slot.memory.alerts.clone_from(&known.form.alerts);
                slot.memory.is_recalled = true;
            }
            _ => slot.memory.begins_anew = slot.policy.periodic && known.form.is_scheduled,
        }
    }

    /// True if a component runs from the start of the fleet.
    pub(in crate::schedule) fn starts_with_fleet(&self, number: u32) -> bool {
        let slot = &self.slots[number as usize];
        let known = self.memory.recalled.as_ref().and_then(|recalled| recalled.components.get(&*slot.name));
        known.map_or(slot.policy.on_startup, |known| known.form.is_scheduled)
    }

    /// Lets a component begin anew whose state of an earlier program cannot be restored. False if it did not go on
    /// from one.
    pub(in crate::schedule) fn begin_anew(&mut self, number: u32, why: &str, now: u64) -> bool {
        let slot = &mut self.slots[number as usize];
        let has_state = slot.body.as_ref().is_some_and(|body| body.part.lasting.saved().is_some());
        // One that fails before it restores its state is to find it again.
        if has_state || !std::mem::take(&mut slot.memory.is_recalled) {
            return false;
        }
        if let Some(mut body) = self.slots[number as usize].body.take() {
            body.part.lasting.forget();
            body.part.alerts.clear();
            body.part.outbox.clear();
            body.part.to_keep.clear();
            body.part.vote = None;
            self.keep_subscriptions(&mut body);
            self.slots[number as usize].body = Some(body);
        }
        let slot = &mut self.slots[number as usize];
        (slot.memory.saved, slot.memory.begins_anew) = (None, true);
        slot.memory.alerts.clear();
        let text = format!("begins anew, since it cannot go on from the state folder: {why}");
        self.emit(now, number, Occurrence::Log { level: Level::Warning, text });
        true
    }

    /// A message of an earlier program; `None` if it is none of the topic, or of a component that is not there.
    fn recalled_message(&mut self, topic: TopicId, form: &MessageForm) -> Option<SharedMessage> {
        let number = |engine: &Engine, path: &str| match path {
            OUTSIDE_NAME => Some(OUTSIDE),
            _ => engine.numbers.get(path).copied().or_else(|| engine.networks.elsewhere.names().find(path)),
        };
        let sender = number(self, &form.sender)?;
        let to = if form.to.is_empty() { None } else { Some(number(self, &form.to)?) };
        let schema = self.schema_of(topic).1.clone()?;
        schema.check(&form.bytes).ok()?;
        let header = Header { sender, sent: Time::from_nanos(form.sent), cause: Cause(form.cause) };
        let (key, place) = (schema.key(&form.bytes), schema.place(&form.bytes));
        Some(SharedMessage::from_bytes(header, None, form.bytes.clone()).of(key, place).only_to(to))
    }

    /// Gives a component that has initialized the events that it had not read.
    pub(in crate::schedule) fn recall_unread(&mut self, body: &mut Body) {
        let Some(recalled) = self.memory.recalled.take() else { return };
        let name = Arc::clone(&body.part.name);
        for unread in recalled.events.unread.iter().filter(|unread| unread.component == *name) {
            let Some(topic) = self.bus.find(&unread.topic).filter(|topic| self.bus.kind(*topic) == TopicKind::Event)
            else {
                continue;
            };
            let forms = unread.messages.iter().filter_map(|place| recalled.events.messages.get(*place as usize));
            let messages: Vec<SharedMessage> = forms.filter_map(|form| self.recalled_message(topic, form)).collect();
            let same = |reader: &&crate::bus::TopicReader| self.bus.topic_of(reader) == topic;
            let readers = body.part.subscriptions.iter().filter(same);
            let reacts: Vec<bool> = readers.map(|reader| self.bus.is_trigger(reader)).collect();
            for reacts in reacts.into_iter().filter(|_| !messages.is_empty()) {
                body.part.lasting.hear_recalled(topic, messages.clone(), reacts);
            }
            if messages.iter().any(|message| message.to().is_some()) {
                self.bus.note_addressed(topic);
            }
        }
        self.memory.recalled = Some(recalled);
    }

    /// Puts back what state topics retained, before the components of the fleet send anything.
    pub(in crate::schedule) fn recall_states(&mut self) {
        let Some(recalled) = self.memory.recalled.take() else { return };
        for (topic, form) in &recalled.states {
            let topic = self.bus.find(topic).filter(|topic| self.bus.kind(*topic) == TopicKind::State);
            if let Some(topic) = topic
                && let Some(message) = self.recalled_message(topic, form)
            {
                // There is room for what was there.
                let _ = self.bus.publish(topic, message);
            }
        }
        self.memory.recalled = Some(recalled);
    }

    /// The first due time of a component that goes on: after the rest of its delay, with true, or in the phase that it
    /// had.
    pub(in crate::schedule) fn recalled_due(&self, number: u32, now: u64) -> Option<(u64, bool)> {
        let slot: &Slot = &self.slots[number as usize];
        let RecalledComponent { form, delayed, .. } = self.memory.recalled.as_ref()?.components.get(&*slot.name)?;
        if form.class == slot.spec.class.name()
            && let Some(delayed) = delayed
        {
            // The composite may have a shorter one now.
            return Some(((*delayed).min(now.saturating_add(slot.policy.delay)).max(now), true));
        }
        let period = slot.policy.period;
        let is_same = slot.memory.is_recalled && form.period == period && period > 0;
        let due = (now - now % period.max(1)).saturating_add(form.phase);
        is_same.then(|| (if due > now { due } else { due.saturating_add(period) }, false))
    }

    /// Lets the rest take effect, once all components have joined the fleet.
    pub(in crate::schedule) fn recall_rest(&mut self, now: u64) {
        if self.memory.is_on() {
            for index in 0..self.slots.len() as u32 {
                // What a component left that the fleet has no more stays there.
                if self.slots[index as usize].is_member() {
                    self.note_differs(index, now);
                }
            }
            self.want_cut(now);
        }
        let Some(recalled) = self.memory.recalled.take() else { return };
        self.standstill.note_effect(now);
        for index in 0..self.slots.len() as u32 {
            let slot = &mut self.slots[index as usize];
            let Some(known) = recalled.components.get(&*slot.name) else { continue };
            if std::mem::take(&mut slot.memory.is_recalled) {
                let left = Some(known.form.sees_work).filter(|_| known.form.has_voted && slot.sees_work.is_none());
                self.note_vote(index, Ballot::recalled(left, known.form.gave_up), now);
                for alert in &known.form.alerts {
                    let (kind, subject) = (alert.kind.as_str().into(), alert.subject.as_str().into());
                    self.emit(now, index, Occurrence::Alert { kind, subject, text: Some(alert.text.clone()) });
                }
            } else if std::mem::take(&mut slot.memory.begins_anew) {
                self.tell_loss(index, true, now);
            }
        }
        self.tell_absent(&recalled, now);
        let forgotten = recalled.events.unread.iter().filter(|unread| {
            let number = self.numbers.get(unread.component.as_str());
            !number.is_some_and(|number| self.slots[*number as usize].is_member())
        });
        let forgotten: Vec<(String, usize, String)> =
            forgotten.map(|unread| (unread.component.clone(), unread.messages.len(), unread.topic.clone())).collect();
        for (component, count, topic) in forgotten {
            let text = format!(
                "{count} messages on `{topic}` waited for `{component}`, which the fleet has no more: they are dropped"
            );
            self.note(now, Occurrence::Note { level: Level::Warning, text });
        }
        if !recalled.events.unread.is_empty() || !recalled.events.held.is_empty() {
            self.settle(now);
        }
        for held in &recalled.events.held {
            let Some(topic) = self.bus.find(&held.topic) else { continue };
            let Some(form) = recalled.events.messages.get(held.message as usize) else { continue };
            let Some(message) = self.recalled_message(topic, form) else { continue };
            let sender = self.slots.get(message.header().sender as usize);
            if let Some((network, name)) = sender.map(|slot| (slot.network, Arc::clone(&slot.name)))
                && network != NO_NETWORK
                && self.bus.kind(topic) == TopicKind::State
            {
                // Events of a network are sent again by what the network itself remembers.
                self.put_on_network(network, &name, topic, &message, now);
            }
            self.send(topic, message, now);
        }
        self.recall_inputs(recalled.inputs, now);
        if self.slots.iter().any(Slot::is_stopped) {
            let stopped: Vec<u32> =
                (0..self.slots.len() as u32).filter(|index| self.slots[*index as usize].is_stopped()).collect();
            self.log_stopped(&stopped, true, None, now);
        }
    }

    /// Tells of components that an earlier program had and that are no part of the fleet any more. What they had begun
    /// is left to others, so that they begin anew if they are there again.
    fn tell_absent(&mut self, recalled: &Recalled, now: u64) {
        let elsewhere: HashSet<String> = self.members_everywhere().map(|(_, spec)| spec.path.clone()).collect();
        for index in 0..self.slots.len() as u32 {
            let slot = &self.slots[index as usize];
            let name = Arc::clone(&slot.name);
            let Some(known) = recalled.components.get(&*name).filter(|_| !elsewhere.contains(&*name)) else { continue };
            if !known.form.is_scheduled || known.has_failed {
                // It has said its last words, or the others have heard that it failed.
                continue;
            }
            let said = recalled.states.iter().filter(|(_, form)| *form.sender == *name);
            let said: Vec<(&str, &[u8])> = said.map(|(topic, form)| (&**topic, &form.bytes[..])).collect();
            if self.tell_absence(&name, &known.form.site, &said, now) {
                self.note_differs(index, now);
                let text = format!(
                    "`{name}` is no part of the fleet any more: the others hear that it has failed, and it begins anew \
                     if it is there again"
                );
                self.note(now, Occurrence::Note { level: Level::Warning, text });
            }
        }
    }

    /// Has cuts count on a counter of the program beside the engine; gives the value of an earlier program.
    pub(in crate::schedule) fn share_counter(
        &mut self,
        name: &str,
        counter: Arc<std::sync::atomic::AtomicU32>,
    ) -> Option<u64> {
        let before = self.memory.counters.insert(name.to_owned(), Counter::Shared(counter));
        before.map(|before| before.value())
    }

    /// Has cuts contain a text of the program beside the engine; gives that of an earlier program.
    pub(in crate::schedule) fn share_text(&mut self, name: &str, text: SharedText) -> Option<String> {
        self.memory.texts.insert(name.to_owned(), text);
        let bytes = self.found.of(&format!("{TEXTS}{name}"))?.get(&0)?;
        String::from_utf8(bytes.to_vec()).ok()
    }

    /// Sets a counter of the program beside the engine, and gives what it was.
    pub(in crate::schedule) fn set_counter(&mut self, name: &str, value: u64) {
        self.memory.counters.insert(name.to_owned(), Counter::Set(value));
    }

    /// A counter of the program beside the engine.
    pub(in crate::schedule) fn counter(&self, name: &str) -> u64 {
        self.memory.counters.get(name).map_or(0, Counter::value)
    }
}
