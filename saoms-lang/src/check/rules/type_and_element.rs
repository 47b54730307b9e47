//! Properties that have both a `type` and an `element`.

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Part, Property};
use crate::source::{Location, Text};

/// A place for a text that may be empty.
fn at(text: &Text, otherwise: Location) -> Location {
    if text.is_empty() { otherwise } else { text.location }
}

pub(crate) fn check(property: &Property, rule: &'static str, report: &mut Report<'_>) {
    if let (Some(of), Some(element)) = (property.r#type(), property.element()) {
        let message = format!("the property {} has both a `type` and an `element`", quoted(&property.name));
        let one = Diagnostic::new(&codes::TYPE_AND_ELEMENT, at(element, property.tag()), message);
        report.push(one.rule(rule).label(at(of, property.tag()), "the other one").help("remove one of them"));
    }
}
