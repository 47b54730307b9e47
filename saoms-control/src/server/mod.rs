//! The server in the program of a fleet.

mod access;
mod alerts;
mod answer;
mod body;
mod change;
mod changes;
mod connections;
mod fleet;
mod logs;
mod orders;
mod over_network;
mod page;
mod problem;
mod routes;
mod services;
mod session;
mod stream;
mod time;
mod topics;
mod view;

use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use axum::Router;
use axum::middleware::{from_fn, from_fn_with_state};
use tokio::runtime::Builder;
use tokio::sync::oneshot;

pub use fleet::{ControlledFleet, SentLine};
pub use over_network::{NetworkDoor, refuse};
pub use routes::openapi;
pub use view::ViewServer;

use access::{Access, at_socket, from_here, guarded};
use body::{sealed, with_body};
use connections::serve;
use problem::as_problems;
use session::Sessions;

use crate::network::{HostNames, NetworkListener};
use crate::place::{Listener, OwnFile};

/// Time for clients that follow the log to take its last lines when the server ends, and for the answers of calls.
const FAREWELL: Duration = Duration::from_millis(100);

/// A server that runs on a thread of its own, until it is dropped.
#[derive(Debug)]
pub struct ControlServer {
    /// Dropped to end the server.
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
    door: NetworkDoor,
    /// Removed after the server has ended.
    _file: Option<OwnFile>,
}

/// The places at which a fleet is reached.
#[derive(Debug, Default)]
pub struct Places {
    /// A socket of the user.
    pub socket: Option<Listener>,
    /// An address of the network.
    pub network: Option<NetworkListener>,
}

impl ControlServer {
    /// Serves a fleet at these places.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(places: Places, fleet: ControlledFleet) -> io::Result<ControlServer> {
        let Places { socket, network } = places;
        let (socket, file) = socket.map(|Listener { socket, file }| (socket, file)).unzip();
        let runtime = Builder::new_current_thread().enable_all().thread_name("saoms-control").build()?;
        let (log, counts, calls) = (Arc::clone(&fleet.log), Arc::clone(&fleet.counts), fleet.call_places.clone());
        let router: Router = routes::router(Arc::new(fleet));
        let door = NetworkDoor { router: router.clone(), runtime: runtime.handle().clone() };
        {
            let _entered = runtime.enter();
            if let Some(socket) = socket {
                socket.set_nonblocking(true)?;
                let socket = tokio::net::UnixListener::from_std(socket)?;
                let open = router.clone().merge(page::assets());
                let open = open.layer(from_fn_with_state(HostNames::of_machine(), at_socket));
                let open = open.layer(from_fn(as_problems)).layer(from_fn(sealed));
                runtime.spawn(serve(socket, open, Arc::clone(&counts)));
            }
            if let Some(NetworkListener { socket, tokens, names, address }) = network {
                socket.set_nonblocking(true)?;
                let socket = tokio::net::TcpListener::from_std(socket)?;
                let sessions = Sessions::at(address.port());
                let access = Arc::new(Access { names, tokens, sessions, counts: Arc::clone(&counts) });
                let guarded = router.layer(from_fn_with_state(Arc::clone(&access), guarded));
                let all = guarded.merge(session::router(&access).layer(from_fn(with_body)));
                let all = all.layer(from_fn_with_state(access, from_here));
                let all = all.layer(from_fn(as_problems)).layer(from_fn(sealed));
                runtime.spawn(serve(socket, all, counts));
            }
        }
        let (end, ended) = oneshot::channel::<()>();
        let serve = move || {
            runtime.block_on(async {
                // Dropping its other end is the order to end.
                let _ = ended.await;
                if log.is_followed() || calls.are_waiting() {
                    tokio::time::sleep(FAREWELL).await;
                }
            });
            // A call that hangs in a component must not keep the program.
            runtime.shutdown_background();
        };
        let thread = thread::Builder::new().name("saoms-control".to_owned()).spawn(serve)?;
        Ok(ControlServer { end: Some(end), thread: Some(thread), door, _file: file })
    }

    /// The server for requests that come over the network of the fleet.
    pub fn door(&self) -> NetworkDoor {
        self.door.clone()
    }
}

impl Drop for ControlServer {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
