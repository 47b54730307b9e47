//! Components that an event of a scenario or of `--faults` crashes.

use saoms_api::event::fault::{FaultCall, FaultKind, names_component};
use saoms_api::rule::FleetView;
use saoms_api::{Class, Place};

use crate::environment::{Environment, EventSpec, Scenario};
use crate::messages::ENVIRONMENT;

/// The components of a class that an event crashes, if they start again after that or, without `restarts`, do not.
pub(in crate::rules) fn crashed<'f, 'v, C: Class>(
    fleet: &'f FleetView<'v>,
    event: &EventSpec,
    restarts: bool,
) -> impl Iterator<Item = usize> + use<'f, 'v, C> {
    let text = if let EventSpec::Raised(text) = event { &**text } else { "" };
    let call = FaultCall::is_one(text).then(|| FaultCall::read(text).ok()).flatten();
    let call = call.filter(|call| matches!(call.kind, FaultKind::Crash { restart } if restart.is_some() == restarts));
    let is_meant = move |index: &usize| {
        let one = &fleet.components()[*index];
        let mut names = call.iter().flat_map(|call| &call.to);
        names.any(|name| names_component(&name.text, one.path, one.node))
    };
    fleet.indices::<C>().filter(is_meant)
}

/// The lines of scenarios that crash such a component of their site, with the first one.
pub(in crate::rules) fn crashes<I: Iterator<Item = usize>>(
    fleet: &FleetView<'_>,
    crashed: impl Fn(&EventSpec) -> I,
) -> Vec<(usize, Place)> {
    let topic = |index: usize| fleet.components()[index].topic(ENVIRONMENT.name());
    let mut found = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        for line in scenario.lines() {
            let mut crashed = crashed(&line.event);
            if let Some(one) = crashed.find(|one| topic(*one) == topic(index)) {
                let place = Place::property("scenario").part(line.text as usize, line.bytes.clone());
                found.push((one, place.in_component(index)));
            }
        }
    }
    found
}
