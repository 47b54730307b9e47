use serde::{Deserialize, Serialize};

use super::Samples;

/// The longest time before and after an event over which work is counted, in nanoseconds.
const WINDOW: u64 = 60_000_000_000;
/// The shortest: events closer to the start or the end of the run do not count.
const LEAST: u64 = 1_000_000_000;

/// The throughput before and after events of one kind.
///
/// It is counted in a minute before and a minute after each event, or in as much as the run has on both sides, at
/// least a second. Events close to each other share what was finished.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Throughput {
    /// Pieces of work that were finished in a minute before an event.
    pub before_per_min: f64,
    /// Those after it.
    pub after_per_min: f64,
    /// How much less that is, in percent of `before_per_min`; negative if it is more. `None` if nothing was finished
    /// before.
    pub dip_percent: Option<f64>,
}

impl Throughput {
    /// That of events at these times in nanoseconds; `None` if none of them has time on both sides, or nobody counts
    /// work.
    pub(super) fn of(times: impl Iterator<Item = u64>, samples: &Samples) -> Option<Throughput> {
        let (mut before, mut after, mut minutes) = (0.0, 0.0, 0.0);
        for at in times.filter(|_| samples.has_work()) {
            let window = WINDOW.min(at).min(samples.end().saturating_sub(at));
            if window < LEAST {
                continue;
            }
            let now = samples.work(at);
            before += now - samples.work(at - window);
            after += samples.work(at + window) - now;
            minutes += window as f64 / 60e9;
        }
        (minutes > 0.0).then(|| Throughput {
            before_per_min: before / minutes,
            after_per_min: after / minutes,
            dip_percent: (before > 0.0).then(|| 100.0 * (before - after) / before),
        })
    }
}
