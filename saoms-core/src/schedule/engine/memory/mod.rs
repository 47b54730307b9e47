//! The memory of a fleet with a state folder: after a crash, a loss of power or a usual end, the same command goes on
//! from the last *cut*.
//!
//! A cut is all that the program is at one moment between two executions: what its components saved, the events that
//! wait for them, what state topics retain, what waits from outside, the report, and the time. It is one group of the
//! log, so that the folder has a whole cut or the one before. Between two cuts nothing is written: messages inside the
//! program need not wait, since sender and receiver go back to the same moment. What leaves the program waits until the
//! next cut is committed.

mod cut;
mod forms;
mod outgoing;
mod recall;
mod waiting;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

use saoms_api::Saved;
use saoms_api::host::SharedMessage;

pub(in crate::schedule) use self::forms::{AlertForm, InputForm, InputMessage, InputsForm, SetForm, is_of_memory};
pub(super) use self::outgoing::MUCH;
use self::outgoing::Outgoing;
use self::recall::Recalled;
pub(in crate::schedule) use self::recall::{Recollection, recall_report, value_hash};
use self::waiting::CodeInCalls;
use super::slot::NEVER;
use super::{Engine, Next, RunPhase};
use crate::bus::TopicId;
use crate::network::FromRun;
use crate::schedule::component::part::Part;
use crate::store::{Change, StoreQueue};

/// Time between two cuts on which nothing waits: the most of what simulated components did that is done again.
const BETWEEN_CUTS: u64 = 500_000_000;
/// Time after which a cut on which something waits does not wait for a pause of the timer any more.
const PATIENCE: u64 = 2_000_000;

/// In place of the number of a component: a cut.
pub(in crate::schedule) const CUT: u32 = u32::MAX - 1;

/// The memory of a fleet.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    /// Where cuts go; `None` where there is no state folder, or it has failed.
    queue: Option<Arc<StoreQueue>>,
    /// The time from which a cut is due, however busy the timer is: `NEVER` while none is wanted.
    pub(crate) due_at_last: u64,
    /// The time since which something waits for the next cut, and since which it would differ from the last one.
    wanted_since: u64,
    differs_since: u64,
    /// Number of cuts that were made, and of those that are committed.
    made: u64,
    committed: u64,
    /// True while an operator pauses the run, also at its end, which ends the pause.
    is_paused: bool,
    /// Number of those who must not see a cut before they have finished; for how long the last cut waits for them, and
    /// until when.
    guards: usize,
    patience: u64,
    guarded_until: Option<u64>,
    /// How the next cut waits for code that runs on other threads.
    code: CodeInCalls,
    /// Components with events that they were given and have not handled.
    with_inbox: Vec<u32>,
    ending: Ending,
    /// Components that differ from the last cut, and those that have to save before the next one.
    differing: Vec<u32>,
    touched: Vec<u32>,
    /// Changes for the next cut, with their bytes in the queue, and the batches of components that they are.
    changes: Vec<Change>,
    announced: usize,
    waiting: Vec<(u32, u64)>,
    /// What leaves the program once the next cut is committed.
    outgoing: Outgoing,
    /// Number of bytes of the messages of components that wait for commits, roughly.
    held_back: usize,
    /// The cuts that are written: one, and at the end of the run the last one.
    writing: VecDeque<Writing>,
    /// What waits from outside when the run ends.
    last_inputs: Option<InputsForm>,
    /// The last change of each topic in the last cut.
    topics: Vec<u64>,
    /// Number of components of this program, and of others, whose paths the last cut has.
    named: (usize, usize),
    /// How far events of other programs were received, by networks, topics and first starts of the programs; and which
    /// of that the last cut does not have.
    received: BTreeMap<(String, Arc<str>, u64), u64>,
    newly_received: BTreeSet<(String, Arc<str>, u64)>,
    /// Counters of the program beside the engine.
    counters: BTreeMap<String, Counter>,
    /// Texts of the program beside the engine, which it changes by itself.
    texts: BTreeMap<String, SharedText>,
    /// What an earlier program left, until the fleet has started.
    pub(crate) recalled: Option<Box<Recalled>>,
}

/// A text that the program beside the engine changes, such as a list.
pub type SharedText = Arc<Mutex<String>>;

/// A counter of the program beside the engine.
#[derive(Clone, Debug)]
pub(crate) enum Counter {
    /// It counts by itself.
    Shared(Arc<AtomicU32>),
    /// It was set to this.
    Set(u64),
}

impl Counter {
    pub(super) fn value(&self) -> u64 {
        match self {
            Counter::Shared(count) => u64::from(count.load(Ordering::Relaxed)),
            Counter::Set(value) => *value,
        }
    }
}

