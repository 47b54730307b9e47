//! Calls of services of the web: what the run has to know of whoever makes them.

use std::fmt;
use std::time::Duration;

use saoms_lang::OperationSchema;
use saoms_lang::assembly::WebTarget;
use serde_json::Value;

/// The client of a run for services of the web. Components call on threads of their own, several at a time, and wait.
pub trait WebClient: fmt::Debug + Send + Sync {
    /// Makes a call, and gives its reply as JSON: `null` where there is none.
    ///
    /// # Errors
    /// There is no reply that could be read.
    fn call(&self, call: &WebCall<'_>) -> Result<Value, WebError>;
}

/// A call of a service of the web.
pub struct WebCall<'a> {
    /// The service.
    pub target: &'a WebTarget,
    /// Its operation.
    pub operation: &'a OperationSchema,
    /// The arguments: an object with each by its name.
    pub arguments: &'a Value,
    /// The time within which it is answered, once the name of the server is looked up.
    pub deadline: Duration,
    /// True once its caller is to end: nothing is waited for then.
    pub is_cancelled: &'a dyn Fn() -> bool,
}

impl fmt::Debug for WebCall<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let operation = &self.operation.name;
        formatter.debug_struct("WebCall").field("target", &self.target.address).field("operation", operation).finish()
    }
}

/// The reason why a call of a service of the web brought no reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WebError {
    /// The server says that it is busy now, and is to be asked again.
    Busy,
    /// There is no answer within the deadline: whether the server has carried it out is not known.
    Late,
    /// Anything else, in words that follow the name of the server.
    Failed(String),
}
