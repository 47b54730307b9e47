//! One run of a simulation.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use saoms_core::adaptation::{AdaptationReport, Spread};
use saoms_core::observe::{AdaptationWatch, InvariantWatch, Observer};
use saoms_core::report::RunStatus;
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use serde::{Deserialize, Serialize};

use crate::command::run::faults::{FaultScript, Known, PlannedEvent};

/// What is run with each seed.
pub(super) struct Simulation {
    pub(super) assembly: Assembly,
    pub(super) known: Known,
    pub(super) script: Option<FaultScript>,
    pub(super) limit: Duration,
    pub(super) first: u64,
    /// True if the figures have how the fleet adapted.
    pub(super) is_measured: bool,
}

/// What came of one seed.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct SeedResult {
    pub(super) seed: u64,
    /// How the run ended, as its report says it.
    pub(super) status: String,
    pub(super) reasons: Vec<String>,
    /// What stands still, if that ended the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) standstill: Option<String>,
    pub(super) time_s: f64,
    pub(super) periods: u64,
    /// Number of messages that the invariants judged.
    #[serde(default)]
    pub(super) checks: u64,
    pub(super) trace_hash: Option<String>,
    /// How often each kind of fault was applied.
    pub(super) faults: BTreeMap<String, u64>,
    pub(super) measures: Vec<Figure>,
    /// Hours of what was simulated.
    #[serde(default)]
    pub(super) simulated: Vec<Figure>,
    pub(super) violations: Vec<Found>,
    /// Number of violations beyond those that are listed.
    pub(super) more: usize,
}

/// A seed that was run, and what that took. Its result is the same each time, and the time is not.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct RunSeed {
    pub(super) result: SeedResult,
    /// Seconds of processor time of its run; of the first one, if it ran twice.
    pub(super) cpu_s: f64,
}

impl From<SeedResult> for RunSeed {
    /// A seed that took no time.
    fn from(result: SeedResult) -> RunSeed {
        RunSeed { result, cpu_s: 0.0 }
    }
}

/// A figure of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Figure {
    pub(super) name: String,
    pub(super) value: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) of: Option<f64>,
}

/// A violation of an invariant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Found {
    pub(super) invariant: String,
    pub(super) at_s: f64,
    pub(super) text: String,
}

/// The most violations of one run that are listed.
const MOST: usize = 20;
/// Each so many seeds, from the first one on, one is run twice.
const TWICE: u64 = 10;
pub(super) const SAME_TRACE: &str = "9 the same seed has the same trace";
const RUNS: &str = "the run does not fail";

impl SeedResult {
    pub(super) fn is_clean(&self) -> bool {
        self.violations.is_empty()
    }

    /// A seed whose run gave no result.
    pub(super) fn failed(seed: u64, why: String) -> SeedResult {
        let violations = vec![Found { invariant: RUNS.to_owned(), at_s: 0.0, text: why }];
        SeedResult { seed, status: "crashed".to_owned(), violations, ..SeedResult::default() }
    }
}

impl Simulation {
    /// The events of the script with this seed.
    pub(super) fn events(&self, seed: u64) -> Result<Vec<PlannedEvent>, String> {
        let events = self.script.as_ref().map(|script| script.events(&self.known, seed));
        events.map_or(Ok(Vec::new()), |planned| planned.map(|planned| planned.events)).map_err(|wrong| wrong.concat())
    }

    /// Runs a seed, some of them twice.
    pub(super) fn run(&self, seed: u64) -> RunSeed {
        let events = match self.events(seed) {
            Ok(events) => events,
            Err(why) => return SeedResult::failed(seed, why).into(),
        };
        let began = cpu_time();
        let mut result = self.run_with(seed, events.clone());
        let cpu_s = cpu_time().saturating_sub(began).as_secs_f64();
        if seed.wrapping_sub(self.first).is_multiple_of(TWICE) {
            let again = self.run_with(seed, events).trace_hash;
            if again != result.trace_hash {
                let hash = |hash: &Option<String>| hash.clone().unwrap_or_default();
                let text =
                    format!("one run has the trace {}, the other one {}", hash(&result.trace_hash), hash(&again));
                result.violations.push(Found { invariant: SAME_TRACE.to_owned(), at_s: 0.0, text });
            }
        }
        RunSeed { result, cpu_s }
    }

