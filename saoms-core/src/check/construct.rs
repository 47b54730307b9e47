//! Whether the values of each component fit together, as its constructor sees it.

use saoms_api::PropertyValue;

use super::classes::ClassIndex;
use super::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Component;
use crate::registry::contain::contained;

/// Constructs the component once, for its judgement on the values, and drops it: constructors do no work.
pub(super) fn check(
    component: &Component,
    class: &ClassIndex<'_>,
    values: &[(String, PropertyValue)],
    report: &mut Report<'_>,
) {
    let Err(failure) = contained(|| class.class.construct(values).map(drop)).and_then(|result| result) else {
        return;
    };
    let message = format!("component {}: {failure}", quoted(&component.name));
    let help = format!(
        "{} says what its properties mean",
        quoted(&format!("saoms components {}", class.class.name()))
    );
    report.push(Diagnostic::new(&codes::CONSTRUCTION, component.name.location, message).help(help));
}
