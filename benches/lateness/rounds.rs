//! The driver: all contenders at all sizes, forwards and backwards in each round.

use crate::common::{Memory, description};
use crate::contender::Contender;
use crate::probe::Plan;
use crate::run::Run;
use crate::size::Size;

/// Everything that was measured.
pub(crate) struct Measured {
    pub(crate) machine: String,
    pub(crate) rounds: u32,
    pub(crate) seconds: f64,
    pub(crate) warm_up: f64,
    pub(crate) sizes: Vec<AtSize>,
}

/// All contenders at one size.
pub(crate) struct AtSize {
    pub(crate) size: Size,
    pub(crate) results: Vec<OfContender>,
}

/// One contender at one size.
pub(crate) struct OfContender {
    pub(crate) contender: &'static Contender,
    /// One entry per round: its two runs put together. `None` where one of them failed.
    pub(crate) rounds: Vec<Option<Run>>,
    pub(crate) failure: Option<String>,
}

/// Measures at every size in turn.
pub(crate) fn measure(plans: &[Plan], contenders: &[&'static Contender], rounds: u32) -> Measured {
    let seconds = |time: fn(&Plan) -> f64| plans.first().map_or(0.0, time);
    Measured {
        machine: description(),
        rounds,
        seconds: seconds(|plan| plan.measured.as_secs_f64()),
        warm_up: seconds(|plan| plan.warm_up.as_secs_f64()),
        sizes: plans.iter().map(|plan| at_size(plan, contenders, rounds)).collect(),
    }
}

fn at_size(plan: &Plan, contenders: &[&'static Contender], rounds: u32) -> AtSize {
    let start = |contender: &&'static Contender| OfContender { contender, rounds: Vec::new(), failure: None };
    let mut results: Vec<OfContender> = contenders.iter().map(start).collect();
    for round in 1..=rounds {
        let mut runs: Vec<Vec<Run>> = vec![Vec::new(); results.len()];
        let there = 0..results.len();
        for index in there.clone().chain(there.rev()) {
            let result = &mut results[index];
            // What failed once (too many threads, no permission) would only take time again.
            if result.failure.is_some() {
                continue;
            }
            let name = result.contender.name;
            match result.contender.run(plan) {
                Ok(run) => {
                    eprintln!("{} round {round}: {name} {}", plan.size, line(&run));
                    runs[index].push(run);
                }
                Err(error) => {
                    eprintln!("{} round {round}: {name} failed: {error}", plan.size);
                    result.failure = Some(error.to_string());
                }
            }
        }
        for (result, runs) in results.iter_mut().zip(runs) {
            result.rounds.push((runs.len() == 2).then(|| together(&runs)));
        }
    }
    AtSize { size: plan.size, results }
}

fn line(run: &Run) -> String {
    let late = |quantile| run.latenesses.quantile_us(quantile);
    format!(
        "p50 {:.0} us, p99 {:.0} us, others used {:.0} % of a core",
        late(0.5),
        late(0.99),
        run.others * 100.0
    )
}

/// The two runs of a round as one.
fn together(runs: &[Run]) -> Run {
    let mut sum = Run { missed: Some(0), ..Run::default() };
    for run in runs {
        sum.latenesses.merge(&run.latenesses);
        sum.missed = sum.missed.zip(run.missed).map(|(left, right)| left + right);
        sum.executions += run.executions;
        sum.cpu += run.cpu;
        sum.memory = Memory {
            resident_kb: sum.memory.resident_kb.max(run.memory.resident_kb),
            peak_kb: sum.memory.peak_kb.max(run.memory.peak_kb),
        };
        sum.others += run.others / runs.len() as f64;
        sum.stolen += run.stolen / runs.len() as f64;
    }
    sum
}
