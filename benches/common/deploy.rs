//! Deployment: from the text of a composite to a fleet, as in the command.

use std::sync::Arc;
use std::time::{Duration, Instant};

// The crate has to be linked for its classes to be registered.
use saoms_components as _;
use saoms_core::report::{RunReport, RunStatus};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use saoms_lang::diagnostic::Severity;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_tools::diagnostics::Human;

use super::Outcome;

/// A checked composite, and the time that this took.
pub(crate) struct Checked {
    pub(crate) assembly: Assembly,
    pub(crate) load: Duration,
    pub(crate) check: Duration,
}

/// Loads and checks the text of a composite.
pub(crate) fn checked(text: String) -> Outcome<Checked> {
    let registry = Registry::linked()?;
    let project = Project::new().text("benchmark.composite", text).in_memory();
    let start = Instant::now();
    let loaded = project.load(&registry);
    let read = Instant::now();
    let mut found = loaded.compile();
    let done = Instant::now();
    match found.output.take() {
        Some(assembly) => Ok(Checked { assembly, load: read - start, check: done - read }),
        None => {
            let first = found.reported().find(|one| one.severity == Severity::Error);
            Err(Human::of(first, &found.sources, false).to_string().into())
        }
    }
}

/// Starts the fleet of a composite, without an observer.
pub(crate) fn start(assembly: Assembly, settings: Settings) -> Outcome<RunningFleet> {
    Ok(RunningFleet::start(assembly, settings, Vec::new())?)
}

/// Runs a fleet to its end, without a failure, and returns its report.
pub(crate) fn finish(fleet: RunningFleet) -> Outcome<RunReport> {
    let report = fleet.run_to_end();
    match report.outcome.status {
        RunStatus::Failed => {
            let reasons = &report.outcome.reasons;
            let first = reasons.first().map_or("without a reason", String::as_str);
            Err(format!("the run failed: {first} ({} reasons)", reasons.len()).into())
        }
        _ => Ok(report),
    }
}
