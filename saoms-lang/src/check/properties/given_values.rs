//! The values of the properties of one component or loop.

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use crate::check::fleet::property_table::PropertyTable;
use crate::source::{Location, Text};

/// The values of the properties of a component or a loop: each converted once, with its place from then on.
#[derive(Default)]
pub(crate) struct PropertyValues {
    /// In the order of the table: those of the class first, presets among them.
    values: Vec<(SmolStr, PropertyValue)>,
    /// The place of each of them.
    places: Vec<ValuePlace>,
    /// The number of those of the class.
    own: usize,
    /// The properties whose values are not known, since a fault of theirs is reported: by their indices in the table.
    pub(crate) unknown: Vec<usize>,
    /// True if no property has a fault, so that the class can construct a component of them.
    pub(crate) is_sound: bool,
}

/// The place of the value of a property.
#[derive(Default)]
pub(crate) struct ValuePlace {
    /// The index of the property in its table.
    pub(crate) property: usize,
    /// The places of each of its values; none for what the class presets.
    pub(crate) places: Box<[Location]>,
    /// The `source` that leads there.
    pub(crate) source: Option<Location>,
}

/// A value that a composite gives.
#[derive(Clone, Copy)]
pub(crate) struct GivenValue<'v> {
    pub(crate) value: &'v PropertyValue,
    /// Its place, the first one of several.
    pub(crate) place: Location,
}

impl GivenValue<'_> {
    /// The value as a text with its place; `None` if it is not one text, or a blank one.
    pub(crate) fn text(&self) -> Option<Text> {
        let text = self.value.as_text().filter(|text| !text.trim().is_empty())?;
        Some(Text::new(text.clone(), self.place))
    }
}

impl PropertyValues {
    /// The values of each property of a table, in its order, with what the class presets for others.
    pub(crate) fn of(
        table: &PropertyTable<'_>,
        given: impl Iterator<Item = Option<(PropertyValue, ValuePlace)>>,
        unknown: Vec<usize>,
        is_sound: bool,
    ) -> Self {
        let mut all = Self { unknown, is_sound, ..Self::default() };
        for (property, (entry, given)) in table.all.iter().zip(given).enumerate() {
            let by_class = ValuePlace { property, ..ValuePlace::default() };
            let preset = || Some((table.preset(&entry.name)?.clone(), by_class));
            let Some((value, place)) = given.or_else(preset) else { continue };
            all.values.push((entry.name.clone(), value));
            all.places.push(place);
            all.own += usize::from(entry.own().is_some());
        }
        all
    }

    /// The value that the composite gives the property of this name.
    pub(crate) fn get(&self, table: &PropertyTable<'_>, name: &str) -> Option<GivenValue<'_>> {
        self.at(table.place(name)?)
    }

    /// The value that the composite gives the property of this index.
    pub(crate) fn at(&self, property: usize) -> Option<GivenValue<'_>> {
        let index = self.places.iter().position(|place| place.property == property)?;
        Some(GivenValue { value: &self.values[index].1, place: *self.places[index].places.first()? })
    }

    /// The values of task properties, presets included.
    pub(crate) fn of_task(&self, table: &PropertyTable<'_>) -> Vec<(SmolStr, PropertyValue)> {
        let all = self.values.iter().zip(&self.places);
        let of_task = all.filter(|(_, place)| table.all[place.property].task.is_some());
        of_task.map(|(value, _)| value.clone()).collect()
    }

    /// The values of the class's own properties, as constructors take them.
    pub(crate) fn own(&self) -> &[(SmolStr, PropertyValue)] {
        &self.values[..self.own]
    }

    /// The same with the place of each.
    pub(crate) fn into_own(mut self) -> (Vec<(SmolStr, PropertyValue)>, Vec<ValuePlace>) {
        self.values.truncate(self.own);
        (self.values, self.places)
    }

    pub(crate) fn places(&self) -> &[ValuePlace] {
        &self.places
    }
}
