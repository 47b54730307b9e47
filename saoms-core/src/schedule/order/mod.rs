//! Orders of operators to a running fleet: each is a line of text, takes effect at an instant, and is in the journal,
//! from which it can be given again.

mod call;
mod carry_out;
mod error;
mod pending;
mod read;
mod remote;
mod ticket;

use std::fmt;
use std::time::Duration;

use saoms_api::host::format_duration;
use serde_json::Value;

pub(super) use carry_out::accept;
pub use error::OrderError;
pub(super) use pending::{InCode, PendingOrder, PendingOrders};
pub use read::TimedOrder;
pub(super) use remote::RemoteCall;
pub use ticket::{OrderTicket, OrderWithdrawal};

/// An order of an operator to a running fleet. [`Order::read`] reads what [`Display`](fmt::Display) writes.
///
/// ```
/// use saoms_core::schedule::Order;
///
/// let line = "at 3s set Robot7 speed=2";
/// let read = Order::read(line).unwrap()?;
/// assert_eq!(read.order, Order::Set { component: "Robot7".into(), property: "speed".into(), value: "2".into() });
/// assert_eq!(read.order.to_string(), "set Robot7 speed=2");
/// assert!(Order::read("luggage (3,1) to (3,10)").is_none());
/// # Ok::<(), saoms_api::extension::LineFault>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Schedules a periodic component.
    Start {
        /// Its path.
        component: String,
        /// Time after which it is unscheduled again.
        lasting: Option<Duration>,
    },
    /// Unschedules a periodic component.
    Stop {
        /// Its path.
        component: String,
    },
    /// Changes a property that is declared `live`.
    Set {
        /// The path of the component.
        component: String,
        /// The property.
        property: String,
        /// The value, as a composite has it.
        value: String,
    },
    /// Calls an operation of a service.
    Call {
        /// The path of the component; the name of one of its services may follow: `Robot7/move`.
        component: String,
        /// The operation.
        operation: String,
        /// Its arguments by name.
        arguments: Vec<(String, Value)>,
    },
    /// Stops components and their hardware at once, until they are released.
    EmergencyStop {
        /// Their paths; without any, all that move something.
        components: Vec<String>,
        /// Who stops them.
        by: Option<String>,
    },
    /// Releases components that were stopped.
    Release {
        /// Their paths; without any, all that are stopped.
        components: Vec<String>,
        /// Who releases them.
        by: Option<String>,
    },
    /// Publishes a message on a topic.
    Publish {
        /// The topic, by the name that it has after renaming.
        topic: String,
        /// The message.
        message: Value,
    },
}

impl fmt::Display for Order {
    /// The line of the order, without a time.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Order::Start { component, lasting: None } => write!(formatter, "start {component}"),
            Order::Start { component, lasting: Some(time) } => {
                write!(formatter, "start {component} for {}", format_duration(*time))
            }
            Order::Stop { component } => write!(formatter, "stop {component}"),
            Order::Set { component, property, value } => {
                write!(formatter, "set {component} {property}=")?;
                if is_plain(value) { formatter.write_str(value) } else { Value::from(value.as_str()).fmt(formatter) }
            }
            Order::Call { component, operation, arguments } => {
                write!(formatter, "call {component}.{operation}")?;
                arguments.iter().try_for_each(|(name, value)| write!(formatter, " {name}={value}"))
            }
            Order::EmergencyStop { components, by } => write_stop(formatter, "estop", components, by.as_deref()),
            Order::Release { components, by } => write_stop(formatter, "release", components, by.as_deref()),
            Order::Publish { topic, message } => write!(formatter, "publish {topic} {message}"),
        }
    }
}

fn write_stop(formatter: &mut fmt::Formatter<'_>, word: &str, components: &[String], by: Option<&str>) -> fmt::Result {
    formatter.write_str(word)?;
    components.iter().try_for_each(|component| write!(formatter, " {component}"))?;
    by.map_or(Ok(()), |name| write!(formatter, " by {name}"))
}

/// True if a value stands in a line without quotes.
fn is_plain(value: &str) -> bool {
    value.trim() == value && !value.starts_with('"') && !value.contains(char::is_control)
}
