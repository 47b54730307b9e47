//! A run that has ended, shown in a browser of this machine.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use axum::Router;
use axum::extract::{Query, State};
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::get;
use saoms_api::Time;
use saoms_api::host::parse_duration;
use serde::Deserialize;
use serde_json::json;
use tokio::runtime::Builder;
use tokio::sync::oneshot;

use super::access::on_machine;
use super::answer::{Answer, Refusal, json_text, waiting};
use super::body::sealed;
use super::connections::serve;
use super::page;
use crate::network::HostNames;
use crate::recording::FinishedRun;
use crate::token::chance;

/// Letters of the key.
const KEY: usize = 32;

type Run = State<Arc<FinishedRun>>;

/// A server of a run that has ended, on a thread of its own, until it is dropped.
///
/// It listens on this machine alone. Its address has a key that nobody can guess: other users of the machine do not see
/// the run.
#[derive(Debug)]
pub struct ViewServer {
    url: String,
    /// Dropped to end the server.
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl ViewServer {
    /// Serves a run at this port; 0 is one that the system chooses.
    ///
    /// # Errors
    /// The port is taken, or the system gives no thread.
    pub fn start(run: FinishedRun, port: u16) -> io::Result<ViewServer> {
        let socket = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)))?;
        let key: String = chance()?.chars().take(KEY).collect();
        let url = format!("http://{}/{key}/", socket.local_addr()?);
        let router = Router::new()
            .route(&format!("/{key}/"), get(page::finished))
            .route(&format!("/{key}/run"), get(shown))
            .route(&format!("/{key}/records"), get(records))
            .route(&format!("/{key}/why"), get(why))
            .with_state(Arc::new(run))
            .merge(page::assets())
            .fallback(|| async { Refusal::not_found() });
        let router = router.layer(from_fn_with_state(HostNames::of_machine(), on_machine)).layer(from_fn(sealed));
        let runtime = Builder::new_current_thread().enable_all().thread_name("saoms-view").build()?;
        {
            let _entered = runtime.enter();
            socket.set_nonblocking(true)?;
            runtime.spawn(serve(tokio::net::TcpListener::from_std(socket)?, router, Arc::default()));
        }
        let (end, ended) = oneshot::channel::<()>();
        let serve = move || {
            // Dropping its other end is the order to end.
            let _ = runtime.block_on(ended);
            runtime.shutdown_background();
        };
        let thread = thread::Builder::new().name("saoms-view".to_owned()).spawn(serve)?;
        Ok(ViewServer { url, end: Some(end), thread: Some(thread) })
    }

    /// The address of the page.
    pub fn url(&self) -> &str {
        &self.url
    }
}

impl Drop for ViewServer {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

async fn shown(State(run): Run) -> Answer {
    json_text(waiting(move || run.json(&page::views())).await?)
}

#[derive(Deserialize)]
struct RecordsQuery {
    component: String,
}

async fn records(State(run): Run, Query(query): Query<RecordsQuery>) -> Answer {
    let records = waiting(move || run.records(&query.component).map(|records| json!(records).to_string())).await?;
    json_text(records.map_err(Refusal::unprocessable)?)
}

#[derive(Deserialize)]
struct WhyQuery {
    component: String,
    at: Option<String>,
}

async fn why(State(run): Run, Query(query): Query<WhyQuery>) -> Answer {
    let at = query.at.as_deref().map(parse_duration).transpose().map_err(Refusal::unprocessable)?;
    let at = at.map(|at| Time::START + at);
    let answer = waiting(move || run.why(&query.component, at).map(|answer| answer.to_string())).await?;
    json_text(answer.map_err(Refusal::unprocessable)?)
}
