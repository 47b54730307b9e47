use std::error::Error;
use std::fmt;

use crate::Finding;

/// The reason why a component cannot continue, as a text for users of the fleet.
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
    /// A failure with this message. An empty one is replaced: the failure says that it has none.
    pub fn new(message: impl Into<String>) -> Failure {
        let mut message = message.into();
        if message.is_empty() {
            "failed without a message".clone_into(&mut message);
        }
        Failure { message, details: None }
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

/// Any error becomes a failure with its message and those of its sources, so `?` takes it; so do a `String` and a
/// `&str`. A [`CallError`] keeps that a component was [busy](Failure::busy_provider), and a [`Finding`] stays one.
///
/// A failure is no `std::error::Error` itself: it would have to become one of itself then.
impl<E: Reason> From<E> for Failure {
    fn from(reason: E) -> Failure {
        let reason: Box<dyn Error + Send + Sync> = reason.into();
        let reason = match reason.downcast::<CallError>() {
            Ok(call) => return Failure::of_call(*call),
            Err(reason) => reason,
        };
        match reason.downcast::<Finding>() {
            Ok(finding) => Failure::of_findings(vec![*finding]),
            Err(reason) => Failure::new(with_sources(&*reason)),
        }
    }
}

/// What becomes a [`Failure`]: an error, a `String` or a `&str`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a reason for a failure",
    label = "an error, a `String` or a `&str` becomes a failure, and several findings by `Failure::of_findings`",
    note = "an error that is `Send + Sync + 'static`, a `String` and a `&str` are; of several findings make one with \
            `Failure::of_findings`"
)]
pub trait Reason: Into<Box<dyn Error + Send + Sync>> {}

#[diagnostic::do_not_recommend]
impl<E: Into<Box<dyn Error + Send + Sync>>> Reason for E {}

/// The message of an error and those of its sources, as far as it does not say them itself.
fn with_sources(error: &(dyn Error + 'static)) -> String {
    let mut message = error.to_string();
    let mut next = error.source();
    while let Some(source) = next {
        let text = source.to_string();
        if !message.contains(&text) {
            message = format!("{message}: {text}");
        }
        next = source.source();
    }
    message
}

impl Failure {
    /// A failure of a constructor about values that do not fit together, each of which is shown at its place.
    pub fn of_findings(findings: Vec<Finding>) -> Failure {
        let message = match &findings[..] {
            [] => "the values do not fit together".to_owned(),
            [one] => one.to_string(),
            [first, more @ ..] => format!("{first} (and {} more)", more.len()),
        };
        Failure::with_findings(message, findings)
    }

    fn of_call(error: CallError) -> Failure {
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
        /// The component that offers the service, or the address of the server that does.
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
            // No path of a component has this.
            CallError::Busy { provider } if provider.contains("://") => {
                write!(formatter, "the server at `{provider}` is busy")
            }
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

impl Error for CallError {}

impl From<Failure> for CallError {
    fn from(failure: Failure) -> CallError {
        // What a busy component could not do, its caller cannot do now either.
        if let Some(provider) = failure.busy_provider() {
            return CallError::Busy { provider: provider.to_owned() };
        }
        CallError::Failed { provider: String::new(), failure }
    }
}
