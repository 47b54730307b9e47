//! The driver: all contenders at all sizes, forwards in one round and backwards in the next.

use crate::common::description;
use crate::contender::Contender;
use crate::probe::Plan;
use crate::run::Run;
use crate::size::Size;

/// All results.
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
    /// One entry per round; `None` where it failed.
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
        for result in &mut results {
            // A contender that failed once (too many threads, no permission) is not run again.
            if result.failure.is_some() {
                result.rounds.push(None);
                continue;
            }
            let name = result.contender.name;
            let run = match result.contender.run(plan) {
                Ok(run) => {
                    eprintln!("{} round {round}: {name} {}", plan.size, line(&run));
                    Some(run)
                }
                Err(error) => {
                    eprintln!("{} round {round}: {name} failed: {error}", plan.size);
                    result.failure = Some(error.to_string());
                    None
                }
            };
            result.rounds.push(run);
        }
        // A drift of the machine affects all contenders in the same way.
        results.reverse();
    }
    if rounds % 2 == 1 {
        results.reverse();
    }
    AtSize { size: plan.size, results }
}

fn line(run: &Run) -> String {
    let late = |quantile| run.latenesses.quantile_us(quantile);
    format!("p50 {:.0} us, p99 {:.0} us, others used {:.0} % of a core", late(0.5), late(0.99), run.others * 100.0)
}
