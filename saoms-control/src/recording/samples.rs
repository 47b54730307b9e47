//! Samples of a run, within a limit.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Duration;

use serde_json::value::RawValue;

/// The samples, each with what differs from the one before.
#[derive(Debug)]
pub(super) struct Samples {
    all: Vec<Sample>,
    bytes: usize,
    /// The most samples, and the most bytes of them.
    most: (usize, usize),
    /// Time between two, in seconds.
    every_s: f64,
    /// The time from which on the next one is kept.
    next_s: f64,
}

#[derive(Debug)]
struct Sample {
    time_s: f64,
    /// Numbers of cells and what each holds from then on, in turn.
    changes: String,
}

impl Samples {
    /// No samples, of which so many are kept, and so many bytes of their changes.
    pub(super) fn new(every: Duration, most: (usize, usize)) -> Samples {
        Samples { all: Vec::new(), bytes: 0, most, every_s: every.as_secs_f64(), next_s: 0.0 }
    }

    /// The number of samples.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// The time between two samples.
    pub(super) fn every_s(&self) -> f64 {
        self.every_s
    }

    /// True if a sample of this time is kept; the last one is in any case.
    pub(super) fn want(&self, time_s: f64, is_last: bool) -> bool {
        is_last || time_s + 1e-9 >= self.next_s
    }

    /// Adds a sample. Where there is no room, every second one is left out; true if that was done.
    pub(super) fn push(&mut self, time_s: f64, changes: &[(u32, String)]) -> bool {
        let mut text = String::new();
        for (cell, holds) in changes {
            // Nothing fails in memory.
            let _ = write!(text, "{}{cell},{holds}", if text.is_empty() { "" } else { "," });
        }
        let sample = Sample { time_s, changes: text };
        match self.all.last_mut().filter(|last| last.time_s >= time_s) {
            // That of the end may be of the same time.
            Some(last) => {
                self.bytes -= last.changes.len();
                last.changes = joined(&last.changes, &sample.changes);
                self.bytes += last.changes.len();
            }
            None => {
                self.bytes += sample.changes.len();
                self.all.push(sample);
            }
        }
        let every_s = self.every_s;
        while (self.bytes > self.most.1 || self.all.len() > self.most.0) && self.all.len() > 2 {
            self.thin();
        }
        self.next_s = ((time_s / self.every_s + 1e-6).floor() + 1.0) * self.every_s;
        self.every_s > every_s
    }

    /// Has cells hold something else, where `anew` says what.
    pub(super) fn rewrite(&mut self, mut anew: impl FnMut(&str) -> Option<String>) {
        for sample in &mut self.all {
            let all = format!("[{}]", sample.changes);
            // They were written as JSON.
            let values: Vec<&RawValue> = serde_json::from_str(&all).unwrap_or_default();
            let shown = |pair: &[&RawValue]| {
                let (cell, holds) = (pair[0].get(), pair[1].get());
                format!("{cell},{}", anew(holds).unwrap_or_else(|| holds.to_owned()))
            };
            let pairs: Vec<String> = values.chunks_exact(2).map(shown).collect();
            sample.changes = pairs.join(",");
        }
        self.bytes = self.all.iter().map(|one| one.changes.len()).sum();
    }

    fn thin(&mut self) {
        self.every_s *= 2.0;
        let mut kept: Vec<Sample> = Vec::with_capacity(self.all.len() / 2 + 1);
        let mut before: Option<Sample> = None;
        for (place, sample) in std::mem::take(&mut self.all).into_iter().enumerate() {
            if !place.is_multiple_of(2) {
                before = Some(sample);
                continue;
            }
            let changes = match before.take() {
                Some(before) => joined(&before.changes, &sample.changes),
                None => sample.changes,
            };
            kept.push(Sample { time_s: sample.time_s, changes });
        }
        // The newest one stays.
        kept.extend(before);
        self.bytes = kept.iter().map(|one| one.changes.len()).sum();
        self.all = kept;
    }

    /// The samples: times, and numbers of cells and what they hold in turn.
    pub(super) fn json(&self) -> String {
        let samples: Vec<String> =
            self.all.iter().map(|Sample { time_s, changes }| format!("[{time_s},[{changes}]]")).collect();
        format!("[{}]", samples.join(",\n"))
    }
}

/// Changes that follow each other as one.
fn joined(earlier: &str, later: &str) -> String {
    let (earlier, later) = (format!("[{earlier}]"), format!("[{later}]"));
    let mut all: BTreeMap<u32, &str> = BTreeMap::new();
    for changes in [&earlier, &later] {
        // They were written as JSON.
        let values: Vec<&RawValue> = serde_json::from_str(changes).unwrap_or_default();
        for pair in values.chunks_exact(2) {
            if let Ok(cell) = pair[0].get().parse() {
                all.insert(cell, pair[1].get());
            }
        }
    }
    let pairs: Vec<String> = all.iter().map(|(cell, holds)| format!("{cell},{holds}")).collect();
    pairs.join(",")
}
