//! The client of the server: HTTP/1.0 over the Unix socket, or over the network.

use std::fmt;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use serde_json::Value;

use crate::description::FleetDescription;
use crate::network::server_of;
use crate::place::{connect, folder, remove_if_dead, token_beside, view_token_beside};
use crate::token::Token;

/// Time for which an answer is waited for.
const PATIENCE: Duration = Duration::from_secs(30);
/// Time in which a fleet introduces itself: one that was stopped (SIGSTOP) must not hold up commands for others.
const INTRODUCTION: Duration = Duration::from_secs(1);
/// The longest head of an answer.
const LONGEST_HEAD: u64 = 65_536;

/// A client of a running fleet.
#[derive(Clone, Debug)]
pub struct Client {
    place: Place,
}

/// Where a fleet is reached.
#[derive(Clone, Debug)]
enum Place {
    Socket(PathBuf),
    /// Address and port.
    Network(String, Token),
}

/// Error of a request.
#[derive(Debug)]
pub enum ClientError {
    /// No fleet answers at this socket.
    NotReached(String, io::Error),
    /// The fleet refused it, with this reason.
    Refused(String),
    /// The answer cannot be understood.
    Malformed(String),
}

impl fmt::Display for ClientError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ClientError::NotReached(place, error) => write!(formatter, "no fleet answers at `{place}`: {error}"),
            ClientError::Refused(reason) => formatter.write_str(reason),
            ClientError::Malformed(what) => write!(formatter, "the answer of the fleet is malformed: {what}"),
        }
    }
}

impl std::error::Error for ClientError {}

/// The answer to a request: its body.
#[derive(Debug)]
pub struct Response {
    body: BufReader<Box<dyn Connection>>,
}

impl Response {
    /// The whole body as JSON.
    ///
    /// # Errors
    /// It is none, or does not come in time.
    pub fn json(mut self) -> Result<Value, ClientError> {
        let mut bytes = Vec::new();
        self.body.read_to_end(&mut bytes).map_err(|error| ClientError::Malformed(error.to_string()))?;
        serde_json::from_slice(&bytes).map_err(|error| ClientError::Malformed(error.to_string()))
    }

    /// The whole body as text.
    ///
    /// # Errors
    /// It is none, or does not come in time.
    pub fn text(mut self) -> Result<String, ClientError> {
        let mut text = String::new();
        self.body.read_to_string(&mut text).map_err(|error| ClientError::Malformed(error.to_string()))?;
        Ok(text)
    }

    /// The server-sent events of the body as they come, each with its name (`message` without one) and its data. It
    /// ends with the fleet.
    pub fn events(mut self) -> impl Iterator<Item = (String, String)> + use<> {
        // Nothing may happen for long.
        let _ = self.body.get_ref().be_patient(None);
        std::iter::from_fn(move || {
            let (mut name, mut data, mut line) = ("message".to_owned(), None::<String>, String::new());
            loop {
                line.clear();
                if self.body.read_line(&mut line).ok()? == 0 {
                    return None;
                }
                match line.trim_end_matches(['\r', '\n']).split_once(':') {
                    Some(("event", value)) => name = value.trim_start().to_owned(),
                    Some(("data", value)) => {
                        let value = value.strip_prefix(' ').unwrap_or(value);
                        data = Some(data.map_or_else(|| value.to_owned(), |before| format!("{before}\n{value}")));
                    }
                    None if line.trim().is_empty() => {
                        if let Some(data) = data.take() {
                            return Some((name, data));
                        }
                    }
                    _ => {}
                }
            }
        })
    }
}

impl Client {
    /// A client of the fleet at this socket.
    pub fn new(socket: impl Into<PathBuf>) -> Client {
        Client { place: Place::Socket(socket.into()) }
    }

    /// A client of the fleet at this address of the network, as `http://127.0.0.1:8080`.
    ///
    /// # Errors
    /// It is no such address.
    pub fn of_network(url: &str, token: Token) -> io::Result<Client> {
        Ok(Client { place: Place::Network(server_of(url)?, token) })
    }

    /// The path of its socket, or its address.
    pub fn place(&self) -> String {
        match &self.place {
            Place::Socket(path) => path.display().to_string(),
            Place::Network(server, _) => format!("http://{server}"),
        }
    }

    fn connect(&self, patience: Duration) -> io::Result<Box<dyn Connection>> {
        let stream: Box<dyn Connection> = match &self.place {
            Place::Socket(path) => Box::new(connect(path)?),
            Place::Network(server, _) => Box::new(connect_to_one(server, patience)?),
        };
        stream.be_patient(Some(patience))?;
        Ok(stream)
    }

    /// Sends a request, such as `GET /v1/status`, with a body of text.
    ///
    /// # Errors
    /// The fleet does not answer, or refuses it.
    pub fn request(&self, method: &str, path: &str, body: &str) -> Result<Response, ClientError> {
        self.request_within(PATIENCE, method, path, body)
    }

