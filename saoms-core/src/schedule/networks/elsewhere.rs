//! Components of other programs: those of other nodes of the fleet, which are known, and others, which were heard.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use saoms_lang::assembly::ComponentSpec;

use crate::schedule::engine::Engine;
use crate::schedule::inject::OUTSIDE;

/// The number of the first component of another program. Components of this one have numbers from 0.
const FIRST: u32 = 1 << 31;

/// The components of other programs.
#[derive(Debug, Default)]
pub(in crate::schedule) struct Elsewhere {
    names: Arc<RemoteNames>,
    /// Those of other nodes of the fleet, by their numbers.
    known: BTreeMap<u32, Known>,
}

#[derive(Debug)]
struct Known {
    spec: Arc<ComponentSpec>,
    /// True if a message of it has arrived.
    is_heard: bool,
}

impl Elsewhere {
    /// The components of other nodes from now on.
    pub(in crate::schedule) fn know(&mut self, specs: Vec<ComponentSpec>) {
        self.known = specs
            .into_iter()
            .map(|spec| (self.names.number(&spec.path), Known { spec: Arc::new(spec), is_heard: false }))
            .collect();
    }

    /// The number of a component of another program that says something.
    pub(super) fn hear(&mut self, name: &str) -> u32 {
        let number = self.names.number(name);
        if let Some(known) = self.known.get_mut(&number) {
            known.is_heard = true;
        }
        number
    }

    /// The names of all of them by their numbers.
    pub(in crate::schedule) fn names(&self) -> Arc<RemoteNames> {
        Arc::clone(&self.names)
    }

    /// The components of other nodes, with their numbers.
    pub(in crate::schedule) fn specs(&self) -> impl Iterator<Item = (u32, Arc<ComponentSpec>)> {
        self.known.iter().map(|(number, known)| (*number, Arc::clone(&known.spec)))
    }

    /// The component of another node with this number, and whether it was ever scheduled, as far as it is known: one
    /// that starts with the fleet has been, since what it drives is there before its program is.
    pub(in crate::schedule) fn get(&self, number: u32) -> Option<(&Arc<ComponentSpec>, bool)> {
        let Known { spec, is_heard } = self.known.get(&number)?;
        let starts = spec.task.as_ref().is_none_or(|task| task.run_on_startup);
        Some((spec, *is_heard || starts))
    }
}

/// The paths of components of other programs, by their numbers.
#[derive(Debug, Default)]
pub(in crate::schedule) struct RemoteNames {
    all: RwLock<Names>,
}

#[derive(Debug, Default)]
struct Names {
    names: Vec<&'static str>,
    numbers: HashMap<&'static str, u32>,
}

impl RemoteNames {
    fn read(&self) -> RwLockReadGuard<'_, Names> {
        self.all.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// The name of the component with this number.
    pub(in crate::schedule) fn get(&self, number: u32) -> Option<&'static str> {
        self.read().names.get(number.checked_sub(FIRST)? as usize).copied()
    }

    /// The number of the component with this name. Names stay: a component that comes again has the same number.
    fn number(&self, name: &str) -> u32 {
        if let Some(number) = self.read().numbers.get(name) {
            return *number;
        }
        let mut all = self.all.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(number) = all.numbers.get(name) {
            return *number;
        }
        let number = FIRST.saturating_add(u32::try_from(all.names.len()).unwrap_or(u32::MAX)).min(OUTSIDE - 1);
        // Never freed: contexts lend it to components.
        let name: &'static str = name.to_owned().leak();
        all.names.push(name);
        all.numbers.insert(name, number);
        number
    }
}

impl Engine {
    /// The path of the component with this number, of this program or of another one.
    pub(in crate::schedule) fn name_of(&self, number: u32) -> Option<Arc<str>> {
        let own = self.slots.get(number as usize).map(|slot| Arc::clone(&slot.name));
        own.or_else(|| self.networks.elsewhere.names.get(number).map(Arc::from))
    }

    /// The components that are members of this program's part of the fleet, and those of other nodes, with their
    /// numbers.
    pub(in crate::schedule) fn members_everywhere(&self) -> impl Iterator<Item = (u32, Arc<ComponentSpec>)> {
        let members = (0..).zip(&self.slots).filter(|(_, slot)| slot.is_member());
        members.map(|(number, slot)| (number, Arc::clone(&slot.spec))).chain(self.networks.elsewhere.specs())
    }
}
