use std::sync::{Mutex, MutexGuard, PoisonError};

use saoms_api::extension::{CurvesRegistration, RunCurves};
use saoms_api::host::TopicDeclaration;
use saoms_api::{Failure, Time};

use super::{Beginning, Interest, Observer, Records, SentMessage};
use crate::adaptation::{Adaptations, Samples};
use crate::report::RunReport;

/// The observer that measures how a fleet adapts, and adds that to the report.
///
/// It takes the records of the journal and the messages that the curves need, so that a run without it does not pay
/// for them.
pub struct AdaptationWatch {
    adaptations: Mutex<Adaptations>,
    curves: Mutex<Curves>,
}

/// The curves that are linked in, and their samples.
struct Curves {
    all: Vec<Box<dyn RunCurves>>,
    samples: Samples,
}

impl Curves {
    fn figures(all: &[Box<dyn RunCurves>], now: Time) -> Vec<f64> {
        all.iter().flat_map(|one| one.figures(now)).collect()
    }
}

impl std::fmt::Debug for AdaptationWatch {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("AdaptationWatch").field("curves", &self.curves().samples.curves).finish()
    }
}

impl Default for AdaptationWatch {
    fn default() -> AdaptationWatch {
        let linked = CurvesRegistration::linked();
        let samples = Samples::new(linked.iter().flat_map(|one| one.curves).copied().collect());
        let all = linked.iter().map(|one| (one.new)()).collect();
        AdaptationWatch { adaptations: Mutex::default(), curves: Mutex::new(Curves { all, samples }) }
    }
}

impl AdaptationWatch {
    /// The curves of the run, after its end.
    pub fn samples(&self) -> Samples {
        self.curves().samples.clone()
    }

    fn adaptations(&self) -> MutexGuard<'_, Adaptations> {
        self.adaptations.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn curves(&self) -> MutexGuard<'_, Curves> {
        self.curves.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for AdaptationWatch {
    fn interest(&self) -> Interest {
        Interest { journal: true, ..Interest::NONE }
    }

    fn begin(&self, beginning: &Beginning<'_>) -> Result<(), Failure> {
        let mut adaptations = self.adaptations();
        beginning.components.iter().for_each(|component| adaptations.join(component));
        Ok(())
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        let mut adaptations = self.adaptations();
        records.joined.iter().for_each(|component| adaptations.join(component));
        records.entries.iter().for_each(|entry| adaptations.take(entry));
        Ok(())
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        // All of them have to be asked.
        self.curves().all.iter_mut().filter_map(|one| one.wants_topic(name, declared).then_some(())).count() > 0
    }

    fn message(&self, sent: &SentMessage) {
        let Curves { all, samples } = &mut *self.curves();
        let now = sent.message.header().sent;
        samples.advance(now.as_nanos(), || Curves::figures(all, now));
        all.iter_mut().for_each(|one| one.message(&sent.topic, &sent.component, &sent.message));
    }

    fn conclude(&self, report: &mut RunReport) {
        let Curves { all, samples } = &mut *self.curves();
        let end = Time::from_nanos((report.time_s * 1e9).round() as u64);
        samples.finish(end.as_nanos(), Curves::figures(all, end));
        report.adaptation = Some(self.adaptations().report(samples));
    }
}
