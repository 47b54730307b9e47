//! The log of the fleet as server-sent events.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::response::IntoResponse;
use axum::response::sse::{Event, KeepAlive, Sse};
use futures_util::stream;
use serde_json::json;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;

use super::answer::{Answer, json_text};
use super::fleet::ControlledFleet;
use crate::counts::ClientCounts;
use crate::log::{LogLine, LogTail};

/// The newest lines as a JSON list.
pub(super) fn newest(log: &LogTail, most: usize) -> Answer {
    let (lines, _) = log.follow(most);
    let lines: Vec<&LogLine> = lines.iter().map(|line| &**line).collect();
    json_text(json!(lines).to_string())
}

/// The newest lines and all that follow, an event each: `data` is a line in JSON. The event `lost` says how many lines
/// came faster than the client took them.
pub(super) fn followed(fleet: &ControlledFleet, most: usize) -> Answer {
    let (lines, new) = fleet.log.follow(most);
    let state = (VecDeque::from(lines), new, Arc::clone(&fleet.counts));
    let events = stream::unfold(state, |(mut lines, mut new, counts)| async move {
        let event = match lines.pop_front() {
            Some(line) => shown(&line),
            None => next(&mut new, &counts).await?,
        };
        Some((Ok::<_, Infallible>(event), (lines, new, counts)))
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::default()).into_response())
}

async fn next(new: &mut Receiver<Arc<LogLine>>, counts: &ClientCounts) -> Option<Event> {
    match new.recv().await {
        Ok(line) => Some(shown(&line)),
        Err(RecvError::Lagged(lost)) => {
            counts.lost.fetch_add(lost, Ordering::Relaxed);
            Some(Event::default().event("lost").data(lost.to_string()))
        }
        Err(RecvError::Closed) => None,
    }
}

fn shown(line: &LogLine) -> Event {
    Event::default().data(json!(line).to_string())
}
