//! All that a page shows of a fleet, in one stream of server-sent events: a browser has few connections to a server.
//!
//! Nobody is told of what changes; the stream looks, at its own pace, as long as its client takes what it finds. So the
//! timer of the fleet does nothing for a page, and a slow one gets the newest state and misses what was in between.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use axum::extract::{Query, State};
use axum::response::IntoResponse;
use axum::response::sse::{Event, Sse};
use futures_util::stream::{self, SelectAll, Stream, StreamExt as _};
use saoms_api::Cause;
use saoms_core::journal::JournalEntry;
use saoms_core::schedule::InjectError;
use saoms_lang::schema::Schema;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{MissedTickBehavior, interval};

use super::answer::{Answer, Refusal, waiting};
use super::changes::{RetainedChanges, StatusChanges};
use super::fleet::ControlledFleet;
use crate::log::LogLine;
use crate::topics::{Followed, Follower};

type Fleet = State<Arc<ControlledFleet>>;

/// Time between two looks at state topics.
const LOOK: Duration = Duration::from_millis(200);
/// Looks between two at the status and the journal, and between two at what counts.
const STATUS: u64 = 2;
const COUNTS: u64 = 10;
/// Lines of the log from before, and records of a component, unless the client says how many.
const LINES: usize = 100;
const RECORDS: usize = 200;

#[derive(Deserialize)]
pub(super) struct StreamQuery {
    topics: Option<String>,
    component: Option<String>,
    lines: Option<usize>,
}

/// Answers with the stream.
pub(super) async fn stream(State(fleet): Fleet, Query(query): Query<StreamQuery>) -> Answer {
    let (alerts, new_alerts) = fleet.alerts.follow();
    let (lines, new_lines) = fleet.log.follow(query.lines.unwrap_or(LINES));
    let mut found = VecDeque::from([event("alerts", &json!(alerts))]);
    found.extend(lines.iter().map(|line| event("log", &json!(**line))));
    let wanted: Vec<String> =
        query.topics.iter().flat_map(|names| names.split_whitespace()).map(str::to_owned).collect();
    let asked = Arc::clone(&fleet);
    let topics = waiting(move || topics(&asked, &wanted)).await?.map_err(Refusal::unprocessable)?;
    let (states, mut sources) = topics;
    sources.push(told("alert", new_alerts, |change: Arc<str>| change.to_string()));
    sources.push(told("log", new_lines, |line: Arc<LogLine>| json!(*line).to_string()));
    sources.push(ticks());
    let looking = Looking { status: StatusChanges::default(), states, component: query.component, last: Cause(0) };
    let state = Streamed { fleet, found, sources, looks: 0, looking: Some(looking) };
    let events = stream::unfold(state, |mut state| async move {
        let event = state.next().await?;
        Some((Ok::<_, Infallible>(event), state))
    });
    Ok(Sse::new(events).into_response())
}

/// What comes by itself.
enum Came {
    Event(Event),
    /// An event that says that so many were lost.
    Lost(Event, u64),
    /// It is time to look.
    Tick,
}

type Source = Pin<Box<dyn Stream<Item = Came> + Send>>;

/// State topics, which are looked at, and event topics, which are followed; a topic that the fleet does not have is
/// neither: a page may ask for more than there is.
fn topics(
    fleet: &ControlledFleet,
    wanted: &[String],
) -> Result<(Vec<RetainedChanges>, SelectAll<Source>), InjectError> {
    let (mut states, mut events) = (Vec::new(), SelectAll::new());
    for status in fleet.handle.topics().into_iter().filter(|one| wanted.contains(&one.name)) {
        if status.kind == "state" {
            let Ok(schema) = Schema::parse(&status.schema.to_string()) else { continue };
            states.push(RetainedChanges::of(status.name, schema));
        } else {
            events.push(messages(status.name.clone(), fleet.topics.follow(&status.name, &fleet.handle)?));
        }
    }
    Ok((states, events))
}

