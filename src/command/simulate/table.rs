//! The result of a simulation.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use serde::Serialize;
use serde_json::{Value, json};

use super::SimulateArguments;
use super::one::{RunSeed, SAME_TRACE, SeedResult, Simulation};
use super::shrink::shrunk;
use crate::arguments::FleetArguments;

/// The most failing seeds that the table shows, and whose faults are shrunk.
const MOST_SHOWN: usize = 20;
const MOST_SHRUNK: usize = 5;

/// The result of all seeds.
pub(super) struct Table {
    first: u64,
    results: Vec<SeedResult>,
    took: Duration,
    /// Seconds of processor time of all runs.
    cpu_s: f64,
    replays: Vec<Replay>,
}

/// How a failing seed is seen again.
#[derive(Clone, Debug, Serialize)]
struct Replay {
    seed: u64,
    command: String,
    /// Lines of faults with which it still fails; absent where none can be left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    faults: Option<Vec<String>>,
}

/// A figure of all runs.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    count: usize,
    total: f64,
    of: Option<f64>,
    least: f64,
    most: f64,
}

impl Sum {
    fn add(&mut self, value: f64, of: Option<f64>) {
        (self.least, self.most) = match self.count {
            0 => (value, value),
            _ => (self.least.min(value), self.most.max(value)),
        };
        self.count += 1;
        self.total += value;
        self.of = of.map(|of| self.of.unwrap_or_default() + of);
    }

    fn mean(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.total / self.count as f64 }
    }
}

impl Table {
    /// The result of the runs of this fleet.
    pub(super) fn of(
        (arguments, fleet): (&SimulateArguments, &FleetArguments),
        runs: Vec<RunSeed>,
        took: Duration,
        simulation: &Simulation,
    ) -> Table {
        let cpu_s = runs.iter().map(|run| run.cpu_s).sum();
        let results: Vec<SeedResult> = runs.into_iter().map(|run| run.result).collect();
        let failing = results.iter().filter(|result| !result.is_clean()).enumerate();
        let replays = failing.map(|(place, result)| {
            let faults = (place < MOST_SHRUNK).then(|| shrunk(simulation, result)).flatten();
            let faults = faults.map(|events| events.iter().map(|event| event.line()).collect());
            Replay { seed: result.seed, command: replay(arguments, fleet, result), faults }
        });
        let replays = replays.collect();
        Table { first: arguments.first, results, took, cpu_s, replays }
    }

    /// True if no run violated an invariant or failed.
    pub(super) fn is_clean(&self) -> bool {
        self.results.iter().all(SeedResult::is_clean)
    }

    /// How many runs ended in which way.
    fn statuses(&self) -> BTreeMap<&str, usize> {
        let mut all = BTreeMap::new();
        self.results.iter().for_each(|result| *all.entry(result.status.as_str()).or_default() += 1);
        all
    }

    /// How often each kind of fault was applied.
    fn faults(&self) -> BTreeMap<&str, u64> {
        let mut all = BTreeMap::new();
        for (kind, count) in self.results.iter().flat_map(|result| &result.faults) {
            *all.entry(kind.as_str()).or_default() += count;
        }
        all
    }

    /// The figures, in the order in which the first run has them.
    fn figures(&self) -> Vec<(&str, Sum)> {
        let mut all: Vec<(&str, Sum)> = Vec::new();
        for figure in self.results.iter().flat_map(|result| &result.measures) {
            let place = all.iter().position(|(name, _)| *name == figure.name);
            let place = place.unwrap_or_else(|| {
                all.push((&figure.name, Sum::default()));
                all.len() - 1
            });
            all[place].1.add(figure.value, figure.of);
        }
        all
    }

    /// By invariant: the number of violations and of the seeds with any.
    fn violations(&self) -> BTreeMap<&str, (usize, usize)> {
        let mut all: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for result in &self.results {
            let mut seen: Vec<&str> = Vec::new();
            for one in &result.violations {
                let entry = all.entry(one.invariant.as_str()).or_default();
                entry.0 += 1;
                if !seen.contains(&one.invariant.as_str()) {
                    seen.push(&one.invariant);
                    entry.1 += 1;
                }
            }
        }
        all
    }

