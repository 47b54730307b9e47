//! The properties that components of a class, or loops, can be given.

use saoms_api::PropertyValue;
use saoms_api::declaration::PropertyKind;

use crate::assembly::TaskProperties;
use crate::hash::Map;
use crate::registry::{Class, LoopClass, PropertyDeclaration};

/// The task property that people know a task by.
const ID: &str = "ID";

/// The properties of a class or a loop.
pub(super) struct Slots<'r> {
    /// `class` or `loop`.
    pub(super) what: &'static str,
    /// What the class or the loop is called.
    pub(super) name: &'r str,
    /// Its properties, those of tasks behind its own.
    pub(super) all: Vec<Slot<'r>>,
    /// The places of those that no two components may share.
    pub(super) unique: Vec<usize>,
    /// The places of those that have to be given.
    pub(super) required: Vec<usize>,
    by_name: Map<&'r str, usize>,
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

    fn is_required(&self) -> bool {
        self.declarations().any(|declaration| declaration.required)
    }

    /// Whether its value is one text.
    pub(super) fn takes_text(&self) -> bool {
        self.main().is_some_and(|main| !main.many && main.kind != PropertyKind::Complex)
    }

    /// Whether people know a task by it.
    pub(super) fn is_task_id(&self) -> bool {
        self.task.is_some_and(|task| task.name == ID)
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
        slots.unique =
            slots.places(|slot| slot.is_task_id() || slot.main().is_some_and(|main| main.unique.is_some()));
        slots.required = slots.places(Slot::is_required);
        slots
    }

    pub(super) fn of_loop(class: &'r LoopClass) -> Self {
        let slots = Self { what: "loop", name: class.name(), ..Self::own(&class.declaration().properties) };
        Self { required: slots.places(Slot::is_required), ..slots }
    }

    fn own(properties: &'r [PropertyDeclaration]) -> Self {
        let places = properties.iter().enumerate();
        Self {
            what: "",
            name: "",
            all: properties.iter().map(|own| Slot { own: Some(own), task: None }).collect(),
            by_name: places.map(|(place, own)| (own.name.as_str(), place)).collect(),
            unique: Vec::new(),
            required: Vec::new(),
            presets: &[],
            is_passive: false,
        }
    }

    fn places(&self, of: impl Fn(&Slot<'r>) -> bool) -> Vec<usize> {
        let slots = self.all.iter().enumerate().filter(|(_, slot)| of(slot));
        slots.map(|(place, _)| place).collect()
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
