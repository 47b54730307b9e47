/// An event and what came of it. Times are in nanoseconds of the run.
#[derive(Clone, Debug)]
pub(super) struct Event {
    pub(super) kind: u32,
    /// True if a loop began by itself.
    pub(super) is_own: bool,
    /// The number of its record.
    pub(super) id: u64,
    pub(super) at: u64,
    pub(super) detected: Option<u64>,
    pub(super) decided: Option<u64>,
    pub(super) acted: Option<u64>,
    pub(super) settled: Option<u64>,
    /// True if another event took over what it had switched, so that it did not settle by itself.
    pub(super) is_overtaken: bool,
    /// Components that adapted to it needlessly.
    pub(super) needless: u32,
}

impl Event {
    pub(super) fn new(kind: u32, is_own: bool, id: u64, at: u64) -> Event {
        Event {
            kind,
            is_own,
            id,
            at,
            detected: None,
            decided: None,
            acted: None,
            settled: None,
            is_overtaken: false,
            needless: 0,
        }
    }

    /// Time from the event to then, in seconds.
    pub(super) fn after(&self, then: Option<u64>) -> Option<f64> {
        then.map(|then| then.saturating_sub(self.at) as f64 / 1e9)
    }

    /// Time until it settled, in seconds; `None` if it had no effect or another event took over.
    pub(super) fn settle(&self) -> Option<f64> {
        self.after(self.settled.filter(|_| !self.is_overtaken))
    }
}
