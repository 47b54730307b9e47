//! Whether the values of each component fit together, as its constructor sees it.

use super::classes::ClassIndex;
use super::findings::{Subject, diagnostic};
use super::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::registry::LoopClass;
use saoms_api::{Failure, contain::contained};

/// Constructs the component once, for its judgement on the values, and drops it: constructors do no work.
pub(super) fn component(
    subject: Subject<'_>,
    class: &ClassIndex<'_>,
    without_plugin_code: bool,
    report: &mut Report<'_>,
) {
    if without_plugin_code && class.class.origin().is_some() {
        return;
    }
    judge(|| class.class.construct(subject.values).map(drop), subject, class.class.name(), report);
}

/// The same for a loop.
pub(super) fn looping(
    subject: Subject<'_>,
    class: &LoopClass,
    without_plugin_code: bool,
    report: &mut Report<'_>,
) {
    if without_plugin_code && class.origin().is_some() {
        return;
    }
    judge(|| class.construct(subject.values).map(drop), subject, class.name(), report);
}

/// What a constructor finds is shown at the values that it is about, any other judgement at the name.
fn judge(
    construct: impl FnOnce() -> Result<(), Failure>,
    subject: Subject<'_>,
    class: &str,
    report: &mut Report<'_>,
) {
    let Err(failure) = contained(construct).and_then(|result| result) else { return };
    let help = format!("{} says what its properties mean", quoted(&format!("saoms components {class}")));
    if failure.findings().is_empty() {
        let message = format!("{} {}: {failure}", subject.what, quoted(subject.name));
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
