use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::time::Duration;

use saoms_api::host::TopicDeclaration;
use saoms_api::{Failure, Level, Time};

use super::queue::Lost;
use super::{FleetSample, Occurrence, RunEvent, RunProgress, SampleRate, SentMessage};
use crate::journal::{ComponentName, JournalEntry};
use crate::report::RunReport;
use crate::status::ComponentStatus;
use crate::tape::Step;

/// Who hears that an observer cannot write what it is to write to its file.
pub trait WriterEvents: Send + Sync {
    /// From now on something is lost, for this reason.
    fn fails(&self, reason: &str);
    /// Everything can be written again.
    fn works(&self);
}

/// A program that sees what happens in a fleet.
///
/// Events, messages and progress come from one thread of their own, in the order in which they happened, so that an
/// observer may take its time; but observers wait for each other. In real time, events that pile up beyond a bound are
/// counted and lost, and so are samples beyond two; in virtual time the run waits. An observer that panics in a call
/// loses that call only.
pub trait Observer: Send + Sync + 'static {
    /// Optional events that the observer wants. Called once, before the start.
    fn interest(&self) -> Interest {
        Interest::default()
    }

    /// The fleet is about to start.
    ///
    /// # Errors
    /// The observer cannot do its work: then the fleet does not start.
    fn begin(&self, beginning: &Beginning<'_>) -> Result<(), Failure> {
        let _ = beginning;
        Ok(())
    }

    /// An event happened.
    fn event(&self, event: &RunEvent) {
        let _ = event;
    }

    /// True if the messages of a topic are wanted, where its publishers declare it so and call it `name` after
    /// renaming. Called when a component becomes a publisher, on a thread of the run, so it has to be fast.
    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        let _ = (name, declared);
        false
    }

    /// True if messages of components of other programs are wanted, too.
    fn hears_others(&self) -> bool {
        false
    }

    /// A component sent a message on a topic that is wanted. Messages without a reader are included.
    fn message(&self, sent: &SentMessage) {
        let _ = sent;
    }

    /// True if the tape of a component is wanted: all that it gets and does. Called when the component starts, on a
    /// thread of the run, so it has to be fast.
    fn wants_tape(&self, component: &str) -> bool {
        let _ = component;
        false
    }

    /// A step of a component whose tape is wanted has ended.
    fn step(&self, component: &str, step: &Step) {
        let _ = (component, step);
    }

    /// Events and messages came faster than the observers took them in, and are lost: in real time alone. Lines of the
    /// log and the console are not counted.
    fn lost(&self, lost: LostEvents) {
        let _ = lost;
    }

    /// True if samples should have what state topics retain whose messages have this name. Called when a sample is
    /// taken, on a thread of the run, so it has to be fast.
    fn wants_state(&self, message: &str) -> bool {
        let _ = message;
        false
    }

    /// True if samples should have what a component says of itself, which has said this for the first time. One that
    /// no observer of samples wants is not asked for them any more, until it starts again, has other values, or says
    /// something else to whoever asks. Called when a sample is taken, on a thread of the run, so it has to be fast.
    fn wants_status(&self, component: &ComponentStatus) -> bool {
        let _ = component;
        true
    }

    /// The fleet at one moment: as often as an observer [wants](Interest::samples), and at the end of the run.
    fn sample(&self, sample: &FleetSample) {
        let _ = sample;
    }

    /// Periodic report of the progress of the run.
    fn progress(&self, progress: &RunProgress) {
        let _ = progress;
    }

    /// New records of the journal, from a thread of their own.
    ///
    /// # Errors
    /// The observer can take neither them nor any that follow: the run reports it at once, and fails at its end.
    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        let _ = records;
        Ok(())
    }

    /// The run has ended: adds to its report what the observer found, before any observer gets it.
    fn conclude(&self, report: &mut RunReport) {
        let _ = report;
    }

    /// The run has ended, and all events before have been delivered. Called by the thread that waited for the end.
    fn end(&self, report: &RunReport) {
        let _ = report;
    }
}

/// Optional events that an observer wants beside those that every observer gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interest {
    /// Highest level of log lines. A line that no observer wants is not even formatted.
    pub log: Option<Level>,
    /// Lines of the classic console.
    pub console: bool,
    /// Interval of [`Observer::progress`]; `None` is never.
    pub progress: Option<Duration>,
    /// How often [`Observer::sample`] is called at least; `None` is never. Components are asked how they are for each
    /// sample, between executions, if an observer [wants](Observer::wants_status) that.
    pub samples: Option<SampleRate>,
    /// Records of the journal.
    pub journal: bool,
}

impl Interest {
    /// No line, no progress, no record.
    pub const NONE: Interest = Interest { log: None, console: false, progress: None, samples: None, journal: false };
}

impl Default for Interest {
    /// Lines of the log up to [`Level::Info`].
    fn default() -> Interest {
        Interest { log: Some(Level::Info), ..Interest::NONE }
    }
}

/// The fleet that is about to start.
#[derive(Clone, Copy, Debug)]
pub struct Beginning<'a> {
    /// The seed of all chance.
    pub seed: u64,
    /// True if it runs in virtual time.
    pub is_virtual: bool,
    /// Its components in document order.
    pub components: &'a [ComponentName],
}

/// Records of the journal, in the order in which executions handed them over.
#[derive(Clone, Copy, Debug)]
pub struct Records<'a> {
    /// The records.
    pub entries: &'a [JournalEntry],
    /// Components that joined the running fleet since the last call.
    pub joined: &'a [ComponentName],
    /// Number of records that were lost for want of room since the last call.
    pub lost: u64,
    /// End of the run, with the last records.
    pub end: Option<Time>,
}

