use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use saoms_api::{Cause, Level};
use saoms_lang::assembly::ComponentSpec;

use super::leaving::Leaving;
use super::live::changed;
use super::planned::PlannedRefusal;
use super::takeover::{Outgoing, Predecessor, Takeover};
use super::updating::Updated;
use crate::journal::ComponentName;
use crate::observe::Occurrence;
use crate::report::{Label, PartOfFleet};
use crate::schedule::component::body::Body;
use crate::schedule::component::estate::Estate;
use crate::schedule::component::stored::Stored;
use crate::schedule::engine::lifecycle::Request;
use crate::schedule::engine::memory::{SlotMemory, value_hash};
use crate::schedule::engine::slot::{NEVER, PendingRequest, Slot, SlotState, TaskPolicy};
use crate::schedule::engine::trace::TraceStep;
use crate::schedule::engine::{Engine, RunPhase};
use crate::schedule::shared::Shared;
use crate::schedule::stop::hears_stops;

impl Engine {
    /// The specifications of the fleet by their numbers.
    pub(super) fn specs(&self) -> Vec<Option<Arc<ComponentSpec>>> {
        self.slots.iter().map(|slot| slot.is_member().then(|| Arc::clone(&slot.spec))).collect()
    }

    /// What of a wanted fleet the networks of the program hinder: it takes part in those that it had at its start, and
    /// other programs know its components from theirs.
    pub(super) fn beyond_its_networks(
        &self,
        part: Option<&PartOfFleet>,
        wanted: &[ComponentSpec],
    ) -> Vec<PlannedRefusal> {
        let mut reasons = Vec::new();
        let members = self.slots.iter().filter(|slot| slot.is_member());
        let known: BTreeSet<&str> = members.filter_map(|slot| slot.spec.url()).collect();
        let urls: BTreeSet<&str> = wanted.iter().filter_map(ComponentSpec::url).collect();
        for url in urls.difference(&known).filter(|url| !self.networks.has(url)) {
            let reason = format!("the program takes part in no network at `{url}`: it joins networks at its start");
            let member = wanted.iter().find(|spec| spec.url() == Some(*url)).map(|spec| spec.path.clone());
            reasons.push(PlannedRefusal { component: member, ..PlannedRefusal::of_fleet(reason) });
        }
        let fleet = |part: Option<&PartOfFleet>| part.map(|part| (part.node.clone(), part.fleet.clone()));
        if fleet(part) != fleet(self.networks.elsewhere.part()) {
            let reason = "other programs run a part of the fleet, and know its components, their classes and their \
                          nodes from their start: restart all of them with the new composites";
            reasons.push(PlannedRefusal::of_fleet(reason.to_owned()));
        }
        reasons
    }

    /// The time at which a change happens.
    pub(super) fn time_of_change(&self, shared: &Shared) -> u64 {
        if self.phase == RunPhase::Starting { shared.clock.origin() } else { shared.clock.now() }
    }

