use std::fmt;
use std::io;

use saoms_api::Failure;

use crate::schedule::component::library::in_library;
use crate::schedule::os::realtime::RealtimeError;

/// Error of a change that was not made. The fleet is as it was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChangeError {
    /// A component cannot end or be replaced now: its code runs, or it refused. A later try may succeed.
    NotNow {
        /// Its path.
        component: String,
        /// The reason.
        why: String,
    },
    /// A new instance of a component cannot be constructed, initialized or restored.
    Failed {
        /// Its path.
        component: String,
        /// Its class.
        class: String,
        /// The library of the code that failed, if it is not linked.
        library: Option<Box<str>>,
        /// Its failure.
        failure: Failure,
    },
    /// A component refuses new values of live properties.
    RefusesValues {
        /// Its path.
        component: String,
        /// Its class.
        class: String,
        /// Its failure.
        failure: Failure,
    },
    /// It cannot be done while the fleet runs, for these reasons.
    Refused(Vec<String>),
    /// Components would lose their state, which nobody allowed.
    LosesState {
        /// Those whose classes save none.
        unsaved: Vec<String>,
        /// Those that become one of another class or site.
        anew: Vec<String>,
    },
    /// The fleet has no such component.
    Unknown(String),
    /// Another change is being made.
    Busy,
    /// Somebody changed the fleet while this change waited for components that leave.
    Meanwhile,
    /// Whoever asked for it took it back.
    Withdrawn,
    /// The run ends.
    Ending,
}

impl ChangeError {
    /// The reason without the component, for a message that names it. It ends with the library of the code that failed.
    pub fn reason(&self) -> String {
        match self {
            ChangeError::NotNow { why, .. } => why.clone(),
            ChangeError::Failed { library, failure, .. } => {
                format!("{failure}{}", library.as_deref().map(in_library).unwrap_or_default())
            }
            ChangeError::RefusesValues { failure, .. } => failure.to_string(),
            ChangeError::Refused(_)
            | ChangeError::LosesState { .. }
            | ChangeError::Unknown(_)
            | ChangeError::Busy
            | ChangeError::Meanwhile
            | ChangeError::Withdrawn
            | ChangeError::Ending => self.to_string(),
        }
    }
}

impl fmt::Display for ChangeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ChangeError::NotNow { component, why } => write!(formatter, "component `{component}`: {why}"),
            ChangeError::Failed { component, class, .. } => {
                let reason = self.reason();
                write!(formatter, "component `{component}` of class `{class}` could not start: {reason}")
            }
            ChangeError::RefusesValues { component, class, failure } => {
                write!(formatter, "component `{component}` of class `{class}` refuses its new values: {failure}")
            }
            ChangeError::Refused(reasons) => formatter.write_str(&reasons.join("; ")),
            ChangeError::LosesState { unsaved, anew } => {
                let of = |components: &[String], one: &str, many: &str| {
                    let why = if components.len() == 1 { one } else { many };
                    let told = || format!("the state of `{}` would be lost: {why}", components.join("`, `"));
                    (!components.is_empty()).then(told)
                };
                let unsaved = of(unsaved, "its class saves none", "their classes save none");
                let anew =
                    of(anew, "it begins anew in another class or site", "they begin anew in another class or site");
                formatter.write_str(&unsaved.into_iter().chain(anew).collect::<Vec<_>>().join("; "))
            }
            ChangeError::Unknown(component) => write!(formatter, "the fleet has no component `{component}`"),
            ChangeError::Busy => formatter.write_str("another change of the fleet is being made: ask again"),
            ChangeError::Meanwhile => formatter.write_str("the fleet changed meanwhile: ask again"),
            ChangeError::Withdrawn => formatter.write_str("the change was taken back before it was made"),
            ChangeError::Ending => formatter.write_str("the run ends"),
        }
    }
}

impl std::error::Error for ChangeError {}

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
        /// The library of the code that failed, if it is not linked.
        library: Option<Box<str>>,
        /// Its failure.
        failure: Failure,
    },
    /// Real-time scheduling was asked for and is not permitted.
    Realtime(RealtimeError),
    /// An observer of the run cannot do its work.
    Observer(Failure),
    /// The system refused to create a thread.
    Thread(io::Error),
    /// The program cannot take part in a network.
    Network {
        /// Where the network is.
        url: String,
        /// What its transport says.
        error: String,
    },
}

impl fmt::Display for StartError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StartError::Component { component, class, library, failure } => {
                let library = library.as_deref().map(in_library).unwrap_or_default();
                write!(formatter, "component `{component}` of class `{class}` could not start: {failure}{library}")
            }
            StartError::Realtime(error) => error.fmt(formatter),
            StartError::Observer(failure) => failure.fmt(formatter),
            StartError::Thread(error) => {
                write!(formatter, "the system cannot create a thread for the fleet: {error}")
            }
            StartError::Network { url, error } => write!(formatter, "the network `{url}` cannot be used: {error}"),
        }
    }
}

impl std::error::Error for StartError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            StartError::Component { .. } | StartError::Observer(_) | StartError::Network { .. } => None,
            StartError::Realtime(error) => Some(error),
            StartError::Thread(error) => Some(error),
        }
    }
}

impl From<ChangeError> for StartError {
    fn from(error: ChangeError) -> StartError {
        match error {
            ChangeError::Failed { component, class, library, failure } => {
                StartError::Component { component, class, library, failure }
            }
            // The other errors need a running fleet.
            other => StartError::Observer(Failure::new(other.to_string())),
        }
    }
}
