use std::sync::{Mutex, MutexGuard, PoisonError};

use saoms_api::Failure;
use saoms_lang::assembly::Assembly;

use super::{Interest, Observer, Records};
use crate::adaptation::Adaptations;
use crate::report::RunReport;

/// The observer that measures how a fleet adapts, and adds that to the report.
///
/// It takes the records of the journal, so that a run without it does not pay for it.
#[derive(Debug)]
pub struct AdaptationWatch {
    all: Mutex<Adaptations>,
}

impl AdaptationWatch {
    /// One for a run of this fleet.
    pub fn of(assembly: &Assembly) -> AdaptationWatch {
        let tasks = assembly.components.iter().filter_map(|one| Some((one.path.clone(), one.task.as_ref()?.period)));
        AdaptationWatch { all: Mutex::new(Adaptations::new(tasks)) }
    }

    fn all(&self) -> MutexGuard<'_, Adaptations> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for AdaptationWatch {
    fn interest(&self) -> Interest {
        Interest { journal: true, ..Interest::NONE }
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        let mut all = self.all();
        records.entries.iter().for_each(|entry| all.take(entry));
        Ok(())
    }

    fn conclude(&self, report: &mut RunReport) {
        report.adaptation = Some(self.all().report());
    }
}
