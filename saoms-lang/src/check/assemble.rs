//! The assembly of a fleet without errors.

use std::sync::Arc;

use super::component::ComponentCheck;
use super::fleet::classes::ClassIndex;
use super::fleet::{Fleet, Member};
use super::report::Report;
use super::rules::traffic;
use super::tasks::Task;
use super::wiring::Wiring;
use crate::assembly::{Assembly, ComponentSpec, Wire, WireTarget};
use crate::model::ComponentElement;

/// A fleet without errors. Components of it may have no class where that is taken as given.
pub(crate) struct CheckedFleet<'f, 'a> {
    pub(crate) fleet: Fleet<'f>,
    pub(crate) classes: Vec<ClassIndex<'a>>,
    pub(crate) checks: Vec<ComponentCheck<'f>>,
    pub(crate) wiring: Wiring,
}

impl CheckedFleet<'_, '_> {
    /// The number of components; `None` if something is taken as given.
    pub(crate) fn count(&self) -> Option<usize> {
        let mut runs = self.fleet.members.iter().zip(&self.checks).filter(|(member, _)| member.runs());
        runs.try_fold(0, |count, (_, check)| check.is_sound().then_some(count + 1))
    }

    /// The places of the components of the assembly in the files.
    pub(crate) fn places(&self, report: &Report<'_>) -> Vec<traffic::ComponentPlaces> {
        let runs = self.fleet.members.iter().enumerate().filter(|(_, member)| member.runs());
        let place = |(place, member): (usize, &Member<'_>)| {
            let (component, given) = (member.component, &self.checks[place].given);
            let class = self.fleet.class_of(place, &self.classes);
            let task = class.filter(|class| class.class.declaration().is_periodic());
            let task = task.map(|class| Task { component, class, given });
            traffic::ComponentPlaces {
                name: component.name.location,
                renamed: task.as_ref().map_or_else(Vec::new, |task| task.renamed(report)),
                queue: task.and_then(|task| task.place("queue")),
            }
        };
        runs.map(place).collect()
    }

    /// The assembly; `None` if something is taken as given.
    pub(crate) fn assemble(self, library: impl Fn(&ComponentElement) -> Option<String>) -> Option<Assembly> {
        let Self { fleet, classes, checks, wiring } = self;
        // Components that composites implement are in no assembly.
        let mut count = 0;
        let indices = fleet.members.iter().map(|member| {
            count += usize::from(member.runs());
            count.saturating_sub(1)
        });
        let indices: Vec<usize> = indices.collect();
        let mut components = Vec::with_capacity(count);
        for (place, check) in checks.into_iter().enumerate() {
            let member = &fleet.members[place];
            if !member.runs() {
                continue;
            }
            if !check.is_sound() {
                return None;
            }
            let class = fleet.class_of(place, &classes)?;
            let references = class.references.iter().zip(wiring.of(place));
            let references = references.map(|(declared, providers)| Wire {
                reference: declared.name.clone(),
                interface: declared.interface.name.clone(),
                targets: providers
                    .iter()
                    .filter_map(|provider| {
                        let class = fleet.class_of(provider.member, &classes)?;
                        let service = class.services[provider.service].name.clone();
                        Some(WireTarget { component: indices[provider.member], service })
                    })
                    .collect(),
            });
            components.push(ComponentSpec {
                path: member.path().to_owned(),
                class: Arc::clone(class.class),
                library: library(member.component),
                values: check.given.into_own().0,
                task: check.task,
                references: references.collect(),
                loops: check.loops?.specs,
            });
        }
        Some(Assembly { components })
    }
}
