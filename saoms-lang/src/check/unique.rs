//! Values that must not occur twice in a fleet.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt;

use saoms_api::host::PropertyValue;
use saoms_api::host::declaration::{PropertyKind, Scalar, parse_scalar};
use smol_str::SmolStr;

use super::checked::Checked;
use super::classes::ClassIndex;
use super::fleet::{Fleet, Member};
use super::replicas::with_index;
use super::report::{Report, replacing};
use super::slots::Slot;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Property;
use crate::registry::PropertyDeclaration;
use crate::source::Location;
use crate::syntax::escaped;

/// The values of a component that others must not have, where each is, and which property has it.
fn uses<'u, 'r>(
    member: &'u Member<'_>,
    class: &'u ClassIndex<'r>,
    checked: Checked<'u>,
) -> impl Iterator<Item = (Canonical, Location, &'u Slot<'r>, &'r PropertyDeclaration)> {
    let slots = class.slots.unique.iter().filter(|_| !member.is_partial);
    slots.filter_map(move |&place| {
        let slot = &class.slots.all[place];
        let declaration = slot.main()?;
        let (value, place) = match checked.at(place) {
            Some(given) => (given.value, given.place),
            None => (class.slots.preset(&declaration.name)?, member.component.name.location),
        };
        Some((Canonical::of(value, slot)?, place, slot, declaration))
    })
}

/// Collects values that components must not share.
#[derive(Default)]
pub(super) struct Unique<'a> {
    /// The words that properties share.
    words: Vec<&'a str>,
    /// The first user of each value.
    seen: HashMap<Canonical, User>,
    /// Further users of values, which share neither the word nor that they are IDs of tasks with those before them.
    more: Vec<User>,
}

/// Who has a value.
#[derive(Clone, Copy)]
struct User {
    seen: Seen,
    /// The place of the word of the property; [`NONE`] for one without.
    word: u32,
    /// Whether it is the ID of a task.
    is_task: bool,
    /// The next user of the value among those in `more`, or [`NONE`].
    next: u32,
}

/// No word, no user: fleets are limited to fewer.
const NONE: u32 = u32::MAX;

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
        checked: Checked<'_>,
        report: &mut Report<'_>,
    ) {
        // Fleets are limited to fewer.
        let member = place as u32;
        for (value, place, slot, declaration) in uses(&fleet.members[place], class, checked) {
            let word = declaration.unique.as_deref().map_or(NONE, |word| self.word(word));
            let user = User { seen: Seen { member, place }, word, is_task: slot.is_task_id, next: NONE };
            self.use_value(value, user, declaration, fleet, report);
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

    fn use_value(
        &mut self,
        value: Canonical,
        user: User,
        declaration: &PropertyDeclaration,
        fleet: &Fleet<'_>,
        report: &mut Report<'_>,
    ) {
        let mut entry = match self.seen.entry(value) {
            Entry::Vacant(entry) => {
                entry.insert(user);
                return;
            }
            Entry::Occupied(entry) => entry,
        };
        let mut last = *entry.get();
        let (mut of_word, mut of_task, mut at) = (None, None, NONE);
        loop {
            let is_of_word = last.word == user.word && user.word != NONE;
            of_word = of_word.or(is_of_word.then_some(last));
            of_task = of_task.or((last.is_task && user.is_task).then_some(last));
            if last.next == NONE {
                break;
            }
            at = last.next;
            last = self.more[at as usize];
        }
        let value = entry.key().clone();
        let is_new_word = of_word.is_none() && user.word != NONE;
        let is_first_task = of_task.is_none() && user.is_task;
        if is_new_word || is_first_task {
            let next = self.more.len() as u32;
            match self.more.get_mut(at as usize) {
                Some(before) => before.next = next,
                None => entry.get_mut().next = next,
            }
            self.more.push(user);
        }
        if let Some(first) = of_word {
            self.shared(&value, &first, &user.seen, declaration, fleet, report);
        }
        if let Some(first) = of_task {
            task(&value, first, user, fleet, report);
        }
    }

    /// Tells of a value that a word forbids to share.
    fn shared(
        &self,
        value: &Canonical,
        first: &User,
        seen: &Seen,
        declaration: &PropertyDeclaration,
        fleet: &Fleet<'_>,
        report: &mut Report<'_>,
    ) {
        let (word, first) = (first.word, &first.seen);
        let [earlier, later] = [first, seen].map(|one| &fleet.members[one.member as usize]);
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
        let one = one.help(format!("every {} needs its own", self.words[word as usize]));
        let own = later.component.properties.iter().filter_map(Property::only_text);
        let is_own = own.clone().any(|text| text.location == seen.place);
        report.push(match first.place == seen.place {
            // Of replicas, whose expression is not different for each.
            true if later.instance.is_some() && is_own && report.has_expression_at(seen.place) => one.help(
                "what stands here comes to the same for several replicas: `${index}` is different for each",
            ),
            // Of replicas.
            true if later.instance.is_some() && is_own => {
                let meant = match value {
                    Canonical::Integer(_) => "${index}".to_owned(),
                    Canonical::Text(text) => with_index(text),
                };
                one.suggest(replacing(&value.to_string(), &meant), seen.place, escaped(&meant))
            }
            // In a composite that is there several times.
            true => one
                .help("both have it from here: let each get its own from outside, by a property or an index"),
            false => one.label(first.place, "the first"),
        });
    }
}

/// Tasks that share an ID run all the same, but people cannot tell them apart.
fn task(value: &Canonical, first: User, user: User, fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let is_told = user.word != NONE && user.word == first.word;
    let (first, seen) = (first.seen, user.seen);
    let [earlier, later] = [first, seen].map(|one| fleet.members[one.member as usize].path());
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

/// What is equal for equal values: `07` and `7` are one number.
#[derive(Clone, PartialEq, Eq, Hash)]
enum Canonical {
    Integer(i64),
    Text(SmolStr),
}

impl Canonical {
    fn of(value: &PropertyValue, slot: &Slot<'_>) -> Option<Self> {
        let (text, declaration) = (value.as_text()?, slot.main()?);
        if matches!(declaration.kind, PropertyKind::String | PropertyKind::Enumeration) {
            return Some(Self::Text(trimmed(text)));
        }
        if let Some(number) = slot.number(text) {
            return Some(Self::Integer(number.into()));
        }
        Some(match parse_scalar(declaration.kind, text)? {
            // Of larger ones there are few.
            Scalar::Integer(number) => match i64::try_from(number) {
                Ok(number) => Self::Integer(number),
                Err(_) => Self::Text(number.to_string().into()),
            },
            Scalar::Float(number) => Self::Text(number.to_string().into()),
            Scalar::Duration(duration) => Self::Text(saoms_api::host::format_duration(duration).into()),
            Scalar::Boolean(value) => Self::Text(value.to_string().into()),
            Scalar::Text(text) => Self::Text(text.into()),
        })
    }
}

/// A text without the blanks around it, of which most have none.
fn trimmed(text: &SmolStr) -> SmolStr {
    match text.as_bytes() {
        [first, .., last] if first.is_ascii_graphic() && last.is_ascii_graphic() => text.clone(),
        _ => text.trim().into(),
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