    /// The same, with this time for the answer.
    ///
    /// # Errors
    /// As [`request`](Client::request).
    pub fn request_within(
        &self,
        patience: Duration,
        method: &str,
        path: &str,
        body: &str,
    ) -> Result<Response, ClientError> {
        let unreached = |error| ClientError::NotReached(self.place(), error);
        let mut stream = self.connect(patience).map_err(unreached)?;
        let length = body.len();
        let (host, authorization) = match &self.place {
            Place::Socket(_) => ("localhost", String::new()),
            Place::Network(server, token) => (&**server, format!("Authorization: {}\r\n", token.authorization())),
        };
        let head = format!(
            "{method} {path} HTTP/1.0\r\nHost: {host}\r\n{authorization}Content-Type: text/plain; charset=utf-8\r\nContent-Length: {length}\r\n\r\n"
        );
        stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body.as_bytes())).map_err(unreached)?;
        let mut answer = BufReader::new(stream);
        let status = read_head(&mut answer).map_err(|error| ClientError::Malformed(error.to_string()))?;
        let response = Response { body: answer };
        match status {
            200..=299 => Ok(response),
            _ => {
                let value = response.json()?;
                let reason = value["error"].as_str().map(str::to_owned);
                Err(ClientError::Refused(reason.unwrap_or_else(|| format!("HTTP status {status}"))))
            }
        }
    }

    /// How the fleet introduces itself.
    ///
    /// # Errors
    /// As [`request`](Client::request).
    pub fn description(&self) -> Result<FleetDescription, ClientError> {
        let value = self.request_within(INTRODUCTION, "GET", "/v1/fleet", "")?.json()?;
        serde_json::from_value(value).map_err(|error| ClientError::Malformed(error.to_string()))
    }
}

/// Connects to the first address of a server that answers in time.
fn connect_to_one(server: &str, patience: Duration) -> io::Result<TcpStream> {
    let mut last = io::Error::new(ErrorKind::NotFound, "the name has no address");
    for address in server.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, patience) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// A connection to a server.
trait Connection: Read + Write + Send + fmt::Debug {
    /// Sets the time for which an answer is waited for; `None` is for ever.
    fn be_patient(&self, time: Option<Duration>) -> io::Result<()>;
}

impl Connection for UnixStream {
    fn be_patient(&self, time: Option<Duration>) -> io::Result<()> {
        self.set_read_timeout(time)?;
        self.set_write_timeout(time)
    }
}

impl Connection for TcpStream {
    fn be_patient(&self, time: Option<Duration>) -> io::Result<()> {
        self.set_read_timeout(time)?;
        self.set_write_timeout(time)
    }
}

/// Reads the head of an answer, and gives its status.
fn read_head(answer: &mut impl BufRead) -> io::Result<u16> {
    let mut head = answer.by_ref().take(LONGEST_HEAD);
    let mut line = String::new();
    head.read_line(&mut line)?;
    let status = line.split(' ').nth(1).and_then(|status| status.parse().ok());
    let status = status.ok_or_else(|| io::Error::new(ErrorKind::InvalidData, "it is not HTTP"))?;
    loop {
        line.clear();
        if head.read_line(&mut line)? == 0 {
            return Err(io::Error::new(ErrorKind::UnexpectedEof, "it is incomplete"));
        }
        if line.trim().is_empty() {
            return Ok(status);
        }
    }
}

/// The user's fleets on this machine that answer, by name and process. Sockets of programs that have ended are removed.
pub fn running() -> Vec<(Client, FleetDescription)> {
    let files = std::fs::read_dir(folder()).into_iter().flatten().flatten().map(|entry| entry.path());
    let sockets = files.filter(|path| path.extension().is_some_and(|extension| extension == "sock"));
    // All at once: several that do not answer take no longer than one.
    let mut fleets: Vec<(Client, FleetDescription)> = thread::scope(|scope| {
        let asked: Vec<_> = sockets.map(|path| scope.spawn(move || introduced(&path))).collect();
        asked.into_iter().filter_map(|one| one.join().ok().flatten()).collect()
    });
    fleets.sort_by(|(_, one), (_, other)| (&one.name, one.pid).cmp(&(&other.name, other.pid)));
    fleets
}

/// The fleet at this socket, which is removed if its program has ended.
fn introduced(path: &Path) -> Option<(Client, FleetDescription)> {
    let client = Client::new(path);
    match client.description() {
        Ok(description) => Some((client, description)),
        Err(_) => {
            if remove_if_dead(path).is_ok() {
                for token in [token_beside(path), view_token_beside(path)] {
                    let _ = std::fs::remove_file(token);
                }
            }
            None
        }
    }
}
