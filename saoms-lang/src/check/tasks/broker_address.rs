//! The address of a network: that of its message broker, `host:port`, or with the name of a transport
//! `tls://host:port`; or those of all its programs, `peers://hall=host:port,gate=host:port`.

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

/// The transports that do not encrypt, each with the one in its place that does. What a transport does that is not
/// among these is known to its library alone.
const IN_CLEAR: [(&str, &str); 4] =
    [("", "tls://"), ("peers://", "peers+tls://"), ("mqtt://", "mqtts://"), ("stomp://", "stomp+ssl://")];

/// The transports of topics of programs that are no part of a fleet: these speak a language of their own, without TLS.
const OF_TOPICS: [&str; 2] = ["ros2://", "rosbridge://"];

/// True if an address leads to topics of programs that are no part of a fleet, as far as is known here.
pub(crate) fn is_of_topics(text: &str) -> bool {
    OF_TOPICS.iter().any(|begin| text.starts_with(begin))
}

/// How the addresses of networks without a broker begin: without TLS, and with it.
const OF_PEERS: [&str; 2] = ["peers://", "peers+tls://"];

/// The programs of a network without a broker, each with its name and where it listens; `None` for one with a broker.
pub(crate) fn peers(text: &str) -> Option<impl Iterator<Item = (&str, &str)>> {
    let list = OF_PEERS.iter().find_map(|begin| text.strip_prefix(begin))?;
    Some(list.split(',').map(|peer| peer.split_once('=').unwrap_or(("", peer))))
}

/// The fault of the list of the programs of a network without a broker, which begins at this byte.
fn fault_of_peers(list: &str, start: usize) -> Option<AddressFault> {
    let mut known: Vec<(&str, &str)> = Vec::new();
    let mut at = start;
    for peer in list.split(',') {
        let place = at..at + peer.len();
        at = place.end + 1;
        let fault_at = |at: Range<usize>, message: String| Some(AddressFault { at, message, instead: None });
        let Some((name, address)) = peer.split_once('=').filter(|(name, _)| !name.is_empty()) else {
            let message = "each peer has a name before `=`, and its address behind it".to_owned();
            return fault_at(place, message);
        };
        let address_at = place.start + name.len() + 1;
        if let Some(fault) = fault(address) {
            return Some(AddressFault { at: fault.at.start + address_at..fault.at.end + address_at, ..fault });
        }
        if !is_plain(address) {
            let message = "an address of a peer has no transport of its own".to_owned();
            return fault_at(address_at..place.end, message);
        }
        if known.iter().any(|(other, _)| *other == name) {
            return fault_at(place.start..address_at - 1, format!("peer `{name}` is named twice"));
        }
        if known.iter().any(|(_, other)| *other == address) {
            return fault_at(address_at..place.end, format!("two peers listen at `{address}`"));
        }
        known.push((name, address));
    }
    let message = "one peer has nobody to speak with: name at least two, with `,` between them".to_owned();
    (known.len() < 2).then_some(AddressFault { at: start..start + list.len(), message, instead: None })
}

/// The fault of `text` as an address: the name of a transport and `://`, unless it is plain TCP; a host name, an IPv4
/// address, or an IPv6 address in brackets; then a colon and a port from 1 to 65535.
pub(crate) fn fault(text: &str) -> Option<AddressFault> {
    if let Some(begin) = OF_PEERS.iter().find(|begin| text.starts_with(**begin)) {
        return fault_of_peers(&text[begin.len()..], begin.len());
    }
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

/// How a network is named with TLS whose address is without it; `None` for one that encrypts, as far as is known here.
pub(crate) fn encrypted(text: &str) -> Option<String> {
    let begin = text.find("://").map_or(0, |end| end + 3);
    let (_, instead) = IN_CLEAR.iter().find(|(clear, _)| *clear == &text[..begin])?;
    Some(format!("{instead}{}", &text[begin..]))
}

/// True if what goes to an address without fault is not encrypted, as far as is known here.
pub(crate) fn is_in_clear(text: &str) -> bool {
    encrypted(text).is_some()
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

/// True if an address without fault is of this machine; of peers, if all are.
pub(crate) fn is_loopback(text: &str) -> bool {
    if let Some(mut peers) = peers(text) {
        return peers.all(|(_, address)| is_loopback(address));
    }
    ip(text).is_some_and(|address| address.is_loopback())
}
