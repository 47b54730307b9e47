//! What the properties of a component come to.

use saoms_api::host::PropertyValue;
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
#[derive(Clone, Copy)]
pub(super) struct Checked<'c> {
    values: &'c [(SmolStr, PropertyValue)],
    of_tasks: &'c [PropertyValue],
    given: &'c [Entry],
    /// The place of the first of these among those of all components.
    first: u32,
    elsewhere: &'c [(u32, Option<Elsewhere>)],
    /// Whether there was no fault, so that the component can be constructed.
    pub(super) is_sound: bool,
}

impl<'c> Checked<'c> {
    /// What is given for the property of this name.
    pub(super) fn get(&self, slots: &Slots<'_>, name: &str) -> Option<Given<'c>> {
        self.at(slots.place(name)?)
    }

    /// What is given for the property of this place.
    pub(super) fn at(&self, slot: usize) -> Option<Given<'c>> {
        let (place, entry) = (self.first..).zip(self.given).find(|(_, entry)| entry.slot as usize == slot)?;
        let elsewhere = elsewhere(self.elsewhere, place).and_then(|at| self.elsewhere[at].1.as_ref());
        Some(Given { value: self.value(entry), place: entry.place, elsewhere })
    }

    fn value(&self, entry: &'c Entry) -> &'c PropertyValue {
        match entry.value {
            Held::Own(own) => &self.values[own as usize].1,
            Held::OfTask(place) => &self.of_tasks[place as usize],
        }
    }

    /// What is given for properties of tasks, with the places of these.
    pub(super) fn of_task<'s>(
        self,
        slots: &'s Slots<'s>,
    ) -> impl Iterator<Item = (usize, &'c PropertyValue)> + use<'c, 's> {
        let given = self.given.iter().filter(|entry| slots.all[entry.slot as usize].task.is_some());
        given.map(move |entry| (entry.slot as usize, self.value(entry)))
    }
}

/// What is said of the value of this place among those of all components, if anything: of few there is.
#[inline]
fn elsewhere(all: &[(u32, Option<Elsewhere>)], place: u32) -> Option<usize> {
    if all.is_empty() {
        return None;
    }
    all.binary_search_by_key(&place, |(of, _)| *of).ok()
}

/// A property that has a value.
struct Entry {
    place: Location,
    /// The place of the property in its class.
    slot: u32,
    value: Held,
}

/// Where a value is kept.
enum Held {
    /// At this place among those of the class's own properties.
    Own(u32),
    /// At this place among those of properties that tasks alone have, which constructors do not take.
    OfTask(u32),
}

/// What the properties of many components come to: in long lists, as a large fleet has many components of few properties.
#[derive(Default)]
pub(super) struct Checks {
    /// For each component its place in `all`; [`NONE`] for one without a class.
    pub(super) of: Vec<u32>,
    all: Vec<One>,
    /// What is given by all of them, in the order in which it is written.
    given: Vec<Entry>,
    /// What is to be said of few of these values, by their places there.
    elsewhere: Vec<(u32, Option<Elsewhere>)>,
    /// By the places of few of `all`, the places of the properties whose values cannot be known for faults.
    unsure: Vec<(u32, Vec<usize>)>,
    /// The values that all of them give for properties of tasks alone.
    of_tasks: Vec<PropertyValue>,
    /// How many values the component before gives, and how many of own properties: most have as many.
    before: (usize, usize),
}

/// No place: fleets are limited to fewer components.
const NONE: u32 = u32::MAX;

struct One {
    /// The names and values of the class's own properties in its order, as constructors take them.
    values: Vec<(SmolStr, PropertyValue)>,
    /// Where what it gives starts, and where it ends.
    given: (u32, u32),
    is_sound: bool,
}

/// What is kept of [`Checked`] when all about it is looked at.
#[derive(Default)]
pub(super) struct Kept {
    /// Those of own properties.
    pub(super) values: Vec<(SmolStr, PropertyValue)>,
    /// What is to be said of those of them that stand elsewhere.
    pub(super) elsewhere: Vec<Elsewhere>,
    /// The places of the properties whose values cannot be known for faults.
    pub(super) unsure: Vec<usize>,
}

impl Checks {
    /// With room for so many components, and for those of them that have a class, with what these give at most.
    pub(super) fn with_capacity(count: usize, with_class: usize, given: usize) -> Self {
        Self {
            of: Vec::with_capacity(count),
            all: Vec::with_capacity(with_class),
            given: Vec::with_capacity(given),
            elsewhere: Vec::new(),
            unsure: Vec::new(),
            of_tasks: Vec::with_capacity(with_class),
            before: (0, 0),
        }
    }

