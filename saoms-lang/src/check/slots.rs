//! The properties that components of a class, or loops, can be given.

use std::collections::HashMap;

use saoms_api::host::PropertyValue;
use saoms_api::host::declaration::{PlainBounds, PropertyKind};
use smol_str::SmolStr;

use crate::assembly::TaskProperties;
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
    /// The place of that whose value chooses among the lists of loops of the class.
    pub(super) choice: Option<usize>,
    /// The place of that for the length of queues.
    pub(super) queue: Option<usize>,
    /// The places of those that have to be given.
    pub(super) required: Vec<usize>,
    by_name: HashMap<&'r str, usize>,
    /// Values that count where the composite gives none.
    pub(super) presets: &'r [(SmolStr, PropertyValue)],
    /// Whether it is never executed, so that it has no task properties.
    pub(super) is_passive: bool,
}

/// A property that components of a class can be given.
///
/// A class can declare a property that tasks have as well, as robots do with `ID`; then one value serves both and the
/// stricter rule counts.
pub(super) struct Slot<'r> {
    pub(super) name: SmolStr,
    pub(super) own: Option<&'r PropertyDeclaration>,
    pub(super) task: Option<&'r PropertyDeclaration>,
    /// What its only declaration allows without a closer look.
    bounds: Option<PlainBounds>,
    /// Whether its value is one text.
    pub(super) takes_text: bool,
    /// Whether any text that is not blank is allowed.
    takes_any: bool,
    /// Whether people know a task by it.
    pub(super) is_task_id: bool,
}

impl<'r> Slot<'r> {
    fn of(own: Option<&'r PropertyDeclaration>, task: Option<&'r PropertyDeclaration>) -> Self {
        let (name, bounds) = match (own, task) {
            (Some(only), None) | (None, Some(only)) => (only.name.as_str(), only.plain_bounds()),
            _ => (own.map_or("", |own| &own.name), None),
        };
        let takes_any = own.into_iter().chain(task).all(PropertyDeclaration::takes_any_text);
        let is_task_id = task.is_some_and(|task| task.name == ID);
        let takes_text = own.or(task).is_some_and(|main| !main.many && main.kind != PropertyKind::Complex);
        Self { name: name.into(), own, task, bounds, takes_text, takes_any, is_task_id }
    }

    /// The number that a text of nothing but a few digits is, where it is allowed.
    pub(super) fn number(&self, text: &str) -> Option<u32> {
        self.bounds?.read(text)
    }

    /// Whether a text is certainly allowed.
    pub(super) fn is_plain(&self, text: &str) -> bool {
        let is_graphic = || text.bytes().next().is_some_and(|first| first.is_ascii_graphic());
        self.takes_any && is_graphic() || self.number(text).is_some()
    }

    pub(super) fn declarations(&self) -> impl Iterator<Item = &'r PropertyDeclaration> {
        self.own.into_iter().chain(self.task)
    }

    fn is_required(&self) -> bool {
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
                Some(&place) => slots.all[place] = Slot::of(slots.all[place].own, Some(task)),
                None => {
                    slots.by_name.insert(&task.name, slots.all.len());
                    slots.all.push(Slot::of(None, Some(task)));
                }
            }
        }
        slots.choice = declaration.loops.property.as_deref().and_then(|name| slots.place(name));
        slots.queue = slots.place("queue");
        slots.unique =
            slots.places(|slot| slot.is_task_id || slot.main().is_some_and(|main| main.unique.is_some()));
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
            all: properties.iter().map(|own| Slot::of(Some(own), None)).collect(),
            by_name: places.map(|(place, own)| (own.name.as_str(), place)).collect(),
            unique: Vec::new(),
            choice: None,
            queue: None,
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
