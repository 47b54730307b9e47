//! Code that a cut waits for: what other components know of an execution that is not over.
//!
//! An execution on another thread counts as not begun. Once it has called another component, that one knows of it, so
//! that both would not go back to the same moment: such an execution has to return before the cut.

use saoms_api::host::{SharedMessage, TopicKind};

use super::super::{Engine, NEVER, Next, RunPhase};
use super::{Ending, SlotMemory};
use crate::bus::TopicId;
use crate::schedule::component::body::{Body, Job};
use crate::schedule::os::sys;

/// Time for which a cut waits for code that runs on another thread, and has to be in it.
const PATIENCE: u64 = 1_000_000_000;

/// How the next cut waits for code.
#[derive(Debug, Default)]
pub(super) struct CodeInCalls {
    /// The time until which it waits at most, if it waits; and the same on the clock of the machine, which does not
    /// stand still while the fleet pauses.
    until: Option<u64>,
    until_on_machine: u64,
    /// True until some code returns.
    is_blocked: bool,
    /// Components whose code has called another one, and may not have returned.
    callers: Vec<u32>,
    /// Components that were not handed over to another thread meanwhile, so that the wait ends.
    held_back: Vec<u32>,
}

impl CodeInCalls {
    /// The time until which there is no use in trying.
    pub(super) fn blocks_until(&self) -> u64 {
        self.until.filter(|_| self.is_blocked).unwrap_or(0)
    }
}

impl SlotMemory {
    /// Numbers code that begins.
    #[inline]
    fn begin_code(&mut self) -> u64 {
        self.code += 1;
        self.code
    }

    /// Notes that the code has returned: no code has the present number.
    #[inline]
    pub(crate) fn note_end_of_code(&mut self) {
        self.code += 1;
    }
}

impl Engine {
    /// Notes that the code of a component calls another one.
    #[inline]
    pub(crate) fn note_caller(&mut self, index: u32) {
        if !self.memory.is_on() {
            return;
        }
        let memory = &mut self.slots[index as usize].memory;
        memory.has_called = true;
        // Once, however long there is no cut, as on a full disk.
        if !std::mem::replace(&mut memory.is_noted_caller, true) {
            self.memory.code.callers.push(index);
        }
    }

    /// Notes that the code of a component begins. Events that it was given before count as unread until it returns,
    /// whatever it does.
    #[inline]
    pub(crate) fn note_code(&mut self, index: u32, body: &mut Body) {
        let memory = &mut self.slots[index as usize].memory;
        (memory.has_called, memory.is_given_up) = (false, false);
        body.part.code = memory.begin_code();
        if !self.memory.with_inbox.is_empty() {
            self.note_given(index, body);
        }
    }

    #[cold]
    fn note_given(&mut self, index: u32, body: &Body) {
        if !self.memory.is_on() || !self.memory.with_inbox.contains(&index) {
            return;
        }
        let inboxes = body.part.subscriptions.iter().zip(&body.inboxes);
        let inboxes = inboxes.chain(body.part.subscriptions.iter().zip(&body.reactions));
        let inboxes = inboxes.map(|(subscription, inbox)| (self.bus.topic_of(subscription), inbox));
        let given = body.part.lasting.unread().map(|(topic, events)| (*topic, events)).chain(inboxes);
        let is_event = |(topic, events): &(TopicId, &Vec<SharedMessage>)| {
            !events.is_empty() && self.bus.kind(*topic) == TopicKind::Event
        };
        let given: Vec<_> = given.filter(is_event).map(|(topic, events)| (topic, events.clone())).collect();
        self.slots[index as usize].memory.reading.extend(given);
    }

