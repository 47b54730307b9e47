//! A look at who listens at an address, before Zenoh speaks to it: Zenoh says of all faults that it timed out.

use std::time::Duration;

use saoms_transport::{Failure, Greeting, connect};

/// Time for which a greeting is waited for.
const GREETING: Duration = Duration::from_millis(100);

/// Looks who listens at `host:port`.
///
/// # Errors
/// Nobody, or somebody who does not speak Zenoh.
pub(super) fn probe(address: &str) -> Result<(), Failure> {
    // ActiveMQ and others speak first; a router of Zenoh waits.
    match Greeting::of(&connect(address)?, GREETING) {
        Greeting::Nothing => Ok(()),
        Greeting::ActiveMq => Err(Failure::failed(
            "an ActiveMQ broker listens there, which speaks another language: start the fleet's own broker at another port, \
             and name that in `url`; or join that one at its connector for STOMP, as `stomp://host:61613` (docs/brokers.md)",
        )),
        Greeting::Other => Err(Failure::failed(
            "who listens there speaks first, which no router of a fleet does: another program has this port",
        )),
    }
}