/// What an observer has not got since it was told last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LostEvents {
    /// Number of alerts that began, changed or were over.
    pub alerts: u64,
    /// Number of messages of topics, and of steps of components, that it wants.
    pub messages: u64,
}

/// The observers of a run, each with its interest.
#[derive(Default)]
pub(crate) struct Observers {
    all: Vec<(Arc<dyn Observer>, Interest)>,
}

impl Observers {
    pub(crate) fn new(observers: Vec<Arc<dyn Observer>>) -> Observers {
        let all = observers.into_iter().map(|one| {
            let interest = one.interest();
            (one, interest)
        });
        Observers { all: all.collect() }
    }

    pub(crate) fn begin(&self, beginning: &Beginning<'_>) -> Result<(), Failure> {
        self.all.iter().try_for_each(|(observer, _)| observer.begin(beginning))
    }

    pub(crate) fn end(&self, report: &mut RunReport) {
        for (observer, _) in &self.all {
            contained(|| observer.conclude(report));
        }
        let report = &*report;
        for (observer, _) in &self.all {
            contained(|| observer.end(report));
        }
    }

    /// The union of all interests, but for samples.
    pub(crate) fn interest(&self) -> Interest {
        let wider = |one: Interest, other: Interest| Interest {
            log: one.log.max(other.log),
            console: one.console || other.console,
            progress: one.progress.into_iter().chain(other.progress).min(),
            samples: None,
            journal: one.journal || other.journal,
        };
        self.all.iter().map(|(_, interest)| *interest).fold(Interest::NONE, wider)
    }

    /// The numbers of the observers that want the messages of a topic.
    pub(crate) fn of_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> Vec<u32> {
        let wants = |(_, (observer, _)): &(usize, &(Arc<dyn Observer>, Interest))| {
            contained(|| observer.wants_topic(name, declared)).unwrap_or(false)
        };
        self.all.iter().enumerate().filter(wants).map(|(number, _)| number as u32).collect()
    }

    /// The numbers of the observers that want the tape of a component.
    pub(crate) fn of_tape(&self, component: &str) -> Vec<u32> {
        let wants = |observer: &dyn Observer| contained(|| observer.wants_tape(component)).unwrap_or(false);
        let all = self.all.iter().enumerate();
        all.filter(|(_, (observer, _))| wants(&**observer)).map(|(number, _)| number as u32).collect()
    }

    /// The number of an observer.
    pub(crate) fn number(&self, observer: &Arc<dyn Observer>) -> Option<u32> {
        self.all.iter().position(|(one, _)| Arc::ptr_eq(one, observer)).map(|place| place as u32)
    }

    pub(crate) fn event(&self, event: &RunEvent) {
        for (observer, interest) in &self.all {
            let is_wanted = match &event.what {
                Occurrence::Log { level, .. } => interest.log.is_some_and(|most| *level <= most),
                Occurrence::Console { .. } => interest.console,
                _ => true,
            };
            if is_wanted {
                contained(|| observer.event(event));
            }
        }
    }

    pub(crate) fn message(&self, sent: &SentMessage, observers: &[u32]) {
        for (observer, _) in observers.iter().filter_map(|number| self.all.get(*number as usize)) {
            if !sent.is_of_other || observer.hears_others() {
                contained(|| observer.message(sent));
            }
        }
    }

    pub(crate) fn step(&self, component: &str, step: &Step, observers: &[u32]) {
        for (observer, _) in observers.iter().filter_map(|number| self.all.get(*number as usize)) {
            contained(|| observer.step(component, step));
        }
    }

    /// Tells each what it lacks.
    pub(super) fn lost(&self, lost: &Lost) {
        for (number, (observer, _)) in self.all.iter().enumerate() {
            if let Some(lost) = lost.of(number) {
                contained(|| observer.lost(lost));
            }
        }
    }

    /// How often samples are wanted.
    pub(crate) fn sample_rates(&self) -> impl Iterator<Item = SampleRate> {
        self.all.iter().filter_map(|(_, interest)| interest.samples)
    }

    /// True if an observer of samples wants what topics with such messages retain.
    pub(crate) fn want_state(&self, message: &str) -> bool {
        let mut all = self.all.iter().filter(|(_, interest)| interest.samples.is_some());
        all.any(|(observer, _)| contained(|| observer.wants_state(message)).unwrap_or(false))
    }

    /// True if an observer of samples wants what a component says of itself.
    pub(crate) fn want_status(&self, component: &ComponentStatus) -> bool {
        let mut all = self.all.iter().filter(|(_, interest)| interest.samples.is_some());
        all.any(|(observer, _)| contained(|| observer.wants_status(component)).unwrap_or(false))
    }

    pub(crate) fn sample(&self, sample: &FleetSample) {
        for (observer, _) in self.all.iter().filter(|(_, interest)| interest.samples.is_some()) {
            contained(|| observer.sample(sample));
        }
    }

    pub(crate) fn progress(&self, progress: &RunProgress) {
        for (observer, _) in self.all.iter().filter(|(_, interest)| interest.progress.is_some()) {
            contained(|| observer.progress(progress));
        }
    }

    /// The observers of the journal.
    pub(crate) fn of_journal(&self) -> impl Iterator<Item = &Arc<dyn Observer>> {
        self.all.iter().filter(|(_, interest)| interest.journal).map(|(observer, _)| observer)
    }
}

/// The result of an observer's code; `None` when it panics, which the panic hook has reported on standard error.
pub(super) fn contained<T>(code: impl FnOnce() -> T) -> Option<T> {
    panic::catch_unwind(AssertUnwindSafe(code)).ok()
}