    /// The numbers of new components. A removed component that returns gets its number again.
    pub(super) fn number<'s>(&self, specs: impl Iterator<Item = &'s Arc<ComponentSpec>>) -> Vec<u32> {
        let recalled = self.memory.recalled.as_ref().map_or(&[][..], |recalled| &recalled.names);
        let recalled: HashMap<&str, u32> = recalled.iter().map(String::as_str).zip(0..).collect();
        let mut next = (self.slots.len() as u32).max(recalled.len() as u32);
        let number = |spec: &Arc<ComponentSpec>| {
            let known = self.numbers.get(spec.path.as_str()).copied();
            let known = known.filter(|number| !self.slots[*number as usize].is_member());
            known.or_else(|| recalled.get(spec.path.as_str()).copied()).unwrap_or_else(|| {
                next += 1;
                next - 1
            })
        };
        specs.map(number).collect()
    }

    /// Makes slots for new components.
    pub(super) fn prepare(
        &mut self,
        shared: &Shared,
        specs: impl Iterator<Item = Arc<ComponentSpec>>,
        numbers: &[u32],
    ) {
        let mut names = Vec::new();
        let mut specs: BTreeMap<u32, Arc<ComponentSpec>> = numbers.iter().copied().zip(specs).collect();
        self.keep_numbers(&mut specs, &mut names);
        for (number, spec) in specs {
            // One that takes the place of a component of another class does not go on from what that kept.
            let stored = match self.numbers.get(spec.path.as_str()) {
                Some(known) if self.slots[*known as usize].is_member() => Stored::default(),
                _ => self.stored_of(&spec.path),
            };
            // An emergency stop holds for whoever has the path.
            let before = self.numbers.get(spec.path.as_str()).copied();
            let is_stopped = before.is_some_and(|before| self.slots[before as usize].is_stopped());
            let spec = before.map_or_else(|| Arc::clone(&spec), |before| self.still_stopped(before, Arc::clone(&spec)));
            let network = self.networks.of(&spec);
            if let Some(slot) = self.slots.get_mut(number as usize) {
                slot.network = network;
                slot.revive(spec, stored);
                self.recall_component(number);
                continue;
            }
            if let Some(records) = &self.records {
                records.join(ComponentName::of(&spec), self.phase != RunPhase::Starting);
            }
            let mut slot = Slot::new(number, spec, stored);
            slot.network = network;
            slot.set_stopped(is_stopped);
            names.push(Arc::clone(&slot.name));
            self.numbers.insert(Arc::clone(&slot.name), number);
            self.slots.push(slot);
            self.recall_component(number);
        }
        shared.names.add(names);
        self.set_apart();
        if self.phase == RunPhase::Starting {
            self.journal_capacity /= self.slots.len().max(1);
        }
    }

    /// Leaves to new components what others kept.
    pub(super) fn leave_to(&mut self, numbers: &[u32], estate: &Estate) {
        for &number in numbers {
            if let Some(body) = &mut self.slots[number as usize].body {
                body.part.estate = estate.clone();
            }
        }
    }

    /// Keeps the numbers of components that an earlier program had and that the fleet has no more: what was saved names
    /// components by them.
    fn keep_numbers(&mut self, specs: &mut BTreeMap<u32, Arc<ComponentSpec>>, names: &mut Vec<Arc<str>>) {
        let Some(any) = specs.values().next().cloned() else { return };
        let Some(recalled) = self.memory.recalled.take() else { return };
        for (number, name) in (self.slots.len() as u32..).zip(recalled.names.iter().skip(self.slots.len())) {
            let spec = specs.remove(&number).unwrap_or_else(|| Arc::clone(&any));
            let mut slot = Slot::new(number, Arc::clone(&spec), Stored::default());
            let is_there = spec.path == *name;
            slot.name = Arc::from(name.as_str());
            slot.state = SlotState::Removed;
            if let Some(body) = &mut slot.body {
                body.part.name = Arc::clone(&slot.name);
            }
            names.push(Arc::clone(&slot.name));
            self.numbers.insert(Arc::clone(&slot.name), number);
            self.slots.push(slot);
            if is_there {
                if let Some(records) = &self.records {
                    records.join(ComponentName::of(&spec), self.phase != RunPhase::Starting);
                }
                specs.insert(number, spec);
            }
        }
        self.memory.recalled = Some(recalled);
    }

    /// Moves components to worker threads whose class never runs on the timer, and those that call them: a call runs on
    /// the thread of its caller. In virtual time there are no others.
    fn set_apart(&mut self) {
        if !self.real {
            return;
        }
        let of_class = |slot: &Slot| slot.spec.class.declaration().apart;
        let mut apart: Vec<bool> = self.slots.iter().map(of_class).collect();
        let mut has_changed = apart.contains(&true);
        while std::mem::take(&mut has_changed) {
            for (place, slot) in self.slots.iter().enumerate() {
                let targets = slot.spec.references.iter().flat_map(|wire| &wire.targets);
                let mut targets = targets.map(|target| apart.get(target.component) == Some(&true));
                if !apart[place] && targets.any(|is_apart| is_apart) {
                    (apart[place], has_changed) = (true, true);
                }
            }
        }
        for (slot, always) in self.slots.iter_mut().zip(apart) {
            slot.isolation.always = always;
            slot.isolation.active |= always;
        }
    }

    /// Takes a body out, as for a call.
    pub(super) fn take(&mut self, number: u32) -> Option<Box<Body>> {
        let slot = &mut self.slots[number as usize];
        let body = slot.body.take()?;
        // No code of it runs, which could hang.
        slot.out_since = NEVER;
        self.out += 1;
        Some(body)
    }

    /// Notes that code of a component runs whose body is in the hands of a change: hardware is stopped if it does not
    /// return.
    pub(super) fn enter_code(&mut self, number: u32) {
        self.slots[number as usize].out_since = self.clock.now_without_pause();
    }

    /// Notes that it has returned.
    pub(super) fn leave_code(&mut self, number: u32) {
        self.slots[number as usize].out_since = NEVER;
    }

    /// Gives a component another body in place of the one whose code does not return on a thread that is left behind,
    /// and stops its hardware.
    pub(super) fn leave_behind(&mut self, number: u32) {
        self.stops.request_of(number);
        let slot = &mut self.slots[number as usize];
        if slot.state == SlotState::Abandoned {
            return;
        }
        slot.cancelled.store(true, Ordering::Relaxed);
        slot.cancelled = Arc::default();
        // Its thread hangs still, and nobody is told otherwise.
        (slot.out_since, slot.hangs_since) = (NEVER, NEVER);
        let body = slot.empty_body(number, Stored::default());
        slot.state = SlotState::Failed;
        self.put_back(number, body);
    }

    /// Gives a body back.
    pub(super) fn put_back(&mut self, number: u32, body: Box<Body>) {
        if self.is_abandoned(number) {
            // It was abandoned, and its destructor may block as its code did: it is leaked.
            std::mem::forget(body);
            return;
        }
        self.note_return();
        self.slots[number as usize].body = Some(body);
    }

    /// Gives back the body of a component that continues as before.
    pub(super) fn return_unchanged(&mut self, number: u32, body: Box<Body>, now: u64) {
        self.slots[number as usize].held = false;
        self.put_back(number, body);
        if self.slots[number as usize].is_alive() {
            self.resume(number, now);
        }
    }

    /// Lets a component that did not run start again.
    pub(super) fn let_go(&mut self, number: u32, now: u64) {
        let slot = &mut self.slots[number as usize];
        slot.held = false;
        if slot.is_alive() {
            self.resume(number, now);
        } else if slot.is_member() && std::mem::take(&mut slot.waiting) {
            self.enqueue(number, now);
        }
    }

    /// Gives a component its name again, which one of another class had in a change that is undone. It hears of an
    /// emergency stop and of a release that came meanwhile.
    pub(super) fn take_place_again(&mut self, number: u32, now: u64) {
        let name = Arc::clone(&self.slots[number as usize].name);
        let other = self.numbers.insert(name, number).map(|other| &self.slots[other as usize]);
        let is_stopped = self.slots[number as usize].is_stopped();
        if let Some(other) = other.map(Slot::is_stopped).filter(|other| *other != is_stopped) {
            self.tell_stopped(&[number], other, Cause::default(), now);
        }
    }

    /// Removes a component from the fleet.
    pub(super) fn forget(&mut self, number: u32) {
        self.forget_take_back(number);
        let slot = &mut self.slots[number as usize];
        if slot.state != SlotState::Abandoned {
            slot.state = SlotState::Removed;
            slot.memory = SlotMemory::default();
            slot.leaving = Leaving::Not;
            (slot.entry, slot.pending, slot.sees_work) = (NEVER, PendingRequest::None, None);
            let now = slot.last_due.unwrap_or_default();
            self.note_differs(number, now);
        }
    }

    pub(super) fn take_vote(&mut self, number: u32, now: u64) {
        let body = self.slots[number as usize].body.as_mut();
        if let Some(vote) = body.and_then(|body| body.part.vote.take()) {
            self.note_vote(number, vote, now);
        }
    }

    /// Adds a new component to the fleet: its messages are delivered, and its first execution is scheduled.
    pub(super) fn join(&mut self, number: u32, now: u64) {
        let slot = &mut self.slots[number as usize];
        (slot.joined, slot.held) = (true, false);
        let is_active = slot.state == SlotState::Active;
        let Some(mut body) = slot.body.take() else { return };
        body.part.held = false;
        if is_active {
            self.deliver(&mut body.part, now);
            self.step(now, number, TraceStep::Started);
            self.emit(now, number, Occurrence::Started);
        }
        let slot = &mut self.slots[number as usize];
        slot.body = Some(body);
        if is_active && slot.policy.periodic {
            let recalled = self.recalled_due(number, now);
            let slot = &mut self.slots[number as usize];
            (slot.due, slot.in_delay) = recalled.unwrap_or((now.saturating_add(slot.policy.delay), true));
            let when = slot.next_time();
            match slot.pending {
                PendingRequest::None => {
                    self.enqueue(number, when);
                    self.react_to_news(number, now);
                }
                PendingRequest::Leave | PendingRequest::Return { .. } => self.resume(number, now),
            }
        } else if std::mem::take(&mut slot.waiting) {
            self.enqueue(number, now);
        }
    }

    pub(super) fn commit_takeover(
        &mut self,
        number: u32,
        predecessor: Predecessor,
        done: Takeover,
        now: u64,
    ) -> Option<Outgoing> {
        let mut body = self.slots[number as usize].body.take()?;
        self.forget_take_back(number);
        let outgoing = body.inherit(&mut self.bus, predecessor);
        self.release(number, &mut body, now);
        // What the new instance saves is not what the earlier one did.
        body.part.lasting.touch();
        self.note_saved(&body.part, false, now);
        self.note_inbox(number);
        self.deliver(&mut body.part, now);
        let vote = body.part.vote.take();
        let slot = &mut self.slots[number as usize];
        let period = slot.policy.period;
        slot.renew(Arc::clone(&body.part.spec));
        slot.forget_other_values();
        body.part.period = slot.policy.period;
        slot.body = Some(body);
        let (heartbeats, elsewhere) = (self.heartbeats_of(number), self.heartbeats_elsewhere(number));
        let slot = &mut self.slots[number as usize];
        if let Some(body) = &mut slot.body {
            (body.part.heartbeats, body.part.heartbeats_elsewhere) = (heartbeats, elsewhere);
        }
        slot.held = false;
        slot.statistics.replaced += 1;
        self.note_differs(number, now);
        self.emit(now, number, Occurrence::Replaced { continued: done == Takeover::Continued });
        if let Some(vote) = vote {
            self.note_vote(number, vote, now);
        }
        let slot = &mut self.slots[number as usize];
        // A new period counts from the last execution.
        if let Some(last) = slot.last_due.filter(|_| slot.policy.period != period) {
            slot.due = last.saturating_add(slot.policy.period).max(now);
            if slot.entry != NEVER {
                let when = slot.next_time();
                self.enqueue(number, when);
            }
        }
        self.react_to_news(number, now);
        self.resume(number, now);
        Some(outgoing)
    }

    /// Lets a component that has taken new values go on with them.
    pub(super) fn commit_update(&mut self, updated: Updated, now: u64) {
        let Updated { number, body, after, properties, .. } = updated;
        self.forget_take_back(number);
        // One that does not run may have been stopped meanwhile.
        let after = if body.is_some() { after } else { self.still_stopped(number, after) };
        let slot = &mut self.slots[number as usize];
        // What an operator set before is over.
        slot.memory.set.retain(|set| !properties.contains(&set.property));
        slot.spec = Arc::clone(&after);
        slot.is_wanted = None;
        match body {
            Some(mut body) => {
                body.part.lasting.touch();
                self.note_saved(&body.part, false, now);
                self.return_unchanged(number, body, now);
            }
            None => {
                if let Some(body) = &mut self.slots[number as usize].body {
                    body.part.spec = after;
                }
            }
        }
        self.note_differs(number, now);
        let text = format!("has new values: {}", properties.join(", "));
        self.emit(now, number, Occurrence::Log { level: Level::Info, text });
    }

    /// Sets the specification that a component which does not run has from its next start on.
    pub(super) fn await_spec(&mut self, number: u32, spec: Arc<ComponentSpec>, estate: Estate, now: u64) {
        self.forget_take_back(number);
        let spec = self.still_stopped(number, spec);
        let slot = &mut self.slots[number as usize];
        slot.renew(Arc::clone(&spec));
        slot.forget_other_values();
        let has_failed = slot.state == SlotState::Failed;
        if let Some(body) = &mut slot.body {
            (body.part.spec, body.part.estate, body.part.period) = (spec, estate, slot.policy.period);
        }
        self.note_differs(number, now);
        if has_failed {
            self.request(number, Request::Schedule { lasting: NEVER }, now);
        }
    }
}

