use std::fmt;

use crate::Finding;

/// The reason why a component cannot continue, in words for the person who runs the fleet.
///
/// The host adds the component's name and the time. What happens next is the `restart` policy of the composite.
///
/// A failure that says that a called component is [busy](Failure::busy_provider) is no fault: an execution that ends
/// with it is skipped and counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    message: String,
    /// Rarely needed fields, boxed: results are moved about on the path of each execution.
    details: Option<Box<FailureDetails>>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct FailureDetails {
    findings: Vec<Finding>,
    busy: Option<String>,
}

impl Failure {
    /// A failure with this message.
    pub fn new(message: impl Into<String>) -> Failure {
        Failure { message: message.into(), details: None }
    }

    /// For hosts: a failure with findings.
    #[doc(hidden)]
    pub fn with_findings(message: String, findings: Vec<Finding>) -> Failure {
        Failure { message, details: Some(Box::new(FailureDetails { findings, busy: None })) }
    }

    /// The message.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The same failure with the place where it occurred before its message.
    ///
    /// ```
    /// use saoms_api::{CallError, Failure};
    ///
    /// let busy = Failure::from(CallError::Busy { provider: "Wheels1".to_owned() }).at("loop `battery`");
    /// assert!(busy.message().starts_with("loop `battery`: component `Wheels1`"));
    /// assert_eq!(busy.busy_provider(), Some("Wheels1"));
    /// ```
    #[must_use]
    pub fn at(self, place: impl fmt::Display) -> Failure {
        Failure { message: format!("{place}: {}", self.message), ..self }
    }

    /// The component that was busy when it was called, if that is the reason: its code was running, and calls never
    /// wait. Failures made by `?` from [`CallError::Busy`] keep it.
    ///
    /// An execution that ends so is skipped and counted in the report as `busy`. What it sent before is sent; the
    /// messages that it received come again with the next execution.
    pub fn busy_provider(&self) -> Option<&str> {
        self.details.as_ref()?.busy.as_deref()
    }

    /// Findings of a constructor about values that do not fit together; see [`Finding`].
    pub fn findings(&self) -> &[Finding] {
        self.details.as_ref().map_or(&[], |details| &details.findings)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

impl From<String> for Failure {
    fn from(message: String) -> Failure {
        Failure::new(message)
    }
}

impl From<&str> for Failure {
    fn from(message: &str) -> Failure {
        Failure::new(message)
    }
}

impl From<CallError> for Failure {
    fn from(error: CallError) -> Failure {
        let message = error.to_string();
        let busy = match error {
            CallError::Busy { provider } => Some(provider),
            CallError::Failed { failure, .. } => failure.details.and_then(|details| details.busy),
            _ => None,
        };
        let details = busy.map(|busy| Box::new(FailureDetails { findings: Vec::new(), busy: Some(busy) }));
        Failure { message, details }
    }
}

/// The reason why a call through a reference brought no reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CallError {
    /// The reference is not wired to a service.
    NotWired {
        /// The reference as the component names it.
        reference: String,
    },
    /// The provider is in the middle of an execution or of another call, by this caller's own chain of calls or because
    /// it is slow.
    Busy {
        /// The component that offers the service.
        provider: String,
    },
    /// The provider is not running: not scheduled yet, unscheduled, or failed.
    NotRunning {
        /// The component that offers the service.
        provider: String,
    },
    /// The provider knows no such service, operation or argument types.
    Mismatch {
        /// The difference between the two.
        message: String,
    },
    /// The provider answered with a failure.
    Failed {
        /// The component that offers the service; empty if the host fills it in.
        provider: String,
        /// Its own words.
        failure: Failure,
    },
}

impl fmt::Display for CallError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CallError::NotWired { reference } => write!(
                formatter,
                "reference `{reference}` is not wired: give it a target in the composite, or do not call it"
            ),
            CallError::Busy { provider } => {
                write!(formatter, "component `{provider}` is in the middle of an execution and cannot be called")
            }
            CallError::NotRunning { provider } => write!(formatter, "component `{provider}` is not running"),
            CallError::Mismatch { message } => formatter.write_str(message),
            CallError::Failed { provider, failure } if provider.is_empty() => write!(formatter, "{failure}"),
            CallError::Failed { provider, failure } => {
                write!(formatter, "component `{provider}` could not serve the call: {failure}")
            }
        }
    }
}

impl std::error::Error for CallError {}

impl From<Failure> for CallError {
    fn from(failure: Failure) -> CallError {
        // What a busy component could not do, its caller cannot do now either.
        if let Some(provider) = failure.busy_provider() {
            return CallError::Busy { provider: provider.to_owned() };
        }
        CallError::Failed { provider: String::new(), failure }
    }
}
