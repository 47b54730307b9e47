//! The contender tokio: one spawned task with an `interval` each, on the runtime that `#[tokio::main]` makes.

use std::time::Instant;

use crate::common::Outcome;
use crate::probe::{self, Plan};

pub(crate) fn run(plan: &Plan) -> Outcome<()> {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_time().build()?;
    let start = Instant::now() + plan.lead();
    probe::open(plan, start);
    for index in 0..plan.size.tasks {
        let first = start + plan.size.delay(index);
        let period = plan.size.period;
        runtime.spawn(async move {
            let mut interval = tokio::time::interval_at(first.into(), period);
            loop {
                probe::executed(interval.tick().await.into_std());
            }
        });
    }
    probe::report(plan)?;
    runtime.shutdown_background();
    Ok(())
}
