//! The properties of components that are written as others are: which properties of their class they are was found out for the first of them,
//! and a value that is as in the one before needs no look.

use std::sync::Arc;

use saoms_api::PropertyValue;
use smol_str::SmolStr;

use super::checked::Checks;
use super::fleet::Member;
use super::slots::{Slot, Slots};
use crate::hash::Map;
use crate::model::{Pair, Pattern, Placed};
use crate::source::Location;
use crate::xml::is_plain;

/// What was found out about patterns of properties of components of classes.
#[derive(Default)]
pub(super) struct Patterns {
    known: Vec<Known>,
    by_place: Map<(*const Pattern, *const ()), usize>,
    /// That of the component before, which this one mostly has as well.
    last: usize,
}

/// A pattern together with a class.
struct Known {
    of: (*const Pattern, *const ()),
    /// The place of each of its properties in the class, with the value that it had last. `None` where the properties are to be looked at one by one.
    properties: Option<Vec<Last>>,
}

/// A property with the value that it had last.
struct Last {
    /// Its place in the class.
    slot: usize,
    text: SmolStr,
    /// Whether that is how it is written, so that what is written so again is the same.
    is_as_written: bool,
}

impl Patterns {
    /// Adds what the properties of a component come to. `false`, with nothing added, where they need a closer look.
    pub(super) fn take(&mut self, member: &Member<'_>, slots: &Slots<'_>, checks: &mut Checks) -> bool {
        let properties = &member.component.properties;
        let Some(placed) = properties.as_placed().filter(|_| member.is_usual && !member.is_partial) else {
            return false;
        };
        let Some(known) = &mut self.known(placed, slots).properties else { return false };
        let mut open = checks.start(properties.len());
        for (written, last) in placed.pattern().properties().iter().zip(known) {
            let slot = &slots.all[last.slot];
            let Some(location) = last.take(slot, placed, written) else {
                open.cancel();
                return false;
            };
            open.add((last.slot, slot), PropertyValue::Text(last.text.clone()), location, None);
        }
        open.finish(true, Vec::new());
        true
    }

    fn known(&mut self, placed: &Placed, slots: &Slots<'_>) -> &mut Known {
        let pattern = placed.pattern();
        // Both stay where they are for as long as components are checked.
        let of = (Arc::as_ptr(pattern), std::ptr::from_ref(slots).cast::<()>());
        if self.known.get(self.last).is_none_or(|known| known.of != of) {
            self.last = *self.by_place.entry(of).or_insert_with(|| {
                self.known.push(Known { of, properties: regular(pattern, slots) });
                self.known.len() - 1
            });
        }
        &mut self.known[self.last]
    }
}

/// The places in a class of properties that take a text each, where all that have to be given are.
fn regular(pattern: &Pattern, slots: &Slots<'_>) -> Option<Vec<Last>> {
    let place = |one: &Pair| slots.place(&one.name).filter(|place| slots.all[*place].takes_text);
    let places: Vec<usize> = pattern.properties().iter().map(place).collect::<Option<_>>()?;
    let has_preset =
        |place: usize| slots.all[place].main().is_some_and(|main| slots.preset(&main.name).is_some());
    let is_whole = slots.required.iter().all(|place| places.contains(place) || has_preset(*place));
    let is_regular = is_whole && pattern.has_distinct_names();
    is_regular.then(|| {
        places.into_iter().map(|slot| Last { slot, text: SmolStr::default(), is_as_written: false }).collect()
    })
}

impl Last {
    /// Takes the value of a component; gives its place. `None` where it is not what the class allows, or cannot be told yet.
    // It is kept here, and copied from here: a text that is moved on and on takes longer than all else about it.
    #[inline]
    fn take(&mut self, slot: &Slot<'_>, placed: &Placed, written: &Pair) -> Option<Location> {
        let is_allowed =
            |text: &str| slot.is_plain(text) || slot.declarations().all(|one| one.allows(text).is_ok());
        if let Some((raw, location)) = placed.raw(written) {
            if self.is_as_written && self.text == raw {
                return Some(location);
            }
            if !raw.is_empty() && is_plain(raw.as_bytes()) {
                self.is_as_written = is_allowed(raw);
                if !self.is_as_written {
                    return None;
                }
                self.text = SmolStr::new(raw);
                return Some(location);
            }
        }
        let text = placed.text(written).filter(|text| is_allowed(text))?;
        (self.text, self.is_as_written) = (text.value, false);
        Some(text.location)
    }
}