    /// What the component at this place gives; `None` for one without a class.
    pub(super) fn get(&self, place: usize) -> Option<Checked<'_>> {
        let One { values, given: (start, end), is_sound } = self.all.get(self.of[place] as usize)?;
        let given = &self.given[*start as usize..*end as usize];
        let (of_tasks, elsewhere) = (&self.of_tasks[..], &self.elsewhere[..]);
        Some(Checked { values, of_tasks, given, first: *start, elsewhere, is_sound: *is_sound })
    }

    /// Takes what the component at this place gives.
    pub(super) fn take(&mut self, place: usize) -> Option<Kept> {
        let of = self.of[place];
        let One { values, given: (start, end), .. } = self.all.get_mut(of as usize)?;
        let values = std::mem::take(values);
        let first = self.elsewhere.partition_point(|(of, _)| of < start);
        let own = self.elsewhere[first..].iter_mut().take_while(|(of, _)| of < end);
        let own = own.filter(|(of, _)| matches!(self.given[*of as usize].value, Held::Own(_)));
        let elsewhere = own.filter_map(|(_, one)| one.take()).collect();
        let unsure = self.unsure.binary_search_by_key(&of, |(of, _)| *of);
        let unsure = unsure.map(|at| std::mem::take(&mut self.unsure[at].1)).unwrap_or_default();
        Some(Kept { values, elsewhere, unsure })
    }

    /// Adds a component without a class.
    pub(super) fn add_none(&mut self) {
        self.of.push(NONE);
    }

    /// Starts the next component, which gives at most so many values.
    pub(super) fn start(&mut self, count: usize) -> Open<'_> {
        let own = if count == self.before.0 { self.before.1 } else { count };
        let start = self.given.len();
        Open { start, count, values: Vec::with_capacity(own), next: 0, checks: self }
    }
}

/// A component whose values are added.
pub(super) struct Open<'c> {
    checks: &'c mut Checks,
    /// The index of its first value.
    start: usize,
    count: usize,
    values: Vec<(SmolStr, PropertyValue)>,
    /// From this place on own properties have no value yet.
    next: usize,
}

impl Open<'_> {
    /// Adds the value of the property of this place, which has none yet.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        (place, slot): (usize, &Slot<'_>),
        value: PropertyValue,
        at: Location,
        elsewhere: Option<Elsewhere>,
    ) {
        let value = match slot.own {
            None => {
                self.checks.of_tasks.push(value);
                Held::OfTask(self.checks.of_tasks.len() as u32 - 1)
            }
            // Most are written in the order of the class.
            Some(_) if place >= self.next => {
                self.next = place + 1;
                self.values.push((slot.name.clone(), value));
                Held::Own(self.values.len() as u32 - 1)
            }
            Some(_) => {
                let own = self.make_place(place);
                self.values.insert(own, (slot.name.clone(), value));
                Held::Own(own as u32)
            }
        };
        // Classes and fleets are limited to fewer.
        if elsewhere.is_some() {
            self.checks.elsewhere.push((self.checks.given.len() as u32, elsewhere));
        }
        self.checks.given.push(Entry { place: at, slot: place as u32, value });
    }

    /// Where the value of an own property belongs that stands before others, which move on.
    fn make_place(&mut self, slot: usize) -> usize {
        let given = &mut self.checks.given[self.start..];
        let is_behind = |entry: &&Entry| matches!(entry.value, Held::Own(_)) && entry.slot as usize > slot;
        let behind = given.iter().filter(is_behind).count();
        let at = self.values.len() - behind;
        for entry in given {
            match &mut entry.value {
                Held::Own(own) if *own as usize >= at => *own += 1,
                _ => {}
            }
        }
        at
    }

    /// What is given so far.
    pub(super) fn so_far(&self) -> Checked<'_> {
        let Checks { given, of_tasks, elsewhere, .. } = &*self.checks;
        let (given, first) = (&given[self.start..], self.start as u32);
        Checked { values: &self.values, of_tasks, given, first, elsewhere, is_sound: false }
    }

    /// That is all; said with it is whether there was no fault, and which properties' values cannot be known for such.
    pub(super) fn finish(self, is_sound: bool, unsure: Vec<usize>) {
        let Self { checks, start, count, values, .. } = self;
        checks.before = (count, values.len());
        // Fleets are limited to fewer.
        let given = (start as u32, checks.given.len() as u32);
        let of = checks.all.len() as u32;
        checks.of.push(of);
        checks.all.push(One { values, given, is_sound });
        if !unsure.is_empty() {
            checks.unsure.push((of, unsure));
        }
    }
}
