//! Requests of HTTP/1.1 to servers that a composite names: each on a connection of its own, with a time until which it
//! waits.

use std::error::Error;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs};
use std::os::fd::AsRawFd;
use std::time::{Duration, Instant};

use saoms_lang::model::HttpAddress;
use socket2::{Domain, Socket, Type};

use crate::token::Token;

/// Time after which who waits looks whether it is to end.
const LOOK: Duration = Duration::from_millis(50);
/// The most bytes of the head of an answer, and of what follows its last part.
const LONGEST_HEAD: usize = 65_536;
/// The most bytes of the line before a part of a body.
const LONGEST_LINE: usize = 4_096;
/// Bytes that are read at once.
const PART: usize = 16_384;

/// How long a request waits.
#[derive(Clone, Copy)]
pub(crate) struct Patience<'a> {
    pub(crate) until: Instant,
    /// True once nobody waits for the answer.
    pub(crate) is_cancelled: &'a dyn Fn() -> bool,
}

impl Patience<'_> {
    /// The time for the next step; the system takes 0 for no limit.
    fn step(&self) -> io::Result<Duration> {
        if (self.is_cancelled)() {
            return Err(io::Error::other(Cancelled));
        }
        let left = self.until.saturating_duration_since(Instant::now());
        if left.is_zero() { Err(ErrorKind::TimedOut.into()) } else { Ok(left) }
    }
}

/// The error of a request for which nobody waits any more.
#[derive(Debug)]
struct Cancelled;

impl fmt::Display for Cancelled {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("its caller is to end")
    }
}

impl Error for Cancelled {}

/// A request, sent: what its server answers is read from the connection.
pub(crate) struct Exchange<'a> {
    stream: TcpStream,
    patience: Patience<'a>,
    /// What was read and not taken.
    ahead: Vec<u8>,
}

/// The head of an answer.
#[derive(Debug)]
pub(crate) struct Head {
    pub(crate) status: u16,
    /// Names in lower case.
    headers: Vec<(String, String)>,
}

