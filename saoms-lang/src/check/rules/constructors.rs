//! Constructors: each judges whether the values of its component fit together. It is called once, and what it makes is
//! dropped: constructors do no work.

use std::collections::BTreeSet;
use std::path::Path;

use crate::check::component::{ComponentCheck, ComponentState};
use crate::check::fleet::Fleet;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::loops;
use crate::check::options::Options;
use crate::check::properties::findings::{Subject, diagnostic};
use crate::check::properties::unread;
use crate::check::report::Report;
use crate::check::rules::languages::Languages;
use crate::check::tasks::unique_values::RepeatedValues;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::expression::has_expression;
use crate::registry::PropertyDeclaration;
use saoms_api::host::{PropertyValue, contain::contained, one_line, present};
use saoms_api::{Failure, Finding};
use smol_str::SmolStr;

/// Judges a component some of whose values are not known, for faults that are reported: `unsure` are the places of
/// these properties. What the constructor finds about the others is reported if it finds it with the unknown ones at
/// both ends of what is allowed, so that a wrong value has no consequences.
fn partly(
    subject: Subject<'_>,
    class: &ClassIndex<'_>,
    unsure: &[usize],
    repeated: &RepeatedValues,
    report: &mut Report<'_>,
) {
    let construct = |values: &[(SmolStr, PropertyValue)]| dropped(class.class.construct(values));
    let unsure: Vec<&PropertyDeclaration> = unsure.iter().filter_map(|place| class.table.all[*place].own()).collect();
    if unsure.is_empty() {
        let class = (class.class.name(), class.class.origin());
        return judge(|| construct(subject.values), subject, class, repeated, report);
    }
    let ends: Option<Vec<[PropertyValue; 2]>> = unsure.iter().map(|one| one.ends()).collect();
    let Some(ends) = ends else { return };
    let is_unsure = |name: &str| unsure.iter().any(|one| one.name == name);
    let with = |end: usize| {
        let known = subject.values.iter().filter(|(name, _)| !is_unsure(name)).cloned();
        let assumed = unsure.iter().zip(&ends);
        let assumed = assumed.map(|(one, ends)| (one.name.as_str().into(), ends[end].clone()));
        known.chain(assumed).collect()
    };
    let mut tries: Vec<Vec<(SmolStr, PropertyValue)>> = vec![with(0), with(1)];
    if unsure.iter().all(|one| !one.required) {
        tries.push(subject.values.to_vec());
    }
    let mut found: Option<Vec<Finding>> = None;
    for values in tries.iter().rev() {
        let Err(failure) = contained(|| present::about(subject.name, || construct(values))).and_then(|result| result)
        else {
            return;
        };
        match &mut found {
            None => found = Some(failure.findings().to_vec()),
            Some(found) => found.retain(|one| failure.findings().contains(one)),
        }
    }
    let is_given = |finding: &Finding| {
        let name = finding.place().property_name();
        name.is_some_and(|name| !is_unsure(name) && subject.gives(name))
    };
    let found: Vec<Finding> = found.unwrap_or_default().into_iter().filter(is_given).collect();
    findings(&found, subject, class.class.name(), repeated, report);
}

/// The judgement alone. A panic of a destructor is none: it harms no fleet.
fn dropped<T>(made: Result<T, Failure>) -> Result<(), Failure> {
    made.map(|made| drop(contained(|| drop(made))))
}

/// Reports the findings of a constructor at the values that they are about, any other judgement at the name.
fn judge(
    construct: impl FnOnce() -> Result<(), Failure>,
    subject: Subject<'_>,
    (class, library): (&str, Option<&Path>),
    repeated: &RepeatedValues,
    report: &mut Report<'_>,
) {
    let about = format!("{} {}", subject.what, quoted(subject.name));
    let construct = || present::about(&about, construct);
    let Err(failure) = contained(construct).and_then(|result| result) else { return };
    if failure.findings().is_empty() {
        let library = library.map(|path| format!(" (library `{}`)", one_line(&path.display().to_string())));
        let message = format!("{about}: {failure}{}", library.unwrap_or_default());
        report.push(Diagnostic::new(&codes::CONSTRUCTION, subject.at, message).help(help(class)));
        return;
    }
    findings(failure.findings(), subject, class, repeated, report);
}

