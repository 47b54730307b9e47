//! The server in the program of a fleet.

mod answer;
mod fleet;
mod logs;
mod routes;
mod topics;

use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use axum::Router;
use tokio::runtime::Builder;
use tokio::sync::oneshot;

pub use fleet::ControlledFleet;
pub use routes::openapi;

use crate::place::{Listener, SocketFile};

/// Time for clients that follow the log to take its last lines when the server ends.
const FAREWELL: Duration = Duration::from_millis(100);

/// A server that runs on a thread of its own, until it is dropped.
#[derive(Debug)]
pub struct ControlServer {
    /// Dropped to end the server.
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
    /// Removed after the server has ended.
    _file: SocketFile,
}

impl ControlServer {
    /// Serves a fleet.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(listener: Listener, fleet: ControlledFleet) -> io::Result<ControlServer> {
        let Listener { socket, file } = listener;
        socket.set_nonblocking(true)?;
        let runtime = Builder::new_current_thread().enable_all().thread_name("saoms-control").build()?;
        let socket = {
            let _entered = runtime.enter();
            tokio::net::UnixListener::from_std(socket)?
        };
        let (end, ended) = oneshot::channel::<()>();
        let log = Arc::clone(&fleet.log);
        let router: Router = routes::router(Arc::new(fleet));
        let serve = move || {
            runtime.block_on(async {
                let serve = axum::serve(socket, router).into_future();
                tokio::select! {
                    _ = serve => {}
                    _ = ended => {
                        if log.is_followed() {
                            tokio::time::sleep(FAREWELL).await;
                        }
                    }
                }
            });
            // A call that hangs in a component must not keep the program.
            runtime.shutdown_background();
        };
        let thread = thread::Builder::new().name("saoms-control".to_owned()).spawn(serve)?;
        Ok(ControlServer { end: Some(end), thread: Some(thread), _file: file })
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
