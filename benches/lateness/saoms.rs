//! SAOMS itself: a composite of components with an empty `execute`, loaded, checked and run as the command does it.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use saoms_api::{Class, Component, Context, Failure, Properties};
use saoms_core::schedule::{RunningFleet, Settings};

use crate::common::composite::{Composite, Task};
use crate::common::{Outcome, deploy};
use crate::probe::{self, Plan};

/// Start of the run on the machine's clock.
static START: OnceLock<Instant> = OnceLock::new();

/// Due time of the task, computed from the composite, independently of the engine.
#[derive(Properties)]
pub(crate) struct Due {
    first: Duration,
}

/// The task that every contender runs.
#[derive(Class)]
#[class(name = "bench.Probe", periodic)]
pub(crate) struct Probe {
    first: Duration,
}

impl Component for Probe {
    type Properties = Due;

    fn new(due: Due) -> Result<Self, Failure> {
        Ok(Self { first: due.first })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let due = Duration::from_nanos(context.due().as_nanos());
        let off = due.saturating_sub(self.first).as_nanos() % context.period().as_nanos();
        if off != 0 || due < self.first {
            return Err(Failure::new(format!("due at {due:?}, which is not on the grid of its period")));
        }
        if let Some(start) = START.get() {
            probe::executed(*start + due);
        }
        Ok(())
    }
}

/// Runs the tasks with the settings of one contender.
pub(crate) fn run(plan: &Plan, settings: Settings) -> Outcome<()> {
    let mut composite = Composite::new();
    for index in 0..plan.size.tasks {
        let task = Task {
            class: "bench.Probe",
            name: format!("Probe{index:05}"),
            period: plan.size.period,
            delay: plan.lead() + plan.size.delay(index),
        };
        composite.add(&task, &[("first", &saoms_api::host::format_duration(task.delay))]);
    }
    let fleet = deploy::start(deploy::checked(composite.finish())?.assembly, settings)?;
    let start = *START.get_or_init(|| start_of(&fleet));
    probe::open(plan, start + plan.lead());
    probe::report(plan)?;
    fleet.handle().stop();
    deploy::finish(fleet).map(drop)
}

/// The least disturbed of some comparisons of the run's time with the machine's clock.
fn start_of(fleet: &RunningFleet) -> Instant {
    let handle = fleet.handle();
    let compare = |_| {
        let before = Instant::now();
        let time = Duration::from_nanos(handle.progress().time.as_nanos());
        (before.elapsed(), before - time)
    };
    (0..100).map(compare).min().map_or_else(Instant::now, |(_, start)| start)
}
