//! Changes of the fleet: what the files of a client would change, and the change itself.
//!
//! The program of the fleet reads these files, so that its own classes and plugins judge them. Only a client at the
//! socket of the user may have that done: diagnostics quote what is read.

use std::sync::Arc;

use axum::Extension;
use axum::extract::State;
use saoms_core::schedule::ChangeWithdrawal;
use serde_json::json;

use super::access::AtSocket;
use super::answer::{Answer, Refusal, json_text, waiting};
use super::fleet::ControlledFleet;
use super::orders::{COMMIT_PATIENCE, word};
use crate::change::{ChangeAnswer, ChangeRequest};

type Fleet = State<Arc<ControlledFleet>>;

pub(super) async fn plan(State(fleet): Fleet, at_socket: Option<Extension<AtSocket>>, body: String) -> Answer {
    let request = read(at_socket, &body)?;
    let answer = waiting(move || (fleet.change)(request, None)).await?.map_err(Refusal::unprocessable)?;
    json_text(json!(answer).to_string())
}

pub(super) async fn apply(State(fleet): Fleet, at_socket: Option<Extension<AtSocket>>, body: String) -> Answer {
    let mut request = read(at_socket, &body)?;
    request.by = request.by.as_deref().and_then(word);
    let client = WaitingClient::default();
    let withdrawal = client.0.clone();
    // It runs to its end whether its client waits or not.
    let change = move || -> Result<ChangeAnswer, String> {
        let composites = request.files.iter().map(|file| request.path(file).display().to_string()).collect();
        let mut answer = (fleet.change)(request, Some(withdrawal))?;
        if answer.is_applied() {
            fleet.now_has(composites);
            // The fleet has changed, whatever becomes of the note of it.
            answer.uncommitted = fleet.handle.commit(COMMIT_PATIENCE).err().map(|why| why.to_string());
        }
        Ok(answer)
    };
    let answer = waiting(change).await?.map_err(Refusal::unprocessable)?;
    json_text(json!(answer).to_string())
}

/// A client that waits for a change. Once it has hung up, which drops this, the change is taken back, unless it is
/// made.
#[derive(Default)]
struct WaitingClient(ChangeWithdrawal);

impl Drop for WaitingClient {
    fn drop(&mut self) {
        self.0.withdraw();
    }
}

fn read(at_socket: Option<Extension<AtSocket>>, body: &str) -> Result<ChangeRequest, Refusal> {
    if at_socket.is_none() {
        return Err(Refusal::forbidden(
            "a change of the fleet has the program read files of its machine: give it there, at the socket of the \
             user who started the fleet",
        ));
    }
    serde_json::from_str(body)
        .map_err(|error| Refusal::unprocessable(format!("the body is no description of a fleet: {error}")))
}
