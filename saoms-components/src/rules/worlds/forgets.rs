//! Rule: a world that crashes and starts again has forgotten its robots and its luggage.

use std::ops::Range;

use saoms_api::extension::LineFault;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::EventSpec;
use crate::rules::crash::{crashed, crashes};
use crate::world::World;

const HELP: &str = "add `<property name=\"restart\">onFailure</property>` to it: it saves then what it goes on with";

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5031",
        name: "forgetful-world",
        meaning: "A scenario or `--faults` crashes a world and starts it again, but the world has no `restart`, so that it saves \
            nothing: it begins anew without the robots and the luggage on its floor.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let found = crashes(fleet, |event| forgetful(fleet, event)).into_iter();
    let found = found.map(|(world, place)| {
        Finding::new(place, message(fleet, world)).label(Place::component(world), "the world").help(HELP)
    });
    found.collect()
}

/// Judges an event that does not stand in a scenario. Places are bytes of its text.
///
/// # Errors
/// It is a crash of a world that forgets all.
pub(crate) fn judge_crash(fleet: &FleetView<'_>, event: &EventSpec, bytes: Range<usize>) -> Result<(), LineFault> {
    match forgetful(fleet, event).next() {
        Some(world) => Err(LineFault::new(bytes, message(fleet, world)).help(HELP).code(&RULE.code)),
        None => Ok(()),
    }
}

fn message(fleet: &FleetView<'_>, world: usize) -> String {
    let path = fleet.components()[world].path;
    format!("`{path}` has forgotten its robots and its luggage when it starts again: it has no `restart`")
}

/// The worlds that an event crashes and starts again, and that save nothing.
fn forgetful<'f, 'v>(fleet: &'f FleetView<'v>, event: &EventSpec) -> impl Iterator<Item = usize> + use<'f, 'v> {
    crashed::<World>(fleet, event, true).filter(move |world| !fleet.components()[*world].restarts)
}
