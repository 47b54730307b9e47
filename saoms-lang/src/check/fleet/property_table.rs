//! The properties that components of a class, or loops, can be given.

use std::collections::HashMap;

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use crate::assembly::TaskProperties;
use crate::registry::{PropertyDeclaration, RegisteredClass, RegisteredLoop};

/// The task property that people know a task by.
const ID: &str = "ID";

/// The properties of a class or a loop.
pub(crate) struct PropertyTable<'r> {
    /// `class` or `loop`.
    pub(crate) what: &'static str,
    pub(crate) name: &'r str,
    /// Its properties, those of tasks behind its own.
    pub(crate) all: Vec<TableEntry<'r>>,
    /// The places of those that no two components may share.
    pub(crate) unique: Vec<usize>,
    /// The places of those that have to be given.
    pub(crate) required: Vec<usize>,
    by_name: HashMap<&'r str, usize>,
    /// The values that count where the composite gives none.
    pub(crate) presets: &'r [(SmolStr, PropertyValue)],
    /// True if it is never executed, so that it has no task properties.
    pub(crate) is_passive: bool,
    /// The names of its references.
    pub(crate) references: Vec<&'r str>,
}

/// A property that components of a class can be given.
///
/// A class can declare a property that tasks have as well, as robots do with `ID`; then one value serves both and the
/// stricter rule counts.
pub(crate) struct TableEntry<'r> {
    pub(crate) name: SmolStr,
    /// The declaration that messages are about: that of the class, if it has one.
    pub(crate) main: &'r PropertyDeclaration,
    /// True if it is the class that declares it.
    is_own: bool,
    /// The declaration as a task property.
    pub(crate) task: Option<&'r PropertyDeclaration>,
}

impl<'r> TableEntry<'r> {
    fn of(main: &'r PropertyDeclaration, is_own: bool) -> Self {
        Self { name: main.name.as_str().into(), main, is_own, task: (!is_own).then_some(main) }
    }

    /// The declaration of the class.
    pub(crate) fn own(&self) -> Option<&'r PropertyDeclaration> {
        self.is_own.then_some(self.main)
    }

    /// The second declaration, as a task property.
    pub(crate) fn also(&self) -> Option<&'r PropertyDeclaration> {
        self.task.filter(|_| self.is_own)
    }

    /// True if people know a task by it.
    pub(crate) fn is_task_id(&self) -> bool {
        self.task.is_some_and(|task| task.name == ID)
    }

    fn is_required(&self) -> bool {
        self.main.required || self.task.is_some_and(|task| task.required)
    }
}

impl<'r> PropertyTable<'r> {
    pub(crate) fn of_class(class: &'r RegisteredClass) -> Self {
        let declaration = class.declaration();
        let mut table = Self {
            what: "class",
            name: class.name(),
            presets: class.presets(),
            is_passive: !declaration.is_periodic(),
            references: declaration.references.iter().map(|one| one.name.as_str()).collect(),
            ..Self::own(&declaration.properties)
        };
        let task = if table.is_passive { &[] } else { TaskProperties::declarations() };
        for task in task {
            match table.by_name.get(task.name.as_str()) {
                Some(&place) => table.all[place].task = Some(task),
                None => {
                    table.by_name.insert(&task.name, table.all.len());
                    table.all.push(TableEntry::of(task, false));
                }
            }
        }
        table.unique = table.places(|entry| entry.is_task_id() || entry.main.unique.is_some());
        table.required = table.places(TableEntry::is_required);
        table
    }

    pub(crate) fn of_loop(class: &'r RegisteredLoop) -> Self {
        let table = Self { what: "loop", name: class.name(), ..Self::own(&class.declaration().properties) };
        Self { required: table.places(TableEntry::is_required), ..table }
    }

    fn own(properties: &'r [PropertyDeclaration]) -> Self {
        let places = properties.iter().enumerate();
        Self {
            what: "",
            name: "",
            all: properties.iter().map(|own| TableEntry::of(own, true)).collect(),
            by_name: places.map(|(place, own)| (own.name.as_str(), place)).collect(),
            unique: Vec::new(),
            required: Vec::new(),
            presets: &[],
            is_passive: false,
            references: Vec::new(),
        }
    }

    fn places(&self, of: impl Fn(&TableEntry<'r>) -> bool) -> Vec<usize> {
        let table = self.all.iter().enumerate().filter(|(_, entry)| of(entry));
        table.map(|(place, _)| place).collect()
    }

    /// The place of the property of this name.
    pub(crate) fn place(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The value that counts where the composite gives none.
    pub(crate) fn preset(&self, name: &str) -> Option<&'r PropertyValue> {
        self.presets.iter().find(|(preset, _)| preset == name).map(|(_, value)| value)
    }

    /// The names of all properties, in order.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'r str> + Clone {
        self.all.iter().map(|entry| entry.main.name.as_str())
    }
}
