//! Requests that come over the network of a fleet, from operators who are on it: those of the commands that reach all
//! programs at once.

use axum::Router;
use axum::body::Body;
use axum::http::{Method, Request, StatusCode};
use axum::response::Response;
use futures_util::StreamExt as _;
use hyper::service::Service as _;
use hyper_util::service::TowerToHyperService;
use saoms_core::network::control::{ControlRequest, Reply};
use serde_json::json;
use tokio::runtime::Handle;

/// The server, for requests that come over a network.
#[derive(Clone, Debug)]
pub struct NetworkDoor {
    pub(super) router: Router,
    pub(super) runtime: Handle,
}

impl NetworkDoor {
    /// Answers a request as it is answered over HTTP. Nobody waits.
    pub fn serve(&self, request: ControlRequest, reply: Reply) {
        let router = self.router.clone();
        self.runtime.spawn(async move {
            let ControlRequest { method, path, body } = request;
            if !is_served(&method, &path) {
                return refuse(
                    &reply,
                    StatusCode::NOT_FOUND.as_u16(),
                    "this cannot be asked over the network of a fleet",
                );
            }
            let asked = Request::builder().method(method.as_str()).uri(path.as_str()).body(Body::from(body));
            let asked = match asked {
                Ok(asked) => asked,
                Err(error) => return refuse(&reply, StatusCode::BAD_REQUEST.as_u16(), &error.to_string()),
            };
            match TowerToHyperService::new(router).call(asked).await {
                Ok(response) => send(response, &reply).await,
                Err(never) => match never {},
            }
        });
    }
}

/// Says why a request is not carried out.
pub fn refuse(reply: &Reply, status: u16, why: &str) {
    reply.part(status, json!({"error": why}).to_string(), true);
}

/// True for what the commands `status`, `topic`, `send` and `estop` ask.
fn is_served(method: &str, path: &str) -> bool {
    let path = path.split('?').next().unwrap_or_default();
    let is_of_topic = path.strip_prefix("/v1/topics/").is_some_and(|rest| rest.ends_with("/messages"));
    match method {
        _ if method == Method::GET => matches!(path, "/v1/fleet" | "/v1/status" | "/v1/topics") || is_of_topic,
        _ if method == Method::POST => matches!(path, "/v1/events" | "/v1/estop") || is_of_topic,
        _ => false,
    }
}

/// Sends an answer, part by part, while somebody waits for it.
async fn send(response: Response, reply: &Reply) {
    let status = response.status().as_u16();
    let mut parts = response.into_body().into_data_stream();
    while let Some(Ok(part)) = parts.next().await {
        // Each part is a whole text: a body in JSON, or events.
        if !reply.part(status, String::from_utf8_lossy(&part).into_owned(), false) {
            return;
        }
    }
    reply.part(status, String::new(), true);
}
