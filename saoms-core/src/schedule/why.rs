//! The journal of a running fleet, for who asks why.

use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use saoms_api::{Cause, Time};
use saoms_lang::assembly::ComponentSpec;

use super::engine::Engine;
use super::shared::Shared;
use crate::journal::{ComponentName, Journal, JournalEntry, LiveJournal, Pieces, find};

/// Number of components whose records are searched while the engine is locked.
const RINGS: usize = 8;

/// The records that explain what a component did, given by its path, ID, or unambiguous ending of its path. The engine
/// is locked for one piece of them after the other, so that its timer goes on between them.
pub(super) fn why(shared: &Shared, component: &str, at: Option<Time>) -> Result<LiveJournal, String> {
    let now = shared.clock.now();
    let (newest, found, live) = component_of(shared, component)?;
    let journal = Journal::excerpt(&live, &found.name, at, newest);
    Ok(LiveJournal { time_s: now as f64 / 1e9, components: vec![found], journal })
}

/// The newest records of a component after this one, oldest first, at most so many.
pub(super) fn records(
    shared: &Shared,
    component: &str,
    after: Cause,
    most: usize,
) -> Result<Vec<JournalEntry>, String> {
    let (newest, _, live) = component_of(shared, component)?;
    let mut records = VecDeque::new();
    let mut from = Cause(after.0.saturating_add(1));
    while from <= newest {
        let piece = live.piece(from);
        let Some(last) = piece.last() else { break };
        from = Cause(last.id().0 + 1);
        records.extend(piece);
        records.drain(..records.len().saturating_sub(most));
    }
    Ok(records.into())
}

/// A component by its path, ID, or unambiguous ending of its path, with its records, and the newest number of all.
fn component_of<'a>(shared: &'a Shared, component: &str) -> Result<(Cause, ComponentName, Live<'a>), String> {
    let (newest, members): (u64, Vec<(usize, Arc<ComponentSpec>)>) = shared.look(|engine| {
        let joined = engine.slots.iter().enumerate().filter(|(_, slot)| slot.joined);
        (
            engine.record_ids.load(Ordering::Relaxed),
            joined.map(|(index, slot)| (index, Arc::clone(&slot.spec))).collect(),
        )
    });
    let names: Vec<ComponentName> = members.iter().map(|(_, spec)| ComponentName::of(spec)).collect();
    let found = find(&names, component)?.clone();
    let place = names.iter().position(|one| *one == found).unwrap_or_default();
    let all: Vec<usize> = members.iter().map(|(index, _)| *index).collect();
    Ok((Cause(newest), found, Live { shared, slot: all[place], near: Cell::new(all[place]), all }))
}

struct Live<'a> {
    shared: &'a Shared,
    /// The number of the component.
    slot: usize,
    /// The numbers of all components.
    all: Vec<usize>,
    /// The one whose record was found last: it wrote the next one, too, more often than others.
    near: Cell<usize>,
}

impl Pieces for Live<'_> {
    fn piece(&self, from: Cause) -> Vec<JournalEntry> {
        self.shared.look(|engine| {
            let slot = &engine.slots[self.slot];
            slot.journal.piece(&slot.name, from)
        })
    }

    fn find(&self, id: Cause) -> Option<JournalEntry> {
        let of = |engine: &Engine, index: usize| {
            let slot = engine.slots.get(index)?;
            slot.journal.find(&slot.name, id)
        };
        let first = self.shared.look(|engine| of(engine, self.near.get()).or_else(|| engine.outside.find(id)));
        first.or_else(|| {
            let found = self.all.chunks(RINGS).find_map(|some| {
                self.shared.look(|engine| some.iter().find_map(|index| Some((*index, of(engine, *index)?))))
            });
            let (index, entry) = found?;
            self.near.set(index);
            Some(entry)
        })
    }

    fn overwritten(&self) -> u64 {
        self.shared.look(|engine| engine.slots[self.slot].journal.overwritten())
    }
}