impl Head {
    /// The value of a header that is there.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

/// The text of a POST with JSON to a path of a server.
pub(crate) fn post(address: &HttpAddress, path: &str, token: Option<&Token>, body: &str) -> String {
    let secret = token.map(|token| format!("Authorization: {}\r\n", token.authorization())).unwrap_or_default();
    format!(
        "POST {path} HTTP/1.1\r\nHost: {}\r\nUser-Agent: saoms/{}\r\nContent-Type: application/json\r\n\
         Content-Length: {}\r\n{secret}Accept: application/json\r\nConnection: close\r\n\r\n{body}",
        address.authority,
        env!("CARGO_PKG_VERSION"),
        body.len()
    )
}

/// The places of a server. The system says how long it looks for them, so that no time of a request begins before.
///
/// # Errors
/// Its name is not known.
pub(crate) fn places(address: &HttpAddress) -> io::Result<Vec<SocketAddr>> {
    let places: Vec<SocketAddr> = (address.host.as_str(), address.port).to_socket_addrs()?.collect();
    if places.is_empty() { Err(io::Error::other("its name has no address")) } else { Ok(places) }
}

/// Connects to the first of the places of a server that answers, and sends a request.
///
/// # Errors
/// Nobody takes it in time.
pub(crate) fn send<'a>(places: &[SocketAddr], request: &[u8], patience: Patience<'a>) -> io::Result<Exchange<'a>> {
    let mut last = io::Error::from(ErrorKind::NotFound);
    for (place, others) in places.iter().zip((0..places.len() as u32).rev()) {
        // One that says nothing leaves time for the others.
        let share = patience.step()? / (others + 1);
        match connect(place, Patience { until: Instant::now() + share, ..patience }) {
            Ok(stream) => {
                let mut exchange = Exchange { stream, patience, ahead: Vec::new() };
                exchange.write(request)?;
                return Ok(exchange);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Connects to a place, in steps: the system knows no way to give up a connection from elsewhere.
fn connect(place: &SocketAddr, patience: Patience<'_>) -> io::Result<TcpStream> {
    let socket = Socket::new(Domain::for_address(*place), Type::STREAM, None)?;
    socket.set_nonblocking(true)?;
    match socket.connect(&(*place).into()) {
        // It goes on, after a signal too.
        Err(error) if error.raw_os_error() == Some(libc::EINPROGRESS) || error.kind() == ErrorKind::Interrupted => {
            while !is_connected(&socket, patience.step()?.min(LOOK))? {}
        }
        other => other?,
    }
    socket.set_nonblocking(false)?;
    Ok(socket.into())
}

/// True once a socket that connects is connected; false after this time.
fn is_connected(socket: &Socket, time: Duration) -> io::Result<bool> {
    let mut asked = libc::pollfd { fd: socket.as_raw_fd(), events: libc::POLLOUT, revents: 0 };
    // SAFETY: it is given one `pollfd`, which is ours and alive, and the descriptor is open as long as the socket.
    let count = unsafe { libc::poll(&raw mut asked, 1, time.as_millis().max(1) as libc::c_int) };
    match count {
        0 => Ok(false),
        1.. => socket.take_error()?.map_or(Ok(true), Err),
        _ => match io::Error::last_os_error() {
            error if error.kind() == ErrorKind::Interrupted => Ok(false),
            error => Err(error),
        },
    }
}

fn malformed(what: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, what)
}

/// True if a part of the time for a request is over, and not all of it, or a signal came.
fn is_pause(error: &io::Error) -> bool {
    // A limit of a socket is told in the first two ways.
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

impl Exchange<'_> {
    fn write(&mut self, mut request: &[u8]) -> io::Result<()> {
        while !request.is_empty() {
            // One that takes a byte now and then must not hold up its caller.
            self.stream.set_write_timeout(Some(self.patience.step()?.min(LOOK)))?;
            match self.stream.write(request) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(written) => request = &request[written..],
                Err(error) if is_pause(&error) => {}
                // It may have answered before it has read all.
                Err(error) if error.kind() == ErrorKind::BrokenPipe => return Ok(()),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Reads more. False at the end.
    fn read(&mut self) -> io::Result<bool> {
        let mut part = [0; PART];
        loop {
            self.stream.set_read_timeout(Some(self.patience.step()?.min(LOOK)))?;
            match self.stream.read(&mut part) {
                Ok(count) => {
                    self.ahead.extend_from_slice(&part[..count]);
                    return Ok(count > 0);
                }
                Err(error) if is_pause(&error) => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Takes a line, without its end.
    fn line(&mut self, left: &mut usize) -> io::Result<String> {
        loop {
            if let Some(end) = self.ahead.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = self.ahead.drain(..=end).collect();
                *left =
                    left.checked_sub(line.len()).ok_or_else(|| malformed("answers with a head that is too long"))?;
                return Ok(String::from_utf8_lossy(&line).trim_end_matches(['\r', '\n']).to_owned());
            }
            if self.ahead.len() > *left {
                return Err(malformed("answers with a head that is too long"));
            }
            if !self.read()? {
                return Err(malformed("answers incompletely"));
            }
        }
    }

    /// The status of the answer.
    ///
    /// # Errors
    /// It does not answer in time, or not in HTTP.
    pub(crate) fn status(&mut self) -> io::Result<u16> {
        let mut left = LONGEST_HEAD;
        self.status_line(&mut left)
    }

    fn status_line(&mut self, left: &mut usize) -> io::Result<u16> {
        if self.ahead.is_empty() && !self.read()? {
            return Err(malformed("closes the connection without an answer"));
        }
        let line = self.line(left)?;
        let status = line.strip_prefix("HTTP/1.").and_then(|rest| rest.get(2..5)).and_then(|text| text.parse().ok());
        status.filter(|status| (100..=599).contains(status)).ok_or_else(|| malformed("does not answer in HTTP"))
    }

    /// The head of the answer.
    ///
    /// # Errors
    /// As [`status`](Exchange::status).
    pub(crate) fn head(&mut self) -> io::Result<Head> {
        let mut left = LONGEST_HEAD;
        loop {
            let status = self.status_line(&mut left)?;
            let mut headers = Vec::new();
            loop {
                let line = self.line(&mut left)?;
                if line.is_empty() {
                    break;
                }
                let (name, value) =
                    line.split_once(':').ok_or_else(|| malformed("answers with a header that is none"))?;
                headers.push((name.to_ascii_lowercase(), value.trim().to_owned()));
            }
            // What comes before the answer says nothing.
            if status >= 200 {
                return Ok(Head { status, headers });
            }
        }
    }

    /// The body of the answer with this head.
    ///
    /// # Errors
    /// It does not come in time or in full, or has more bytes than these.
    pub(crate) fn body(&mut self, head: &Head, most: usize) -> io::Result<Vec<u8>> {
        let too_long = || malformed(&format!("answers with more than {most} bytes"));
        if matches!(head.status, 204 | 304) {
            return Ok(Vec::new());
        }
        if let Some(encoding) = head.header("transfer-encoding") {
            if !encoding.eq_ignore_ascii_case("chunked") {
                return Err(malformed(&format!("answers in the encoding `{encoding}`")));
            }
            return self.chunks(most);
        }
        let mut lengths = head.headers.iter().filter(|(name, _)| name == "content-length").map(|(_, value)| value);
        let Some(length) = lengths.next() else {
            while self.ahead.len() <= most && self.read()? {}
            return match self.ahead.len() <= most {
                true => Ok(std::mem::take(&mut self.ahead)),
                false => Err(too_long()),
            };
        };
        let number = length.parse::<usize>().ok().filter(|_| length.bytes().all(|byte| byte.is_ascii_digit()));
        let number = number.filter(|_| lengths.all(|other| other == length));
        let number = number.ok_or_else(|| malformed("answers with a length that is none"))?;
        if number > most {
            return Err(too_long());
        }
        self.take(number)
    }

    fn take(&mut self, count: usize) -> io::Result<Vec<u8>> {
        while self.ahead.len() < count {
            if !self.read()? {
                let found = self.ahead.len();
                return Err(malformed(&format!("answers incompletely: {found} of {count} bytes came")));
            }
        }
        Ok(self.ahead.drain(..count).collect())
    }

    fn chunks(&mut self, most: usize) -> io::Result<Vec<u8>> {
        let mut body = Vec::new();
        loop {
            let line = self.line(&mut { LONGEST_LINE })?;
            let digits = line.split(';').next().unwrap_or_default().trim();
            let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
            let length = usize::from_str_radix(digits, 16).ok().filter(|_| is_number);
            let length = length.ok_or_else(|| malformed("answers with a part whose length is none"))?;
            if length == 0 {
                let mut left = LONGEST_HEAD;
                while !self.line(&mut left)?.is_empty() {}
                return Ok(body);
            }
            if length > most.saturating_sub(body.len()) {
                return Err(malformed(&format!("answers with more than {most} bytes")));
            }
            body.extend(self.take(length)?);
            if !self.line(&mut { LONGEST_LINE })?.is_empty() {
                return Err(malformed("answers with a part that is longer than it says"));
            }
        }
    }
}

/// What an error of a request means, in words that follow the name of the server; `None` if the time is over.
pub(crate) fn reason(error: &io::Error) -> Option<String> {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => None,
        ErrorKind::InvalidData => Some(error.to_string()),
        _ if error.get_ref().is_some_and(|inner| inner.is::<Cancelled>()) => {
            Some(format!("is not waited for any more: {error}"))
        }
        _ => Some(format!("cannot be reached: {error}")),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::net::TcpListener;
    use std::thread;

    use saoms_lang::model::AddressHelp;

    use super::*;

    /// What comes of an answer of these bytes: status and body, or the error.
    fn answered(answer: &[u8], most: usize) -> Result<(u16, String), String> {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}/a", listener.local_addr().unwrap());
        let address = HttpAddress::parse(&url, &AddressHelp::SERVICES).unwrap();
        let answer = answer.to_owned();
        let server = thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let mut request = [0; 1024];
            let count = stream.read(&mut request).unwrap();
            // Piece by piece.
            for part in answer.chunks(7) {
                if stream.write_all(part).is_err() {
                    break;
                }
            }
            String::from_utf8_lossy(&request[..count]).into_owned()
        });
        let patience = Patience { until: Instant::now() + Duration::from_secs(20), is_cancelled: &|| false };
        let result = send(&places(&address).unwrap(), post(&address, "/a/b", None, "{}").as_bytes(), patience)
            .and_then(|mut exchange| {
                let head = exchange.head()?;
                let body = exchange.body(&head, most)?;
                Ok((head.status, String::from_utf8_lossy(&body).into_owned()))
            });
        assert!(server.join().unwrap().starts_with("POST /a/b HTTP/1.1\r\nHost: 127.0.0.1:"));
        result.map_err(|error| error.to_string())
    }

    #[test]
    fn answers_are_read_however_their_length_is_told() {
        for (answer, expected) in [
            ("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n42more", "42"),
            ("HTTP/1.0 200 OK\r\n\r\n42", "42"),
            ("HTTP/1.1 200 OK\nConnection: close\n\n42", "42"),
            ("HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n1\r\n4\r\n1;x=y\r\n2\r\n0\r\nA: b\r\n\r\n", "42"),
            ("HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 200 OK\r\ncontent-length:1\r\n\r\n7", "7"),
        ] {
            assert_eq!(answered(answer.as_bytes(), 100), Ok((200, expected.to_owned())), "{answer}");
        }
        let chunk = format!("1;{}\r\n4\r\n", "x".repeat(3_000));
        let many = format!("HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n{}0\r\n\r\n", chunk.repeat(50));
        assert_eq!(answered(many.as_bytes(), 100), Ok((200, "4".repeat(50))));
        assert_eq!(answered(b"HTTP/1.1 204 No Content\r\nContent-Length: 9\r\n\r\n", 1), Ok((204, String::new())));
    }

    #[test]
    fn answers_that_are_none_are_told() {
        let long = format!("HTTP/1.1 200 OK\r\nX: {}\r\n", "x".repeat(LONGEST_HEAD));
        for (answer, expected) in [
            ("", "closes the connection without an answer"),
            ("HTTP/1.1 20", "answers incompletely"),
            ("HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\n42", "answers incompletely: 2 of 5 bytes came"),
            ("HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n5\r\n42", "answers incompletely: 2 of 5 bytes came"),
            (
                "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n+1\r\n4",
                "answers with a part whose length is none",
            ),
            (
                "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n1\r\n42\r\n",
                "answers with a part that is longer than it says",
            ),
            ("HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nfff\r\n", "answers with more than 100 bytes"),
            ("HTTP/1.1 200 OK\r\nTransfer-Encoding: gzip\r\n\r\n", "answers in the encoding `gzip`"),
            ("HTTP/1.1 200 OK\r\nContent-Length: 101\r\n\r\n", "answers with more than 100 bytes"),
            ("HTTP/1.1 200 OK\r\nContent-Length: +1\r\n\r\n4", "answers with a length that is none"),
            (
                "HTTP/1.1 200 OK\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n42",
                "answers with a length that is none",
            ),
            ("HTTP/1.1 200 OK\r\nno header\r\n\r\n", "answers with a header that is none"),
            ("SSH-2.0-OpenSSH_9.6\r\n", "does not answer in HTTP"),
            ("HTTP/1.1 999 OK\r\n\r\n", "does not answer in HTTP"),
            (&long, "answers with a head that is too long"),
        ] {
            assert_eq!(answered(answer.as_bytes(), 100), Err(expected.to_owned()), "{answer:.60}");
        }
        let huge = format!("HTTP/1.1 200 OK\r\n\r\n{}", "x".repeat(500));
        assert_eq!(answered(huge.as_bytes(), 100), Err("answers with more than 100 bytes".to_owned()));
    }

    #[test]
    fn the_next_place_of_a_server_gets_its_turn() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let full = Socket::new(Domain::IPV4, Type::STREAM, None).unwrap();
        full.bind(&"127.0.0.1:0".parse::<SocketAddr>().unwrap().into()).unwrap();
        full.listen(0).unwrap();
        let silent = full.local_addr().unwrap().as_socket().unwrap();
        // Once nobody takes connections any more, further ones are neither taken nor refused.
        let step = || Patience { until: Instant::now() + Duration::from_millis(200), is_cancelled: &|| false };
        let taken: Vec<TcpStream> = (0..8).map_while(|_| connect(&silent, step()).ok()).collect();
        assert!(taken.len() < 8);
        let patience = Patience { until: Instant::now() + Duration::from_secs(2), is_cancelled: &|| false };
        let places = [silent, listener.local_addr().unwrap()];
        assert!(send(&places, b"POST / HTTP/1.1\r\n\r\n", patience).is_ok());
        let looks = std::cell::Cell::new(0);
        let is_cancelled = || looks.replace(looks.get() + 1) > 3;
        let patience = Patience { until: Instant::now() + Duration::from_secs(600), is_cancelled: &is_cancelled };
        let cancelled = send(&[silent], b"POST / HTTP/1.1\r\n\r\n", patience).err().unwrap();
        assert_eq!(reason(&cancelled).unwrap(), "is not waited for any more: its caller is to end");
    }

    #[test]
    fn a_server_that_does_not_answer_is_left() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}/a", listener.local_addr().unwrap());
        let address = HttpAddress::parse(&url, &AddressHelp::SERVICES).unwrap();
        let left = |until: Instant, is_cancelled: &dyn Fn() -> bool| {
            let patience = Patience { until, is_cancelled };
            let places = places(&address).unwrap();
            send(&places, b"POST / HTTP/1.1\r\n\r\n", patience).and_then(|mut exchange| exchange.status()).unwrap_err()
        };
        let late = left(Instant::now() + Duration::from_millis(120), &|| false);
        assert_eq!(reason(&late), None);
        let cancelled = left(Instant::now() + Duration::from_secs(600), &|| true);
        assert_eq!(reason(&cancelled).unwrap(), "is not waited for any more: its caller is to end");
    }
}