/// The messages of an event topic.
fn messages(topic: String, follower: Follower) -> Source {
    Box::pin(stream::unfold((topic, follower), |(topic, mut follower)| async move {
        let came = match follower.next().await? {
            Followed::Retained(message) | Followed::Sent(message) => {
                let name = Value::from(&*topic);
                Came::Event(
                    Event::default().event("topic").data(format!("{{\"topic\":{name},\"messages\":[{message}]}}")),
                )
            }
            Followed::Lost(lost) => Came::Lost(event("lost", &json!({"what": topic, "count": lost})), lost),
        };
        Some((came, (topic, follower)))
    }))
}

/// What somebody tells all clients.
fn told<T: Clone + Send + 'static>(name: &'static str, new: Receiver<T>, text: fn(T) -> String) -> Source {
    Box::pin(stream::unfold(new, move |mut new| async move {
        let came = match new.recv().await {
            Ok(one) => Came::Event(Event::default().event(name).data(text(one))),
            Err(RecvError::Lagged(lost)) => Came::Lost(event("lost", &json!({"what": name, "count": lost})), lost),
            Err(RecvError::Closed) => return None,
        };
        Some((came, new))
    }))
}

fn ticks() -> Source {
    let mut ticks = interval(LOOK);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    Box::pin(stream::unfold(ticks, |mut ticks| async move {
        ticks.tick().await;
        Some((Came::Tick, ticks))
    }))
}

/// What a client is sent.
struct Streamed {
    fleet: Arc<ControlledFleet>,
    /// What was found, and waits for the client.
    found: VecDeque<Event>,
    sources: SelectAll<Source>,
    looks: u64,
    /// With the thread that looks, while it does.
    looking: Option<Looking>,
}

/// What is looked at.
struct Looking {
    status: StatusChanges,
    states: Vec<RetainedChanges>,
    component: Option<String>,
    /// The last record of the component that was sent.
    last: Cause,
}

impl Streamed {
    /// The next event; `None` is the end of the fleet.
    async fn next(&mut self) -> Option<Event> {
        loop {
            if let Some(event) = self.found.pop_front() {
                return Some(event);
            }
            match self.sources.next().await? {
                Came::Event(event) => return Some(event),
                Came::Lost(event, lost) => {
                    self.fleet.counts.lost.fetch_add(lost, Ordering::Relaxed);
                    return Some(event);
                }
                Came::Tick => self.look().await?,
            }
        }
    }

    /// Looks at the fleet, beside the thread of the server.
    async fn look(&mut self) -> Option<()> {
        let (looks, mut looking) = (self.looks, self.looking.take()?);
        self.looks += 1;
        let status = match looks.is_multiple_of(STATUS) {
            true => {
                let fleet = Arc::clone(&self.fleet);
                Some(self.fleet.status.get(move || fleet.handle.status()).await.ok()?)
            }
            false => None,
        };
        let fleet = Arc::clone(&self.fleet);
        let looked = waiting(move || {
            let mut found = VecDeque::new();
            if let Some(status) = status {
                let mut changes = looking.status.next(&status, looks.is_multiple_of(COUNTS));
                if changes["all"] == true {
                    changes["fleet"] = json!(fleet.description());
                }
                found.push_back(event("status", &changes));
                found.extend(looking.records(&fleet));
            }
            for topic in &mut looking.states {
                // One that is gone has nothing new.
                let retained = fleet.handle.retained(&topic.topic).unwrap_or_default();
                found.extend(topic.next(retained).map(|messages| event("topic", &messages)));
            }
            (looking, found)
        });
        let (looking, found) = looked.await.ok()?;
        self.looking = Some(looking);
        self.found = found;
        Some(())
    }
}

impl Looking {
    /// The new records of the component.
    fn records(&mut self, fleet: &ControlledFleet) -> Option<Event> {
        let component = self.component.as_ref()?;
        let records = match fleet.handle.records(component, self.last, RECORDS) {
            Ok(records) => records,
            // It said so once.
            Err(_) if self.last != Cause(0) => return None,
            Err(error) => {
                self.component = None;
                return Some(event("records", &json!({"error": error})));
            }
        };
        self.last = records.last().map(JournalEntry::id)?;
        Some(event("records", &json!({"component": component, "records": records})))
    }
}

fn event(name: &str, data: &Value) -> Event {
    Event::default().event(name).data(data.to_string())
}
