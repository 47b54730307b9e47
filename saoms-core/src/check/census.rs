//! What of the composites is in the fleet, and how many times, for pictures of them.

use std::collections::HashMap;

use super::arena::Arena;
use super::options::Options;
use super::parameters::Parameters;
use super::report::Report;
use super::unfold;
use crate::diagnostic::Diagnostics;
use crate::model::{Contribution, Origin};
use crate::source::{FileId, Sources};
use crate::xml::ElementId;

/// How many times each replicated or conditional part of the composites is in a fleet.
#[derive(Clone, Debug, Default)]
pub struct Census {
    counts: HashMap<(FileId, ElementId), usize>,
}

impl Census {
    /// Counts the parts of the fleet that these composites come to with these options. What is wrong with replicas, conditions and settings
    /// is reported.
    pub fn of(
        contribution: &Contribution,
        options: &Options,
        sources: &Sources,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let report = &mut Report::new(sources, diagnostics);
        let replicas = Arena::new();
        let fleet = unfold::unfold(contribution, options, &replicas, report);
        Parameters::of(&fleet, options, report);
        report.finish();
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
        Self { counts }
    }

    /// How many times a part is there; `None` for one that is neither replicated nor conditional.
    pub fn count(&self, origin: Origin) -> Option<usize> {
        self.counts.get(&(origin.file(), origin.element)).copied()
    }

    /// Whether it is there at all.
    pub fn is_there(&self, origin: Origin) -> bool {
        self.count(origin) != Some(0)
    }
}
