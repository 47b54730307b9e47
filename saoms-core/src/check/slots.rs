//! The properties that components of a class, or loops, can be given.

use std::collections::HashMap;

use saoms_api::PropertyValue;

use crate::assembly::TaskProperties;
use crate::registry::{Class, LoopClass, PropertyDeclaration};

/// The properties of a class or a loop.
pub(super) struct Slots<'r> {
    /// `class` or `loop`.
    pub(super) what: &'static str,
    /// What the class or the loop is called.
    pub(super) name: &'r str,
    /// Its properties, those of tasks behind its own.
    pub(super) all: Vec<Slot<'r>>,
    by_name: HashMap<&'r str, usize>,
    /// Values that count where the composite gives none.
    pub(super) presets: &'r [(String, PropertyValue)],
    /// Whether it is never executed, so that it has no task properties.
    pub(super) is_passive: bool,
}

/// A property that components of a class can be given.
///
/// A class can declare a property that tasks have as well, as robots do with `ID`; then one value serves both and the
/// stricter rule counts.
pub(super) struct Slot<'r> {
    pub(super) own: Option<&'r PropertyDeclaration>,
    pub(super) task: Option<&'r PropertyDeclaration>,
}

impl<'r> Slot<'r> {
    pub(super) fn declarations(&self) -> impl Iterator<Item = &'r PropertyDeclaration> {
        self.own.into_iter().chain(self.task)
    }

    pub(super) fn is_required(&self) -> bool {
        self.declarations().any(|declaration| declaration.required)
    }

    /// The declaration that people are told of.
    pub(super) fn main(&self) -> Option<&'r PropertyDeclaration> {
        self.own.or(self.task)
    }
}

impl<'r> Slots<'r> {
    pub(super) fn of_class(class: &'r Class) -> Self {
        let declaration = class.declaration();
        let mut slots = Self {
            what: "class",
            name: class.name(),
            presets: class.presets(),
            is_passive: !declaration.is_periodic(),
            ..Self::own(&declaration.properties)
        };
        let task = if slots.is_passive { &[] } else { TaskProperties::declarations() };
        for task in task {
            match slots.by_name.get(task.name.as_str()) {
                Some(&place) => slots.all[place].task = Some(task),
                None => {
                    slots.by_name.insert(&task.name, slots.all.len());
                    slots.all.push(Slot { own: None, task: Some(task) });
                }
            }
        }
        slots
    }

    pub(super) fn of_loop(class: &'r LoopClass) -> Self {
        Self { what: "loop", name: class.name(), ..Self::own(&class.declaration().properties) }
    }

    fn own(properties: &'r [PropertyDeclaration]) -> Self {
        let places = properties.iter().enumerate();
        Self {
            what: "",
            name: "",
            all: properties.iter().map(|own| Slot { own: Some(own), task: None }).collect(),
            by_name: places.map(|(place, own)| (own.name.as_str(), place)).collect(),
            presets: &[],
            is_passive: false,
        }
    }

    /// The place of the property of this name.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The value that counts where the composite gives none.
    pub(super) fn preset(&self, name: &str) -> Option<&'r PropertyValue> {
        self.presets.iter().find(|(preset, _)| preset == name).map(|(_, value)| value)
    }

    /// The names of all properties, in order.
    pub(super) fn names(&self) -> impl Iterator<Item = &'r str> + Clone {
        self.all.iter().filter_map(Slot::main).map(|declaration| declaration.name.as_str())
    }
}