impl Slot {
    /// Sets a new specification.
    pub(super) fn renew(&mut self, spec: Arc<ComponentSpec>) {
        self.policy = TaskPolicy::of(&spec);
        self.hears_stops = hears_stops(&spec);
        self.label = Label::of(&spec);
        self.is_wanted = None;
        self.spec = spec;
    }

    /// Forgets what operators have set and the specification does not say any more.
    fn forget_other_values(&mut self) {
        let spec = &self.spec;
        self.memory.set.retain(|set| {
            let changed = changed(spec, &set.property, &set.value);
            changed.is_ok_and(|changed| value_hash(&changed, &set.property) == value_hash(spec, &set.property))
        });
    }

    /// Reuses the slot of a removed component that returns.
    pub(super) fn revive(&mut self, spec: Arc<ComponentSpec>, stored: Stored) {
        self.renew(Arc::clone(&spec));
        (self.state, self.held) = (SlotState::Idle, true);
        (self.due, self.last_due, self.until) = (NEVER, None, NEVER);
        (self.react_due, self.last_react) = (NEVER, None);
        if let Some(body) = &mut self.body {
            (body.part.spec, body.part.period, body.part.held) = (spec, self.policy.period, true);
            body.part.lasting.forget();
            body.part.stored = stored;
            body.part.to_keep.clear();
            body.part.outbox.clear();
        }
    }
}
