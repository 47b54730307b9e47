//! The time of the fleet: pause, steps and speed.

use std::sync::Arc;

use axum::extract::{Query, State};
use saoms_api::Time;
use saoms_api::host::parse_duration;
use saoms_core::schedule::{HoldError, Speed};
use serde::Deserialize;
use serde_json::json;

use super::answer::{Answer, Refusal, done, json_text};
use super::fleet::ControlledFleet;
use super::orders::commit;

type Fleet = State<Arc<ControlledFleet>>;

pub(super) async fn pause(State(fleet): Fleet) -> Answer {
    let at = fleet.handle.pause();
    if at.is_ok() {
        commit(fleet).await?;
    }
    stands(at)
}

pub(super) async fn resume(State(fleet): Fleet) -> Answer {
    fleet.handle.resume().map_err(Refusal::unprocessable)?;
    commit(fleet).await?;
    done()
}

#[derive(Deserialize)]
pub(super) struct StepQuery {
    #[serde(rename = "for")]
    time: Option<String>,
}

pub(super) async fn step(State(fleet): Fleet, Query(query): Query<StepQuery>) -> Answer {
    let time = query.time.as_deref().map(parse_duration).transpose().map_err(Refusal::unprocessable)?;
    stands(fleet.handle.step(time))
}

pub(super) async fn speed(State(fleet): Fleet, body: String) -> Answer {
    let speed: Speed = body.trim().parse().map_err(|error: String| Refusal::unprocessable(error))?;
    fleet.handle.set_speed(speed).map_err(Refusal::unprocessable)?;
    done()
}

fn stands(at: Result<Time, HoldError>) -> Answer {
    let at = at.map_err(Refusal::unprocessable)?;
    json_text(json!({"time_s": at.as_secs_f64()}).to_string())
}
