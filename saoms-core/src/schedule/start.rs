use std::fmt;
use std::io;

use saoms_api::Failure;

use super::change::ChangeError;
use super::realtime::RealtimeError;

/// Error of a fleet that did not start. No part of it runs.
#[derive(Debug)]
#[non_exhaustive]
pub enum StartError {
    /// A component could not be constructed or initialized. Those that were initialized before it have been shut down.
    Component {
        /// Its path in the composite.
        component: String,
        /// Its class.
        class: String,
        /// Its failure.
        failure: Failure,
    },
    /// Real-time scheduling was asked for and is not permitted.
    Realtime(RealtimeError),
    /// An observer of the run cannot do its work.
    Observer(Failure),
    /// The system refused to create a thread.
    Thread(io::Error),
}

impl fmt::Display for StartError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StartError::Component { component, class, failure } => {
                write!(formatter, "component `{component}` of class `{class}` could not start: {failure}")
            }
            StartError::Realtime(error) => error.fmt(formatter),
            StartError::Observer(failure) => failure.fmt(formatter),
            StartError::Thread(error) => {
                write!(formatter, "the system gives no thread to run the fleet on: {error}")
            }
        }
    }
}

impl std::error::Error for StartError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            StartError::Component { .. } | StartError::Observer(_) => None,
            StartError::Realtime(error) => Some(error),
            StartError::Thread(error) => Some(error),
        }
    }
}

impl From<ChangeError> for StartError {
    fn from(error: ChangeError) -> StartError {
        match error {
            ChangeError::Failed { component, class, failure } => {
                StartError::Component { component, class, failure }
            }
            // The other errors need a running fleet.
            other => StartError::Observer(Failure::new(other.to_string())),
        }
    }
}
