use std::collections::HashMap;

use saoms_api::PropertyValue;

use super::order::providers_first;
use saoms_lang::assembly::{Assembly, ComponentSpec, LoopSpec, Target, Wire};

/// What turns one fleet into another. Components are the same when their paths are; numbers are places in the two assemblies.
///
/// ```
/// use saoms_core::assemble::Plan;
/// use saoms_lang::assembly::Assembly;
///
/// assert!(Plan::between(&Assembly::default(), &Assembly::default()).is_empty());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Components of the current assembly that have to end, each before those whose services it calls.
    pub remove: Vec<usize>,
    /// Components that end and start again, because something about them differs; in the order in which they have to start.
    pub replace: Vec<Replacement>,
    /// Components of the wanted assembly that have to start, each after those whose services it calls.
    pub add: Vec<usize>,
    /// Components that stay as they are, as (current, wanted).
    pub keep: Vec<(usize, usize)>,
}

/// A component that ends and starts again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replacement {
    /// Its place in the current assembly.
    pub current: usize,
    /// Its place in the wanted assembly.
    pub wanted: usize,
    /// Why it cannot stay.
    pub differences: Vec<Difference>,
}

/// What differs between two components of one path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Difference {
    /// The class.
    Class,
    /// The value of this property of the class.
    Value(String),
    /// How it runs: period, delay, renames, policies.
    Task,
    /// Where this reference leads.
    Reference(String),
    /// Which loops it has, in which order, or the values of one of them.
    Loops,
}

impl Plan {
    /// The plan from the fleet that runs to the fleet that is wanted.
    pub fn between(current: &Assembly, wanted: &Assembly) -> Plan {
        let running: HashMap<&str, usize> = current
            .components
            .iter()
            .enumerate()
            .map(|(place, component)| (component.path.as_str(), place))
            .collect();
        let mut stays = vec![false; current.components.len()];
        let mut plan = Plan::default();
        for place in providers_first(wanted) {
            let component = &wanted.components[place];
            let Some(&before) = running.get(component.path.as_str()) else {
                plan.add.push(place);
                continue;
            };
            stays[before] = true;
            let differences = differences(current, &current.components[before], wanted, component);
            if differences.is_empty() {
                plan.keep.push((before, place));
            } else {
                plan.replace.push(Replacement { current: before, wanted: place, differences });
            }
        }
        plan.remove = providers_first(current).into_iter().rev().filter(|&place| !stays[place]).collect();
        plan
    }

    /// Whether nothing has to change.
    pub fn is_empty(&self) -> bool {
        self.remove.is_empty() && self.replace.is_empty() && self.add.is_empty()
    }
}

fn differences(
    current: &Assembly,
    before: &ComponentSpec,
    wanted: &Assembly,
    after: &ComponentSpec,
) -> Vec<Difference> {
    if before.class.name() != after.class.name() {
        return vec![Difference::Class];
    }
    let mut differences = Vec::new();
    let missing_after = before.values.iter().filter(|(name, _)| value(after, name).is_none());
    for (name, _) in after.values.iter().chain(missing_after) {
        if value(before, name) != value(after, name) {
            differences.push(Difference::Value(name.to_string()));
        }
    }
    if before.task != after.task {
        differences.push(Difference::Task);
    }
    let loops = |component: &ComponentSpec| -> Vec<_> {
        let one = |one: &LoopSpec| (one.name.clone(), one.class.name().to_owned(), one.values.clone());
        component.loops.iter().map(one).collect()
    };
    if loops(before) != loops(after) {
        differences.push(Difference::Loops);
    }
    let leads_to = |assembly: &Assembly, wire: &Wire| -> Vec<Option<(String, String)>> {
        let of = |target: &Target| {
            Some((assembly.components.get(target.component)?.path.clone(), target.service.clone()))
        };
        wire.targets.iter().map(of).collect()
    };
    for wire in &after.references {
        let same = before.references.iter().any(|known| {
            known.reference == wire.reference
                && known.interface == wire.interface
                && leads_to(current, known) == leads_to(wanted, wire)
        });
        if !same {
            differences.push(Difference::Reference(wire.reference.clone()));
        }
    }
    differences
}

fn value<'a>(component: &'a ComponentSpec, name: &str) -> Option<&'a PropertyValue> {
    component.values.iter().find(|(known, _)| known == name).map(|(_, value)| value)
}
