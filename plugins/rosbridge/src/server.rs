//! The server: each client has a thread that reads what it says, and one that writes to it.

use std::collections::HashMap;
use std::io::ErrorKind;
use std::net::{Shutdown, TcpListener, TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use saoms_transport::{Failure, Program, Topic};
use serde_json::{Value, json};

use crate::incoming::{Incoming, Said};
use crate::op::{Op, bare, publish, status};
use crate::session::Topics;
use crate::socket::{Socket, lock};
use crate::{handshake, rosapi};

/// Clients at the same time, at most.
const MOST_CLIENTS: usize = 256;
/// Topics that a client follows, at most.
const MOST_WANTED: usize = 4096;
/// Time that a client has to begin.
const BEGINNING: Duration = Duration::from_secs(5);
/// Time for an attempt to reach oneself.
const KNOCK: Duration = Duration::from_millis(200);

/// A server that listens.
pub(crate) struct Server {
    shared: Arc<Shared>,
    address: std::net::SocketAddr,
    thread: JoinHandle<()>,
}

struct Shared {
    program: Program,
    /// Held while something is sent, so that what is kept for late readers and what is sent are one order.
    topics: Mutex<Topics>,
    clients: Mutex<Clients>,
    is_closed: AtomicBool,
}

#[derive(Default)]
struct Clients {
    all: HashMap<u64, Arc<Client>>,
    last: u64,
    threads: Vec<JoinHandle<()>>,
}

struct Client {
    socket: Socket,
    /// The topics that it follows, and how it writes their names.
    wants: Mutex<HashMap<String, String>>,
}

impl Server {
    pub(crate) fn open(address: &str, program: Program) -> Result<Server, Failure> {
        let listener = listen(address)?;
        let address = listener.local_addr().map_err(Failure::failed)?;
        let (topics, clients, is_closed) = Default::default();
        let shared = Arc::new(Shared { program, topics, clients, is_closed });
        let own = Arc::clone(&shared);
        let thread = thread::Builder::new().name("saoms-rosbridge".to_owned());
        let thread = thread.spawn(move || own.accept(&listener)).map_err(Failure::failed)?;
        Ok(Server { shared, address, thread })
    }

    pub(crate) fn advertise(&self, topic: &Topic, token: u64) -> Result<(), Failure> {
        lock(&self.shared.topics).advertise(topic, token)
    }

    pub(crate) fn subscribe(&self, topic: &Topic, token: u64) -> Result<(), Failure> {
        lock(&self.shared.topics).subscribe(topic, token)
    }

    pub(crate) fn publish(&self, token: u64, of: u64, message: &[u8]) -> Result<(), Failure> {
        let (name, form) = lock(&self.shared.topics).published(token)?;
        let message: Arc<str> = form.to_json(message).map_err(Failure::failed)?.to_string().into();
        let mut topics = lock(&self.shared.topics);
        if let Some(known) = topics.all.get_mut(&name) {
            known.keep(of, &message);
        }
        self.shared.send(&name, &message);
        Ok(())
    }

    pub(crate) fn close(self) {
        let shared = &self.shared;
        shared.program.leave();
        shared.is_closed.store(true, Ordering::SeqCst);
        // The thread that waits for clients wakes for this one.
        let _ = TcpStream::connect_timeout(&knocked(self.address), KNOCK);
        let _ = self.thread.join();
        let mut clients = lock(&shared.clients);
        let (all, threads) = (std::mem::take(&mut clients.all), std::mem::take(&mut clients.threads));
        drop(clients);
        all.values().for_each(|client| client.socket.close());
        let begin = Instant::now();
        all.values().for_each(|client| client.socket.finish(begin));
        threads.into_iter().for_each(|thread| drop(thread.join()));
    }
}

/// Where a listener of all addresses is reached.
fn knocked(mut address: std::net::SocketAddr) -> std::net::SocketAddr {
    if address.ip().is_unspecified() {
        address.set_ip(if address.is_ipv4() {
            std::net::Ipv4Addr::LOCALHOST.into()
        } else {
            std::net::Ipv6Addr::LOCALHOST.into()
        });
    }
    address
}

fn listen(address: &str) -> Result<TcpListener, Failure> {
    let addresses: Vec<_> = address.to_socket_addrs().map_err(Failure::failed)?.collect();
    TcpListener::bind(&*addresses).map_err(|error| {
        Failure::failed(match error.kind() {
            ErrorKind::AddrInUse => {
                "another program listens at this port: end it, or give the broker another `port`".to_owned()
            }
            ErrorKind::AddrNotAvailable => "this machine does not have this address".to_owned(),
            _ => error.to_string(),
        })
    })
}

impl Shared {
    fn accept(self: &Arc<Self>, listener: &TcpListener) {
        for stream in listener.incoming() {
            if self.is_closed.load(Ordering::SeqCst) {
                return;
            }
            let Ok(stream) = stream else {
                // As when there are too many files.
                thread::sleep(KNOCK);
                continue;
            };
            let own = Arc::clone(self);
            let mut clients = lock(&self.clients);
            clients.threads.retain(|thread| !thread.is_finished());
            if clients.threads.len() >= MOST_CLIENTS {
                let _ = stream.shutdown(Shutdown::Both);
                continue;
            }
            let thread = thread::Builder::new().name("saoms-rosbridge".to_owned());
            clients.threads.extend(thread.spawn(move || own.serve(stream)));
        }
    }

    /// Serves a client until it leaves.
    fn serve(self: &Arc<Self>, stream: TcpStream) {
        let Ok(()) = stream.set_read_timeout(Some(BEGINNING)) else { return };
        let Ok(from) = handshake::accept(&stream) else { return };
        let Ok(socket) = Socket::new(stream, false) else { return };
        let client = Arc::new(Client { socket, wants: Mutex::default() });
        let mut clients = lock(&self.clients);
        clients.last += 1;
        let number = clients.last;
        clients.all.insert(number, Arc::clone(&client));
        drop(clients);
        if self.is_closed.load(Ordering::SeqCst) {
            return;
        }
        thread::scope(|scope| {
            scope.spawn(|| client.socket.write());
            let mut incoming = Incoming::new(from, true);
            loop {
                match incoming.next() {
                    Ok(Said::Text(text)) => self.hear(&client, &text),
                    Ok(Said::Ping(content)) => client.socket.pong(&content),
                    Ok(Said::Nothing) => {}
                    Ok(Said::End) => break client.socket.close(),
                    Err(error) => {
                        if error.kind() == ErrorKind::InvalidData {
                            client.socket.send(&status(None, &error.to_string()));
                            break client.socket.close();
                        }
                        break client.socket.cut();
                    }
                }
            }
        });
        lock(&self.clients).all.remove(&number);
    }

    /// Takes what a client says.
    fn hear(&self, client: &Client, text: &str) {
        let op = match serde_json::from_str::<Op>(text) {
            Ok(op) => op,
            Err(error) => return client.refuse(None, &format!("this is no operation of rosbridge: {error}")),
        };
        let name = bare(&op.topic).to_owned();
        match op.op.as_str() {
            "subscribe" => self.subscribe(client, &op, name),
            "unsubscribe" => _ = lock(&client.wants).remove(&name),
            "advertise" => _ = self.holds_type(client, &op, &name),
            "publish" => self.publish(client, op, &name),
            "call_service" => self.call(client, &op),
            "unadvertise" | "set_level" => {}
            other => {
                let text = format!(
                    "`{}` is not served: topics are advertised, published and subscribed",
                    other.escape_debug()
                );
                client.refuse(op.id.as_ref(), &text);
            }
        }
    }

    /// Refuses a topic with the type of another one.
    fn holds_type(&self, client: &Client, op: &Op, name: &str) -> bool {
        let topics = lock(&self.topics);
        let Some(known) = topics.all.get(name).filter(|known| !op.kind.is_empty() && !known.form.is_named(&op.kind))
        else {
            return true;
        };
        let text =
            format!("topic `/{name}` has messages of `{}`, not of `{}`", known.form.kind, op.kind.escape_debug());
        drop(topics);
        client.refuse(op.id.as_ref(), &text);
        false
    }

    fn subscribe(&self, client: &Client, op: &Op, name: String) {
        if !self.holds_type(client, op, &name) {
            return;
        }
        if let Some(other) = op.compression.as_deref().filter(|other| *other != "none") {
            let text = format!("`{}` is not served as `compression`: messages are JSON", other.escape_debug());
            return client.refuse(op.id.as_ref(), &text);
        }
        // What is kept is sent before all that is sent from now on.
        let topics = lock(&self.topics);
        let mut wants = lock(&client.wants);
        if wants.len() >= MOST_WANTED {
            return client.refuse(op.id.as_ref(), &format!("nobody follows more than {MOST_WANTED} topics"));
        }
        if wants.insert(name.clone(), op.topic.clone()).is_none() {
            for message in topics.all.get(&name).into_iter().flat_map(|known| known.states.values()) {
                client.send(&publish(&op.topic, message));
            }
        }
    }

    /// Takes a message of a client, for the program and for all clients that follow its topic.
    fn publish(&self, client: &Client, op: Op, name: &str) {
        let known = lock(&self.topics).all.get(name).map(|known| (Arc::clone(&known.form), known.read));
        let Some((form, read)) = known else {
            // Clients may have topics of their own.
            let _order = lock(&self.topics);
            return self.send(name, &op.msg.to_string());
        };
        let message = form.to_cdr(op.msg).and_then(|bytes| Ok((form.to_json(&bytes)?.to_string(), bytes)));
        match message {
            Ok((text, bytes)) => {
                let order = lock(&self.topics);
                self.send(name, &text);
                drop(order);
                if let Some(token) = read {
                    self.program.deliver(token, "", &bytes);
                }
            }
            Err(why) => {
                client
                    .refuse(op.id.as_ref(), &format!("the message is none of topic `/{name}` ({}): {why}", form.kind));
                if let Some(token) = read {
                    self.program.refuse(token, "", &why);
                }
            }
        }
    }

    /// Answers the call of a service.
    fn call(&self, client: &Client, op: &Op) {
        let answer = rosapi::answer(&lock(&self.topics), &op.service, &op.args);
        let is_known = answer.is_some();
        let values = answer.unwrap_or_else(|| format!("there is no service `{}`", op.service.escape_debug()).into());
        let mut answer = json!({"op": "service_response", "service": op.service, "values": values, "result": is_known});
        if let Some(id) = &op.id {
            answer["id"] = id.clone();
        }
        client.send(&answer.to_string());
    }

    /// Sends a message to all clients that follow its topic. The topics are locked.
    fn send(&self, name: &str, message: &str) {
        let clients: Vec<Arc<Client>> = lock(&self.clients).all.values().cloned().collect();
        for client in clients {
            let spelled = lock(&client.wants).get(name).cloned();
            if let Some(spelled) = spelled {
                client.send(&publish(&spelled, message));
            }
        }
    }
}

impl Client {
    /// Sends a text. One that reads too slowly is left: it gets all or is told by the end of its connection.
    fn send(&self, text: &str) {
        if !self.socket.send(text) {
            self.socket.cut();
        }
    }

    fn refuse(&self, id: Option<&Value>, text: &str) {
        self.send(&status(id, text));
    }
}