    fn simulated(&self) -> f64 {
        self.results.iter().map(|result| result.time_s).sum()
    }

    fn periods(&self) -> u64 {
        self.results.iter().map(|result| result.periods).sum()
    }

    fn checks(&self) -> u64 {
        self.results.iter().map(|result| result.checks).sum()
    }

    /// How many hours of what were simulated in an hour of processor time.
    fn performance(&self) -> BTreeMap<&str, f64> {
        let mut all: BTreeMap<&str, f64> = BTreeMap::new();
        for one in self.results.iter().flat_map(|result| &result.simulated) {
            *all.entry(one.name.as_str()).or_default() += one.value;
        }
        all.retain(|_, hours| *hours > 0.0 && self.cpu_s > 0.0);
        all.values_mut().for_each(|hours| *hours /= self.cpu_s / 3600.0);
        all
    }

    pub(super) fn json(&self) -> Value {
        let figures = self.figures().into_iter().map(|(name, sum)| {
            let value = match sum.of {
                Some(of) => json!({ "total": sum.total, "of": of }),
                None => json!({ "mean": sum.mean(), "least": sum.least, "most": sum.most }),
            };
            (name.to_owned(), value)
        });
        let violations = self.violations().into_iter();
        let violations =
            violations.map(|(name, (count, seeds))| (name.to_owned(), json!({ "violations": count, "seeds": seeds })));
        json!({
            "first": self.first,
            "seeds": self.results.len(),
            "took_s": self.took.as_secs_f64(),
            "cpu_s": self.cpu_s,
            "performance": self.performance(),
            "simulated_s": self.simulated(),
            "periods": self.periods(),
            "checks": self.checks(),
            "runs": self.statuses(),
            "figures": figures.collect::<serde_json::Map<String, Value>>(),
            "faults": self.faults(),
            "violations": violations.collect::<serde_json::Map<String, Value>>(),
            "failing": self.replays,
            "results": self.results,
        })
    }
}

