//! The alerts of the fleet: the list, its changes as server-sent events, and acknowledgements.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::extract::{Query, State};
use axum::response::IntoResponse;
use axum::response::sse::{Event, KeepAlive, Sse};
use futures_util::stream;
use saoms_api::Level;
use serde::Deserialize;
use serde_json::json;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;

use super::answer::{Answer, Refusal, json_text};
use super::fleet::ControlledFleet;
use super::orders::{self, word};

type Fleet = State<Arc<ControlledFleet>>;

#[derive(Deserialize)]
pub(super) struct AlertQuery {
    #[serde(default)]
    follow: bool,
}

/// The alerts as a JSON list; or as server-sent events: `alerts` with the list, then each change. The event `lost` says
/// how many changes the client missed.
pub(super) async fn list(State(fleet): Fleet, Query(query): Query<AlertQuery>) -> Answer {
    let (alerts, new) = fleet.alerts.follow();
    if !query.follow {
        return json_text(json!(alerts).to_string());
    }
    let first = Event::default().event("alerts").data(json!(alerts).to_string());
    let state = (Some(first), new, fleet);
    let events = stream::unfold(state, |(mut first, mut new, fleet)| async move {
        let event = match first.take() {
            Some(event) => event,
            None => next(&mut new, &fleet).await?,
        };
        Some((Ok::<_, Infallible>(event), (first, new, fleet)))
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::default()).into_response())
}

async fn next(new: &mut Receiver<Arc<str>>, fleet: &ControlledFleet) -> Option<Event> {
    match new.recv().await {
        Ok(change) => Some(Event::default().data(&*change)),
        Err(RecvError::Lagged(lost)) => {
            fleet.counts.lost.fetch_add(lost, Ordering::Relaxed);
            Some(Event::default().event("lost").data(lost.to_string()))
        }
        Err(RecvError::Closed) => None,
    }
}

#[derive(Deserialize)]
pub(super) struct ByQuery {
    by: Option<String>,
}

/// Acknowledges the alerts of the numbers in the body, or all that wait. The log says who did.
pub(super) async fn acknowledge(State(fleet): Fleet, Query(query): Query<ByQuery>, body: String) -> Answer {
    let number = |text: &str| {
        text.parse().map_err(|_| Refusal::unprocessable(format!("`{text}` is not the number of an alert")))
    };
    let ids = body.split_whitespace().map(number).collect::<Result<Vec<u64>, _>>()?;
    let by = query.by.as_deref().and_then(word).unwrap_or_else(|| "somebody".to_owned());
    let unknown = |id| Refusal::unprocessable(format!("there is no alert {id}"));
    let acknowledged = fleet.alerts.acknowledge(&ids, &by).map_err(unknown)?;
    if !acknowledged.is_empty() {
        orders::commit(Arc::clone(&fleet)).await?;
        let numbers = acknowledged.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
        fleet.handle.note(Level::Info, format!("alerts acknowledged by {by}: {numbers}"));
    }
    json_text(json!({"acknowledged": acknowledged}).to_string())
}
