//! Alerts by HTTP: a request for each change, on a connection of its own.

use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use saoms_lang::model::HttpAddress;

use super::delivery::{End, Failed};
use crate::token::Token;

/// Time for a request, without the look-up of its name.
const PATIENCE: Duration = Duration::from_secs(5);
/// Bytes of an answer within which its status has to stand.
const STATUS_LINE: usize = 256;

/// Posts a text of JSON; `Err` says why nobody took it.
pub(super) fn post(address: &HttpAddress, token: Option<&Token>, body: &str, end: &End) -> Result<(), Failed> {
    let failed = |error: io::Error| Failed::ForNow(reason(&error));
    let places = (address.host.as_str(), address.port).to_socket_addrs().map_err(failed)?;
    let deadline = end.deadline().unwrap_or_else(|| Instant::now() + PATIENCE).min(Instant::now() + PATIENCE);
    let mut last = io::Error::other("its name has no address");
    for place in places {
        let connected = left(deadline).and_then(|left| TcpStream::connect_timeout(&place, left));
        match connected {
            Ok(stream) => {
                let request = request(address, token, body);
                return judged(&exchange(stream, request.as_bytes(), deadline).map_err(failed)?);
            }
            Err(error) => last = error,
        }
    }
    Err(failed(last))
}

fn request(address: &HttpAddress, token: Option<&Token>, body: &str) -> String {
    let HttpAddress { authority, target, .. } = address;
    let secret = token.map(|token| format!("Authorization: {}\r\n", token.authorization())).unwrap_or_default();
    format!(
        "POST {target} HTTP/1.1\r\nHost: {authority}\r\nUser-Agent: saoms/{}\r\nContent-Type: application/json\r\n\
         Content-Length: {}\r\n{secret}Connection: close\r\n\r\n{body}",
        env!("CARGO_PKG_VERSION"),
        body.len()
    )
}

/// The time that is left.
fn left(deadline: Instant) -> io::Result<Duration> {
    let left = deadline.saturating_duration_since(Instant::now());
    // The system takes 0 for no limit.
    if left.is_zero() { Err(io::ErrorKind::TimedOut.into()) } else { Ok(left) }
}

/// Sends a request, and gives the first line of the answer.
fn exchange(mut stream: TcpStream, mut request: &[u8], deadline: Instant) -> io::Result<String> {
    while !request.is_empty() {
        // One that takes a byte now and then must not hold up the others.
        stream.set_write_timeout(Some(left(deadline)?))?;
        let written = stream.write(request)?;
        request = &request[written..];
    }
    let mut answer = Vec::new();
    while !answer.contains(&b'\n') && answer.len() < STATUS_LINE {
        stream.set_read_timeout(Some(left(deadline)?))?;
        let mut part = [0; STATUS_LINE];
        match stream.read(&mut part)? {
            0 => break,
            count => answer.extend_from_slice(&part[..count]),
        }
    }
    let text = String::from_utf8_lossy(&answer);
    Ok(text.lines().next().unwrap_or_default().to_owned())
}

/// What the first line of an answer means.
fn judged(line: &str) -> Result<(), Failed> {
    let status = line.strip_prefix("HTTP/1.").and_then(|rest| rest.get(2..5)).and_then(|status| status.parse().ok());
    let Some(status) = status else { return Err(Failed::ForNow("it does not answer in HTTP".to_owned())) };
    let status: u16 = status;
    let text = format!("it answers with the status {status}");
    match status {
        200..=299 => Ok(()),
        300..=399 => Err(Failed::ForGood(format!("{text}: use the address to which it redirects"))),
        // Too early, too slow or too many.
        408 | 425 | 429 => Err(Failed::ForNow(text)),
        400..=499 => Err(Failed::ForGood(text)),
        _ => Err(Failed::ForNow(text)),
    }
}

/// What an error of a connection means.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        // A limit of a socket is told in this way.
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => {
            format!("it does not answer within {} s", PATIENCE.as_secs())
        }
        _ => error.to_string(),
    }
}
