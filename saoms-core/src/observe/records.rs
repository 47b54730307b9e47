use saoms_api::{Failure, Time};

use super::observer::contained;
use super::{Observers, Records};
use crate::journal::RecordQueue;

/// Result of the delivery of records.
#[derive(Debug, Default)]
pub(crate) struct RecordDelivery {
    /// Records that did not reach all observers of the journal.
    pub(crate) lost: u64,
    /// Failures of the observers that could not take them.
    pub(crate) failures: Vec<Failure>,
}

/// Delivers records as they come, until the queue is closed and empty. `failed` is called with the first failure of
/// each observer, when it happens; after that, its records are only counted.
pub(crate) fn deliver_records(queue: &RecordQueue, observers: &Observers, failed: impl Fn(&Failure)) -> RecordDelivery {
    let mut listeners: Vec<_> = observers.of_journal().map(|observer| (observer, 0_u64, true)).collect();
    let mut delivery = RecordDelivery::default();
    let (mut entries, mut joined) = (Vec::new(), Vec::new());
    loop {
        let (lost, end): (u64, Option<Time>) = queue.next(&mut entries, &mut joined);
        let records = Records { entries: &entries, joined: &joined, lost, end };
        for (observer, missing, is_well) in &mut listeners {
            *missing += lost;
            if !*is_well {
                *missing += entries.len() as u64;
                continue;
            }
            let result = contained(|| observer.records(&records));
            if let Err(failure) = result.unwrap_or_else(|| Err(Failure::new("an observer of the journal panicked"))) {
                *missing += entries.len() as u64;
                *is_well = false;
                failed(&failure);
                delivery.failures.push(failure);
            }
        }
        if end.is_some() {
            delivery.lost = listeners.iter().map(|(_, missing, _)| *missing).max().unwrap_or(0);
            return delivery;
        }
    }
}
