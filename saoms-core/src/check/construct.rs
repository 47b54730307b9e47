//! Whether the values of each component fit together, as its constructor sees it.

use saoms_api::PropertyValue;

use super::classes::ClassIndex;
use super::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Component;
use crate::source::Location;
use saoms_api::contain::contained;

/// Constructs the component once, for its judgement on the values, and drops it: constructors do no work.
///
/// A judgement that begins with "property `NAME`" is shown at what `places` has for that property, any other at the component's name.
pub(super) fn check(
    component: &Component,
    class: &ClassIndex<'_>,
    values: &[(String, PropertyValue)],
    places: &[(String, Location)],
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
    let named = failure.message().strip_prefix("property `").and_then(|rest| Some(rest.split_once('`')?.0));
    let place = named.and_then(|name| places.iter().find(|(given, _)| given == name));
    let at = place.map_or(component.name.location, |(_, place)| *place);
    report.push(Diagnostic::new(&codes::CONSTRUCTION, at, message).help(help));
}
