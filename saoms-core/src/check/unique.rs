//! Values that must not occur twice in a fleet.

use std::collections::hash_map::Entry;
use std::fmt;

use saoms_api::PropertyValue;
use saoms_api::declaration::{PropertyKind, Scalar, parse_scalar};
use smol_str::SmolStr;

use super::classes::ClassIndex;
use super::fleet::Fleet;
use super::properties::Checked;
use super::replicas::with_index;
use super::report::{Report, replacing};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::hash::Map;
use crate::model::Property;
use crate::registry::PropertyDeclaration;
use crate::source::Location;

/// Collects values that components must not share. A large fleet has many, so that what is kept of each is small.
#[derive(Default)]
pub(super) struct Unique<'a> {
    /// The words that properties share.
    words: Vec<&'a str>,
    /// The first user of a value, by the place of the word.
    seen: Map<(u32, Canonical), Seen>,
    /// The first task of an ID, with the place of the word by which that is unique.
    tasks: Map<Canonical, (Seen, Option<u32>)>,
}

#[derive(Clone, Copy)]
struct Seen {
    /// The place of the component.
    member: u32,
    place: Location,
}

impl<'a> Unique<'a> {
    /// Adds what a component gives, or what its class presets.
    pub(super) fn add(
        &mut self,
        (place, fleet): (usize, &Fleet<'_>),
        class: &ClassIndex<'a>,
        checked: &Checked,
        report: &mut Report<'_>,
    ) {
        let own = &fleet.members[place];
        if own.is_partial {
            return;
        }
        // Fleets are limited to fewer.
        let member = place as u32;
        for &place in &class.slots.unique {
            let slot = &class.slots.all[place];
            let Some(declaration) = slot.main() else { continue };
            let (value, place) = match checked.at(place) {
                Some(given) => (Some(&given.value), given.place),
                None => (class.slots.preset(&declaration.name), own.component.name.location),
            };
            let Some(value) = value.and_then(|value| Canonical::of(value, declaration)) else { continue };
            let seen = Seen { member, place };
            let word = declaration.unique.as_deref().map(|word| self.word(word));
            if let Some(word) = word {
                self.declared((word, value.clone()), seen, declaration, fleet, report);
            }
            if slot.is_task_id() {
                self.task(value, (seen, word), fleet, report);
            }
        }
    }

    /// The place of a word; few are used.
    fn word(&mut self, word: &'a str) -> u32 {
        let known = self.words.iter().position(|known| *known == word);
        known.unwrap_or_else(|| {
            self.words.push(word);
            self.words.len() - 1
        }) as u32
    }

    fn declared(
        &mut self,
        key: (u32, Canonical),
        seen: Seen,
        declaration: &PropertyDeclaration,
        fleet: &Fleet<'_>,
        report: &mut Report<'_>,
    ) {
        let entry = match self.seen.entry(key) {
            Entry::Occupied(entry) => entry,
            Entry::Vacant(entry) => {
                entry.insert(seen);
                return;
            }
        };
        let ((word, value), first) = (entry.key(), entry.get());
        let [earlier, later] = [first, &seen].map(|one| &fleet.members[one.member as usize]);
        // That there are two components of one name is told.
        if earlier.path() == later.path() {
            return;
        }
        let message = format!(
            "components {} and {} have the same {} {}",
            quoted(earlier.path()),
            quoted(later.path()),
            quoted(&declaration.name),
            quoted(&value.to_string())
        );
        let one = Diagnostic::new(&codes::NOT_UNIQUE, seen.place, message);
        let one = one.help(format!("every {} needs its own", self.words[*word as usize]));
        let own = later.component.properties.iter().filter_map(Property::only_text);
        let is_own = own.clone().any(|text| text.location == seen.place);
        report.push(match first.place == seen.place {
            // Of replicas.
            true if later.instance.is_some() && is_own => {
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
    fn task(
        &mut self,
        value: Canonical,
        (seen, word): (Seen, Option<u32>),
        fleet: &Fleet<'_>,
        report: &mut Report<'_>,
    ) {
        let entry = match self.tasks.entry(value) {
            Entry::Occupied(entry) => entry,
            Entry::Vacant(entry) => {
                entry.insert((seen, word));
                return;
            }
        };
        let (value, (first, first_word)) = (entry.key(), entry.get());
        let is_told = word.is_some() && word == *first_word;
        let [earlier, later] = [first, &seen].map(|one| fleet.members[one.member as usize].path());
        if is_told || earlier == later {
            return;
        }
        let message = format!(
            "components {} and {} share the ID {}",
            quoted(earlier),
            quoted(later),
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
    Integer(i64),
    Text(SmolStr),
}

impl Canonical {
    fn of(value: &PropertyValue, declaration: &PropertyDeclaration) -> Option<Self> {
        let PropertyValue::Text(text) = value else { return None };
        if matches!(declaration.kind, PropertyKind::String | PropertyKind::Enumeration) {
            return Some(Self::Text(text.trim().into()));
        }
        Some(match parse_scalar(declaration.kind, text)? {
            // Of larger ones there are few.
            Scalar::Integer(number) => match i64::try_from(number) {
                Ok(number) => Self::Integer(number),
                Err(_) => Self::Text(number.to_string().into()),
            },
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
