//! What an emergency stop reaches in a fleet, for `saoms check --wiring`.

use std::fmt;

use saoms_api::host::one_line;
use saoms_core::schedule::hears_stops;
use saoms_lang::assembly::{Assembly, ComponentSpec};
use serde::Serialize;

/// A component that an emergency stop is for.
#[derive(Debug, Serialize)]
pub(super) struct Stopped<'a> {
    component: &'a str,
    class: &'a str,
    /// True if it hears of the stop by its property `stopped`; otherwise its executions are left out.
    hears: bool,
    /// Components with a function that stops their hardware and a heartbeat that ends: itself, and what it is wired to.
    hardware: Vec<&'a str>,
}

/// The components that an emergency stop of the whole fleet is for.
pub(super) fn stopped(assembly: &Assembly) -> Vec<Stopped<'_>> {
    let stops = |spec: &ComponentSpec| spec.class.declaration().stops;
    let all = assembly.components.iter().filter(|spec| spec.task.is_some()).map(|spec| {
        let targets = spec.references.iter().flat_map(|wire| &wire.targets);
        let targets = targets.filter_map(|target| assembly.components.get(target.component));
        let mut hardware: Vec<&str> =
            std::iter::once(spec).chain(targets).filter(|one| stops(one)).map(|one| one.path.as_str()).collect();
        hardware.dedup();
        Stopped { component: &spec.path, class: spec.class.name(), hears: hears_stops(spec), hardware }
    });
    all.filter(|one| one.hears || !one.hardware.is_empty()).collect()
}

/// The same for people, with equal neighbours in one line.
pub(super) struct StopReport<'a>(pub(super) &'a Assembly);

impl fmt::Display for StopReport<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = stopped(self.0);
        if all.is_empty() {
            return out.write_str("an emergency stop affects no component\n\n");
        }
        out.write_str("components that an emergency stop affects\n")?;
        let is_alike = |one: &Stopped<'_>, other: &Stopped<'_>| {
            (one.class, one.hears, &one.hardware) == (other.class, other.hears, &other.hardware)
        };
        for group in all.chunk_by(is_alike) {
            let (Some(first), Some(last)) = (group.first(), group.last()) else { continue };
            match group.len() {
                1 => write!(out, "  {} ({})", one_line(first.component), first.class)?,
                count => {
                    let (from, to) = (one_line(first.component), one_line(last.component));
                    write!(out, "  {count} of {}: {from} to {to}", first.class)?;
                }
            }
            match &first.hardware[..] {
                [] => out.write_str(": no function stops its hardware")?,
                names => {
                    let names: Vec<String> = names.iter().map(|name| format!("`{}`", one_line(name))).collect();
                    write!(out, ": a function of {} stops its hardware", names.join(", "))?;
                }
            }
            out.write_str(match first.hears {
                true => "; its property `stopped` is set\n",
                false => "; its executions are left out\n",
            })?;
        }
        out.write_str("\n")
    }
}
