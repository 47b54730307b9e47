use serde::{Deserialize, Serialize};

/// Steps of the histogram within each power of two.
const STEPS: usize = 8;
/// Powers of two covered: up to 2^26 us, a bit more than a minute. Larger values count as the largest one, except for
/// the maximum.
const OCTAVES: usize = 24;
const BUCKETS: usize = STEPS * OCTAVES;

/// Lateness of executions: a histogram whose steps grow with the value. It takes less than 1 kB, and a few nanoseconds
/// for each entry.
///
/// Below 8 us each microsecond has its own bucket, above each power of two has eight, so that a quantile is at most
/// 1/16 off. (The layout is that of Gil Tene's HdrHistogram with three significant bits.)
#[derive(Clone, Debug, Default)]
pub struct Lateness {
    buckets: Option<Box<[u32; BUCKETS]>>,
    punctual: u64,
    count: u64,
    max_us: u64,
}

/// The quantiles of [`Lateness`], in microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LatenessSummary {
    /// Half of the executions were not later.
    pub p50: u64,
    /// 99 of 100 executions were not later.
    pub p99: u64,
    /// No execution was later.
    pub max: u64,
}

/// The counts of [`Lateness`] in a few steps, for metrics.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LatenessSteps {
    /// Number of executions that were less late than each of the bounds.
    pub below: [u64; LatenessSteps::BOUNDS.len()],
    /// Number of all executions.
    pub count: u64,
    /// Their lateness together in microseconds, at most 1/16 off.
    pub sum_us: u64,
}

impl LatenessSteps {
    /// The bounds in microseconds: powers of two, since a bucket ends there.
    pub const BOUNDS: [u64; 9] = [1 << 4, 1 << 6, 1 << 8, 1 << 10, 1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20];
}

impl Lateness {
    /// Counts one execution that started `nanos` nanoseconds after it was due.
    pub fn record(&mut self, nanos: u64) {
        self.count += 1;
        let micros = nanos / 1_000;
        if micros == 0 {
            // In virtual time no execution is late, and no memory is needed.
            self.punctual += 1;
            return;
        }
        self.max_us = self.max_us.max(micros);
        let buckets = self.buckets.get_or_insert_with(|| Box::new([0; BUCKETS]));
        let bucket = &mut buckets[bucket_of(micros)];
        *bucket = bucket.saturating_add(1);
    }

    /// Adds the counts of another histogram.
    pub fn merge(&mut self, other: &Lateness) {
        self.count += other.count;
        self.punctual += other.punctual;
        self.max_us = self.max_us.max(other.max_us);
        if let Some(others) = &other.buckets {
            let buckets = self.buckets.get_or_insert_with(|| Box::new([0; BUCKETS]));
            for (bucket, more) in buckets.iter_mut().zip(others.iter()) {
                *bucket = bucket.saturating_add(*more);
            }
        }
    }

    /// The quantile of this share (0 to 1), in microseconds.
    pub fn quantile(&self, share: f64) -> u64 {
        let rank = ((self.count as f64 * share).ceil() as u64).clamp(1, self.count.max(1));
        let mut below = self.punctual;
        if rank <= below {
            return 0;
        }
        for (place, &count) in self.buckets.iter().flat_map(|buckets| buckets.iter()).enumerate() {
            below += u64::from(count);
            if rank <= below {
                return middle_of(place).min(self.max_us);
            }
        }
        self.max_us
    }

    /// The same counts in a few steps.
    pub fn steps(&self) -> LatenessSteps {
        let mut steps =
            LatenessSteps { below: [self.punctual; LatenessSteps::BOUNDS.len()], count: self.count, sum_us: 0 };
        for (place, &count) in self.buckets.iter().flat_map(|buckets| buckets.iter().enumerate()) {
            let count = u64::from(count);
            steps.sum_us = steps.sum_us.saturating_add(middle_of(place).saturating_mul(count));
            for (below, bound) in steps.below.iter_mut().zip(LatenessSteps::BOUNDS) {
                if place < bucket_of(bound) {
                    *below += count;
                }
            }
        }
        steps
    }

    /// Median, 99th percentile and maximum.
    pub fn summary(&self) -> LatenessSummary {
        LatenessSummary { p50: self.quantile(0.5), p99: self.quantile(0.99), max: self.max_us }
    }
}

fn bucket_of(micros: u64) -> usize {
    if micros < STEPS as u64 {
        return micros as usize;
    }
    let octave = micros.ilog2() as usize - 2;
    let step = (micros >> (octave - 1)) as usize - STEPS;
    (octave * STEPS + step).min(BUCKETS - 1)
}

fn middle_of(bucket: usize) -> u64 {
    let (octave, step) = (bucket / STEPS, bucket % STEPS);
    if octave == 0 {
        return step as u64;
    }
    let width = 1u64 << (octave - 1);
    (STEPS + step) as u64 * width + width / 2
}
