//! What the properties of a component come to.

use saoms_api::PropertyValue;
use smol_str::SmolStr;

use super::slots::{Slot, Slots};
use crate::source::{Location, Text};

/// What a component gives for one property of its class.
#[derive(Clone, Copy)]
pub(super) struct Given<'c> {
    pub(super) value: &'c PropertyValue,
    /// Where the value is, to point at.
    pub(super) place: Location,
    elsewhere: Option<&'c Elsewhere>,
}

/// What is to be said of a value that is not one text in the property itself, as most are.
pub(super) struct Elsewhere {
    /// The name of the property.
    pub(super) name: SmolStr,
    /// Where its values are.
    pub(super) places: Vec<Location>,
    /// The `source` that leads there.
    pub(super) source: Option<Location>,
}

impl Given<'_> {
    /// Where its values are.
    pub(super) fn places(&self) -> impl Iterator<Item = Location> {
        let more = self.elsewhere.and_then(|elsewhere| elsewhere.places.get(1..)).unwrap_or_default();
        std::iter::once(self.place).chain(more.iter().copied())
    }

    /// The value as a text with its place; `None` when it is not one text.
    pub(super) fn text(&self) -> Option<Text> {
        Some(Text::new(self.value.as_text()?.clone(), self.place))
    }
}

/// What all properties of a component come to.
#[derive(Default)]
pub(super) struct Checked {
    /// The names and values of the class's own properties in its order, as constructors take them.
    values: Vec<(SmolStr, PropertyValue)>,
    /// All that is given, in the order in which it is written: as a rule little.
    given: Vec<Entry>,
    /// Whether there was no fault, so that the component can be constructed.
    pub(super) is_sound: bool,
    /// The places of the properties whose values cannot be known for such faults.
    pub(super) unsure: Vec<usize>,
}

/// A property that has a value.
struct Entry {
    /// The place of the property in its class.
    slot: u32,
    place: Location,
    value: Held,
    elsewhere: Option<Box<Elsewhere>>,
}

/// Where a value is kept.
enum Held {
    /// Here: that of a property of tasks alone, which constructors do not take.
    Here(PropertyValue),
    /// At this place among the class's own.
    Own(u32),
}

impl Checked {
    /// With room for so many values.
    pub(super) fn with_capacity(count: usize) -> Self {
        Self { values: Vec::with_capacity(count), given: Vec::with_capacity(count), ..Self::default() }
    }

    /// Adds the value of the property of this place, which has none yet.
    #[inline]
    pub(super) fn add(
        &mut self,
        (place, slot): (usize, &Slot<'_>),
        value: PropertyValue,
        at: Location,
        elsewhere: Option<Box<Elsewhere>>,
    ) {
        let value = match slot.own {
            None => Held::Here(value),
            Some(_) => {
                let behind = self.make_place(place);
                let pair = (slot.name.clone(), value);
                match behind == self.values.len() {
                    true => self.values.push(pair),
                    false => self.values.insert(behind, pair),
                }
                Held::Own(behind as u32)
            }
        };
        // Classes have fewer properties.
        self.given.push(Entry { slot: place as u32, place: at, value, elsewhere });
    }

    /// Where the value of an own property belongs; those that belong behind it move on. Most are written in the order of the class.
    fn make_place(&mut self, slot: usize) -> usize {
        let is_before = |entry: &&Entry| matches!(entry.value, Held::Own(_)) && (entry.slot as usize) < slot;
        let at = self.given.iter().filter(is_before).count();
        if at < self.values.len() {
            for entry in &mut self.given {
                match &mut entry.value {
                    Held::Own(own) if *own as usize >= at => *own += 1,
                    _ => {}
                }
            }
        }
        at
    }

    /// What is given for the property of this name.
    pub(super) fn get(&self, slots: &Slots<'_>, name: &str) -> Option<Given<'_>> {
        self.at(slots.place(name)?)
    }

    /// What is given for the property of this place.
    pub(super) fn at(&self, slot: usize) -> Option<Given<'_>> {
        let entry = self.given.iter().find(|entry| entry.slot as usize == slot)?;
        let Entry { place, elsewhere, .. } = entry;
        Some(Given { value: self.value(entry), place: *place, elsewhere: elsewhere.as_deref() })
    }

    fn value<'c>(&'c self, entry: &'c Entry) -> &'c PropertyValue {
        match &entry.value {
            Held::Here(value) => value,
            Held::Own(own) => &self.values[*own as usize].1,
        }
    }

    /// What is given for properties of tasks, with the places of these.
    pub(super) fn of_task(&self, slots: &Slots<'_>) -> impl Iterator<Item = (usize, &PropertyValue)> {
        let given = self.given.iter().filter(|entry| slots.all[entry.slot as usize].task.is_some());
        given.map(|entry| (entry.slot as usize, self.value(entry)))
    }

    /// The values of own properties, and what is to be said of those of them that stand elsewhere.
    pub(super) fn into_values(self) -> (Vec<(SmolStr, PropertyValue)>, Vec<Elsewhere>) {
        let own = self.given.into_iter().filter(|entry| matches!(entry.value, Held::Own(_)));
        let elsewhere = own.filter_map(|entry| entry.elsewhere);
        (self.values, elsewhere.map(|one| *one).collect())
    }
}
