//! Names of composites and paths of components, of which there can be one each.

use std::collections::{HashMap, HashSet};

use super::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Composite;
use crate::source::Location;

/// Checks that no two components have one path. Where nobody gives one, names alone see to that.
pub(crate) fn paths(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    if fleet.members.iter().all(|member| member.component.path().is_none()) {
        return;
    }
    let mut first: HashMap<&str, Location> = HashMap::with_capacity(fleet.members.len());
    for member in fleet.members.iter().filter(|one| !one.is_partial && !one.component.name.is_empty()) {
        let given = member.component.path();
        let place = given.unwrap_or(&member.component.name).location;
        let earlier = first.entry(member.path()).or_insert(place);
        if *earlier != place && given.is_some() {
            let message = format!("there are two components of the path {}", quoted(member.path()));
            let one = Diagnostic::new(&codes::COMPONENT_REPEATED, place, message);
            report.push(one.label(*earlier, "the first").help("give each its own path, or none"));
        }
    }
}

/// Checks that no two composites of one namespace have one name; the places of those that are there again, text for
/// text.
pub(crate) fn composites(composites: &[Composite], report: &mut Report<'_>) -> HashSet<usize> {
    let mut again = HashSet::new();
    let mut names: HashMap<(&str, &str), &Composite> = HashMap::new();
    let named = composites.iter().enumerate().filter(|(_, composite)| !composite.name.is_empty());
    for (place, composite) in named {
        let name = (composite.namespace(), composite.name.as_str());
        let Some(first) = names.get(&name) else {
            names.insert(name, composite);
            continue;
        };
        let message = format!("there are two composites {} in one namespace", quoted(name.1));
        report.push(
            Diagnostic::new(&codes::COMPOSITE_REPEATED, composite.name.location, message)
                .label(first.name.location, "the first")
                .help("give each its own name; was one file given twice?"),
        );
        if first.document.text() == composite.document.text() {
            again.insert(place);
        }
    }
    again
}
