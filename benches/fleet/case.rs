//! One fleet, measured in a process of its own.

use std::process;
use std::time::Duration;

use saoms_api::{Class, Component, Failure};
use saoms_core::report::RunReport;
use saoms_core::schedule::Settings;
use serde::{Deserialize, Serialize};

use crate::common::composite::{Airport, Composite, Task, airport};
use crate::common::{Outcome, cpu_time, deploy, memory};

/// A fleet to measure.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum Case {
    /// Robots in real time.
    Real { airport: Airport, seconds: u32 },
    /// Robots in virtual time.
    Robots { airport: Airport, seconds: u32 },
    /// Components that do nothing, in virtual time.
    Empty { tasks: u32 },
}

/// Result of a process.
#[derive(Serialize, Deserialize)]
pub(crate) struct Measured {
    /// Executions of robots, or of empty tasks.
    pub(crate) executions: f64,
    /// Executions of the world, the masters and the environment.
    pub(crate) other_executions: f64,
    /// Messages that the robots received.
    pub(crate) received: f64,
    pub(crate) missed: u64,
    pub(crate) delivered: f64,
    /// Processor time of the process from the end of the fleet's start to the end of the run.
    pub(crate) cpu_s: f64,
    pub(crate) peak_mb: f64,
}

/// The task that does nothing.
#[derive(Class)]
#[class(name = "bench.Empty", periodic)]
struct Empty;

impl Component for Empty {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Self)
    }
}

const ROBOT: &str = "saoms.Robot";
/// The period of the components that do nothing, in virtual time.
const PERIOD: Duration = Duration::from_millis(100);
const EMPTY_EXECUTIONS: u32 = 3_000_000;

impl Case {
    pub(crate) fn measure(self) -> Outcome<Measured> {
        let (text, settings, lasting) = match self {
            Case::Real { airport: fleet, seconds } => {
                let lasting = Duration::from_secs(seconds.into());
                (airport(fleet, lasting), Settings::default(), lasting)
            }
            Case::Robots { airport: fleet, seconds } => {
                let lasting = Duration::from_secs(seconds.into());
                (airport(fleet, lasting), Settings::simulated(1), lasting)
            }
            Case::Empty { tasks } => (empty(tasks), Settings::simulated(1), PERIOD * (EMPTY_EXECUTIONS / tasks)),
        };
        let assembly = deploy::checked(text)?.assembly;
        let fleet = deploy::start(assembly, Settings { limit: Some(lasting), ..settings })?;
        let before = cpu_time(process::id())?;
        let report = deploy::finish(fleet)?;
        let used = cpu_time(process::id())? - before;
        Ok(Measured::of(&report, used.as_secs_f64(), memory(process::id())?.peak_kb))
    }
}

fn empty(tasks: u32) -> String {
    let mut composite = Composite::new();
    for number in 0..tasks {
        let (name, delay) = (format!("Task{number:05}"), PERIOD * number / tasks);
        composite.add(&Task { class: "bench.Empty", name, period: PERIOD, delay }, &[]);
    }
    composite.finish()
}

impl Measured {
    fn of(report: &RunReport, cpu_s: f64, peak_kb: u64) -> Self {
        let subjects = || report.components.iter().filter(|one| matches!(one.class.as_str(), ROBOT | "bench.Empty"));
        let executions: u64 = subjects().map(|one| one.executions).sum();
        Self {
            executions: executions as f64,
            other_executions: (report.periods - executions) as f64,
            received: subjects().map(|one| one.messages.received).sum::<u64>() as f64,
            missed: report.components.iter().map(|one| one.missed).sum(),
            delivered: report.sections["luggage"]["delivered"].as_f64().unwrap_or(0.0),
            cpu_s,
            peak_mb: peak_kb as f64 / 1024.0,
        }
    }
}
