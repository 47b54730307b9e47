//! The topics of the fleet.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::extract::{Path, State};
use axum::response::IntoResponse;
use axum::response::sse::{Event, KeepAlive, Sse};
use futures_util::stream;
use saoms_core::schedule::Order;
use serde_json::{Value, json};

use super::answer::{Answer, Refusal, json_text, waiting};
use super::fleet::ControlledFleet;
use super::orders;
use crate::topics::Followed;

type Fleet = State<Arc<ControlledFleet>>;

pub(super) async fn list(State(fleet): Fleet) -> Answer {
    json_text(waiting(move || json!(fleet.handle.topics()).to_string()).await?)
}

/// The messages of a topic as they come, an event each, after those that it retains, as events `retained`. The event
/// `lost` says how many came faster than the client took them.
pub(super) async fn echo(State(fleet): Fleet, Path(topic): Path<String>) -> Answer {
    let follower = fleet.topics.follow(&topic, &fleet.handle).map_err(Refusal::unprocessable)?;
    let counts = Arc::clone(&fleet.counts);
    let events = stream::unfold((follower, counts), |(mut follower, counts)| async move {
        let event = match follower.next().await? {
            Followed::Retained(message) => Event::default().event("retained").data(&*message),
            Followed::Sent(message) => Event::default().data(&*message),
            Followed::Lost(lost) => {
                counts.lost.fetch_add(lost, Ordering::Relaxed);
                Event::default().event("lost").data(lost.to_string())
            }
        };
        Some((Ok::<_, Infallible>(event), (follower, counts)))
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::default()).into_response())
}

pub(super) async fn publish(State(fleet): Fleet, Path(topic): Path<String>, message: String) -> Answer {
    let message: Value = serde_json::from_str(&message)
        .map_err(|error| Refusal::unprocessable(format!("the message is not JSON: {error}")))?;
    orders::give(fleet, Order::Publish { topic, message }).await
}
