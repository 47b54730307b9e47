//! Whether the values of each component fit together, as its constructor sees it.

use std::panic::{AssertUnwindSafe, catch_unwind};

use saoms_api::PropertyValue;

use super::classes::ClassIndex;
use super::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Component;

/// Constructs the component once, for its judgement on the values, and drops it: constructors do no work.
pub(super) fn check(
    component: &Component,
    class: &ClassIndex<'_>,
    values: &[(String, PropertyValue)],
    report: &mut Report<'_>,
) {
    let construct = || class.class.construct(values).map(drop);
    let message = match catch_unwind(AssertUnwindSafe(construct)) {
        Ok(Ok(())) => return,
        Ok(Err(failure)) => failure.message().to_owned(),
        Err(panic) => format!("its constructor panicked: {}", said(&*panic)),
    };
    let message = format!("component {}: {message}", quoted(&component.name));
    let help = format!(
        "{} says what its properties mean",
        quoted(&format!("saoms components {}", class.class.name()))
    );
    report.push(Diagnostic::new(&codes::CONSTRUCTION, component.name.location, message).help(help));
}

fn said(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("without a word")
}