    /// Runs a seed with these events once.
    pub(super) fn run_with(&self, seed: u64, events: Vec<PlannedEvent>) -> SeedResult {
        let watch = Arc::new(InvariantWatch::default());
        let settings =
            Settings { limit: Some(self.limit), ends_at_standstill: true, journal: 0, ..Settings::simulated(seed) };
        let mut observers = vec![Arc::clone(&watch) as Arc<dyn Observer>];
        if self.is_measured {
            observers.push(Arc::new(AdaptationWatch::default()));
        }
        let fleet = match RunningFleet::start(self.assembly.clone(), settings, observers) {
            Ok(fleet) => fleet,
            Err(error) => return SeedResult::failed(seed, error.to_string()),
        };
        for event in events {
            if let Err(why) = event.play(&fleet.handle()) {
                return SeedResult::failed(seed, why);
            }
        }
        let report = fleet.run_to_end();
        let applied = report.sections.get("faults").and_then(|faults| faults.get("applied")?.as_object());
        let faults = applied.into_iter().flatten();
        let faults = faults.filter_map(|(kind, count)| Some((kind.clone(), count.as_u64()?))).collect();
        let mut violations: Vec<Found> = watch
            .violations()
            .into_iter()
            .map(|one| Found { invariant: one.invariant.to_owned(), at_s: one.at.as_secs_f64(), text: one.text })
            .collect();
        if report.outcome.status == RunStatus::Failed {
            let text = report.outcome.reasons.join("; ");
            violations.push(Found { invariant: RUNS.to_owned(), at_s: report.time_s, text });
        }
        let more = violations.len().saturating_sub(MOST);
        violations.truncate(MOST);
        let figure =
            |one: saoms_api::extension::Measure| Figure { name: one.name.to_owned(), value: one.value, of: one.of };
        let mut measures: Vec<Figure> = watch.measures().into_iter().map(figure).collect();
        measures.extend(report.adaptation.iter().flat_map(figures));
        let simulated = watch.simulated().into_iter().map(figure).collect();
        SeedResult {
            seed,
            status: serde_json::to_value(report.outcome.status)
                .ok()
                .and_then(|one| one.as_str().map(str::to_owned))
                .unwrap_or_default(),
            reasons: report.outcome.reasons,
            standstill: report.standstill.filter(|one| one.ends).map(|one| one.to_string()),
            time_s: report.time_s,
            periods: report.periods,
            checks: watch.checks(),
            trace_hash: report.trace_hash,
            faults,
            measures,
            simulated,
            violations,
            more,
        }
    }
}

/// The processor time of this process so far.
fn cpu_time() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is a valid place for the one value that the call writes.
    match unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) } {
        0 => Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap_or(0)),
        _ => Duration::ZERO,
    }
}

/// How the fleet adapted, as figures: of each kind of event the means of its times, and sums.
fn figures(adaptation: &AdaptationReport) -> Vec<Figure> {
    let mut all = Vec::new();
    for kind in &adaptation.kinds {
        let mut add = |what: &str, value: Option<f64>| {
            let name = format!("{kind}: {what}");
            all.extend(value.map(|value| Figure { name, value, of: None }));
        };
        let mean = |spread: Option<Spread>| spread.map(|spread| spread.mean);
        add("events", Some(kind.count as f64));
        add("detect, s", mean(kind.detect_s));
        add("decide, s", mean(kind.decide_s));
        add("effect, s", mean(kind.effect_s));
        add("settle, s", mean(kind.settle_s));
        add("needless", (!kind.own).then_some(kind.needless as f64));
        add("dip, %", kind.throughput.and_then(|throughput| throughput.dip_percent));
    }
    all
}
