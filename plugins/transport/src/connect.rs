//! A look at who listens at an address, with words of our own for what goes wrong.

use std::io::{ErrorKind, Read};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use crate::Failure;

/// Longest time for an attempt to connect.
const PATIENCE: Duration = Duration::from_millis(500);

/// What ActiveMQ says first in its own language, OpenWire, behind a length.
pub(crate) const ACTIVE_MQ: &[u8] = b"ActiveMQ";

/// What somebody says who speaks first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Greeting {
    /// Nothing.
    Nothing,
    /// That of ActiveMQ, in its own language.
    ActiveMq,
    /// Something else.
    Other,
}

/// Connects to `host:port`.
///
/// # Errors
/// Nobody listens there, or the address is none.
pub fn connect(address: &str) -> Result<TcpStream, Failure> {
    let addresses = address.to_socket_addrs().map_err(|error| match error.kind() {
        ErrorKind::InvalidInput => Failure::failed(format!("`{address}` is not an address: write `host:port`")),
        _ => Failure::unreachable(format!("the name of the machine is not known: {error}")),
    })?;
    let mut why = "its name has no address".to_owned();
    for one in addresses {
        match TcpStream::connect_timeout(&one, PATIENCE) {
            Ok(stream) => return Ok(stream),
            Err(error) => {
                why = match error.kind() {
                    ErrorKind::ConnectionRefused => "nobody listens there".to_owned(),
                    ErrorKind::TimedOut => "the machine does not answer".to_owned(),
                    ErrorKind::HostUnreachable => "the machine cannot be reached, or is off".to_owned(),
                    ErrorKind::NetworkUnreachable => "this machine has no network that leads there".to_owned(),
                    _ => error.to_string(),
                };
            }
        }
    }
    Err(Failure::unreachable(why))
}

impl Greeting {
    /// Waits this long for what the other end says first.
    pub fn of(mut stream: &TcpStream, patience: Duration) -> Greeting {
        let mut greeting = [0; 64];
        let _ = stream.set_read_timeout(Some(patience));
        match stream.read(&mut greeting).unwrap_or_default() {
            0 => Greeting::Nothing,
            length if is_active_mq(&greeting[..length]) => Greeting::ActiveMq,
            _ => Greeting::Other,
        }
    }
}

/// True for bytes with which ActiveMQ begins in its own language.
pub(crate) fn is_active_mq(bytes: &[u8]) -> bool {
    bytes.windows(ACTIVE_MQ.len()).any(|part| part == ACTIVE_MQ)
}
