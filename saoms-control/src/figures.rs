//! Figures of a fleet over time, for plots, from the start of a run.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use saoms_api::extension::{DashboardLine, DashboardView, Summary};
use saoms_core::observe::{FleetSample, Interest, Observer, SampleRate};
use saoms_core::status::{ComponentState, ComponentStatus, FleetStatus};
use serde_json::{Value, json};

/// Time of the run between two rows.
const EVERY: Duration = Duration::from_secs(1);
/// The newest rows, which are all kept.
const NEWEST: usize = 1800;
/// Rows from before that are kept at most, at equal distances.
const OLDER: usize = 1800;

/// The plots of each fleet: title, unit and lines, with the seconds for which their growth is shown.
type OwnPlot = (&'static str, &'static str, &'static [(&'static str, Option<u32>)]);

const OWN: &[OwnPlot] = &[
    ("Lateness of executions", "us", &[("99 %, worst component", None), ("50 %, worst component", None)]),
    ("Executions in a second", "", &[("all components", Some(1))]),
    ("Missed executions and failures", "", &[("missed", None), ("failures", None)]),
];

/// An observer that keeps the figures of a run: those of each fleet, and those of linked views.
#[derive(Debug)]
pub struct FigureWatch {
    lines: Vec<&'static DashboardLine>,
    /// True if somebody may look while the run goes on: then there is a new row each second, however long it lasts.
    is_live: bool,
    rows: Mutex<Rows>,
}

/// A time in seconds, and the values of all lines.
type Row = (f64, Vec<f64>);

#[derive(Debug, Default)]
struct Rows {
    older: Vec<Row>,
    newest: VecDeque<Row>,
    /// The time from which on the next row is made.
    next_s: f64,
    /// The least time between two older rows.
    apart_s: f64,
}

impl Rows {
    fn last_s(&self) -> Option<f64> {
        self.newest.back().map(|(time_s, _)| *time_s)
    }

    fn push(&mut self, row: Row) {
        self.next_s = (row.0 / EVERY.as_secs_f64() + 1e-6).floor() + EVERY.as_secs_f64();
        self.newest.push_back(row);
        if self.newest.len() <= NEWEST {
            return;
        }
        let Some(old) = self.newest.pop_front() else { return };
        if self.older.last().is_none_or(|(last, _)| old.0 >= last + self.apart_s - 1e-6) {
            self.older.push(old);
        }
        if self.older.len() > OLDER {
            self.apart_s = (2.0 * self.apart_s).max(2.0 * EVERY.as_secs_f64());
            let mut place = 0;
            self.older.retain(|_| {
                place += 1;
                place % 2 == 1
            });
        }
    }
}

impl FigureWatch {
    /// The figures of a run; `is_live` if somebody may look at them while it goes on.
    pub fn new(is_live: bool) -> FigureWatch {
        let plots = DashboardView::linked().into_iter().flat_map(|view| view.plots);
        let lines = plots.flat_map(|plot| plot.lines).collect();
        FigureWatch { lines, is_live, rows: Mutex::default() }
    }

    fn lock(&self) -> MutexGuard<'_, Rows> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The plots and their figures as JSON; only those after a time, or all.
    pub(crate) fn json(&self, after: Option<f64>) -> Value {
        let of_views = DashboardView::linked().into_iter().flat_map(|view| view.plots).map(|plot| {
            let per = |line: &DashboardLine| (line.by == Summary::PerMinute).then_some(60);
            let lines = plot.lines.iter().map(|line| json!({"title": line.title, "per_s": per(line)}));
            json!({"title": plot.title, "unit": plot.unit, "lines": lines.collect::<Vec<_>>()})
        });
        let own = OWN.iter().map(|(title, unit, lines)| {
            let lines = lines.iter().map(|(title, per)| json!({"title": title, "per_s": per}));
            json!({"title": title, "unit": unit, "lines": lines.collect::<Vec<_>>()})
        });
        let rows = self.lock();
        let all = rows.older.iter().chain(&rows.newest);
        let new = all.filter(|(time_s, _)| after.is_none_or(|after| *time_s > after));
        let row = |(time_s, values): &(f64, Vec<f64>)| {
            let numbers = std::iter::once(time_s).chain(values).copied();
            numbers.map(Value::from).collect::<Value>()
        };
        let new: Vec<Value> = new.map(row).collect();
        json!({"plots": of_views.chain(own).collect::<Vec<_>>(), "rows": new})
    }
}

impl Observer for FigureWatch {
    fn interest(&self) -> Interest {
        let most = (!self.is_live).then_some((NEWEST + OLDER) as u32);
        Interest { samples: Some(SampleRate { every: EVERY, most }), ..Interest::NONE }
    }

    /// Plots show some fields alone: nobody else is asked while nobody looks.
    fn wants_status(&self, component: &ComponentStatus) -> bool {
        let has = |field: &&str| component.values.contains_key(*field);
        self.lines.iter().any(|line| has(&line.field) || line.of.iter().any(&has))
    }

    fn sample(&self, sample: &FleetSample) {
        let time_s = sample.time.as_secs_f64();
        let mut rows = self.lock();
        let is_later = rows.last_s().is_none_or(|last| last < time_s);
        if !is_later || !sample.is_last && time_s < rows.next_s {
            return;
        }
        let of_views = self.lines.iter().map(|line| figure(line, &sample.status));
        let values = of_views.chain(own(&sample.status)).map(short).collect();
        rows.push((time_s, values));
    }
}

