use std::any::Any;
use std::fmt;

use crate::host::{DynEntries, EntryDeclaration};
use crate::{Entries, Failure};

/// The entries that loops add to the knowledge of their component. A [`Knowledge`](crate::Knowledge) has one field of
/// this type; those who reach entries by name see no difference.
#[derive(Default)]
pub struct Extras {
    groups: Vec<Box<dyn DynEntries>>,
    /// Entries that the present loop may change.
    writable: Writable,
}

/// The entries that a loop may change.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Writable {
    pub(crate) effects: &'static [&'static str],
    pub(crate) own: &'static [EntryDeclaration],
}

impl Writable {
    pub(crate) fn has(self, name: &str) -> bool {
        self.effects.contains(&name) || self.own.iter().any(|entry| entry.name == name)
    }
}

impl Extras {
    /// The entries of this type, as the loop that declares them added them.
    pub fn of<E: Entries>(&self) -> Option<&E> {
        self.groups.iter().find_map(|group| {
            let group: &dyn Any = &**group;
            group.downcast_ref()
        })
    }

    /// See [`of`](Extras::of).
    pub fn of_mut<E: Entries>(&mut self) -> Option<&mut E> {
        self.groups.iter_mut().find_map(|group| {
            let group: &mut dyn Any = &mut **group;
            group.downcast_mut()
        })
    }

    pub(crate) fn add(
        &mut self,
        group: Box<dyn DynEntries>,
        known: &'static [EntryDeclaration],
    ) -> Result<(), Failure> {
        for added in group.declared() {
            if known.iter().chain(self.declared()).any(|known| known.name == added.name) {
                return Err(Failure::new(format!(
                    "the knowledge already has an entry `{}`: no loop can add another one",
                    added.name
                )));
            }
        }
        self.groups.push(group);
        Ok(())
    }

    pub(crate) fn permit(&mut self, writable: Writable) {
        self.writable = writable;
    }

    pub(crate) fn writable(&self) -> Writable {
        self.writable
    }

    pub(crate) fn declared(&self) -> impl Iterator<Item = &'static EntryDeclaration> {
        self.groups.iter().flat_map(|group| group.declared())
    }

    pub(crate) fn groups(&self) -> impl Iterator<Item = &dyn DynEntries> {
        self.groups.iter().map(|group| &**group)
    }

    /// The group with this entry, and the entry's place in it.
    pub(crate) fn at(&self, mut entry: u32) -> Option<(&dyn DynEntries, u32)> {
        for group in &self.groups {
            let count = group.declared().len() as u32;
            if entry < count {
                return Some((&**group, entry));
            }
            entry -= count;
        }
        None
    }

    /// See [`at`](Extras::at).
    pub(crate) fn at_mut(&mut self, mut entry: u32) -> Option<(&mut dyn DynEntries, u32)> {
        for group in &mut self.groups {
            let count = group.declared().len() as u32;
            if entry < count {
                return Some((&mut **group, entry));
            }
            entry -= count;
        }
        None
    }
}

impl fmt::Debug for Extras {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.declared().map(|entry| entry.name)).finish()
    }
}
