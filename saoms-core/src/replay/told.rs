//! Differences between what a component did and what it does, as people read them.

use std::collections::BTreeMap;

use saoms_api::{Failure, Time};
use saoms_lang::OperationSchema;
use saoms_lang::registry::{InterfaceDeclaration, ReferenceDeclaration};
use saoms_lang::schema::Schema;

use super::host::ReplayHost;
use crate::tape::{Act, ActKind, Step, StepKind, answer_of};

/// A step in which a component does something else than then.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The time of the run.
    pub time: Time,
    /// The number of the execution of its instance.
    pub execution: u64,
    /// What was called.
    pub kind: StepKind,
    /// What it did in the step, in order: what is the same, and where it is not, what it did then before what it does
    /// now.
    pub lines: Vec<(Side, String)>,
}

/// When something was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Then and now.
    Both,
    /// Only then.
    Then,
    /// Only now.
    Now,
}

/// The interfaces of references, by their names.
#[derive(Default)]
pub(super) struct Interfaces(BTreeMap<String, InterfaceDeclaration>);

impl Interfaces {
    pub(super) fn of<'a>(references: impl Iterator<Item = &'a ReferenceDeclaration>) -> Interfaces {
        Interfaces(references.map(|one| (one.name.clone(), one.interface.clone())).collect())
    }

    /// A call through a reference.
    fn call(&self, reference: &str, act: &Act) -> String {
        let number = u32::try_from(act.other).unwrap_or(u32::MAX);
        let operation = self.0.get(reference).and_then(|interface| OperationSchema::numbered(interface, number));
        match operation {
            Some(Ok(operation)) => {
                let arguments = operation.decode_arguments(&act.bytes).map(|arguments| arguments.to_string());
                let arguments = arguments.unwrap_or_else(|_| bytes(&act.bytes));
                format!("calls {reference}.{} {arguments}", operation.name)
            }
            _ => format!("calls operation {number} of {reference} with {}", bytes(&act.bytes)),
        }
    }
}

impl ReplayHost {
    /// How what was done in the step differs from what the step has, if it does.
    pub(super) fn difference(&self, step: &Step, failure: Option<&Failure>) -> Option<Difference> {
        let then: Vec<&Act> = step.acts.iter().filter(|act| act.what.is_deed()).collect();
        let now: Vec<&Act> = self.deeds.iter().collect();
        let failed = failure.map(Failure::message);
        let is_same = then.len() == now.len() && then.iter().zip(&now).all(|(then, now)| then.is_same(now));
        if is_same && step.failure.as_deref() == failed {
            return None;
        }
        let same = |(then, now): &(&&Act, &&Act)| then.is_same(now);
        let before = then.iter().zip(&now).take_while(same).count();
        let rest = then.len().min(now.len()) - before;
        let after = then.iter().rev().zip(now.iter().rev()).take(rest).take_while(same).count();
        let mut lines = Vec::new();
        lines.extend(then[..before].iter().map(|act| (Side::Both, self.text(act, Side::Both))));
        lines.extend(then[before..then.len() - after].iter().map(|act| (Side::Then, self.text(act, Side::Then))));
        lines.extend(now[before..now.len() - after].iter().map(|act| (Side::Now, self.text(act, Side::Now))));
        lines.extend(then[then.len() - after..].iter().map(|act| (Side::Both, self.text(act, Side::Both))));
        match (step.failure.as_deref(), failed) {
            (Some(then), Some(now)) if then == now => lines.push((Side::Both, format!("fails: {then}"))),
            (then, now) => {
                lines.extend(then.map(|text| (Side::Then, format!("fails: {text}"))));
                lines.extend(now.map(|text| (Side::Now, format!("fails: {text}"))));
            }
        }
        Some(Difference { time: Time::from_nanos(step.time), execution: step.execution, kind: step.kind, lines })
    }

    /// What a deed is, in one line.
    fn text(&self, act: &Act, side: Side) -> String {
        let (name, text) = (&act.name, act.text());
        let by = if name.is_empty() { String::new() } else { format!("{name} ") };
        match act.what {
            ActKind::Symptom => format!("{by}symptom: {text}"),
            ActKind::Decision => format!("{by}decision: {text}"),
            ActKind::Effect | ActKind::Changed => format!("{by}effect: {text}"),
            ActKind::Sent => format!("sends {name} {}", self.message(act, side)),
            ActKind::Called => {
                let (place, target) = (act.number as u32 & 0xffff, act.number >> 16);
                let reference = self.references.get(&place).map_or("(unknown)", |(name, _)| name);
                let call = self.interfaces.call(reference, act);
                if target == 0 { call } else { format!("{call} (target {target})") }
            }
            ActKind::Replied => match answer_of(act) {
                Ok(reply) => format!("answers {}", bytes(reply)),
                Err(error) => format!("answers that it fails: {error}"),
            },
            ActKind::Raised => format!("raises {name}"),
            ActKind::Keeps => format!("keeps under {} {}", act.number, bytes(&act.bytes)),
            ActKind::Region if text.is_empty() => format!("reads all of subscription {}", act.number),
            ActKind::Region => format!("reads of subscription {} what is in {text}", act.number),
            ActKind::Alert if act.number == 0 => format!("alert {name} is over"),
            ActKind::Alert => format!("alert {name}: {text}"),
            ActKind::Reported => format!("reports {name} = {text}"),
            ActKind::Counted => format!("counts {name} + {text}"),
            ActKind::Voted => format!("votes that the work is {name}"),
            _ => format!("{:?} {name} {text}", act.what),
        }
    }

    /// The message that was sent, as JSON.
    fn message(&self, act: &Act, side: Side) -> String {
        let now = || self.publishers.iter().find(|(topic, _)| *topic == act.name);
        let known = match side {
            Side::Now => now(),
            Side::Both | Side::Then => self.publishers_then.values().find(|(topic, _)| *topic == act.name).or_else(now),
        };
        let schema = known.and_then(|(_, schema)| Schema::parse(schema).ok());
        let message = schema.and_then(|schema| schema.decode(&act.bytes).ok());
        message.map_or_else(|| bytes(&act.bytes), |message| message.to_string())
    }
}

/// Bytes that nobody can read otherwise.
fn bytes(bytes: &[u8]) -> String {
    let shown: String = bytes.iter().take(32).map(|byte| format!("{byte:02x}")).collect();
    let more = if bytes.len() > 32 { "..." } else { "" };
    format!("{} bytes {shown}{more}", bytes.len())
}
