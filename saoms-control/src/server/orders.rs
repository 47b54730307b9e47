//! Orders to the fleet and its components.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Path, Query, State};
use saoms_api::host::parse_duration;
use saoms_core::schedule::{Order, OrderTicket};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::answer::{Answer, Refusal, json_text, waiting};
use super::fleet::{ControlledFleet, SentLine};

type Fleet = State<Arc<ControlledFleet>>;

/// Time for which an answer is waited for.
const PATIENCE: Duration = Duration::from_millis(500);

/// Time for which a commit is waited for.
pub(super) const COMMIT_PATIENCE: Duration = Duration::from_secs(5);

/// Gives an order, and waits for its answer.
pub(super) async fn give(fleet: Arc<ControlledFleet>, order: Order) -> Answer {
    // Whoever stops something hears at once that it stops, whatever the disk does.
    let commits = !matches!(order, Order::EmergencyStop { .. });
    if let Some(refusal) = fleet.handle.refusal_of_work().filter(|_| matches!(order, Order::Publish { .. })) {
        return Err(Refusal::unprocessable(refusal));
    }
    let given = Arc::clone(&fleet);
    let ticket = waiting(move || given.handle.order(order, None)).await?.map_err(Refusal::unprocessable)?;
    answered(ticket, commits.then_some(fleet)).await
}

async fn answered(ticket: OrderTicket, committed: Option<Arc<ControlledFleet>>) -> Answer {
    let reply = waiting(move || ticket.wait(PATIENCE)).await?.map_err(Refusal::unprocessable)?;
    if let Some(fleet) = committed {
        commit(fleet).await?;
    }
    json_text(json!({"reply": reply}).to_string())
}

/// Waits until what is answered outlives the program.
pub(super) async fn commit(fleet: Arc<ControlledFleet>) -> Result<(), Refusal> {
    waiting(move || fleet.handle.commit(COMMIT_PATIENCE)).await?.map_err(Refusal::unprocessable)
}

pub(super) async fn send(State(fleet): Fleet, line: String) -> Answer {
    let sent = Arc::clone(&fleet);
    match waiting(move || (sent.send)(&line)).await?.map_err(Refusal::unprocessable)? {
        SentLine::Events(count) => {
            commit(fleet).await?;
            json_text(json!({"events": count}).to_string())
        }
        SentLine::Order(ticket) => answered(ticket, Some(fleet)).await,
    }
}

#[derive(Deserialize)]
pub(super) struct StartQuery {
    #[serde(rename = "for")]
    duration: Option<String>,
}

pub(super) async fn start(
    State(fleet): Fleet,
    Path(component): Path<String>,
    Query(query): Query<StartQuery>,
) -> Answer {
    let lasting = query.duration.as_deref().map(parse_duration).transpose().map_err(Refusal::unprocessable)?;
    give(fleet, Order::Start { component, lasting }).await
}

pub(super) async fn stop(State(fleet): Fleet, Path(component): Path<String>) -> Answer {
    give(fleet, Order::Stop { component }).await
}

pub(super) async fn set(
    State(fleet): Fleet,
    Path((component, property)): Path<(String, String)>,
    value: String,
) -> Answer {
    give(fleet, Order::Set { component, property, value }).await
}

pub(super) async fn call(
    State(fleet): Fleet,
    Path((component, operation)): Path<(String, String)>,
    body: String,
) -> Answer {
    let arguments: Map<String, Value> = match body.trim() {
        "" => Map::new(),
        body => serde_json::from_str(body)
            .map_err(|error| Refusal::unprocessable(format!("the arguments are not a JSON object: {error}")))?,
    };
    give(fleet, Order::Call { component, operation, arguments: arguments.into_iter().collect() }).await
}

#[derive(Deserialize)]
pub(super) struct ByQuery {
    by: Option<String>,
}

pub(super) async fn stop_at_once(State(fleet): Fleet, Query(query): Query<ByQuery>, body: String) -> Answer {
    give(fleet, Order::EmergencyStop { components: paths(&body), by: query.by.as_deref().and_then(word) }).await
}

pub(super) async fn release(State(fleet): Fleet, Query(query): Query<ByQuery>, body: String) -> Answer {
    give(fleet, Order::Release { components: paths(&body), by: query.by.as_deref().and_then(word) }).await
}

fn paths(body: &str) -> Vec<String> {
    body.split_whitespace().map(str::to_owned).collect()
}

/// A name as one word of a line.
pub(super) fn word(name: &str) -> Option<String> {
    let word: String =
        name.chars().map(|letter| if letter.is_alphanumeric() { letter } else { '-' }).take(64).collect();
    (!word.is_empty()).then_some(word)
}
