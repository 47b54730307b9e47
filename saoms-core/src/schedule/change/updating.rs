//! Live properties that are a part of a change: they are set last, and set back if the change is undone.

use std::sync::Arc;
use std::time::Instant;

use saoms_api::Failure;
use saoms_api::host::contain::contained;
use saoms_lang::assembly::ComponentSpec;

use super::ChangeError;
use super::apart::{Unreturned, within_member};
use super::transaction::{Change, WAIT};
use crate::observe::Occurrence;
use crate::schedule::component::body::Body;
use crate::schedule::component::library::with_library;
use crate::schedule::component::part::Part;
use crate::schedule::engine::Engine;
use crate::schedule::engine::slot::SlotState;
use crate::schedule::shared::Shared;

/// A component that has taken new values, out of the engine until the change is committed.
pub(super) struct Updated {
    pub(super) number: u32,
    /// Its body; `None` for one that does not run, and has the values from its next start on.
    pub(super) body: Option<Box<Body>>,
    /// The specification that it had.
    before: Arc<ComponentSpec>,
    /// The specification that it has.
    pub(super) after: Arc<ComponentSpec>,
    pub(super) properties: Vec<String>,
}

impl Change<'_> {
    /// Gives a component new values.
    pub(super) fn update(
        &mut self,
        number: u32,
        after: Arc<ComponentSpec>,
        properties: Vec<String>,
    ) -> Result<(), ChangeError> {
        let body = self.body_of(number)?;
        let (before, after) = self
            .shared
            .look(|engine| (Arc::clone(&engine.slots[number as usize].spec), engine.still_stopped(number, after)));
        let Some(mut body) = body else {
            self.updated.push(Updated { number, body: None, before, after, properties });
            return Ok(());
        };
        let now = self.shared.clock.now();
        (body.part.now, body.part.due) = (now, now);
        let (values, had) = (Arc::clone(&after), Arc::clone(&before));
        let take = move |body: &mut Body, shared: &Arc<Shared>| body.take_values(shared, values);
        let goes_on = move |body: Box<Body>, _: Result<(), Failure>, shared: &Arc<Shared>| go_on(shared, body, had);
        let (body, taken) = match within_member(self.shared, ("`update`", WAIT), body, take, goes_on) {
            Ok(returned) => returned,
            Err(Unreturned { body, failure }) => {
                let mut engine = self.shared.lock();
                let component = engine.slots[number as usize].name.to_string();
                if let Some(body) = body {
                    engine.return_unchanged(number, body, now);
                }
                self.shared.release(engine);
                return Err(ChangeError::NotNow { component, why: failure.message().to_owned() });
            }
        };
        self.updated.push(Updated { number, body: Some(body), before, after, properties });
        taken.map_err(|failure| {
            let spec = self.shared.look(|engine| Arc::clone(&engine.slots[number as usize].spec));
            let failure = Failure::new(with_library(&spec, failure));
            ChangeError::RefusesValues { component: spec.path.clone(), class: spec.class.name().to_owned(), failure }
        })
    }

    /// Takes the body of a component that runs out of the engine, once its code has returned. Another one does not
    /// start before the change is made.
    fn body_of(&mut self, number: u32) -> Result<Option<Box<Body>>, ChangeError> {
        let deadline = Instant::now() + WAIT;
        let mut engine = self.shared.lock();
        loop {
            let slot = &engine.slots[number as usize];
            if slot.state != SlotState::Active && slot.body.is_some() {
                self.hold(&mut engine, number);
                self.shared.release(engine);
                return Ok(None);
            }
            if slot.state == SlotState::Active
                && let Some(body) = engine.take(number)
            {
                self.shared.release(engine);
                return Ok(Some(body));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                let component = engine.slots[number as usize].name.to_string();
                self.shared.release(engine);
                return Err(ChangeError::NotNow { component, why: "its code has not returned yet".to_owned() });
            }
            engine = self.shared.wait_for_return(engine, left);
        }
    }

    /// Gives components the values that they had.
    pub(super) fn undo_updates(&mut self) {
        for Updated { number, body, before, .. } in std::mem::take(&mut self.updated).into_iter().rev() {
            let Some(body) = body else { continue };
            let (had, left) = (Arc::clone(&before), Arc::clone(&before));
            let take_back = move |body: &mut Body, shared: &Arc<Shared>| body.take_back(shared, had);
            let goes_on = move |body: Box<Body>, _: Result<(), Failure>, shared: &Arc<Shared>| {
                go_on(shared, body, left);
            };
            match within_member(self.shared, ("`update`", WAIT), body, take_back, goes_on) {
                Ok((body, result)) => settle(self.shared, body, result),
                Err(Unreturned { body: Some(body), .. }) => {
                    // It takes them back between two executions, as what operators set: nobody waits for that.
                    let mut engine = self.shared.lock();
                    engine.queue_take_back(number, before);
                    engine.return_unchanged(number, body, self.shared.clock.now());
                    self.shared.release(engine);
                }
                Err(Unreturned { body: None, failure }) => {
                    let mut engine = self.shared.lock();
                    let now = self.shared.clock.now();
                    let message = format!("does not take back the values that it had: {failure}");
                    engine.emit(now, number, Occurrence::Failed { message, restart: None });
                    self.shared.release(engine);
                }
            }
        }
    }
}

/// Lets a component go on with the values that it had, on the thread on which its code has returned.
fn go_on(shared: &Shared, mut body: Box<Body>, before: Arc<ComponentSpec>) {
    let result = body.take_back(shared, before);
    settle(shared, body, result);
}

/// Lets a component go on that has taken its values back, or refuses that.
fn settle(shared: &Shared, body: Box<Body>, result: Result<(), Failure>) {
    let (number, now) = (body.part.index, shared.clock.now());
    let mut engine = shared.lock();
    engine.note_taken_back(&body.part, result.err(), now);
    engine.return_unchanged(number, body, now);
    shared.release(engine);
}

impl Engine {
    /// Takes in that a component has its earlier values again, or refuses that.
    pub(in crate::schedule) fn note_taken_back(&mut self, part: &Part, refusal: Option<Failure>, now: u64) {
        if let Some(failure) = refusal {
            // It has told what it does, and its specification says so.
            self.slots[part.index as usize].spec = Arc::clone(&part.spec);
            let why = with_library(&part.spec, failure);
            let message = format!("does not take back the values that it had: {why}");
            self.emit(now, part.index, Occurrence::Failed { message, restart: None });
        }
    }
}

impl Body {
    /// Lets the component have the values of its earlier specification again.
    pub(in crate::schedule) fn take_back(
        &mut self,
        shared: &Shared,
        before: Arc<ComponentSpec>,
    ) -> Result<(), Failure> {
        if Arc::ptr_eq(&self.part.spec, &before) { Ok(()) } else { self.take_values(shared, before) }
    }

    /// Lets the component take the values of a specification. After an error it goes on with those that it has.
    pub(in crate::schedule) fn take_values(
        &mut self,
        shared: &Shared,
        changed: Arc<ComponentSpec>,
    ) -> Result<(), Failure> {
        match &mut self.instance {
            Some(instance) => {
                self.part.begin_update(&changed);
                let updated = contained(|| instance.update(&changed.values)).and_then(|updated| updated);
                self.part.end_step(shared, updated.as_ref().err());
                updated?;
            }
            None => return Err(Failure::new("it has just ended")),
        }
        self.part.spec = changed;
        if self.part.lasting.saves_at_once {
            self.part.lasting.touch();
            // What it cannot save now, it saves after the next execution, or fails then.
            let _ = self.save_for_later();
        }
        Ok(())
    }
}
