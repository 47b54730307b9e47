use saoms_api::{Failure, Time};

use super::observer::contained;
use super::{Observers, Records};
use crate::journal::RecordQueue;

/// How the telling of records ended.
#[derive(Debug, Default)]
pub(crate) struct Told {
    /// Records that did not reach all observers of the journal.
    pub(crate) lost: u64,
    /// Why observers could not take them.
    pub(crate) failures: Vec<Failure>,
}

/// Tells records as they come, until the queue is closed and empty. `failed` is told the first failure of each observer, when it happens;
/// after that, its records are only counted.
pub(crate) fn tell_records(queue: &RecordQueue, observers: &Observers, failed: impl Fn(&Failure)) -> Told {
    let mut listeners: Vec<_> = observers.of_journal().map(|observer| (observer, 0_u64, true)).collect();
    let mut told = Told::default();
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
            if let Err(failure) =
                result.unwrap_or_else(|| Err(Failure::new("an observer of the journal panicked")))
            {
                *missing += entries.len() as u64;
                *is_well = false;
                failed(&failure);
                told.failures.push(failure);
            }
        }
        if end.is_some() {
            told.lost = listeners.iter().map(|(_, missing, _)| *missing).max().unwrap_or(0);
            return told;
        }
    }
}
