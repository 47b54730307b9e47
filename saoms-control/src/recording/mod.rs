//! The recording of a run, for who looks at it later (`saoms view`).
//!
//! A fleet is sampled some times a second of the run, between executions. Each sample holds what differs from the one
//! before. When there are too many samples, or they grow too large, every second one is left out, also from then on, so
//! that a recording has a limit however long a run lasts.

mod cells;
mod fields;
mod finished;
mod form;
mod retained;
mod samples;
#[cfg(test)]
mod tests;
mod text;

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use saoms_api::Level;
use saoms_api::extension::DashboardView;
use saoms_core::observe::{FleetSample, Interest, Observer, Occurrence, RunEvent, SampleRate};
use saoms_core::report::{Recording, RunReport};
use saoms_core::status::{ComponentState, ComponentStatus};
use serde_json::{Map, Value, json};

use self::cells::{Cells, Subject};
use self::retained::RetainedTopic;
use self::samples::Samples;
use crate::alerts::AlertList;
use crate::figures::FigureWatch;
use crate::log::LogLine;
pub use finished::{FinishedRun, RunReadError};

/// The version of what is recorded.
pub(crate) const VERSION: u32 = 1;
/// Time of the run between two samples at first, of fleets with up to so many components, and of larger ones.
const EVERY: [Duration; 2] = [Duration::from_millis(200), Duration::from_secs(1)];
const SMALL: usize = 250;
/// The most samples.
const SAMPLES: u32 = 3600;
/// The most bytes of all samples: for each component, and in all at least and at most.
const OF_COMPONENT: usize = 32 << 10;
const BYTES: [usize; 2] = [8 << 20, 32 << 20];
/// Samples between two that also have what counts.
const COUNTS: usize = 5;
/// Lines of the log that are kept.
const LINES: usize = 1000;
/// What a component counts, of what is shown.
const COUNTED: [&str; 5] = ["executions", "missed", "failures", "restarts", "dropped"];

/// The observer that records a run, and adds that to its report.
#[derive(Debug)]
pub struct Recorder {
    name: String,
    every: Duration,
    alerts: Arc<AlertList>,
    figures: Arc<FigureWatch>,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    cells: Cells,
    samples: Samples,
    topics: HashMap<Arc<str>, RetainedTopic>,
    log: VecDeque<LogLine>,
}

impl Recorder {
    /// A recorder of a fleet of this name with so many components, and with its alerts and figures, which are observers
    /// of it.
    pub fn new(name: String, components: usize, alerts: Arc<AlertList>, figures: Arc<FigureWatch>) -> Recorder {
        let most = (components * OF_COMPONENT).clamp(BYTES[0], BYTES[1]);
        let every = EVERY[usize::from(components > SMALL)];
        let state = State {
            cells: Cells::new(most / 4),
            samples: Samples::new(every, (SAMPLES as usize, most)),
            topics: HashMap::new(),
            log: VecDeque::new(),
        };
        Recorder { name, every, alerts, figures, state: Mutex::new(state) }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Recorder {
    fn interest(&self) -> Interest {
        let rate = SampleRate { every: self.every, most: Some(SAMPLES) };
        Interest { log: Some(Level::Info), samples: Some(rate), ..Interest::NONE }
    }

    fn wants_state(&self, message: &str) -> bool {
        !fields_of(message).is_empty()
    }

    fn event(&self, event: &RunEvent) {
        if matches!(event.what, Occurrence::Console { .. }) || event.what.level() > Level::Info {
            return;
        }
        let mut state = self.lock();
        if state.log.len() == LINES {
            state.log.pop_front();
        }
        state.log.push_back(LogLine::of(event));
    }

    fn sample(&self, sample: &FleetSample) {
        let State { cells, samples, topics, .. } = &mut *self.lock();
        let time_s = sample.time.as_secs_f64();
        if !samples.want(time_s, sample.is_last) {
            return;
        }
        let has_counts = sample.is_last || samples.len().is_multiple_of(COUNTS);
        let status = &sample.status;
        let fleet = cells.row(&Subject::Fleet);
        cells.put(fleet, &["summaries"], &json!(status.summaries));
        cells.put(fleet, &["paused"], &json!(status.paused));
        for one in &status.components {
            record(cells, one, has_counts);
        }
        for topic in &sample.states {
            let known = topics.entry(Arc::clone(&topic.topic)).or_default();
            known.record(cells, topic, fields_of);
        }
        let changes = cells.changes();
        if samples.push(time_s, &changes) {
            cells.forget_texts(samples);
        }
    }

    fn conclude(&self, report: &mut RunReport) {
        let State { cells, samples, log, .. } = &*self.lock();
        let alerts: Vec<Value> = self.alerts.kept().iter().map(|alert| undated(json!(alert))).collect();
        let log: Vec<Value> = log.iter().map(|line| undated(json!(line))).collect();
        let json = format!(
            "{{\"version\":{VERSION},\"name\":{},\"every_s\":{},\"subjects\":{},\"cells\":{},\"texts\":{},\"samples\":{},\
             \"figures\":{},\"alerts\":{},\"log\":{}}}",
            json!(self.name),
            samples.every_s(),
            cells.subjects(),
            cells.paths(),
            cells.texts(),
            samples.json(),
            self.figures.json(None),
            Value::from(alerts),
            Value::from(log),
        );
        // It is JSON.
        report.recording = Recording::of(json).ok();
    }
}

/// The fields that views show of such messages.
fn fields_of(message: &str) -> Vec<&'static str> {
    let views = DashboardView::linked().into_iter();
    let states = views.flat_map(|view| view.states).filter(|state| state.message == message);
    states.flat_map(|state| state.fields).copied().collect()
}

/// The same without its dates, which differ from run to run.
fn undated(mut value: Value) -> Value {
    value.as_object_mut().map(|fields| fields.remove("date"));
    value.get_mut("acknowledged").and_then(Value::as_object_mut).map(|fields| fields.remove("date"));
    value
}

fn record(cells: &mut Cells, one: &ComponentStatus, has_counts: bool) {
    let row = cells.row(&Subject::Component(&one.report.name));
    cells.put(row, &["class"], &json!(one.report.class.as_str()));
    cells.put(row, &["site"], &json!(one.site.as_str()));
    cells.put(row, &["state"], &json!(one.state));
    cells.put(row, &["emergency_stop"], &json!(one.emergency_stop));
    cells.put(row, &["period_ms"], &json!(one.period_ms));
    cells.put(row, &["waits_for"], &json!(one.waits_for));
    for (name, value) in one.values.iter() {
        cells.put(row, &["values", name], value);
    }
    if one.values.is_empty() && one.state != ComponentState::Running {
        // One that sleeps says nothing, and is as it was.
        cells.keep(row, &["values"]);
    }
    if !has_counts {
        cells.keep(row, &COUNTED);
        cells.keep(row, &["late_us"]);
        return;
    }
    let counts = match serde_json::to_value(&one.report) {
        Ok(Value::Object(counts)) => counts,
        _ => Map::new(),
    };
    for name in COUNTED {
        cells.put(row, &[name], &counts[name]);
    }
    for name in ["p50", "p99"] {
        cells.put(row, &["late_us", name], &counts["late_us"][name]);
    }
}
