//! Latenesses by frequency, in buckets that are at most 1/128 of their value wide.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, Ordering};

/// Steps within each power of two, as a power of two: values below 2^7 ns are exact.
const STEP_BITS: u32 = 7;
/// Latenesses from 2^40 ns (18 minutes) on share the last bucket.
const VALUE_BITS: u32 = 40;
const BUCKETS: usize = ((VALUE_BITS - STEP_BITS + 1) as usize) << STEP_BITS;

/// The histogram that a contender fills while it runs: a fixed array, no lock, no allocation.
pub(crate) struct Recorder {
    counts: [AtomicU32; BUCKETS],
}

impl Recorder {
    pub(crate) const fn new() -> Self {
        Self { counts: [const { AtomicU32::new(0) }; BUCKETS] }
    }

    /// Counts one lateness.
    pub(crate) fn add(&self, ns: u64) {
        if let Some(count) = self.counts.get(bucket(ns)) {
            count.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The lower bound of each used bucket with its count.
    pub(crate) fn used(&self) -> impl Iterator<Item = (u64, u32)> {
        let counts = self.counts.iter().map(|count| count.load(Ordering::Relaxed)).enumerate();
        counts.filter(|(_, count)| *count > 0).map(|(index, count)| (lower_bound(index), count))
    }
}

/// Log-linear buckets, as in HdrHistogram: the position of the highest bit, then the `STEP_BITS` bits below it.
fn bucket(ns: u64) -> usize {
    let ns = ns.min((1 << VALUE_BITS) - 1);
    let shift = (64 - ns.leading_zeros()).saturating_sub(STEP_BITS + 1);
    ((shift as usize) << STEP_BITS) + usize::try_from(ns >> shift).unwrap_or(usize::MAX)
}

fn lower_bound(bucket: usize) -> u64 {
    let shift = (bucket >> STEP_BITS).saturating_sub(1);
    ((bucket - (shift << STEP_BITS)) as u64) << shift
}

/// The latenesses of one or more runs, as the driver reads them.
#[derive(Clone, Default)]
pub(crate) struct Histogram {
    counts: BTreeMap<u64, u64>,
    total: u64,
}

impl Histogram {
    pub(crate) fn add(&mut self, ns: u64, count: u64) {
        *self.counts.entry(ns).or_default() += count;
        self.total += count;
    }

    pub(crate) fn total(&self) -> u64 {
        self.total
    }

    /// The lateness in us that a share of `quantile` of all executions did not exceed (nearest rank); 1.0 gives the
    /// maximum.
    pub(crate) fn quantile_us(&self, quantile: f64) -> f64 {
        let rank = (quantile * self.total as f64).ceil() as u64;
        let mut seen = 0;
        for (ns, count) in &self.counts {
            seen += count;
            if seen >= rank {
                return *ns as f64 / 1000.0;
            }
        }
        f64::NAN
    }
}