    /// A cut, or what a component has to save before; `None` while it waits for code on another thread.
    #[cold]
    pub(super) fn cut_or_save(&mut self, now: u64) -> Option<Next> {
        let is_late = self.memory.code.until.is_some() && sys::monotonic() >= self.memory.code.until_on_machine;
        while let Some(index) = self.memory.touched.last().copied() {
            let slot = &mut self.slots[index as usize];
            let is_touched = slot.memory.is_touched && !slot.held && slot.is_alive();
            match slot.body {
                Some(_) if is_touched => return Some(Next::Run(index, Job::Save)),
                // What it did since it saved has effects elsewhere. If it hangs, it goes on from what it saved.
                None if is_touched && !is_late => return self.wait_for_code(now),
                _ => {
                    slot.memory.is_touched = false;
                    self.memory.touched.pop();
                }
            }
        }
        while let Some(index) = self.memory.code.callers.last().copied() {
            let slot = &mut self.slots[index as usize];
            let is_out = slot.body.is_none() && slot.memory.has_called && slot.is_alive();
            if is_out && !slot.memory.is_given_up {
                if !is_late {
                    return self.wait_for_code(now);
                }
                // It goes on as after a failure, and no further cut waits for it.
                slot.memory.is_given_up = true;
            }
            slot.memory.is_noted_caller = false;
            self.memory.code.callers.pop();
        }
        self.memory.code.until = None;
        self.release_held_back(now);
        Some(Next::Cut)
    }

    #[cold]
    fn wait_for_code(&mut self, now: u64) -> Option<Next> {
        if self.memory.code.until.is_none() {
            self.memory.code.until = Some(now.saturating_add(PATIENCE));
            self.memory.code.until_on_machine = sys::monotonic().saturating_add(PATIENCE);
        }
        self.memory.code.is_blocked = true;
        self.memory.schedule();
        None
    }

    /// The last cut of a run that ends, or what has to be before; `None` if there is none.
    pub(in super::super) fn next_for_last_cut(&mut self, now: u64) -> Option<Next> {
        if self.memory.guards > 0 {
            let until = now.saturating_add(self.memory.patience);
            let until = *self.memory.guarded_until.get_or_insert(until);
            if now < until {
                return Some(Next::Wait(until));
            }
            self.cut_short();
            return None;
        }
        if self.memory.guarded_until.take().is_some() {
            // Each component has the time of `grace` for its end.
            self.ended.1 = sys::monotonic();
        }
        Some(self.cut_or_save(now).unwrap_or_else(|| self.wait_for_cut()))
    }

    /// Lets the run end without a last cut: what belongs together would be in it in part. The next program goes on from
    /// the cut before, and what was kept since then or waited for this one is gone, as after a crash.
    #[cold]
    fn cut_short(&mut self) {
        self.ended.1 = sys::monotonic();
        self.injections.clear();
        let memory = &mut self.memory;
        (memory.ending, memory.last_inputs) = (Ending::CutShort, None);
        self.unsent += std::mem::take(&mut memory.outgoing).len() as u64;
        memory.note_outgoing();
        memory.changes.clear();
        memory.waiting.clear();
        let announced = std::mem::take(&mut memory.announced);
        if let Some(queue) = &memory.queue {
            queue.withdraw(announced);
        }
        // What is in a cut that is being written leaves still.
        let written = memory.writing.back().map_or(0, |last| last.batch);
        self.drop_uncommitted(written);
        self.release_held_back(0);
        self.has_returned |= self.awaited > 0;
    }

    /// Waits until there is use in trying again.
    pub(in super::super) fn wait_for_cut(&self) -> Next {
        Next::Wait(self.memory.code.until.unwrap_or(NEVER))
    }

    /// Looks again whether a cut can be made, since some code has returned.
    #[inline]
    pub(in super::super) fn retry_cut(&mut self) {
        if std::mem::take(&mut self.memory.code.is_blocked) {
            self.memory.schedule();
            self.wake |= self.roles.asleep_until != 0;
        }
    }

    /// True if a component is not handed over to another thread now, since a cut waits, and it may call others.
    #[inline]
    pub(in super::super) fn holds_back(&mut self, index: u32) -> bool {
        let waits = self.memory.code.until.is_some() && self.phase == RunPhase::Running;
        let slot = &mut self.slots[index as usize];
        if !waits || slot.spec.references.iter().all(|wire| wire.targets.is_empty()) {
            return false;
        }
        slot.waiting = true;
        self.memory.code.held_back.push(index);
        true
    }

    /// Lets the components go on that were not handed over.
    pub(super) fn release_held_back(&mut self, now: u64) {
        for index in std::mem::take(&mut self.memory.code.held_back) {
            // At the end of the run all components end anyway.
            if self.phase == RunPhase::Running && self.slots[index as usize].body.is_some() {
                self.resume(index, now);
            }
        }
    }
}