/// A cut on its way to the disk.
#[derive(Debug)]
struct Writing {
    cut: u64,
    /// The number of the last batch in it; and the components of all, each with a batch, in the order of these.
    batch: u64,
    batches: Vec<(u32, u64)>,
    /// What leaves the program once it is committed.
    outgoing: Outgoing,
}

/// The last cut: the end of the run is no part of the memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Ending {
    #[default]
    Running,
    /// The run ends, and the last cut is still to be made.
    Due,
    Made,
    /// There is none, since what belongs together was not complete in time.
    CutShort,
}

/// What the memory knows of a component.
#[derive(Debug, Default)]
pub(crate) struct SlotMemory {
    /// What it saved when its code returned last.
    saved: Option<Arc<Saved>>,
    differs: bool,
    is_touched: bool,
    /// Number of times that its code has begun or returned.
    code: u64,
    /// The events that its code has, while it runs.
    reading: Vec<(TopicId, Vec<SharedMessage>)>,
    /// True if its code has called another component, until it returns; and if cuts have waited for that long enough.
    has_called: bool,
    is_given_up: bool,
    /// True if it is among the callers that the next cut looks at.
    is_noted_caller: bool,
    /// The values that operators have set, and the alerts that it has raised.
    pub(crate) set: Vec<SetForm>,
    alerts: Vec<AlertForm>,
    /// True if it goes on from what an earlier program saved, until it has started.
    pub(crate) is_recalled: bool,
    /// True if it was there in an earlier program, and has lost what it knew.
    begins_anew: bool,
}

impl Memory {
    /// With the time for which the last cut waits for what belongs together.
    pub(super) fn new(patience: u64) -> Memory {
        Memory { due_at_last: NEVER, wanted_since: NEVER, differs_since: NEVER, patience, ..Memory::default() }
    }

    #[inline]
    pub(crate) fn is_on(&self) -> bool {
        self.queue.is_some()
    }

    /// True if what an execution does counts for the next cut.
    fn takes(&self, phase: RunPhase) -> bool {
        let runs = self.ending == Ending::Running && matches!(phase, RunPhase::Running | RunPhase::Starting);
        // What returns before the last cut is part of that.
        self.is_on() && (runs || self.ending == Ending::Due)
    }

    /// The same, for others.
    pub(super) fn takes_now(&self, phase: RunPhase) -> bool {
        self.takes(phase)
    }

    /// True if what happens from now on is no part of what the fleet goes on from, so that nothing of it is kept or
    /// leaves over a network.
    pub(in crate::schedule) fn is_over(&self, phase: RunPhase) -> bool {
        self.is_on() && !self.takes(phase)
    }

    /// The time from which a cut is due when nothing else is.
    #[inline]
    pub(super) fn due(&self) -> u64 {
        let due = self.wanted_since.min(self.differs_since.saturating_add(BETWEEN_CUTS));
        self.code.blocks_until().max(due)
    }

    fn may_cut(&self) -> bool {
        self.is_on() && self.writing.is_empty() && self.guards == 0
    }

    /// The number of the cut that has all that happened so far.
    pub(crate) fn next(&self) -> u64 {
        self.made + 1
    }

    pub(crate) fn is_committed(&self, cut: u64) -> bool {
        self.committed >= cut
    }

    /// True if there was no last cut.
    pub(crate) fn is_cut_short(&self) -> bool {
        self.ending == Ending::CutShort
    }

    /// True if the run ends, and the last cut waits for what belongs together.
    pub(in crate::schedule) fn is_open(&self) -> bool {
        self.is_on() && self.ending == Ending::Due && self.guards > 0
    }

    /// True if what happens outside waits for a cut that will come.
    pub(crate) fn has_uncommitted(&self) -> bool {
        self.is_on() && (!self.outgoing.is_empty() || !self.writing.is_empty() || self.ending == Ending::Due)
    }

    /// Counts what waits for cuts among what waits for the disk.
    fn note_outgoing(&self) {
        let written: usize = self.writing.iter().map(|one| one.outgoing.bytes()).sum();
        if let Some(queue) = &self.queue {
            queue.note_outgoing(self.outgoing.bytes() + written + self.held_back);
        }
    }

    /// Notes that messages of components wait for commits, or do not any more: their bytes before and now.
    pub(super) fn note_held_back(&mut self, before: usize, now: usize) {
        self.held_back = self.held_back.saturating_sub(before) + now;
        self.note_outgoing();
    }

