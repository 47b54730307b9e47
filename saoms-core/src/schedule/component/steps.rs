//! The steps of a component whose tape is written: when they begin, what they begin with, and how they end.

use std::sync::Arc;

use saoms_api::host::{Invocation, PropertyValue, ServiceCall, SharedMessage, SmolStr};
use saoms_api::{CallError, Cause, Failure, Saved};
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::registry::PropertyDeclaration;

use super::body::{Body, Job};
use super::part::Part;
use crate::observe::Notification;
use crate::schedule::shared::Shared;
use crate::tape::{Act, ActKind, Heard, StepKind, Tape, TapedCall, answered, values_as_bytes, with_loop};

/// What stands in place of a secret.
const SECRET: &str = "$SAOMS_PASSWORD";

impl Part {
    /// Begins the tape of an instance, and the step of its start, if an observer wants it.
    pub(super) fn begin_tape(&mut self, shared: &Shared) {
        if self.tape.is_none() {
            let observers = shared.observers.of_tape(&self.name);
            if observers.is_empty() {
                return;
            }
            self.tape = Some(Box::new(Tape::new(observers)));
        }
        self.begin_step(StepKind::Start, Cause::default());
        let Part { spec, stored, index, tape: Some(tape), .. } = self else { return };
        let class = &spec.class;
        tape.note(Act::new(ActKind::Class, u64::from(*index), class.name()));
        let declared = &class.declaration().properties;
        tape.note(Act::new(ActKind::Values, 0, "").with(values_as_bytes(&without_secrets(&spec.values, declared))));
        for one in spec.loops.iter() {
            let values = without_secrets(&one.values, &one.class.declaration().properties);
            tape.note(Act::new(ActKind::Loop, 0, &one.name).with(with_loop(one.class.name(), &values)));
        }
        for (key, bytes) in stored.entries() {
            tape.note(Act::new(ActKind::Kept, *key, "").with(&**bytes));
        }
    }

    pub(super) fn begin_step(&mut self, kind: StepKind, cause: Cause) {
        let times = (self.now, self.due);
        if let Some(tape) = &mut self.tape {
            tape.begin(kind, times, self.execution, cause.0);
        }
    }

    /// Ends the step that is open, if one is, and hands it to the observers that want it.
    #[inline]
    pub(in crate::schedule) fn end_step(&mut self, shared: &Shared, failure: Option<&Failure>) {
        if self.tape.is_some() {
            self.hand_over_step(shared, failure);
        }
    }

    #[cold]
    fn hand_over_step(&mut self, shared: &Shared, failure: Option<&Failure>) {
        let Some(tape) = &mut self.tape else { return };
        if let Some(step) = tape.end(failure.map(|failure| failure.message().to_owned())) {
            let (component, observers) = (Arc::clone(&self.name), Arc::clone(&tape.observers));
            shared.events.put(Notification::Step(component, Box::new(step), observers));
        }
    }

    /// Notes that the present execution fails before the code of the component runs.
    #[cold]
    pub(super) fn note_fault(&mut self) {
        if let Some(tape) = &mut self.tape {
            tape.note(Act::new(ActKind::Fault, 0, ""));
        }
    }

    /// Notes that another instance takes the place of the present one, without a start of its own.
    pub(in crate::schedule) fn note_replacement(&mut self, shared: &Shared) {
        if self.tape.is_some() {
            self.begin_step(StepKind::Replaced, Cause::default());
            self.hand_over_step(shared, None);
        }
    }
}

impl Body {
    /// Begins the step of a job that runs code of the component with its context.
    #[cold]
    pub(super) fn begin_step_of(&mut self, job: Job) {
        let kind = match job {
            Job::Execute => StepKind::Execute,
            Job::React => StepKind::React,
            Job::Shutdown => StepKind::Shutdown,
            // A start begins its own, and an order is a call or takes values.
            Job::Start | Job::Ask | Job::Describe | Job::Sample | Job::Order | Job::Save => return,
        };
        self.part.begin_step(kind, Cause::default());
        let inboxes = if job == Job::React { &self.reactions } else { &self.inboxes };
        self.part.note_heard(inboxes);
    }

    /// Serves a call, and notes what is asked and answered.
    #[cold]
    pub(super) fn serve_taped(
        &mut self,
        shared: &Arc<Shared>,
        invocation: &mut Invocation<'_>,
        cause: Cause,
    ) -> Result<Result<(), CallError>, Failure> {
        let mut call = TapedCall::new(&mut *invocation.call);
        self.part.begin_step(StepKind::Serve, cause);
        self.part.note_heard(&self.inboxes);
        if let Some(tape) = &mut self.part.tape {
            let act = Act::new(ActKind::Service, u64::from(call.operation()), invocation.service);
            tape.note(act.with(call.arguments.as_slice()));
        }
        let mut taped = Invocation { service: invocation.service, call: &mut call };
        let result = self.call(shared, |instance, context| instance.serve(&mut taped, context));
        let reply = call.reply.take().unwrap_or_default();
        if let (Some(tape), Ok(served)) = (&mut self.part.tape, &result) {
            tape.note(answered(ActKind::Replied, &served.clone().map(|()| reply)));
        }
        self.part.end_step(shared, result.as_ref().err());
        result
    }
}

impl Part {
    /// Begins the step in which the component takes new values.
    pub(in crate::schedule) fn begin_update(&mut self, spec: &ComponentSpec) {
        if self.tape.is_none() {
            return;
        }
        self.begin_step(StepKind::Update, Cause::default());
        if let Some(tape) = &mut self.tape {
            let values = without_secrets(&spec.values, &spec.class.declaration().properties);
            tape.note(Act::new(ActKind::Values, 0, "").with(values_as_bytes(&values)));
        }
    }

    /// Notes the messages that the code of the component can read.
    fn note_heard(&mut self, inboxes: &[Vec<SharedMessage>]) {
        let Some(step) = self.tape.as_mut().and_then(|tape| tape.open()) else { return };
        for (place, inbox) in (0..).zip(inboxes) {
            step.heard.extend(inbox.iter().map(|message| Heard::of(place, message)));
        }
        for (place, departed) in (0..).zip(&self.departed) {
            step.heard.extend(departed.iter().map(|one| Heard::left(place, one)));
        }
    }
}

/// Notes the state from which an instance goes on.
pub(super) fn note_restored(tape: &mut Option<Box<Tape>>, saved: &Saved) {
    if let Some(tape) = tape {
        tape.note(Act::new(ActKind::Restored, 0, "").with(saved.bytes()));
    }
}

/// Values without those that nothing prints.
fn without_secrets(
    values: &[(SmolStr, PropertyValue)],
    declared: &[PropertyDeclaration],
) -> Vec<(SmolStr, PropertyValue)> {
    let shown = |(name, value): &(SmolStr, PropertyValue)| {
        let declared = declared.iter().find(|declared| declared.name == *name);
        let value = match (declared, value) {
            (Some(declared), _) if declared.secret => PropertyValue::from(SECRET),
            (Some(declared), PropertyValue::Complex(values)) => {
                PropertyValue::Complex(without_secrets(values, &declared.properties).into())
            }
            (Some(declared), PropertyValue::Many(values)) => {
                let shown = values.iter().map(|value| match value {
                    PropertyValue::Complex(values) => {
                        PropertyValue::Complex(without_secrets(values, &declared.properties).into())
                    }
                    value => value.clone(),
                });
                PropertyValue::Many(shown.collect())
            }
            _ => value.clone(),
        };
        (name.clone(), value)
    };
    values.iter().map(shown).collect()
}
