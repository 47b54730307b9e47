//! Whether the values of each component fit together, as its constructor sees it.

use super::classes::ClassIndex;
use super::findings::{Subject, diagnostic};
use super::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use saoms_api::contain::contained;

/// Constructs the component once, for its judgement on the values, and drops it: constructors do no work.
///
/// What it finds is shown at the values that it is about, any other judgement at the component's name.
pub(super) fn check(subject: Subject<'_>, class: &ClassIndex<'_>, report: &mut Report<'_>) {
    let constructed = contained(|| class.class.construct(subject.values).map(drop));
    let Err(failure) = constructed.and_then(|result| result) else { return };
    let help = format!(
        "{} says what its properties mean",
        quoted(&format!("saoms components {}", class.class.name()))
    );
    if failure.findings().is_empty() {
        let message = format!("component {}: {failure}", quoted(subject.name));
        report.push(Diagnostic::new(&codes::CONSTRUCTION, subject.at, message).help(help));
        return;
    }
    for finding in failure.findings() {
        let one = diagnostic(&codes::CONSTRUCTION, Severity::Error, finding, subject, &|_| None, report);
        let Some(one) = one else { continue };
        report.push(if one.help.is_empty() && one.suggestions.is_empty() {
            one.help(help.clone())
        } else {
            one
        });
    }
}