    fn schedule(&mut self) {
        self.due_at_last = match self.may_cut() {
            true => {
                let due = self.differs_since.saturating_add(2 * BETWEEN_CUTS);
                due.min(self.wanted_since.saturating_add(PATIENCE)).max(self.code.blocks_until())
            }
            false => NEVER,
        };
    }
}

impl Engine {
    /// The next thing to do for a cut that is due.
    #[inline]
    pub(super) fn next_for_cut(&mut self, now: u64) -> Option<Next> {
        let is_due = self.memory.may_cut() && now >= self.memory.due();
        if is_due { self.cut_or_save(now) } else { None }
    }

    /// The same while the fleet pauses: time stands still.
    pub(super) fn next_for_cut_while_paused(&mut self, now: u64) -> Option<Next> {
        let differs = self.memory.wanted_since != NEVER || self.memory.differs_since != NEVER;
        if differs && self.memory.may_cut() { self.cut_or_save(now) } else { None }
    }

    /// The time at which the next cut is due; `NEVER` while one is written.
    #[inline]
    pub(super) fn next_cut(&self) -> u64 {
        if self.memory.may_cut() { self.memory.due() } else { NEVER }
    }

    /// True at the end of the run, until its last cut is made.
    pub(super) fn is_last_cut_due(&self) -> bool {
        self.memory.ending == Ending::Due && self.memory.is_on()
    }

    /// Notes that a component may have events that it was given and has not handled.
    pub(crate) fn note_inbox(&mut self, index: u32) {
        if self.memory.is_on() && !self.memory.with_inbox.contains(&index) {
            self.memory.with_inbox.push(index);
        }
    }

    /// Asks for a cut as soon as possible; gives its number.
    pub(crate) fn want_cut(&mut self, now: u64) -> u64 {
        self.memory.wanted_since = self.memory.wanted_since.min(now);
        self.memory.schedule();
        self.wake |= self.roles.asleep_until != 0;
        self.memory.next()
    }

    /// Keeps cuts away until [`unguard_cut`](Engine::unguard_cut). False if the memory is over, which takes nothing
    /// more.
    pub(in crate::schedule) fn guard_cut(&mut self) -> bool {
        let is_over = self.memory.is_on() && self.memory.ending != Ending::Running;
        if !is_over {
            self.memory.guards += 1;
            self.memory.schedule();
        }
        !is_over
    }

    /// Gives a guard back.
    pub(in crate::schedule) fn unguard_cut(&mut self) {
        self.memory.guards -= 1;
        if self.memory.ending == Ending::Running {
            self.memory.schedule();
        }
        self.wake |= self.roles.asleep_until != 0;
    }

    /// Notes that a component differs from the last cut.
    pub(crate) fn note_differs(&mut self, index: u32, now: u64) {
        if !self.memory.is_on() {
            return;
        }
        if !std::mem::replace(&mut self.slots[index as usize].memory.differs, true) {
            self.memory.differing.push(index);
        }
        self.note_difference(now);
    }

    /// Notes that an operator pauses the run, or lets it go on.
    pub(in crate::schedule) fn note_pause(&mut self, is_paused: bool, now: u64) {
        self.memory.is_paused = is_paused;
        self.note_difference(now);
    }

    /// Notes that something differs from the last cut.
    #[inline]
    pub(crate) fn note_difference(&mut self, now: u64) {
        if self.memory.differs_since == NEVER && self.memory.is_on() {
            self.memory.differs_since = now;
            self.memory.schedule();
        }
    }

    /// Takes over what a component saved, whose code has returned.
    #[inline]
    pub(crate) fn note_saved(&mut self, part: &Part, for_cut: bool, now: u64) {
        if self.memory.takes(self.phase) || for_cut && self.memory.is_on() {
            self.take_saved(part, now);
        }
    }

    #[cold]
    fn take_saved(&mut self, part: &Part, now: u64) {
        let memory = &mut self.slots[part.index as usize].memory;
        memory.reading.clear();
        let saved = part.lasting.saved();
        let has_alerts = memory.alerts != part.alerts;
        if has_alerts {
            memory.alerts.clone_from(&part.alerts);
        }
        let is_same = match (saved, &memory.saved) {
            (Some(saved), Some(known)) => Arc::ptr_eq(saved, known),
            (None, None) => true,
            _ => false,
        };
        if part.lasting.is_touched() && !std::mem::replace(&mut memory.is_touched, true) {
            self.memory.touched.push(part.index);
            self.note_difference(now);
        }
        let memory = &mut self.slots[part.index as usize].memory;
        if !part.lasting.is_touched() {
            memory.is_touched = false;
        }
        if !is_same || has_alerts {
            memory.saved = saved.map(Arc::clone);
            self.note_differs(part.index, now);
        } else {
            self.note_difference(now);
        }
    }

