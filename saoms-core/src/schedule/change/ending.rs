//! Components that end in a change, and what is tried again because another component hindered it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use saoms_api::Failure;

use super::apart::{Performed, Unreturned, within};
use super::transaction::Change;
use crate::observe::Occurrence;
use crate::schedule::component::body::{Body, Job};
use crate::schedule::component::library::with_library;
use crate::schedule::engine::RunPhase;
use crate::schedule::engine::slot::{NEVER, PendingRequest, SlotState};
use crate::schedule::shared::Shared;

/// Maximum time between two tries of what another component hinders.
const LOOK: Duration = Duration::from_millis(10);

impl Change<'_> {
    /// Waits until the component is free that one which failed found busy. False if that is not why it failed, or lasts
    /// for too long.
    pub(super) fn may_try_again(&self, failure: &Failure, deadline: Instant) -> bool {
        let left = deadline.saturating_duration_since(Instant::now());
        if failure.busy_provider().is_none() || left.is_zero() {
            return false;
        }
        let engine = self.shared.wait_for_return(self.shared.lock(), left.min(LOOK));
        self.shared.release(engine);
        true
    }

    /// Forgets what a new component did before it failed.
    pub(super) fn clear(&self, number: u32) {
        let mut engine = self.shared.lock();
        if let Some(mut body) = engine.take(number) {
            body.part.outbox.clear();
            body.part.to_keep.clear();
            body.part.vote = None;
            engine.keep_subscriptions(&mut body);
            engine.put_back(number, body);
        }
        self.shared.release(engine);
    }

    /// Shuts down a new component of a change that is undone.
    pub(super) fn take_back(&self, number: u32) {
        let mut engine = self.shared.lock();
        if engine.slots[number as usize].state != SlotState::Active {
            return;
        }
        let now = engine.time_of_change(self.shared);
        let Some(body) = engine.begin(number, Job::Shutdown, now) else { return };
        self.shared.release(engine);
        let ended = self.end(number, body);
        let mut engine = self.shared.lock();
        let (is_told, result) = match ended {
            Ok((mut body, result)) => {
                body.part.outbox.clear();
                body.part.to_keep.clear();
                let is_told = body.part.told.take().is_some();
                engine.put_back(number, body);
                (is_told, result)
            }
            Err(failure) => (false, Err(failure)),
        };
        if let Err(failure) = result
            && !is_told
        {
            let message =
                format!("could not shut down: {}", with_library(&engine.slots[number as usize].spec, failure));
            engine.emit(now, number, Occurrence::Failed { message, restart: None });
        }
        self.shared.release(engine);
    }

    /// Shuts a component down, again and again while one that it calls is busy. An error is one of code that does not
    /// return: its thread is left behind.
    fn end(&self, number: u32, mut body: Box<Body>) -> Result<Performed<()>, Failure> {
        let deadline = Instant::now() + self.shared.settings.grace;
        body.part.retries_shutdown = true;
        loop {
            let (returned, result) =
                self.perform_within(number, body, Job::Shutdown).map_err(|(_, failure)| failure)?;
            body = returned;
            match &result {
                Err(failure) if body.part.retries_shutdown && body.part.busy_provider(failure).is_some() => {
                    body.part.outbox.clear();
                    body.part.retries_shutdown = self.may_try_again(failure, deadline);
                }
                _ => return Ok((body, result)),
            }
        }
    }

    /// Performs a job of a component that joins or ends, within the time that components have to end. Where its code
    /// does not return, its hardware is stopped, and the component is without its body.
    pub(super) fn perform_within(
        &self,
        number: u32,
        mut body: Box<Body>,
        job: Job,
    ) -> Result<Performed<()>, (u32, Failure)> {
        let mut engine = self.shared.lock();
        let apart = engine.goes_apart(&mut body);
        engine.enter_code(number);
        self.shared.release(engine);
        let limit = self.shared.settings.grace;
        let perform = move |body: &mut Body, shared: &Arc<Shared>| body.perform(shared, job);
        let late = |body: Box<Body>, _: Result<(), Failure>, shared: &Arc<Shared>| body.end_late(shared);
        let performed = within(self.shared, (job.name(), limit), body, perform, late);
        let mut engine = self.shared.lock();
        match performed {
            Ok((mut body, result)) => {
                engine.returns_from_apart(&mut body);
                engine.leave_code(number);
                self.shared.release(engine);
                Ok((body, result))
            }
            Err(Unreturned { body, failure }) => {
                engine.leave_behind(number);
                if body.is_none() {
                    engine.take_off(apart);
                }
                self.shared.release(engine);
                body.into_iter().for_each(|body| body.withdraw(self.shared));
                Err((number, failure))
            }
        }
    }

    /// Shuts down the components that the change has removed, those that call others first. As at the end of a run,
    /// each serves calls until its turn.
    pub(super) fn shut_down_removed(&mut self, now: u64) {
        let leaving = std::mem::take(&mut self.leaving);
        let mut ends = Vec::with_capacity(leaving.len());
        let mut engine = self.shared.lock();
        for (number, mut body) in leaving {
            let slot = &mut engine.slots[number as usize];
            if slot.state != SlotState::Abandoned {
                // Its turn comes from here, and not from the queues.
                (slot.state, slot.pending) = (SlotState::Leaving, PendingRequest::None);
                (slot.entry, slot.waiting, slot.queued) = (NEVER, false, false);
            }
            // The thread of a caller has it meanwhile, and may never give it back.
            ends.push((number, engine.goes_apart(&mut body)));
            engine.note_answer(number);
            engine.put_back(number, body);
        }
        engine.roles.work.retain(|number| !ends.iter().any(|(ends, _)| ends == number));
        self.shared.release(engine);
        for (number, apart) in ends {
            self.shut_down(number, apart, now);
        }
    }

    /// Shuts down a component that the change has removed, and whose body has this number while others call it.
    fn shut_down(&self, number: u32, apart: u64, now: u64) {
        let deadline = Instant::now() + self.shared.settings.grace;
        let mut engine = self.shared.lock();
        let taken = loop {
            if !engine.slots[number as usize].is_alive() {
                // The run has begun to end, or its code has failed in a call.
                if let Some(body) = engine.slots[number as usize].body.as_mut() {
                    body.part.apart = None;
                }
                engine.no_longer_apart(apart);
                engine.leave_topics(number, now);
                engine.forget_vote(number, now);
                engine.forget(number);
                return self.shared.release(engine);
            }
            let left = deadline.saturating_duration_since(Instant::now());
            match engine.take(number) {
                None if !left.is_zero() => engine = self.shared.wait_for_return(engine, left),
                taken => break taken,
            }
        };
        let ended = match taken {
            Some(mut body) => {
                engine.returns_from_apart(&mut body);
                self.shared.release(engine);
                (body.part.now, body.part.due) = (now, now);
                self.end(number, body)
            }
            None => {
                // Who ends the run meanwhile gives up what does not return.
                if engine.phase == RunPhase::Running {
                    engine.leave_behind(number);
                    engine.take_off(apart);
                }
                self.shared.release(engine);
                Err(Failure::new("a call of its code has not returned"))
            }
        };
        let mut engine = self.shared.lock();
        match ended {
            Ok((mut body, result)) => {
                // What it keeps now would outlive it.
                body.part.to_keep.clear();
                engine.finish(number, body, Job::Shutdown, result, now, now);
            }
            Err(failure) => {
                let name = &engine.slots[number as usize].name;
                let reason = format!("component `{name}` was removed, and did not end: {failure}");
                engine.reasons.push(reason);
                engine.emit(now, number, Occurrence::Abandoned);
                engine.stop_its_hardware(number);
                engine.forget_vote(number, now);
            }
        }
        engine.forget(number);
        self.shared.release(engine);
    }
}
