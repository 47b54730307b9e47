//! How a WebSocket begins (RFC 6455, 4): a request of HTTP, and its answer.

use std::hash::{BuildHasher as _, RandomState};
use std::io::{self, BufRead, BufReader, Read as _, Write as _};
use std::net::{IpAddr, TcpStream};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha1::{Digest as _, Sha1};

/// Bytes of a request or an answer, at most.
const LONGEST: u64 = 16 << 10;
/// What is appended to the key of a client.
const MAGIC: &str = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";

/// What a server answers to the key of a client.
pub(crate) fn accepted(key: &str) -> String {
    STANDARD.encode(Sha1::digest(format!("{key}{MAGIC}")))
}

/// The first line and the fields of a head, whose names are in small letters.
struct Head {
    first: String,
    fields: Vec<(String, String)>,
}

impl Head {
    fn read(from: &mut BufReader<TcpStream>) -> io::Result<Head> {
        let mut head = from.take(LONGEST);
        let mut line = || {
            let mut line = String::new();
            head.read_line(&mut line)?;
            let is_whole = line.ends_with('\n');
            is_whole.then(|| line.trim_end().to_owned()).ok_or_else(|| wrong("it does not speak HTTP"))
        };
        let first = line()?;
        let mut fields = Vec::new();
        loop {
            let line = line()?;
            if line.is_empty() {
                return Ok(Head { first, fields });
            }
            let (name, value) = line.split_once(':').ok_or_else(|| wrong("it does not speak HTTP"))?;
            fields.push((name.trim().to_ascii_lowercase(), value.trim().to_owned()));
        }
    }

    fn get(&self, name: &str) -> Option<&str> {
        self.fields.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// True if a list in a field has this word.
    fn has(&self, name: &str, word: &str) -> bool {
        self.get(name).is_some_and(|list| list.split(',').any(|one| one.trim().eq_ignore_ascii_case(word)))
    }
}

fn wrong(text: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, text)
}

/// Answers a client, as a server.
///
/// # Errors
/// It is no client, or a page of another site in a browser.
pub(crate) fn accept(stream: &TcpStream) -> io::Result<BufReader<TcpStream>> {
    let mut from = BufReader::new(stream.try_clone()?);
    let head = Head::read(&mut from)?;
    let is_local = stream.peer_addr()?.ip().is_loopback();
    let refuse = |status: &str, why: &str| {
        let text = format!(
            "HTTP/1.1 {status}\r\nConnection: close\r\nSec-WebSocket-Version: 13\r\nContent-Type: text/plain\r\n\
             Content-Length: {}\r\n\r\n{why}",
            why.len()
        );
        (&*stream).write_all(text.as_bytes())?;
        Err(wrong(why))
    };
    let is_upgrade = head.has("upgrade", "websocket") && head.has("connection", "upgrade");
    let key = head.get("sec-websocket-key").filter(|_| is_upgrade && head.first.starts_with("GET "));
    let Some(key) = key else {
        return refuse("426 Upgrade Required", "this is a server of rosbridge: connect to it by WebSocket\n");
    };
    if head.get("sec-websocket-version") != Some("13") {
        return refuse("426 Upgrade Required", "the version of WebSocket has to be 13\n");
    }
    let host = head.get("host").unwrap_or_default();
    if !is_trusted(host, head.get("origin"), is_local) {
        return refuse("403 Forbidden", "pages of other sites may not use this server\n");
    }
    let answer = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {}\r\n\r\n",
        accepted(key)
    );
    (&*stream).write_all(answer.as_bytes())?;
    Ok(from)
}

/// Asks a server to speak WebSocket, as a client.
///
/// # Errors
/// It does not.
pub(crate) fn ask(stream: &TcpStream, host: &str) -> io::Result<BufReader<TcpStream>> {
    let random = RandomState::new();
    let mut key = [0; 16];
    key[..8].copy_from_slice(&random.hash_one(0).to_le_bytes());
    key[8..].copy_from_slice(&random.hash_one(1).to_le_bytes());
    let key = STANDARD.encode(key);
    let request = format!(
        "GET / HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n\
         Sec-WebSocket-Version: 13\r\n\r\n"
    );
    (&*stream).write_all(request.as_bytes())?;
    let mut from = BufReader::new(stream.try_clone()?);
    let head = Head::read(&mut from)?;
    let status = head.first.split(' ').nth(1).unwrap_or_default();
    if status != "101" {
        return Err(wrong(&format!(
            "it is a web server without rosbridge: it answers `{}`",
            head.first.escape_debug()
        )));
    }
    match head.get("sec-websocket-accept") {
        Some(found) if found == accepted(&key) => Ok(from),
        _ => Err(wrong("it does not speak WebSocket")),
    }
}

/// True for a client that is no page in a browser, and for pages of this machine and of the server's own.
pub(crate) fn is_trusted(host: &str, origin: Option<&str>, is_local: bool) -> bool {
    let Some(origin) = origin else { return true };
    // Whoever has a name that leads to this machine does not become a page of this machine.
    let is_own = !is_local || is_address(name(host));
    let Some((_, of)) = origin.split_once("://") else { return false };
    let of = name(of);
    is_own && (is_here(of) || of.eq_ignore_ascii_case(name(host)))
}

/// A host without its port.
fn name(host: &str) -> &str {
    match host.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        Some((address, _)) => address,
        None => host.rsplit_once(':').map_or(host, |(name, _)| name),
    }
}

fn is_address(name: &str) -> bool {
    name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok()
}

fn is_here(name: &str) -> bool {
    name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}
