//! What loops know, saved by their component for the one that takes its place.

use super::Loops;
use crate::{Extras, Failure, Field, Knowledge, Saved};

/// What the loops of a component know beside its knowledge, and the entries that they added to it: a part of what the
/// component [saves](crate::Component::save).
#[derive(Clone, Debug, Default, PartialEq, Eq, Field)]
pub struct SavedLoops {
    loops: Vec<SavedLoop>,
    entries: Vec<SavedEntry>,
}

/// State of a loop, by the name that composites use.
#[derive(Clone, Debug, PartialEq, Eq, Field)]
struct SavedLoop {
    name: String,
    state: Vec<u8>,
}

/// An entry that a loop added.
#[derive(Clone, Debug, PartialEq, Eq, Field)]
struct SavedEntry {
    name: String,
    of: String,
    bytes: Vec<u8>,
}

impl Loops {
    /// What the loops [save](crate::Loop::save), and the entries that they added to the knowledge.
    ///
    /// # Errors
    /// The first failure of a loop.
    pub fn save(&mut self, knowledge: &dyn Knowledge) -> Result<SavedLoops, Failure> {
        let mut saved = SavedLoops { loops: Vec::new(), entries: entries(knowledge.extras())? };
        self.for_each(|name, instance| {
            let state = instance.save()?;
            if !state.is_nothing() {
                saved.loops.push(SavedLoop { name: name.to_owned(), state: state.into_bytes() });
            }
            Ok(())
        })?;
        Ok(saved)
    }

    /// Goes on from what [`save`](Loops::save) gave, after [`initialize`](Loops::initialize). What belonged to loops
    /// that are not there any more is left out; loops that are new begin.
    ///
    /// # Errors
    /// The first failure of a loop.
    pub fn restore(&mut self, knowledge: &mut dyn Knowledge, saved: &SavedLoops) -> Result<(), Failure> {
        for entry in &saved.entries {
            let declared =
                knowledge.extras().declared().position(|added| added.name == entry.name && added.of == entry.of);
            let place = declared.and_then(|place| u32::try_from(place).ok());
            if let Some((group, place)) = place.and_then(|place| knowledge.extras_mut().at_mut(place)) {
                group.set_bytes(place, &entry.bytes)?;
            }
        }
        self.for_each(|name, instance| match saved.loops.iter().find(|saved| saved.name == name) {
            Some(saved) => instance.restore(&Saved::from_bytes(saved.state.clone())),
            None => Ok(()),
        })
    }
}

fn entries(extras: &Extras) -> Result<Vec<SavedEntry>, Failure> {
    (0..)
        .zip(extras.declared())
        .map(|(place, declared)| {
            let mut bytes = Vec::new();
            if let Some((group, place)) = extras.at(place) {
                group.get_bytes(place, &mut bytes)?;
            }
            Ok(SavedEntry { name: declared.name.to_owned(), of: declared.of.to_owned(), bytes })
        })
        .collect()
}