/// Three digits after the point are more than is seen.
fn short(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

/// The figures of each fleet, in the order of their plots.
fn own(status: &FleetStatus) -> [f64; 5] {
    let all = || status.components.iter();
    let running = || all().filter(|one| one.state == ComponentState::Running);
    let most = |of: fn(&ComponentStatus) -> u64| running().map(of).max().unwrap_or(0) as f64;
    let sum = |of: fn(&ComponentStatus) -> u64| all().map(of).sum::<u64>() as f64;
    [
        most(|one| one.report.late_us.p99),
        most(|one| one.report.late_us.p50),
        sum(|one| one.report.executions),
        sum(|one| one.report.missed),
        sum(|one| one.report.failures),
    ]
}

/// A figure of a view; no number where no component says anything.
fn figure(line: &DashboardLine, status: &FleetStatus) -> f64 {
    let has = |one: &ComponentStatus, field: &str| one.values.contains_key(field);
    let of = line.of.iter().find(|field| status.components.iter().any(|one| has(one, field)));
    if of.is_none() && !line.of.is_empty() {
        return f64::NAN;
    }
    let concerned = status.components.iter().filter(|one| of.is_none_or(|field| has(one, field)));
    let values = concerned.filter_map(|one| one.values.get(line.field)).filter(|value| !value.is_null());
    if line.by == Summary::Count {
        return values.count() as f64;
    }
    let numbers: Vec<f64> = values.filter_map(Value::as_f64).collect();
    let sum: f64 = numbers.iter().sum();
    match line.by {
        Summary::Sum | Summary::PerMinute | Summary::Count => sum,
        Summary::Mean => sum / numbers.len() as f64,
        Summary::Least => numbers.into_iter().reduce(f64::min).unwrap_or(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use saoms_core::report::ComponentReport;
    use saoms_core::status::FleetPhase;

    use super::*;

    fn component(values: Value) -> ComponentStatus {
        ComponentStatus {
            report: ComponentReport { executions: 3, ..ComponentReport::default() },
            site: "".into(),
            state: ComponentState::Running,
            emergency_stop: false,
            period_ms: None,
            in_code_s: None,
            waits_for: None,
            values: values.as_object().cloned().unwrap_or_default().into(),
            values_s: None,
        }
    }

    fn status(components: &[Value]) -> FleetStatus {
        FleetStatus {
            time_s: 0.0,
            phase: FleetPhase::Running,
            paused: false,
            speed: None,
            summaries: Vec::new(),
            components: components.iter().cloned().map(component).collect(),
        }
    }

    #[test]
    fn values_of_many_components_become_one() {
        let fleet = status(&[
            json!({"hand": 1, "level": 80, "waits": null, "done": 2}),
            json!({"hand": 2, "level": 40.5, "waits": 1, "done": 3}),
            json!({"done": 9, "counts": true}),
            json!({}),
        ]);
        let line = |field, by, of| figure(&DashboardLine { title: "", field, by, of }, &fleet);
        assert_eq!(line("done", Summary::Sum, &[]), 14.0);
        assert_eq!(line("done", Summary::PerMinute, &["counts", "hand"]), 9.0);
        assert_eq!(line("done", Summary::Sum, &["nobody", "hand"]), 5.0);
        assert_eq!(line("waits", Summary::Count, &["hand"]), 1.0);
        assert_eq!(line("level", Summary::Mean, &["hand"]), 60.25);
        assert_eq!(line("level", Summary::Least, &["hand"]), 40.5);
        assert!(line("level", Summary::Mean, &["nobody"]).is_nan());
        assert!(line("missing", Summary::Least, &["hand"]).is_nan());
        assert_eq!(own(&fleet), [0.0, 0.0, 12.0, 0.0, 0.0]);
    }

    #[test]
    fn a_long_run_keeps_so_many_rows_from_its_start_on_and_the_newest_ones() {
        let watch = FigureWatch::new(true);
        let seconds = 5 * (NEWEST + OLDER) as u64;
        for tenth in 0..=10 * seconds {
            let time = saoms_api::Time::from_nanos(tenth * 100_000_000);
            let (status, is_last) = (status(&[]), tenth == 10 * seconds);
            watch.sample(&FleetSample { time, status, states: Vec::new(), is_last });
        }
        let told = watch.json(None);
        let rows = told["rows"].as_array().map_or(&[][..], Vec::as_slice);
        assert!((OLDER..=NEWEST + OLDER).contains(&rows.len()), "{}", rows.len());
        let times: Vec<f64> = rows.iter().filter_map(|row| row[0].as_f64()).collect();
        assert_eq!(times[0], 0.0);
        assert!(times.windows(2).all(|pair| pair[0] < pair[1] && pair[1] - pair[0] <= 16.0), "{times:?}");
        let newest: Vec<f64> = (seconds - 1700..=seconds).map(|second| second as f64).collect();
        assert!(times.ends_with(&newest), "{:?}", &times[times.len() - 1701..]);
        let new = watch.json(Some(seconds as f64 - 20.0));
        assert_eq!(new["rows"].as_array().map(Vec::len), Some(20));
        assert_eq!(told["plots"].as_array().map(Vec::len), Some(OWN.len() + DashboardView::linked().len()));
    }
}
