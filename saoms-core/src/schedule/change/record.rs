//! What the journal has of changes: who changed the fleet, what changed, and what came of it.

use std::sync::{Arc, PoisonError};

use saoms_lang::assembly::ComponentSpec;
use serde_json::{Map, Value};

use super::{ChangeError, HandedOver, PlannedChanges, PlannedReplacement};
use crate::assemble::ChangePlan;
use crate::journal::FLEET_CHANGED;
use crate::schedule::engine::Engine;
use crate::schedule::engine::memory::SharedText;
use crate::schedule::inject::OUTSIDE_NAME;
use crate::schedule::shared::Shared;

/// A change that somebody asked for.
pub(super) struct ChangeRecord {
    /// Who.
    pub(super) by: Option<String>,
    pub(super) plan: PlannedChanges,
    /// Components that end although they have not finished what they have begun.
    pub(super) unfinished: Vec<String>,
    /// What outlives the program of a change that is made.
    pub(super) keeps: Option<(SharedText, String)>,
}

impl ChangeRecord {
    /// The record of a change that gives components new instances.
    pub(super) fn of_replacement(
        by: Option<&str>,
        plan: &ChangePlan,
        wanted: &[Option<Arc<ComponentSpec>>],
    ) -> ChangeRecord {
        let replaced = plan.replace.iter().filter_map(|one| {
            let spec = wanted[one.wanted].as_ref()?;
            let state = if one.hands_over(spec) { HandedOver::Kept } else { HandedOver::Lost };
            let (component, class) = (spec.path.clone(), spec.class.name().to_owned());
            Some(PlannedReplacement { component, class, differences: Vec::new(), state })
        });
        let plan = PlannedChanges { replaced: replaced.collect(), ..PlannedChanges::default() };
        ChangeRecord { by: by.map(str::to_owned), plan, unfinished: Vec::new(), keeps: None }
    }

    /// Writes to the journal what came of it.
    fn write(&self, engine: &mut Engine, time: u64, outcome: Result<(), &ChangeError>) {
        if !self.plan.is_empty() {
            let content = (FLEET_CHANGED, self.text(outcome), self.values(outcome));
            engine.record_notice(time, OUTSIDE_NAME, content, saoms_api::Cause::default());
        }
    }

    /// Notes that the change takes effect now.
    pub(super) fn is_made(&self, engine: &mut Engine, time: u64) {
        self.write(engine, time, Ok(()));
        if let Some((text, now)) = &self.keeps {
            text.lock().unwrap_or_else(PoisonError::into_inner).clone_from(now);
            engine.note_difference(time);
        }
    }

    /// Writes that the change was not made, where it was not.
    pub(super) fn unless_made<T>(&self, shared: &Shared, result: Result<T, ChangeError>) -> Result<T, ChangeError> {
        if let Err(error) = &result {
            let mut engine = shared.lock();
            self.write(&mut engine, shared.clock.now(), Err(error));
            shared.release(engine);
        }
        result
    }

    /// As `change by alice: 1 added (Robot9), 1 set (Robot7): made`, or `... made; unfinished: Robot3`.
    fn text(&self, outcome: Result<(), &ChangeError>) -> String {
        let parts = self.components().into_iter().filter(|(_, paths)| !paths.is_empty());
        let parts = parts.map(|(what, paths)| format!("{} {what} ({})", paths.len(), paths.join(", ")));
        let parts: Vec<String> = parts.collect();
        let by = self.by.as_ref().map(|by| format!(" by {by}")).unwrap_or_default();
        let unfinished = match self.unfinished.as_slice() {
            [] => String::new(),
            unfinished => format!("; unfinished: {}", unfinished.join(", ")),
        };
        let came = outcome.map_or_else(|error| format!("not made: {error}"), |()| format!("made{unfinished}"));
        format!("change{by}: {}: {came}", parts.join(", "))
    }

    fn values(&self, outcome: Result<(), &ChangeError>) -> Map<String, Value> {
        let mut values = Map::new();
        values.extend(self.by.clone().map(|by| ("by".to_owned(), Value::from(by))));
        for (what, paths) in self.components() {
            values.insert(what.to_owned(), paths.into());
        }
        values.insert("made".to_owned(), outcome.is_ok().into());
        if outcome.is_ok() && !self.unfinished.is_empty() {
            values.insert("unfinished".to_owned(), self.unfinished.as_slice().into());
        }
        values.extend(outcome.err().map(|error| ("error".to_owned(), error.to_string().into())));
        values
    }

    /// The paths of the components, by what becomes of them.
    fn components(&self) -> [(&'static str, Vec<&str>); 4] {
        let PlannedChanges { added, removed, replaced, set, .. } = &self.plan;
        let mut updated: Vec<&str> = set.iter().map(|one| one.component.as_str()).collect();
        updated.dedup();
        [
            ("added", added.iter().map(|one| one.component.as_str()).collect()),
            ("removed", removed.iter().map(|one| one.component.as_str()).collect()),
            ("replaced", replaced.iter().map(|one| one.component.as_str()).collect()),
            ("set", updated),
        ]
    }
}
