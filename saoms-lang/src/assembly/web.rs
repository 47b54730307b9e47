//! Services that are offered over the web, and those of the web that are called.

use std::sync::Arc;
use std::time::Duration;

use crate::OperationSchema;
use crate::model::{HttpAddress, WebPath};
use crate::source::Location;

/// Time within which a call is answered that goes to another program or to the web, or comes from there, unless the
/// composite gives it.
pub const CALL_DEADLINE: Duration = Duration::from_secs(3);

/// A service of a component that the control server of a run offers over HTTP with JSON.
#[derive(Clone, Debug)]
pub struct WebService {
    /// Where it is offered.
    pub path: WebPath,
    /// The service's name in its class.
    pub service: String,
    /// The name of its interface.
    pub interface: String,
    /// The operations of its interface.
    pub operations: Arc<[OperationSchema]>,
    /// The time within which a call is answered, where the composite gives it.
    pub deadline: Option<Duration>,
    /// The place of its binding.
    pub place: Location,
}

/// Places are no part of what is offered.
impl PartialEq for WebService {
    fn eq(&self, other: &WebService) -> bool {
        let WebService { path, service, interface, operations, deadline, place: _ } = other;
        (&self.path, &self.service, &self.interface, &self.operations, &self.deadline)
            == (path, service, interface, operations, deadline)
    }
}

/// A service of an HTTP server that a reference leads to.
#[derive(Clone, Debug)]
pub struct WebTarget {
    /// The address of the service: those of its operations follow it.
    pub address: HttpAddress,
    /// The environment variable with the token that the server asks for.
    pub token_env: Option<String>,
    /// The operations of the interface of the reference.
    pub operations: Arc<[OperationSchema]>,
    /// The place of the token, or else of the address.
    pub place: Location,
}

/// Places are no part of where a reference leads.
impl PartialEq for WebTarget {
    fn eq(&self, other: &WebTarget) -> bool {
        let WebTarget { address, token_env, operations, place: _ } = other;
        (&self.address, &self.token_env, &self.operations) == (address, token_env, operations)
    }
}

impl Eq for WebTarget {}
