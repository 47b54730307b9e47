//! The contender's side of a run: the common start, the measured window, and the report to the driver.

use std::io::{self, Read, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::histogram::Recorder;
use crate::size::Size;

/// Parameters of a contender's run.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) size: Size,
    pub(crate) warm_up: Duration,
    pub(crate) measured: Duration,
}

impl Plan {
    /// Time for creating the tasks before the first is due.
    pub(crate) fn lead(&self) -> Duration {
        Duration::from_millis(500) + Duration::from_micros(100) * self.size.tasks
    }

    /// Time after the window in which an execution may start without counting as missed.
    pub(crate) fn grace(&self) -> Duration {
        self.size.period.max(Duration::from_millis(100))
    }

    /// The whole run, from the process' start to its end.
    pub(crate) fn total(&self) -> Duration {
        self.lead() + self.warm_up + self.measured + self.grace()
    }
}

struct Window {
    start: Instant,
    end: Instant,
}

static WINDOW: OnceLock<Window> = OnceLock::new();
static LATENESSES: Recorder = Recorder::new();
static EXECUTIONS: AtomicU64 = AtomicU64::new(0);

/// The task's body: it counts the execution that was due at `due`, and nothing else.
pub(crate) fn executed(due: Instant) {
    let now = Instant::now();
    EXECUTIONS.fetch_add(1, Ordering::Relaxed);
    if WINDOW.get().is_some_and(|window| due >= window.start && due < window.end) {
        let late = now.saturating_duration_since(due);
        LATENESSES.add(u64::try_from(late.as_nanos()).unwrap_or(u64::MAX));
    }
}

/// Fixes the window for tasks when the first is due at `start`.
pub(crate) fn open(plan: &Plan, start: Instant) {
    let begin = start + plan.warm_up;
    WINDOW.get_or_init(|| Window { start: begin, end: begin + plan.measured });
}

/// Waits until the window is over, and reports to the driver.
///
/// The driver samples the process between the lines `begin` and `end`; only then is the histogram written.
pub(crate) fn report(plan: &Plan) -> io::Result<()> {
    let mut out = io::stdout();
    if let Some(window) = WINDOW.get() {
        sleep_until(window.start);
        writeln!(out, "begin {}", EXECUTIONS.load(Ordering::Relaxed))?;
        sleep_until(window.end + plan.grace());
        writeln!(out, "end {}", EXECUTIONS.load(Ordering::Relaxed))?;
    }
    let mut nothing = [0];
    let _closed = io::stdin().read(&mut nothing)?;
    for (ns, count) in LATENESSES.used() {
        writeln!(out, "late {ns} {count}")?;
    }
    out.flush()
}

fn sleep_until(time: Instant) {
    thread::sleep(time.saturating_duration_since(Instant::now()));
}
