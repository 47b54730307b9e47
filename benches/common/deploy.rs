//! From the text of a composite to a fleet, as the command does it.

use std::sync::Arc;
use std::time::{Duration, Instant};

// Its classes are found only where the crate is used.
use saoms_components as _;
use saoms_core::report::{RunReport, RunStatus};
use saoms_core::schedule::{Fleet, Settings};
use saoms_lang::assembly::Assembly;
use saoms_lang::check::{Options, check};
use saoms_lang::diagnostic::{Diagnostics, Severity, human};
use saoms_lang::load::load_file;
use saoms_lang::model::Contribution;
use saoms_lang::registry::Registry;
use saoms_lang::source::Sources;

use super::Outcome;

/// A checked composite, and how long its way took.
pub(crate) struct Checked {
    pub(crate) assembly: Assembly,
    pub(crate) load: Duration,
    pub(crate) check: Duration,
}

/// Loads and checks the text of a composite.
pub(crate) fn checked(text: String) -> Outcome<Checked> {
    let registry = Registry::linked()?;
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let start = Instant::now();
    let file = sources.add("benchmark.composite", text);
    let composite = load_file(file, &sources, &mut diagnostics);
    let loaded = Instant::now();
    let assembly = composite.and_then(|one| {
        let fleet = Contribution::of(vec![one]);
        check(&fleet, &registry, &Options::default(), &sources, &mut diagnostics)
    });
    let done = Instant::now();
    match assembly {
        Some(assembly) => Ok(Checked { assembly, load: loaded - start, check: done - loaded }),
        None => {
            let first = diagnostics.into_sorted().into_iter().find(|one| one.severity == Severity::Error);
            Err(human(first.as_slice(), &sources, false).into())
        }
    }
}

/// Starts the fleet of a composite. Nobody is told what happens in it.
pub(crate) fn start(assembly: Assembly, settings: Settings) -> Outcome<Fleet> {
    Ok(Fleet::start(assembly, settings, Vec::new())?)
}

/// The report of a fleet that has to end without a failure.
pub(crate) fn finish(fleet: Fleet) -> Outcome<RunReport> {
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
