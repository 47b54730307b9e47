//! The report for people.

use std::fmt::Write;

use saoms_api::extension::RunSummary;
use saoms_api::host::one_line;
use saoms_core::journal::Journal;
use saoms_core::report::{ComponentReport, RunReport, RunStatus};

use crate::output::counted;

/// Components that the table shows at most; the report file has all.
const ROWS: usize = 24;

/// The report in a few lines: the outcome of the run, and a line per component. `keeps_all` says that a file has all
/// records of the journal.
pub(crate) fn summary(report: &RunReport, keeps_all: bool) -> String {
    let mut text = format!("\n{}\n", ending(report));
    text.push_str(&table(&report.components));
    text.push_str(&problem_lines(&report.components));
    if let Some(adaptation) = report.adaptation.as_ref().filter(|adaptation| !adaptation.kinds.is_empty()) {
        let _ = write!(text, "\n{adaptation}");
    }
    text.push_str(&journal(&report.journal, keeps_all));
    if let Some(hash) = &report.trace_hash {
        let _ = writeln!(text, "\nseed {}, trace {hash}", report.seed);
    }
    text
}

/// The outcome of the run, and its reasons below.
pub(crate) fn ending(report: &RunReport) -> String {
    let mut text = format!("{}\n", outcome(report));
    for reason in &report.outcome.reasons {
        let _ = writeln!(text, "  {}", one_line(reason));
    }
    text
}

/// The outcome of the run and its results, in one line.
pub(crate) fn outcome(report: &RunReport) -> String {
    let how = match report.outcome.status {
        RunStatus::Done => "done",
        RunStatus::Elapsed => "time limit reached",
        RunStatus::Stopped => "stopped",
        RunStatus::Incomplete => "incomplete",
        RunStatus::Failed => "failed",
        RunStatus::Interrupted => "interrupted",
    };
    let mut text = format!("{how} after {:.3} s", report.time_s);
    let count = |path: &str| report.count(path);
    let results = RunSummary::linked().into_iter().filter_map(|summary| (summary.result)(&count));
    for (place, result) in results.enumerate() {
        let _ = write!(text, "{} {result}", if place == 0 { ":" } else { ";" });
    }
    text
}

/// The records missing in the journal; usually none.
fn journal(journal: &Journal, keeps_all: bool) -> String {
    let mut text = String::new();
    if journal.overwritten > 0 && !keeps_all {
        let _ = writeln!(
            text,
            "\njournal: {} of {} records were overwritten by newer ones; --journal FILE keeps all",
            journal.overwritten, journal.records
        );
    }
    if journal.lost > 0 {
        let from = if keeps_all { "in the file" } else { "measured" };
        let _ = writeln!(text, "\njournal: {} of {} records are not {from}", journal.lost, journal.records);
    }
    text
}

/// Rare counts, for which the table has no column: a line for each component that had trouble.
fn problem_lines(components: &[ComponentReport]) -> String {
    let lines = components.iter().filter_map(|one| {
        let counts = [
            (one.failures, "failure", ""),
            (one.deadline_misses, "execution", " ended after the deadline"),
            (one.slow, "execution", " took longer than the budget"),
            (one.busy, "execution", " skipped, as a component that it calls was busy"),
        ];
        let lines: Vec<String> = counts
            .iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, noun, what)| {
                format!("{}{what}", counted(usize::try_from(*count).unwrap_or(usize::MAX), noun))
            })
            .collect();
        (!lines.is_empty()).then(|| format!("{}: {}\n", one_line(&one.name), lines.join(", ")))
    });
    let mut lines: Vec<String> = lines.collect();
    let more = lines.len().saturating_sub(ROWS);
    lines.truncate(ROWS);
    let mut text = if lines.is_empty() { String::new() } else { format!("\n{}", lines.concat()) };
    if more > 0 {
        let _ = writeln!(text, "and {more} more: see --report");
    }
    text
}

fn table(components: &[ComponentReport]) -> String {
    let shown = &components[..components.len().min(ROWS)];
    let name_width =
        shown.iter().map(|one| one_line(&one.name).chars().count()).max().unwrap_or(0).max("component".len());
    let class_width = shown.iter().map(|one| one.class.chars().count()).max().unwrap_or(0).max("class".len());
    let mut text = format!(
        "{:name_width$}  {:class_width$}  executions  missed  late us p50/p99/max  restarts  dropped\n",
        "component", "class"
    );
    for one in shown {
        let late = format!("{}/{}/{}", one.late_us.p50, one.late_us.p99, one.late_us.max);
        let _ = writeln!(
            text,
            "{:name_width$}  {:class_width$}  {:>10}  {:>6}  {late:>19}  {:>8}  {:>7}",
            one_line(&one.name),
            one.class,
            one.executions,
            one.missed,
            one.restarts,
            one.dropped
        );
    }
    if components.len() > shown.len() {
        let _ = writeln!(text, "and {} more: see --report", components.len() - shown.len());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_in_the_journal_is_told() {
        let mut one = Journal::default();
        one.records = 9;
        assert_eq!(journal(&one, false), "");
        one.overwritten = 4;
        assert_eq!(
            journal(&one, false),
            "\njournal: 4 of 9 records were overwritten by newer ones; --journal FILE keeps all\n"
        );
        assert_eq!(journal(&one, true), "", "it is kept");
    }

    #[test]
    fn trouble_is_told_below_the_table() {
        let quiet = ComponentReport { name: "Quiet".into(), executions: 9, ..ComponentReport::default() };
        assert_eq!(problem_lines(std::slice::from_ref(&quiet)), "");
        let late = ComponentReport { name: "Late".into(), deadline_misses: 2, ..quiet.clone() };
        let weak = ComponentReport { name: "Weak".into(), failures: 1, slow: 1, ..ComponentReport::default() };
        assert_eq!(
            problem_lines(&[quiet, late.clone(), weak]),
            "\nLate: 2 executions ended after the deadline\nWeak: 1 failure, 1 execution took longer than the budget\n"
        );
        let many = problem_lines(&vec![late; ROWS + 3]);
        assert!(many.ends_with("and 3 more: see --report\n"), "{many}");
    }
}
