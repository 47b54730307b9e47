//! The address of a message broker: `host:port`, or with the name of a transport `tls://host:port`.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};
use std::ops::Range;

/// The port of brokers where nothing else is known: that of ActiveMQ, which the original uses.
const USUAL_PORT: u16 = 61616;

/// What people write before an address although it is no transport: plain TCP is what an address without one means,
/// and a network is named by the text of its address.
const NO_TRANSPORTS: [&str; 3] = ["tcp", "http", "https"];

/// The fault of an address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AddressFault {
    /// The bytes at fault.
    pub(crate) at: Range<usize>,
    pub(crate) message: String,
    /// The right text for the bytes at `at`, where that is plain.
    pub(crate) instead: Option<String>,
}

/// The fault of `text` as an address: the name of a transport and `://`, unless it is plain TCP; a host name, an IPv4
/// address, or an IPv6 address in brackets; then a colon and a port from 1 to 65535.
pub(crate) fn fault(text: &str) -> Option<AddressFault> {
    let at = |at: Range<usize>, message: String| Some(AddressFault { at, message, instead: None });
    if let Some(end) = text.find("://") {
        let (scheme, rest) = (&text[..end], &text[end + 3..]);
        let address = &rest[..rest.find(['/', '?']).unwrap_or(rest.len())];
        let instead = || match fault(address) {
            None => Some(address.to_owned()),
            Some(fault) => fault.instead.filter(|_| fault.at == (0..address.len())),
        };
        if NO_TRANSPORTS.contains(&scheme) {
            let message = format!("found `{scheme}://` before host and port");
            let instead = instead().map(|address| if scheme == "https" { format!("tls://{address}") } else { address });
            return Some(AddressFault { at: 0..text.len(), message, instead });
        }
        if let Some(found) = scheme.find(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c))) {
            let character = scheme[found..].chars().next().unwrap_or(' ');
            let message = format!("`{}` cannot be in the name of a transport", character.escape_debug());
            return at(found..found + character.len_utf8(), message);
        }
        if scheme.is_empty() {
            return at(0..3, "there is no name of a transport before `://`".to_owned());
        }
        let start = end + 3;
        if address.len() < rest.len() {
            let message = "found more behind host and port".to_owned();
            return Some(AddressFault { at: start + address.len()..text.len(), message, instead: Some(String::new()) });
        }
        return fault(rest).map(|fault| AddressFault { at: fault.at.start + start..fault.at.end + start, ..fault });
    }
    let bracket = text.starts_with('[').then(|| text.find(']')).flatten();
    let colon = match bracket {
        Some(end) => text[end..].find(':').map(|at| end + at),
        None => text.rfind(':'),
    };
    let Some(colon) = colon else {
        let is_host =
            !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._".contains(&byte));
        let instead = is_host.then(|| format!("{text}:{USUAL_PORT}"));
        return Some(AddressFault { at: 0..text.len(), message: "there is no port".to_owned(), instead });
    };
    let (host, port) = (&text[..colon], &text[colon + 1..]);
    if host.is_empty() {
        return at(0..text.len(), "there is no host".to_owned());
    }
    if let Some(address) = host.strip_prefix('[') {
        if address.strip_suffix(']').is_none_or(|address| address.parse::<Ipv6Addr>().is_err()) {
            return at(0..colon, format!("`{host}` is not an IPv6 address"));
        }
    } else if host.contains(':') {
        let message = format!("`{host}` is not a host: an IPv6 address is written in brackets");
        let instead = host.parse::<Ipv6Addr>().is_ok().then(|| format!("[{host}]"));
        return Some(AddressFault { at: 0..colon, message, instead });
    } else if let Some(found) = host.find(|c: char| !(c.is_ascii_alphanumeric() || "-._".contains(c))) {
        let character = host[found..].chars().next().unwrap_or(' ');
        return at(
            found..found + character.len_utf8(),
            format!("`{}` cannot be in the name of a host", character.escape_debug()),
        );
    }
    let digits = port.bytes().all(|byte| byte.is_ascii_digit());
    match port.parse::<u16>() {
        Ok(1..) if digits => None,
        _ if port.is_empty() => at(colon..text.len(), "there is no port".to_owned()),
        _ if digits => at(colon + 1..text.len(), format!("port {port} is outside 1 to 65535")),
        _ => at(colon + 1..text.len(), format!("`{port}` is not a port")),
    }
}

/// True if an address without fault names no transport: it is plain TCP.
pub(crate) fn is_plain(text: &str) -> bool {
    !text.contains("://")
}

/// The host and the port of an address without fault.
pub(crate) fn host_and_port(text: &str) -> (&str, &str) {
    let address = text.split_once("://").map_or(text, |(_, address)| address);
    address.rsplit_once(':').unwrap_or((address, ""))
}

/// The IP address that the host of an address is, where it is one; `localhost` is that of this machine.
pub(crate) fn ip(text: &str) -> Option<IpAddr> {
    let (host, _) = host_and_port(text);
    if host.eq_ignore_ascii_case("localhost") {
        return Some(IpAddr::V4(Ipv4Addr::LOCALHOST));
    }
    host.trim_start_matches('[').trim_end_matches(']').parse().ok()
}

/// True if an address without fault is of this machine.
pub(crate) fn is_loopback(text: &str) -> bool {
    ip(text).is_some_and(|address| address.is_loopback())
}
