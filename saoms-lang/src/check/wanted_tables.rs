//! Tables of replicas whose names are expressions: which files they are is known when composites are unfolded.

use crate::check::options::Options;
use crate::check::report::{Report, severities::Severities};
use crate::check::unfolding;
use crate::check::unfolding::append_list::AppendList;
use crate::diagnostic::Diagnostics;
use crate::expression::has_expression;
use crate::model::{ComponentElement, Contribution};
use crate::registry::Registry;
use crate::source::{Location, Sources, Text};

/// The files of the tables that a fleet needs and that are not read yet: each name where it is written, and the place
/// of the attribute `overrides` that comes to it. What is wrong with the fleet is left to the check.
pub fn wanted_tables(
    contribution: &Contribution,
    registry: &Registry,
    options: &Options,
    sources: &Sources,
) -> Vec<(Text, Location)> {
    let is_open = |component: &ComponentElement| {
        let overrides = component.replicas.as_ref().and_then(|replicas| replicas.overrides.as_ref());
        overrides.is_some_and(|file| has_expression(file))
    };
    if !contribution.composites().iter().flat_map(|composite| &composite.components).any(is_open) {
        return Vec::new();
    }
    let mut dropped = Diagnostics::new();
    let severities = Severities::of(contribution, options, registry, &mut dropped);
    let report = &mut Report::new(sources, &mut dropped);
    unfolding::unfold(contribution, options, &severities, &AppendList::new(), report).wanted_tables
}
