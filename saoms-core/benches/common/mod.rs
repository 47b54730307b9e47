//! What the benchmarks of executions have in common.

use std::sync::Arc;
use std::time::Instant;

use saoms_api::{Properties, Time};
use saoms_core::schedule::RunningFleet;
use saoms_lang::assembly::{ComponentSpec, TaskProperties};
use saoms_lang::registry::Registry;

pub(crate) type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// A component of a registered class with these values and task properties.
pub(crate) fn component(
    registry: &Registry,
    (path, class): (&str, &str),
    values: &[(&str, &str)],
    task: &[(&str, &str)],
) -> Result<ComponentSpec> {
    let owned = |(name, value): &(&str, &str)| ((*name).into(), (*value).into());
    let task: Vec<_> = [("ID", path)].iter().chain(task).map(owned).collect();
    Ok(ComponentSpec {
        path: path.to_owned(),
        class: registry.get(class).map(Arc::clone).ok_or("the class is registered")?,
        site: Default::default(),
        node: Default::default(),
        fault_node: Default::default(),
        values: values.iter().map(owned).collect(),
        written: Default::default(),
        task: Some(TaskProperties::from_values(&task).map_err(|failure| failure.to_string())?),
        library: None,
        references: Vec::new(),
        loops: Default::default(),
        web: Box::default(),
    })
}

/// Nanoseconds per execution of a component with a period of a second in virtual time, the best of seven rounds after
/// one that warms up.
pub(crate) fn best(fleet: &RunningFleet) -> f64 {
    let (periods, mut best) = (200_000, f64::INFINITY);
    for round in 0..8 {
        let begin = Instant::now();
        fleet.run_until(Time::from_nanos((round + 1) * periods * 1_000_000_000));
        let time = begin.elapsed().as_nanos() as f64 / periods as f64;
        best = if round == 0 { best } else { best.min(time) };
    }
    best
}