fn findings(
    findings: &[Finding],
    subject: Subject<'_>,
    class: &str,
    repeated: &RepeatedValues,
    report: &mut Report<'_>,
) {
    for finding in findings {
        let one = diagnostic(&codes::CONSTRUCTION, Severity::Error, finding, subject, &|_| None, report);
        let Some(one) = one else { continue };
        // A value that replicas share is faulty already.
        if repeated.is_of_replicas(one.location) {
            continue;
        }
        // The text of an expression that nobody reads is wrong for that alone.
        let is_unread = |text: &&str| has_expression(text) && !report.has_index() || unread::source(text).is_some();
        if let Some(text) = subject.text(finding.place()).filter(is_unread) {
            let whole = subject.written(finding.place());
            [Some(one.location), whole].iter().flatten().for_each(|at| report.withdraw(&codes::EXPRESSION_UNREAD, *at));
            report.push(unread::diagnostic(&codes::CONSTRUCTION, text, one.location).help(one.message));
            continue;
        }
        let is_plain = one.help.is_empty() && one.suggestions.is_empty();
        report.push(if is_plain { one.help(help(class)) } else { one });
    }
}

fn help(class: &str) -> String {
    format!("{} describes its properties", quoted(&format!("saoms components {class}")))
}

/// Lets the constructors of all components judge their values.
pub(crate) fn check_all(
    fleet: &Fleet<'_>,
    checks: &[ComponentCheck<'_>],
    repeated: &RepeatedValues,
    options: &Options,
    report: &mut Report<'_>,
) {
    saoms_api::host::contain::install_hook();
    let languages = Languages::of(fleet, checks);
    let mut unloadable = BTreeSet::new();
    // A library that cannot be loaded is told once, and has nothing to do with values.
    let mut loads =
        |origin: Option<&Path>, loaded: Result<(), Failure>, subject: Subject<'_>, report: &mut Report<'_>| {
            let Err(failure) = loaded else { return true };
            if unloadable.insert(origin.map(Path::to_owned)) {
                let message = format!("{} {}: {failure}", subject.what, quoted(subject.name));
                report.push(Diagnostic::new(&codes::CONSTRUCTION, subject.at, message));
            }
            false
        };
    let is_asked =
        |origin: Option<&Path>, is_only_read: bool| !is_only_read && (!options.without_plugin_code || origin.is_none());
    let all = || {
        let all = fleet.members.iter().zip(checks).enumerate();
        all.filter_map(|(place, (member, check))| Some((member, check, fleet.class_of(place)?)))
    };
    for (member, check, of) in all().filter(|(_, check, _)| check.is_sound()) {
        report.about(member);
        let (subject, class) = (check.subject(member), of.class);
        let found = languages.judge(member, subject, &class.declaration().properties, report);
        if !found.is_empty() {
            findings(&found, subject, class.name(), repeated, report);
        } else if is_asked(class.origin(), class.is_only_read()) && loads(class.origin(), class.load(), subject, report)
        {
            let name = (class.name(), class.origin());
            judge(|| dropped(class.construct(subject.values)), subject, name, repeated, report);
        }
        for (class, subject) in check.loops.iter().flat_map(loops::Resolved::changed) {
            if is_asked(class.origin(), class.is_only_read()) && loads(class.origin(), class.load(), subject, report) {
                let name = (class.name(), class.origin());
                judge(|| dropped(class.construct(subject.values)), subject, name, repeated, report);
            }
        }
    }
    let faulty = all().filter(|(member, check, _)| check.state == ComponentState::Faulty && !member.lacks_table());
    for (member, check, class) in faulty.filter(|(.., one)| is_asked(one.class.origin(), one.class.is_only_read())) {
        report.about(member);
        let subject = check.subject(member);
        if loads(class.class.origin(), class.class.load(), subject, report) {
            partly(subject, class, &check.given.unknown, repeated, report);
        }
    }
    report.about_all();
}
