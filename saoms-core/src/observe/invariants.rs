use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use saoms_api::Time;
use saoms_api::extension::{InvariantsRegistration, Measure, RunEnd, RunInvariants, Violation};
use saoms_api::host::TopicDeclaration;

use super::{Interest, Observer, Occurrence, RunEvent, SentMessage};
use crate::report::{RunReport, RunStatus};

/// The observer that holds a run to the invariants that are linked in.
///
/// Without any, it finds nothing.
pub struct InvariantWatch {
    all: Mutex<Vec<Box<dyn RunInvariants>>>,
    checks: AtomicU64,
}

impl Default for InvariantWatch {
    fn default() -> InvariantWatch {
        InvariantWatch { all: Mutex::new(InvariantsRegistration::linked()), checks: AtomicU64::new(0) }
    }
}

impl std::fmt::Debug for InvariantWatch {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("InvariantWatch").field("invariants", &self.all().len()).finish()
    }
}

impl InvariantWatch {
    fn all(&self) -> MutexGuard<'_, Vec<Box<dyn RunInvariants>>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The run goes on from what an earlier program left.
    pub fn goes_on(&self) {
        self.all().iter_mut().for_each(|one| one.goes_on());
    }

    /// The violations since the last call.
    pub fn violations(&self) -> Vec<Violation> {
        self.all().iter_mut().flat_map(|one| one.violations()).collect()
    }

    /// Number of messages that were judged.
    pub fn checks(&self) -> u64 {
        self.checks.load(Ordering::Relaxed)
    }

    /// What the run came to, after its end.
    pub fn measures(&self) -> Vec<Measure> {
        self.all().iter().flat_map(|one| one.measures()).collect()
    }

    /// How much was simulated, after the end of the run.
    pub fn simulated(&self) -> Vec<Measure> {
        self.all().iter().filter_map(|one| one.simulated()).collect()
    }
}

impl Observer for InvariantWatch {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        // All of them have to be asked.
        self.all().iter_mut().filter_map(|one| one.wants_topic(name, declared).then_some(())).count() > 0
    }

    fn message(&self, sent: &SentMessage) {
        self.checks.fetch_add(1, Ordering::Relaxed);
        self.all().iter_mut().for_each(|one| one.message(&sent.topic, &sent.message));
    }

    fn event(&self, event: &RunEvent) {
        if let Occurrence::Fault { call, concerned } = &event.what {
            self.all().iter_mut().for_each(|one| one.fault(event.time, call, concerned));
        }
    }

    fn end(&self, report: &RunReport) {
        let at = Time::from_nanos((report.time_s * 1e9) as u64);
        let end = match report.outcome.status {
            _ if report.standstill.as_ref().is_some_and(|standstill| standstill.ends) => RunEnd::Standstill,
            RunStatus::Elapsed | RunStatus::Stopped | RunStatus::Interrupted => RunEnd::CutOff,
            RunStatus::Done | RunStatus::Incomplete | RunStatus::Failed => RunEnd::Own,
        };
        self.all().iter_mut().for_each(|one| one.end(at, end, &|path| report.count(path)));
    }
}
