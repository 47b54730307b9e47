//! The values of the properties of one component or loop.

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use crate::assembly::Written;
use crate::check::fleet::property_table::PropertyTable;
use crate::source::{Location, Text};

/// The values of the properties of a component or a loop: each converted once, when it is found, and with its place and
/// its text from then on.
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
    /// The value with the texts that the composite gives, where one of them is not the usual one of its scalar.
    pub(crate) written: Option<Box<PropertyValue>>,
    /// The value as the task has it, where its declaration is of another type than that of the class.
    pub(crate) as_task: Option<Box<PropertyValue>>,
}

/// A value that a composite gives.
#[derive(Clone, Copy)]
pub(crate) struct GivenValue<'v> {
    pub(crate) value: &'v PropertyValue,
    at: &'v ValuePlace,
    /// Its place, the first one of several.
    pub(crate) place: Location,
}

impl GivenValue<'_> {
    /// The text that the composite gives with its place; `None` if it is not one text, or a blank one.
    pub(crate) fn text(&self) -> Option<Text> {
        let PropertyValue::Scalar(written) = self.at.written.as_deref().unwrap_or(self.value) else { return None };
        Some(Text::new(written.text(), self.place)).filter(|text| !text.trim().is_empty())
    }

    /// The value as the task of the component has it.
    pub(crate) fn as_task(&self) -> &PropertyValue {
        self.at.as_task.as_deref().unwrap_or(self.value)
    }
}

impl PropertyValues {
    /// Values that were found for properties of a table, with what the class presets for others.
    pub(crate) fn of(
        table: &PropertyTable<'_>,
        mut found: Vec<(PropertyValue, ValuePlace)>,
        unknown: Vec<usize>,
        is_sound: bool,
    ) -> Self {
        let given = found.len();
        for (name, value) in table.presets {
            let Some(property) = table.place(name) else { continue };
            if found[..given].iter().all(|(_, at)| at.property != property) {
                found.push((value.clone(), ValuePlace { property, ..ValuePlace::default() }));
            }
        }
        found.sort_by_key(|(_, at)| at.property);
        let own = found.iter().filter(|(_, at)| table.all[at.property].own().is_some()).count();
        let named = found.into_iter().map(|(value, at)| ((table.all[at.property].name.clone(), value), at));
        let (values, places) = named.unzip();
        Self { values, places, own, unknown, is_sound }
    }

    /// The value that the composite gives the property of this name.
    pub(crate) fn get(&self, name: &str) -> Option<GivenValue<'_>> {
        let index = self.values.iter().position(|(known, _)| known == name)?;
        let (value, at) = (&self.values[index].1, &self.places[index]);
        Some(GivenValue { value, at, place: *at.places.first()? })
    }

    /// The places of the values that the composite gives the property of this name.
    pub(crate) fn places_of(&self, name: &str) -> &[Location] {
        let index = self.values.iter().position(|(known, _)| known == name);
        index.map_or(&[], |index| &self.places[index].places)
    }

    /// The values of task properties, presets included.
    pub(crate) fn of_task(&self, table: &PropertyTable<'_>) -> Vec<(SmolStr, PropertyValue)> {
        let all = self.values.iter().zip(&self.places);
        let of_task = all.filter(|(_, place)| table.all[place.property].task.is_some());
        let as_task = |((name, value), at): (&(SmolStr, PropertyValue), &ValuePlace)| {
            (name.clone(), at.as_task.as_deref().unwrap_or(value).clone())
        };
        of_task.map(as_task).collect()
    }

    /// The values of all properties.
    pub(crate) fn all(&self) -> &[(SmolStr, PropertyValue)] {
        &self.values
    }

    /// The values of the class's own properties, as constructors take them.
    pub(crate) fn own(&self) -> &[(SmolStr, PropertyValue)] {
        &self.values[..self.own]
    }

    /// The same, as the composite writes them where that is not as usual, and the place of each.
    pub(crate) fn into_own(mut self) -> (Vec<(SmolStr, PropertyValue)>, Written, Vec<ValuePlace>) {
        self.values.truncate(self.own);
        let all = self.values.iter().zip(&self.places);
        let written = all.map(|((name, value), at)| (name.clone(), at.written.as_deref().unwrap_or(value).clone()));
        let written = self.places[..self.own].iter().any(|at| at.written.is_some()).then(|| written.collect());
        (self.values, written, self.places)
    }

    pub(crate) fn places(&self) -> &[ValuePlace] {
        &self.places
    }
}