/// A word as a shell takes it.
fn quoted(text: String) -> String {
    match text.chars().all(|sign| sign.is_alphanumeric() || "._-/=:+,".contains(sign)) {
        true => text,
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

/// The files and settings of a fleet, as a command line has them.
pub(super) fn named(fleet: &FleetArguments) -> String {
    let files = fleet.files.iter().map(|path| quoted(path.display().to_string()));
    let settings = fleet.settings.iter().flat_map(|one| ["--set".to_owned(), quoted(one.clone())]);
    files.chain(settings).collect::<Vec<_>>().join(" ")
}

/// The command that shows a seed again.
fn replay(arguments: &SimulateArguments, fleet: &FleetArguments, result: &SeedResult) -> String {
    // A trace is compared with another one of its seed by a simulation alone.
    let runs_twice = result.violations.first().is_some_and(|first| first.invariant == SAME_TRACE);
    let command = if runs_twice { "simulate" } else { "run" };
    let mut words = vec!["saoms".to_owned(), command.to_owned(), named(fleet)];
    words.extend(
        fleet.plugins.plugins.iter().flat_map(|one| ["--plugin".to_owned(), quoted(one.display().to_string())]),
    );
    words.extend(fleet.severities.iter().flat_map(|one| ["--severity".to_owned(), quoted(one.clone())]));
    if fleet.allow_outside {
        words.push("--allow-outside".to_owned());
    }
    let seed = result.seed.to_string();
    match runs_twice {
        true => words.extend(["--seeds", "1", "--first", &seed].map(str::to_owned)),
        false => words.extend(["--virtual", "--invariants", "--seed", &seed].map(str::to_owned)),
    }
    words.extend(["--for".to_owned(), saoms_api::host::format_duration(arguments.limit)]);
    if let Some(path) = &arguments.faults {
        words.extend(["--faults".to_owned(), quoted(path.display().to_string())]);
    }
    words.join(" ")
}

/// A name and its value.
fn row(formatter: &mut fmt::Formatter<'_>, name: &str, value: &str) -> fmt::Result {
    writeln!(formatter, "{name:<27}{value}")
}

fn listed(all: Vec<String>) -> String {
    if all.is_empty() { "none".to_owned() } else { all.join(", ") }
}

impl Table {
    /// The rows of seeds, time and ends of runs.
    pub(super) fn runs(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let last = self.results.last().map_or(self.first, |result| result.seed);
        row(formatter, "seeds", &format!("{} to {last}: {}", self.first, self.results.len()))?;
        let hours = self.simulated() / 3600.0;
        let time = format!("{hours:.1} h simulated in {:.1} s, {} executions", self.took.as_secs_f64(), self.periods());
        row(formatter, "time", &time)?;
        let performance = self.performance().into_iter().map(|(name, rate)| format!("{rate:.0} {name} per CPU-hour"));
        let performance: Vec<String> = performance.collect();
        if !performance.is_empty() {
            row(formatter, "performance", &listed(performance))?;
        }
        row(formatter, "checks", &format!("{} messages held to the invariants", self.checks()))?;
        let statuses = self.statuses().into_iter().map(|(status, count)| format!("{status} {count}"));
        row(formatter, "runs", &listed(statuses.collect()))
    }

    /// The rows of faults and violations, and what shows failing seeds again.
    pub(super) fn failures(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let faults = self.faults().into_iter().map(|(kind, count)| format!("{kind} {count}"));
        row(formatter, "faults applied", &listed(faults.collect()))?;
        let stand = || self.results.iter().filter_map(|result| Some((result.seed, result.standstill.as_ref()?)));
        if let Some((seed, first)) = stand().next() {
            row(formatter, "standstills", &format!("{}, first seed {seed}: {first}", stand().count()))?;
        }
        let violations = self.violations();
        if violations.is_empty() {
            return row(formatter, "violations", "none");
        }
        for (name, (count, seeds)) in violations {
            row(formatter, "violations", &format!("{count} in {seeds} seeds: {name}"))?;
        }
        let failing = self.results.iter().filter(|result| !result.is_clean());
        for (result, replay) in failing.clone().zip(&self.replays).take(MOST_SHOWN) {
            let Some(first) = result.violations.first() else { continue };
            writeln!(formatter, "\nseed {}: [{:.3} s] {}: {}", result.seed, first.at_s, first.invariant, first.text)?;
            if let Some(standstill) = &result.standstill {
                writeln!(formatter, "  it stands still: {standstill}")?;
            }
            writeln!(formatter, "  {}", replay.command)?;
            match replay.faults.as_deref() {
                None => {}
                Some([]) => writeln!(formatter, "  it fails without the faults of the file, too")?,
                Some(lines) => {
                    writeln!(formatter, "  it fails with these lines alone:")?;
                    lines.iter().try_for_each(|line| writeln!(formatter, "    {line}"))?;
                }
            }
        }
        let hidden = failing.count().saturating_sub(MOST_SHOWN);
        if hidden > 0 {
            writeln!(formatter, "\n{hidden} more seeds with violations: `--report json` has all")?;
        }
        Ok(())
    }

    /// The results by seed.
    pub(super) fn results(&self) -> &[SeedResult] {
        &self.results
    }
}

impl fmt::Display for Table {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.runs(formatter)?;
        for (name, sum) in self.figures() {
            let value = match sum.of {
                Some(of) if of > 0.0 => format!("{} of {of} ({:.1} %)", sum.total, 100.0 * sum.total / of),
                Some(of) => format!("{} of {of}", sum.total),
                None => format!("{:.1} ({:.1} to {:.1})", sum.mean(), sum.least, sum.most),
            };
            row(formatter, name, &value)?;
        }
        self.failures(formatter)
    }
}