    /// Notes the events that the code of a component gets: until it returns, they count as unread.
    #[inline]
    pub(crate) fn note_reading(&mut self, index: u32, part: &Part, inboxes: &[Vec<SharedMessage>]) {
        if self.memory.is_on() {
            for (subscription, inbox) in part.subscriptions.iter().zip(inboxes).filter(|(_, inbox)| !inbox.is_empty()) {
                let topic = self.bus.topic_of(subscription);
                if self.bus.kind(topic) == saoms_api::host::TopicKind::Event {
                    self.slots[index as usize].memory.reading.push((topic, inbox.clone()));
                }
            }
        }
    }

    /// Hands over to the store what is kept, with the next cut.
    pub(crate) fn hand_over(&mut self, index: u32, number: u64, changes: Vec<Change>, now: u64) {
        let Some(queue) = &self.memory.queue else { return };
        self.memory.announced += queue.announce(&changes);
        self.memory.changes.extend(changes);
        // Events of a topic leave in the order in which they were numbered, whoever sent them.
        match self.memory.waiting.last_mut() {
            Some((last, batch)) if *last == index => *batch = number,
            _ => self.memory.waiting.push((index, number)),
        }
        self.want_cut(now);
    }

    /// Leaves something for a network: with a memory, once what it follows from is committed.
    pub(crate) fn leave_for_network(&mut self, network: u8, from_run: FromRun, now: u64) {
        if self.memory.takes(self.phase) {
            self.memory.outgoing.push(network, from_run);
            self.memory.note_outgoing();
            self.want_cut(now);
        } else if !self.memory.is_over(self.phase) || !matches!(from_run, FromRun::Message { .. }) {
            // Others would act on what is said in a shutdown, and the fleet goes on from before that.
            self.networks.waiting.push((network, from_run));
        }
    }

    /// Notes that an event of another program was received: the first start of that program, and its number.
    pub(in crate::schedule) fn note_received(
        &mut self,
        network: usize,
        topic: TopicId,
        (origin, number): (u64, u64),
        now: u64,
    ) {
        if self.memory.takes(self.phase) {
            let url = self.networks.url(u8::try_from(network).unwrap_or(u8::MAX));
            let key = (url, Arc::clone(self.bus.name(topic)), origin);
            self.memory.received.insert(key.clone(), number + 1);
            self.memory.newly_received.insert(key);
            self.note_difference(now);
        }
    }

    /// A cut is committed: what waited for it leaves.
    #[cold]
    pub(super) fn commit_cut(&mut self, cut: u64, now: u64) {
        self.memory.committed = cut;
        while let Some(written) = self.memory.writing.pop_front_if(|first| first.cut <= cut) {
            for (index, batch) in written.batches {
                self.commit(index, batch, now);
            }
            self.networks.waiting.extend(written.outgoing.into_all());
        }
        self.memory.note_outgoing();
        self.memory.schedule();
        self.has_returned |= self.awaited > 0;
        self.wake |= self.roles.asleep_until != 0;
    }

    /// Nothing is committed any more. Gives the number of messages that do not leave.
    pub(super) fn fail_memory(&mut self) -> u64 {
        let written = self.memory.writing.iter().map(|one| one.outgoing.len()).sum::<usize>();
        let unsent = self.memory.outgoing.len() + written;
        self.release_held_back(0);
        let Memory { committed, made, guards, patience, .. } = self.memory;
        self.memory = Memory { committed, made, guards, ..Memory::new(patience) };
        self.has_returned |= self.awaited > 0;
        unsent as u64
    }

    /// Lets the memory end with the present moment: what components do in their shutdown is no part of it.
    pub(super) fn end_memory(&mut self) {
        if self.memory.is_on() && self.memory.ending == Ending::Running {
            self.memory.ending = Ending::Due;
            self.memory.due_at_last = NEVER;
            self.memory.last_inputs = Some(self.waiting_inputs());
        }
    }

    /// Notes a value that an operator has set.
    pub(in crate::schedule) fn note_set(&mut self, index: u32, set: SetForm, now: u64) {
        let known = &mut self.slots[index as usize].memory.set;
        match known.iter_mut().find(|known| known.property == set.property) {
            Some(known) => known.value = set.value,
            None => known.push(set),
        }
        self.note_differs(index, now);
    }

    /// Notes that a component has executed for the first time: it is not in its delay any more.
    #[inline]
    pub(super) fn note_executed(&mut self, index: u32, now: u64) {
        if std::mem::take(&mut self.slots[index as usize].in_delay) {
            self.note_differs(index, now);
        }
    }
}
