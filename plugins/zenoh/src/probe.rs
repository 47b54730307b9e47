//! A look at who listens at an address, before Zenoh speaks to it: Zenoh says of all faults that it timed out.

use std::io::{ErrorKind, Read};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use saoms_abi::Status;

use super::Failure;

/// Longest time for an attempt to connect.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time for which a greeting is waited for.
const GREETING: Duration = Duration::from_millis(100);

/// Looks who listens at `host:port`.
///
/// # Errors
/// Nobody, or somebody who does not speak Zenoh.
pub(super) fn probe(address: &str) -> Result<(), Failure> {
    let unreachable = |text: String| Failure { status: Status::UNREACHABLE, text };
    let addresses = address.to_socket_addrs().map_err(|error| match error.kind() {
        ErrorKind::InvalidInput => Failure::failed(format!("`{address}` is not an address: write `host:port`")),
        _ => unreachable(format!("the name of the machine is not known: {error}")),
    })?;
    let mut why = "its name has no address".to_owned();
    for one in addresses {
        let mut stream = match TcpStream::connect_timeout(&one, PATIENCE) {
            Ok(stream) => stream,
            Err(error) => {
                why = match error.kind() {
                    ErrorKind::ConnectionRefused => "nobody listens there".to_owned(),
                    ErrorKind::TimedOut => "the machine does not answer".to_owned(),
                    ErrorKind::HostUnreachable => "the machine cannot be reached, or is off".to_owned(),
                    ErrorKind::NetworkUnreachable => "this machine has no network that leads there".to_owned(),
                    _ => error.to_string(),
                };
                continue;
            }
        };
        // ActiveMQ and others speak first; a router of Zenoh waits.
        let mut greeting = [0; 64];
        let _ = stream.set_read_timeout(Some(GREETING));
        let length = stream.read(&mut greeting).unwrap_or_default();
        return match &greeting[..length] {
            [] => Ok(()),
            text if text.windows(8).any(|part| part == b"ActiveMQ") => Err(Failure::failed(
                "an ActiveMQ broker listens there, which speaks another language: start the fleet's own broker at another port, \
                 and name that in `url`",
            )),
            _ => Err(Failure::failed(
                "who listens there speaks first, which no router of a fleet does: another program has this port",
            )),
        };
    }
    Err(unreachable(why))
}
