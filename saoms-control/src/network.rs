//! Where a fleet is reached over the network, and by which names.

use std::fmt;
use std::io::{self, ErrorKind};
use std::net::{IpAddr, SocketAddr, TcpListener, ToSocketAddrs};

use crate::token::Tokens;

/// An address at which a fleet listens on the network, for clients with one of its tokens.
#[derive(Debug)]
pub struct NetworkListener {
    pub(crate) socket: TcpListener,
    pub(crate) tokens: Tokens,
    pub(crate) names: HostNames,
    pub(crate) address: SocketAddr,
}

/// Error of an address at which a fleet should listen.
#[derive(Debug)]
pub enum NetworkError {
    /// The text is no address with a port.
    Malformed(String),
    /// Other machines reach the address, and nobody has allowed that.
    NotLoopback(SocketAddr),
    /// The system refuses it.
    System(io::Error),
}

impl fmt::Display for NetworkError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NetworkError::Malformed(why) => {
                write!(formatter, "expected an address and a port, such as `127.0.0.1:8080`: {why}")
            }
            NetworkError::NotLoopback(address) => write!(
                formatter,
                "other machines can reach {address}, and nothing is encrypted: anyone who can read the network traffic gets the token"
            ),
            NetworkError::System(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for NetworkError {}

impl NetworkListener {
    /// Listens at an address such as `127.0.0.1:8080`, whose port may be 0 for one that the system chooses. Addresses
    /// that other machines reach are refused unless `is_unencrypted` allows them: nothing is encrypted.
    ///
    /// # Errors
    /// See [`NetworkError`].
    pub fn bind(address: &str, is_unencrypted: bool, tokens: Tokens) -> Result<NetworkListener, NetworkError> {
        let malformed = |error: io::Error| NetworkError::Malformed(error.to_string());
        let addresses: Vec<SocketAddr> = address.to_socket_addrs().map_err(malformed)?.collect();
        let first = addresses.first().copied().ok_or_else(|| NetworkError::Malformed("it has none".to_owned()))?;
        if let Some(outer) = addresses.iter().find(|one| !one.ip().is_loopback() && !is_unencrypted) {
            return Err(NetworkError::NotLoopback(*outer));
        }
        let socket = TcpListener::bind(first).map_err(NetworkError::System)?;
        let bound = socket.local_addr().map_err(NetworkError::System)?;
        let name = address.rsplit_once(':').map_or(address, |(name, _)| name);
        let names = HostNames { given: unbracketed(name).to_ascii_lowercase(), is_loopback: bound.ip().is_loopback() };
        Ok(NetworkListener { socket, tokens, names, address: bound })
    }

    /// Its URL, as `http://127.0.0.1:8080`.
    pub fn url(&self) -> String {
        format!("http://{}", self.address)
    }

    /// The files with its tokens.
    pub fn tokens(&self) -> &Tokens {
        &self.tokens
    }
}

/// The names by which a request may call the server. A page of another site reaches it by the name of that site, which
/// points to this machine (DNS rebinding): the name alone gives it away.
#[derive(Clone, Debug)]
pub(crate) struct HostNames {
    /// The name or address on the command line, in lower case.
    given: String,
    is_loopback: bool,
}

impl HostNames {
    /// Those of this machine alone.
    pub(crate) fn of_machine() -> HostNames {
        HostNames { given: "localhost".to_owned(), is_loopback: true }
    }

    /// True if `Host` has such a value, with or without a port. Where other machines reach the server, any address of
    /// it counts: no site has an address for its name.
    pub(crate) fn include(&self, host: &str) -> bool {
        let Some(name) = without_port(host).map(str::to_ascii_lowercase) else { return false };
        let address = name.parse::<IpAddr>().ok();
        name == "localhost" || name == self.given || address.is_some_and(|one| one.is_loopback() || !self.is_loopback)
    }
}

fn unbracketed(name: &str) -> &str {
    name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name)
}

/// The name in a value of `Host`; `None` if it is none.
fn without_port(host: &str) -> Option<&str> {
    let (name, port) = match host.strip_prefix('[') {
        Some(rest) => {
            let (name, port) = rest.split_once(']')?;
            (name, port)
        }
        None => host.find(':').map_or((host, ""), |colon| host.split_at(colon)),
    };
    let is_port = |digits: &str| !digits.is_empty() && digits.parse::<u16>().is_ok();
    (!name.is_empty() && (port.is_empty() || port.strip_prefix(':').is_some_and(is_port))).then_some(name)
}

/// Reads an address such as `http://127.0.0.1:8080` as a client gets it: `host:port`.
///
/// # Errors
/// It is no such address.
pub(crate) fn server_of(url: &str) -> io::Result<String> {
    let wrong = |why: &str| Err(io::Error::new(ErrorKind::InvalidInput, why.to_owned()));
    let Some(rest) = url.strip_prefix("http://") else {
        return wrong(
            "expected an address such as `http://127.0.0.1:8080`; a tunnel such as `ssh -L` reaches other machines",
        );
    };
    let server = rest.strip_suffix('/').unwrap_or(rest);
    let (_, port) = server.rsplit_once(':').unwrap_or_default();
    if server.contains(['/', '@', '?', '#']) || without_port(server).is_none() || port.parse::<u16>().is_err() {
        return wrong("expected an address and a port, such as `http://127.0.0.1:8080`");
    }
    Ok(server.to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    #[test]
    fn a_site_of_the_network_is_no_name_of_the_server() {
        let loopback = HostNames { given: "127.0.0.1".to_owned(), is_loopback: true };
        for host in ["localhost", "LOCALHOST:8080", "127.0.0.1", "127.0.0.1:1", "[::1]:8080", "[::1]", "127.1.2.3"] {
            assert!(loopback.include(host), "{host}");
        }
        for host in [
            "", ":", ":80", "evil.example", "localhost.evil.example:80", "127.0.0.1.evil.example", "192.0.2.1:80",
            "[::2]", "[::1", "::1", "localhost:", "localhost:x", "localhost:99999", "localhost:80:80", "a@localhost",
        ] {
            assert!(!loopback.include(host), "{host}");
        }
        let any = HostNames { given: "fleet.example".to_owned(), is_loopback: false };
        for host in ["Fleet.example:8080", "192.0.2.1:80", "[2001:db8::1]:80", "localhost"] {
            assert!(any.include(host), "{host}");
        }
        assert!(!any.include("evil.example"));
    }

    #[test]
    fn an_address_of_a_client_has_a_port_and_no_path() {
        assert_eq!(server_of("http://127.0.0.1:8080").unwrap(), "127.0.0.1:8080");
        assert_eq!(server_of("http://[::1]:8080/").unwrap(), "[::1]:8080");
        for url in
            ["https://127.0.0.1:8080", "http://", "http://localhost", "http://localhost:80/x", "http://a@b:80", "x:80"]
        {
            assert!(server_of(url).is_err(), "{url}");
        }
    }
}
