//! Fleets that do not start.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use saoms_api::Failure;
use saoms_core::observe::RunEvent;
use saoms_core::schedule::StartError;

use crate::Fleet;
use crate::run::{Log, Run};

/// A fleet that did not start: with mistakes in its composites, or with a component that could not be constructed or
/// initialized.
#[derive(Debug)]
pub struct NotStarted {
    cause: NotStartedCause,
    log: Vec<RunEvent>,
}

#[derive(Debug)]
pub(crate) enum NotStartedCause {
    /// The diagnostics as they are shown to people.
    Mistakes(String),
    Component(StartError),
}

impl NotStarted {
    /// The path of the component that did not start; `None` if the composites have mistakes.
    pub fn component(&self) -> Option<&str> {
        match &self.cause {
            NotStartedCause::Component(StartError::Component { component, .. }) => Some(component),
            _ => None,
        }
    }

    /// What it said.
    pub fn failure(&self) -> Option<&Failure> {
        match &self.cause {
            NotStartedCause::Component(StartError::Component { failure, .. }) => Some(failure),
            _ => None,
        }
    }

    /// The log lines of all components until then, as [`Run::log`] has them: those that had started are shut down.
    pub fn log(&self) -> String {
        self.log.iter().map(|event| format!("{event}\n")).collect()
    }
}

impl fmt::Display for NotStarted {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.cause.fmt(formatter)
    }
}

impl std::error::Error for NotStarted {}

impl fmt::Display for NotStartedCause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotStartedCause::Mistakes(shown) => formatter.write_str(shown),
            NotStartedCause::Component(error) => error.fmt(formatter),
        }
    }
}

impl Fleet {
    /// Runs the fleet as [`run`](Fleet::run) does, where a test wants to know why it does not start.
    ///
    /// # Errors
    /// It did not start.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use saoms_components as _;
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_file("../composites/hall.composite");
    /// assert!(fleet.try_run(0, Duration::from_secs(1)).is_ok());
    /// let wrong = Fleet::of_text("<composite/>").try_run(0, Duration::from_secs(1)).unwrap_err();
    /// assert!(wrong.component().is_none() && wrong.to_string().contains("error"));
    /// ```
    pub fn try_run(&self, seed: u64, limit: Duration) -> Result<Run, NotStarted> {
        let log = Arc::new(Log::default());
        match self.begin(seed, limit, log.clone()) {
            Ok(report) => Ok(Run::new(report, &log)),
            Err(cause) => Err(NotStarted { cause, log: log.take() }),
        }
    }

    /// Holds the fleet to not starting because of this component, with these words in what it says.
    ///
    /// # Panics
    /// The fleet starts, has mistakes, or another component says something else.
    #[track_caller]
    #[expect(clippy::panic, reason = "this is an assertion of tests")]
    pub fn expect_not_started(&self, component: &str, words: &str) {
        let Err(found) = self.try_run(0, Duration::ZERO) else {
            panic!("the fleet starts, expected that `{component}` does not: {words}")
        };
        let says = |failure: &Failure| failure.to_string().contains(words);
        assert!(
            found.component() == Some(component) && found.failure().is_some_and(says),
            "expected that `{component}` does not start, with `{words}`, but found: {found}"
        );
    }
}
