//! What of the composites is in the fleet, how many times, and with which topics, for pictures of them.

use std::collections::HashMap;

use super::arena::Arena;
use super::fleet::{Fleet, Kind};
use super::options::Options;
use super::parameters::Parameters;
use super::report::Report;
use super::severities::Severities;
use super::{classes, loops, task, unfold};
use crate::diagnostic::Diagnostics;
use crate::model::{Contribution, Origin};
use crate::registry::{Registry, TopicDeclaration};
use crate::source::{FileId, Sources};
use crate::xml::ElementId;

/// How many times each replicated or conditional part of the composites is in a fleet, and which topics its components use.
#[derive(Clone, Debug, Default)]
pub struct Census {
    counts: HashMap<(FileId, ElementId), usize>,
    topics: HashMap<(FileId, ElementId), Vec<TopicUse>>,
}

/// A topic that a component publishes or subscribes to, itself or by one of its loops.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicUse {
    /// Its name, after renaming.
    pub name: String,
    /// What the component's part says of it.
    pub declared: TopicDeclaration,
    /// Whether it is published; it is subscribed to otherwise.
    pub is_published: bool,
}

impl Census {
    /// Counts the parts of the fleet that these composites come to with these options. What is wrong with replicas, conditions and settings
    /// is reported.
    pub fn of(
        contribution: &Contribution,
        registry: &Registry,
        options: &Options,
        sources: &Sources,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut severities = Severities::of(contribution, options, registry, diagnostics);
        let report = &mut Report::new(sources, diagnostics);
        let replicas = Arena::new();
        let mut fleet = unfold::unfold(contribution, options, &replicas, report);
        let parameters = Parameters::of(&fleet, options, report);
        report.finish();
        severities.apply(0, report.diagnostics());
        let topics = topics(&mut fleet, parameters, registry, sources);
        let mut counts: HashMap<(FileId, ElementId), usize> = HashMap::new();
        for composite in contribution.composites() {
            let special = composite.components.iter();
            let special = special.filter(|one| one.replicas.is_some() || one.condition.is_some());
            counts.extend(special.map(|one| ((one.origin.file(), one.origin.element), 0)));
        }
        for member in fleet.members.iter().filter(|member| !member.is_absent) {
            let origin = member.component.origin;
            if let Some(count) = counts.get_mut(&(origin.file(), origin.element)) {
                *count += 1;
            }
        }
        counts.extend(fleet.conditional.iter().map(|(place, is_there)| (*place, usize::from(*is_there))));
        Self { counts, topics }
    }

    /// How many times a part is there; `None` for one that is neither replicated nor conditional.
    pub fn count(&self, origin: Origin) -> Option<usize> {
        self.counts.get(&(origin.file(), origin.element)).copied()
    }

    /// Whether it is there at all.
    pub fn is_there(&self, origin: Origin) -> bool {
        self.count(origin) != Some(0)
    }

    /// The topics that a component and its loops use, those of all its replicas.
    pub fn topics(&self, origin: Origin) -> &[TopicUse] {
        self.topics.get(&(origin.file(), origin.element)).map_or(&[], Vec::as_slice)
    }
}

/// The topics of all components whose classes are known, found in the way in which the checker finds them. What is wrong with them is
/// left to it.
fn topics<'a>(
    fleet: &mut Fleet<'a>,
    mut parameters: Parameters<'a>,
    registry: &'a Registry,
    sources: &Sources,
) -> HashMap<(FileId, ElementId), Vec<TopicUse>> {
    let mut unheard = Diagnostics::new();
    let report = &mut Report::new(sources, &mut unheard);
    report.assumes = true;
    let mut classes = classes::resolve(fleet, fleet.contribution, registry, true, report);
    let checked = super::properties(fleet, &classes, &mut parameters, report);
    loops::resolve(fleet, &mut classes, &checked, registry, &mut parameters, report);
    let mut all: HashMap<_, Vec<TopicUse>> = HashMap::new();
    let mut before = task::Before::default();
    for (member, checked) in fleet.members.iter().zip(&checked).filter(|(member, _)| !member.is_absent) {
        let (Kind::Class(index), Some(checked)) = (member.kind, checked) else { continue };
        let class = &classes[index];
        let is_periodic = class.class.declaration().is_periodic();
        let renames = match is_periodic {
            true => task::check(member.component, (index, class), checked, &mut before, report).renames,
            false => Vec::new(),
        };
        let origin = member.component.origin;
        let uses = all.entry((origin.file(), origin.element)).or_default();
        let published = class.publishes.iter().map(|topic| (*topic, true));
        for (declared, is_published) in published.chain(class.subscribes.iter().map(|topic| (*topic, false)))
        {
            let renamed = renames.iter().find(|(old, _)| *old == declared.name);
            let name = renamed.map_or(&declared.name, |(_, new)| new);
            if !uses.iter().any(|one| one.name == *name && one.is_published == is_published) {
                uses.push(TopicUse { name: name.clone(), declared: declared.clone(), is_published });
            }
        }
    }
    all
}
