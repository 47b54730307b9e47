use std::fmt;

use crate::schedule::change::SetError;
use crate::schedule::{InjectError, UnknownComponent};

/// Error of an order that was refused. It had no effect, unless it says otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OrderError {
    /// The fleet has no such component, or it is passive.
    Component(UnknownComponent),
    /// The property was not set.
    Set(SetError),
    /// The message was not accepted.
    Message(InjectError),
    /// The component offers no such operation.
    Operation(String),
    /// The arguments are none of the operation.
    Arguments(String),
    /// The component failed in the call.
    Call(String),
    /// The component does not run.
    NotRunning(String),
    /// A component that the called one calls is in the middle of an execution.
    Busy(String),
    /// It has not begun: code of the component has not returned, the fleet still starts, or it is paused. It was
    /// withdrawn.
    NotYet,
    /// It has begun, and code of the component has not returned. Whether it takes effect is not known.
    Begun,
    /// The run ends.
    Ending,
}

impl fmt::Display for OrderError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OrderError::Component(error) => error.fmt(formatter),
            OrderError::Set(error) => error.fmt(formatter),
            OrderError::Message(error) => error.fmt(formatter),
            OrderError::Operation(message)
            | OrderError::Arguments(message)
            | OrderError::Call(message)
            | OrderError::NotRunning(message)
            | OrderError::Busy(message) => formatter.write_str(message),
            OrderError::NotYet => formatter.write_str(
                "no answer yet: the code of the component has not returned, or the fleet has not started; the order is withdrawn",
            ),
            OrderError::Begun => formatter.write_str(
                "no answer yet: the order has begun, and the code of the component has not returned",
            ),
            OrderError::Ending => formatter.write_str("the run ends"),
        }
    }
}

impl std::error::Error for OrderError {}
