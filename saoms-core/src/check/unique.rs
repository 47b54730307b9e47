//! Values that must not occur twice in a fleet.

use std::collections::HashMap;

use saoms_api::PropertyValue;
use saoms_api::declaration::{PropertyKind, Scalar, parse_scalar};

use super::classes::ClassIndex;
use super::fleet::Member;
use super::properties::Checked;
use super::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::registry::PropertyDeclaration;
use crate::source::Location;

/// The task property that people know a task by.
const ID: &str = "ID";

/// Collects values that components must not share.
#[derive(Default)]
pub(super) struct Unique<'a> {
    /// The first user of a value, by the word that the properties share.
    seen: HashMap<(&'a str, String), Seen<'a>>,
    /// The first task of an ID.
    tasks: HashMap<String, Seen<'a>>,
}

#[derive(Clone, Copy)]
struct Seen<'a> {
    component: &'a str,
    place: Location,
    /// Whether it is unique by the class's own word.
    is_declared: Option<&'a str>,
}

impl<'a> Unique<'a> {
    /// Adds what a component gives, or what its class presets.
    pub(super) fn add(
        &mut self,
        member: &'a Member<'_>,
        class: &ClassIndex<'a>,
        checked: &Checked,
        report: &mut Report<'_>,
    ) {
        if member.is_partial {
            return;
        }
        let component = member.path();
        for (slot, given) in class.slots.all.iter().zip(&checked.given) {
            let Some(declaration) = slot.main() else { continue };
            let word = declaration.unique.as_deref();
            let is_task_id = slot.task.is_some_and(|task| task.name == ID);
            if word.is_none() && !is_task_id {
                continue;
            }
            let (value, place) = match given {
                Some(given) => (Some(&given.value), given.place),
                None => (class.slots.preset(&declaration.name), member.component.name.location),
            };
            let Some(value) = value.and_then(|value| canonical(value, declaration)) else { continue };
            let seen = Seen { component, place, is_declared: word };
            if let Some(word) = word {
                self.declared(word, &value, seen, declaration, report);
            }
            if is_task_id {
                self.task(value, seen, report);
            }
        }
    }

    fn declared(
        &mut self,
        word: &'a str,
        value: &str,
        seen: Seen<'a>,
        declaration: &PropertyDeclaration,
        report: &mut Report<'_>,
    ) {
        let Some(first) = self.seen.get(&(word, value.to_owned())) else {
            self.seen.insert((word, value.to_owned()), seen);
            return;
        };
        let message = format!(
            "components {} and {} have the same {} {}",
            quoted(first.component),
            quoted(seen.component),
            quoted(&declaration.name),
            quoted(value)
        );
        report.push(
            Diagnostic::new(&codes::NOT_UNIQUE, seen.place, message)
                .label(first.place, "the first")
                .help(format!("every {word} needs its own")),
        );
    }

    /// Tasks that share an ID run all the same, but people cannot tell them apart.
    fn task(&mut self, value: String, seen: Seen<'a>, report: &mut Report<'_>) {
        let Some(first) = self.tasks.get(&value) else {
            self.tasks.insert(value, seen);
            return;
        };
        if seen.is_declared.is_some() && seen.is_declared == first.is_declared {
            return;
        }
        let message = format!(
            "components {} and {} share the ID {}",
            quoted(first.component),
            quoted(seen.component),
            quoted(&value)
        );
        report.push(
            Diagnostic::new(&codes::TASK_ID_SHARED, seen.place, message)
                .label(first.place, "the first")
                .help("messages and reports name tasks by their ID"),
        );
    }
}

/// A text that is equal for equal values: `07` and `7` are one number.
fn canonical(value: &PropertyValue, declaration: &PropertyDeclaration) -> Option<String> {
    let PropertyValue::Text(text) = value else { return None };
    Some(match parse_scalar(declaration.kind, text)? {
        Scalar::Integer(number) if declaration.kind == PropertyKind::Integer => number.to_string(),
        Scalar::Float(number) => number.to_string(),
        Scalar::Duration(duration) => saoms_api::format_duration(duration),
        Scalar::Boolean(value) => value.to_string(),
        _ => text.trim().to_owned(),
    })
}
