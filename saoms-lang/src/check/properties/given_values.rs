//! Conversion of the properties of one component or loop.

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use super::property_table::PropertyTable;
use crate::source::{Location, Text};

/// The values that a component or a loop gives its properties.
#[derive(Default)]
pub(crate) struct PropertyValues {
    given: Vec<GivenValue>,
    /// The properties whose values are not known, since a fault of theirs is reported: by their indices in the class.
    pub(crate) unknown: Vec<usize>,
    /// True if no property has a fault, so that the class can construct a component of them.
    pub(crate) is_sound: bool,
}

/// The value of one property.
pub(crate) struct GivenValue {
    /// The index of the property in its class.
    property: usize,
    pub(crate) value: PropertyValue,
    /// The place of the value, the first one of several.
    pub(crate) place: Location,
    /// Absent where the value is one text in the property itself.
    origin: Option<Box<ValueOrigin>>,
}

/// The origin of a value that is not one text in the property itself.
#[derive(Clone)]
pub(crate) struct ValueOrigin {
    /// The name of the property.
    pub(crate) name: SmolStr,
    /// The places of its values.
    pub(crate) places: Vec<Location>,
    /// The `source` that leads there.
    pub(crate) source: Option<Location>,
}

impl GivenValue {
    /// The value as a text with its place; `None` if it is not one text.
    pub(crate) fn text(&self) -> Option<Text> {
        Some(Text::new(self.value.as_text()?.clone(), self.place))
    }
}

impl PropertyValues {
    pub(crate) fn add(
        &mut self,
        property: usize,
        value: PropertyValue,
        place: Location,
        origin: Option<ValueOrigin>,
    ) {
        self.given.push(GivenValue { property, value, place, origin: origin.map(Box::new) });
    }

    /// The value of the property of this name.
    pub(crate) fn get(&self, table: &PropertyTable<'_>, name: &str) -> Option<&GivenValue> {
        self.at(table.place(name)?)
    }

    /// The value of the property of this index.
    pub(crate) fn at(&self, property: usize) -> Option<&GivenValue> {
        self.given.iter().find(|given| given.property == property)
    }

    /// The values of task properties, by the names of these.
    pub(crate) fn of_task(
        &self,
        table: &PropertyTable<'_>,
    ) -> impl Iterator<Item = (SmolStr, &PropertyValue)> {
        let of_task = self.given.iter().filter(|given| table.all[given.property].task.is_some());
        of_task.map(|given| (table.all[given.property].name.clone(), &given.value))
    }

    /// The values of the class's own properties in the order of the class, presets included, as constructors take them; and the origins of those
    /// that have one.
    pub(crate) fn of_class(
        &self,
        table: &PropertyTable<'_>,
    ) -> (Vec<(SmolStr, PropertyValue)>, Vec<ValueOrigin>) {
        let mut own: Vec<&GivenValue> =
            self.given.iter().filter(|given| table.all[given.property].own.is_some()).collect();
        own.sort_by_key(|given| given.property);
        let origins = own.iter().filter_map(|given| given.origin.as_deref().cloned()).collect();
        let named = own.iter().map(|given| (table.all[given.property].name.clone(), given.value.clone()));
        let mut values: Vec<(SmolStr, PropertyValue)> = named.collect();
        for preset in table.presets {
            if values.iter().all(|(name, _)| *name != preset.0) {
                values.push(preset.clone());
            }
        }
        (values, origins)
    }
}
