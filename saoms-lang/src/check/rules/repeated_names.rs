//! Names that have to be unique in one element.

use std::collections::HashMap;

use crate::check::report::Report;
use crate::diagnostic::Diagnostic;
use crate::source::{Location, Text};

/// Reports each name that occurs before, by this diagnostic about it.
pub(crate) fn check<'a>(
    names: impl Iterator<Item = &'a Text> + Clone,
    repeated: impl Fn(&Text) -> Diagnostic,
    report: &mut Report<'_>,
) {
    /// So many are compared with each other sooner than they are in a table.
    const FEW: usize = 8;
    let is_repeated = |(place, name): (usize, &Text)| names.clone().take(place).any(|one| one.value == name.value);
    if names.clone().nth(FEW).is_none() && !names.clone().enumerate().any(is_repeated) {
        return;
    }
    let mut first: HashMap<&str, Location> = HashMap::new();
    for name in names.filter(|name| !name.is_empty()) {
        match first.get(name.as_str()) {
            Some(first) => report.push(repeated(name).label(*first, "the first")),
            None => _ = first.insert(name, name.location),
        }
    }
}
