//! Values that must not occur twice in a fleet.

use std::collections::hash_map::Entry;
use std::fmt;

use saoms_api::PropertyValue;
use saoms_api::declaration::{PropertyKind, Scalar, parse_scalar};
use smol_str::SmolStr;

use super::classes::ClassIndex;
use super::fleet::Member;
use super::properties::Checked;
use super::replicas::with_index;
use super::report::{Report, replacing};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::hash::Map;
use crate::model::Property;
use crate::registry::PropertyDeclaration;
use crate::source::Location;

/// Collects values that components must not share.
#[derive(Default)]
pub(super) struct Unique<'a> {
    /// The first user of a value, by the word that the properties share.
    seen: Map<(&'a str, Canonical), Seen<'a>>,
    /// The first task of an ID.
    tasks: Map<Canonical, Seen<'a>>,
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
        for &place in &class.slots.unique {
            let slot = &class.slots.all[place];
            let Some(declaration) = slot.main() else { continue };
            let word = declaration.unique.as_deref();
            let (value, place) = match checked.at(place) {
                Some(given) => (Some(&given.value), given.place),
                None => (class.slots.preset(&declaration.name), member.component.name.location),
            };
            let Some(value) = value.and_then(|value| Canonical::of(value, declaration)) else { continue };
            let seen = Seen { component, place, is_declared: word };
            if let Some(word) = word {
                self.declared(word, value.clone(), seen, declaration, member, report);
            }
            if slot.is_task_id() {
                self.task(value, seen, report);
            }
        }
    }

    fn declared(
        &mut self,
        word: &'a str,
        value: Canonical,
        seen: Seen<'a>,
        declaration: &PropertyDeclaration,
        member: &Member<'_>,
        report: &mut Report<'_>,
    ) {
        let entry = match self.seen.entry((word, value)) {
            Entry::Occupied(entry) => entry,
            Entry::Vacant(entry) => {
                entry.insert(seen);
                return;
            }
        };
        let ((_, value), first) = (entry.key(), entry.get());
        // That there are two components of one name is told.
        if first.component == seen.component {
            return;
        }
        let message = format!(
            "components {} and {} have the same {} {}",
            quoted(first.component),
            quoted(seen.component),
            quoted(&declaration.name),
            quoted(&value.to_string())
        );
        let one = Diagnostic::new(&codes::NOT_UNIQUE, seen.place, message);
        let one = one.help(format!("every {word} needs its own"));
        let own = member.component.properties.iter().filter_map(Property::only_text);
        let is_own = own.clone().any(|text| text.location == seen.place);
        report.push(match first.place == seen.place {
            // Of replicas.
            true if member.instance.is_some() && is_own => {
                let meant = match value {
                    Canonical::Integer(_) => "${index}".to_owned(),
                    Canonical::Text(text) => with_index(text),
                };
                one.suggest(replacing(&value.to_string(), &meant), seen.place, meant)
            }
            // In a composite that is there several times.
            true => one
                .help("both have it from here: let each get its own from outside, by a property or an index"),
            false => one.label(first.place, "the first"),
        });
    }

    /// Tasks that share an ID run all the same, but people cannot tell them apart.
    fn task(&mut self, value: Canonical, seen: Seen<'a>, report: &mut Report<'_>) {
        let entry = match self.tasks.entry(value) {
            Entry::Occupied(entry) => entry,
            Entry::Vacant(entry) => {
                entry.insert(seen);
                return;
            }
        };
        let (value, first) = (entry.key(), entry.get());
        let is_told = seen.is_declared.is_some() && seen.is_declared == first.is_declared;
        if is_told || first.component == seen.component {
            return;
        }
        let message = format!(
            "components {} and {} share the ID {}",
            quoted(first.component),
            quoted(seen.component),
            quoted(&value.to_string())
        );
        report.push(
            Diagnostic::new(&codes::TASK_ID_SHARED, seen.place, message)
                .label(first.place, "the first")
                .help("messages and reports name tasks by their ID"),
        );
    }
}

/// What is equal for equal values: `07` and `7` are one number.
#[derive(Clone, PartialEq, Eq, Hash)]
enum Canonical {
    Integer(i128),
    Text(SmolStr),
}

impl Canonical {
    fn of(value: &PropertyValue, declaration: &PropertyDeclaration) -> Option<Self> {
        let PropertyValue::Text(text) = value else { return None };
        if matches!(declaration.kind, PropertyKind::String | PropertyKind::Enumeration) {
            return Some(Self::Text(text.trim().into()));
        }
        Some(match parse_scalar(declaration.kind, text)? {
            Scalar::Integer(number) => Self::Integer(number),
            Scalar::Float(number) => Self::Text(number.to_string().into()),
            Scalar::Duration(duration) => Self::Text(saoms_api::format_duration(duration).into()),
            Scalar::Boolean(value) => Self::Text(value.to_string().into()),
            Scalar::Text(text) => Self::Text(text.into()),
        })
    }
}

impl fmt::Display for Canonical {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(number) => number.fmt(out),
            Self::Text(text) => text.fmt(out),
        }
    }
}
