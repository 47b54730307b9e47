//! Results, as a page of tables and as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::common::{self, Outcome, median};
use crate::goals;
use crate::rounds::{AtSize, Measured, OfContender};
use crate::run::Run;

/// A figure of one round of one contender.
pub(crate) type Figure = fn(&Run) -> f64;

pub(crate) fn p50(run: &Run) -> f64 {
    run.latenesses.quantile_us(0.5)
}

pub(crate) fn p99(run: &Run) -> f64 {
    run.latenesses.quantile_us(0.99)
}

/// Processor time in us per execution, which is also seconds per million executions.
pub(crate) fn cpu(run: &Run) -> f64 {
    run.cpu.as_secs_f64() * 1e6 / run.executions as f64
}

/// Prints the page and writes it to a file.
pub(crate) fn write(measured: &Measured) -> Outcome<()> {
    common::write("lateness", &page(measured)?, &raw(measured))
}

fn page(measured: &Measured) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    writeln!(page, "Lateness of a periodic start. {}.", measured.machine)?;
    writeln!(
        page,
        "{} rounds, forwards and backwards in turn, {} s measured after {} s of warm-up; medians over the rounds.",
        measured.rounds, measured.seconds, measured.warm_up
    )?;
    for size in &measured.sizes {
        table(&mut page, size)?;
    }
    goals::table(&mut page, measured)?;
    Ok(page)
}

fn table(page: &mut String, size: &AtSize) -> std::fmt::Result {
    writeln!(page, "\n### {}\n", size.size)?;
    writeln!(page, "| | p50 us | p99 us | p99.9 us | max us | missed | CPU s per million | MB | others % |")?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
    for result in &size.results {
        let title = result.contender.title;
        if let Some(failure) = &result.failure {
            writeln!(page, "| {title} | {} | | | | | | | |", failure.replace('|', "/"))?;
            continue;
        }
        let middle = |figure: Figure| median(result.runs().map(figure)).unwrap_or(f64::NAN);
        let missed: Option<u64> = result.runs().map(|run| run.missed).sum();
        writeln!(
            page,
            "| {title} | {:.0} | {:.0} | {:.0} | {:.0} | {} | {:.1} | {:.1} | {:.0} |",
            middle(p50),
            middle(p99),
            middle(|run| run.latenesses.quantile_us(0.999)),
            middle(|run| run.latenesses.quantile_us(1.0)),
            missed.map_or_else(|| "-".to_owned(), |missed| missed.to_string()),
            middle(cpu),
            middle(|run| run.memory.peak_kb as f64 / 1024.0),
            middle(|run| run.others * 100.0),
        )?;
    }
    Ok(())
}

impl OfContender {
    /// The rounds that were measured.
    pub(crate) fn runs(&self) -> impl Iterator<Item = &Run> {
        self.rounds.iter().flatten()
    }
}

fn raw(measured: &Measured) -> Value {
    let round = |run: &Option<Run>| {
        let run = run.as_ref()?;
        let late = |quantile| run.latenesses.quantile_us(quantile);
        Some(json!({
            "late_us": {"p50": late(0.5), "p90": late(0.9), "p99": late(0.99), "p99.9": late(0.999), "max": late(1.0)},
            "measured": run.latenesses.total(),
            "missed": run.missed,
            "cpu_us_per_execution": cpu(run),
            "resident_kb": run.memory.resident_kb,
            "peak_kb": run.memory.peak_kb,
            "others_share_of_a_core": run.others,
            "stolen_share_of_a_core": run.stolen,
        }))
    };
    let contender = |result: &OfContender| {
        json!({
            "name": result.contender.name,
            "failure": result.failure,
            "rounds": result.rounds.iter().map(round).collect::<Vec<_>>(),
        })
    };
    let size = |size: &AtSize| {
        json!({
            "size": size.size.to_string(),
            "contenders": size.results.iter().map(contender).collect::<Vec<_>>(),
        })
    };
    json!({
        "machine": measured.machine,
        "rounds": measured.rounds,
        "seconds": measured.seconds,
        "warm_up_seconds": measured.warm_up,
        "sizes": measured.sizes.iter().map(size).collect::<Vec<_>>(),
        "goals": goals::raw(measured),
    })
}
