/// The summary of a run: the counts that a crate's components report, and a short text about them.
#[derive(Clone, Copy, Debug)]
pub struct RunSummary {
    /// The paths of the counts that every report has; 0 where no component counted. Components count with
    /// [`Context::count`](crate::Context::count).
    pub counts: &'static [&'static str],
    /// The result of a run, beside how it ended; `None` where the counts say nothing.
    pub result: fn(&Counts<'_>) -> Option<String>,
    /// The progress of a run that has not ended; `None` where the counts say nothing.
    pub progress: fn(&Counts<'_>) -> Option<String>,
    /// The components that vote when the work is done, as advice for a fleet without any: `a world and a
    /// scenario`.
    pub voters: &'static str,
}

/// The counts of a report so far, by their paths; 0 where no component counted.
pub type Counts<'a> = dyn Fn(&str) -> i64 + 'a;

inventory::collect!(RunSummary);

impl RunSummary {
    /// The summaries that are linked into this program, in the order of their counts.
    pub fn linked() -> Vec<&'static RunSummary> {
        let mut all: Vec<&RunSummary> = inventory::iter::<RunSummary>().collect();
        all.sort_by_key(|summary| summary.counts);
        all
    }
}
