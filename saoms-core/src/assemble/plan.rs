use std::collections::HashMap;

use saoms_api::host::PropertyValue;

use super::Members;
use super::order::providers_first;
use saoms_lang::assembly::{ComponentSpec, LoopSpec, Wire, WireTarget};

/// The steps that turn one fleet into another. Components are the same when their paths are.
///
/// ```
/// use saoms_core::assemble::{ChangePlan, members};
/// use saoms_lang::assembly::Assembly;
///
/// let fleet = Assembly::default();
/// assert!(ChangePlan::between(&members(&fleet), &members(&fleet)).is_empty());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChangePlan {
    /// Components of the current fleet that have to end, each before those whose services it calls.
    pub remove: Vec<usize>,
    /// Components that end and start again, because something about them differs; in the order in which they have to
    /// start.
    pub replace: Vec<Replacement>,
    /// Components that stay and take new values while they run: nothing but live properties differs.
    pub update: Vec<LiveUpdate>,
    /// Components of the wanted fleet that have to start, each after those whose services it calls.
    pub add: Vec<usize>,
    /// Components that stay as they are, as (current, wanted).
    pub keep: Vec<(usize, usize)>,
}

/// A component that ends and starts again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replacement {
    /// Its number in the current fleet.
    pub current: usize,
    /// Its number in the wanted fleet.
    pub wanted: usize,
    /// The reasons against keeping it.
    pub differences: Vec<Difference>,
}

/// A component that takes new values of properties that its class declares `live`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LiveUpdate {
    /// Its number in the current fleet.
    pub current: usize,
    /// Its number in the wanted fleet.
    pub wanted: usize,
    /// The properties whose values differ.
    pub properties: Vec<String>,
}

/// A difference between two components of one path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Difference {
    /// The class. The new instance begins anew.
    Class,
    /// The site, and with it the names of its topics. The new instance begins anew: what the earlier one knows is of
    /// the other site, where others know it.
    Site,
    /// The value of this property of the class.
    Value(String),
    /// Its task properties: period, delay, renames, policies.
    Task,
    /// The services to which this reference leads, the class of one that offers them, or the deadline of its calls.
    Reference(String),
    /// Its loops, their order, or the values of one of them.
    Loops,
    /// Which of its services are offered over the web, or where.
    Web,
}

impl ChangePlan {
    /// The plan from the fleet that runs to the fleet that is wanted.
    pub fn between(current: &Members<'_>, wanted: &Members<'_>) -> ChangePlan {
        let present = current.iter().enumerate().filter_map(|(number, spec)| Some((number, (*spec)?)));
        let running: HashMap<&str, usize> =
            present.map(|(number, component)| (component.path.as_str(), number)).collect();
        let mut stays = vec![false; current.len()];
        let mut plan = ChangePlan::default();
        for number in providers_first(wanted) {
            let Some(component) = wanted[number] else { continue };
            let before = running.get(component.path.as_str()).copied();
            let Some((before, known)) = before.and_then(|before| Some((before, current[before]?))) else {
                plan.add.push(number);
                continue;
            };
            stays[before] = true;
            let differences = differences(current, known, wanted, component);
            if differences.is_empty() {
                plan.keep.push((before, number));
            } else if let Some(properties) = live(component, &differences) {
                plan.update.push(LiveUpdate { current: before, wanted: number, properties });
            } else {
                plan.replace.push(Replacement { current: before, wanted: number, differences });
            }
        }
        plan.remove = providers_first(current).into_iter().rev().filter(|&number| !stays[number]).collect();
        plan
    }

    /// True if nothing has to change.
    pub fn is_empty(&self) -> bool {
        self.remove.is_empty() && self.replace.is_empty() && self.update.is_empty() && self.add.is_empty()
    }
}

impl Replacement {
    /// True if the component is another one under the same path: the present one leaves the fleet, and the new one
    /// begins without its state.
    pub fn is_anew(&self) -> bool {
        self.differences.iter().any(|one| matches!(one, Difference::Class | Difference::Site))
    }

    /// True if the new instance gets the state of the earlier one: it is the same component, and its class saves it.
    pub fn hands_over(&self, wanted: &ComponentSpec) -> bool {
        wanted.class.declaration().saves && !self.is_anew()
    }
}

/// The properties that differ, if they are all live and nothing else differs.
fn live(wanted: &ComponentSpec, differences: &[Difference]) -> Option<Vec<String>> {
    let class = wanted.class.declaration();
    let live = |difference: &Difference| match difference {
        Difference::Value(name) if class.property(name).is_some_and(|one| one.live) => Some(name.clone()),
        _ => None,
    };
    differences.iter().map(live).collect()
}

fn differences(
    current: &Members<'_>,
    before: &ComponentSpec,
    wanted: &Members<'_>,
    after: &ComponentSpec,
) -> Vec<Difference> {
    if before.class.name() != after.class.name() {
        return vec![Difference::Class];
    }
    let mut differences = Vec::new();
    let missing_after = before.values.iter().filter(|(name, _)| value(after, name).is_none());
    for (name, _) in after.values.iter().chain(missing_after) {
        if !is_same(after, name, value(before, name), value(after, name)) {
            differences.push(Difference::Value(name.to_string()));
        }
    }
    if before.site != after.site {
        differences.push(Difference::Site);
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
    if before.web != after.web {
        differences.push(Difference::Web);
    }
    let same_target = |one: &WireTarget, other: &WireTarget| {
        let (before, after) = (current.get(one.component), wanted.get(other.component));
        let same = matches!((before, after), (Some(Some(before)), Some(Some(after)))
            if before.path == after.path && before.class.name() == after.class.name() && before.site == after.site);
        same && one.service == other.service
    };
    let same_targets = |one: &Wire, other: &Wire| {
        one.elsewhere == other.elsewhere
            && one.web == other.web
            && one.deadline == other.deadline
            && one.targets.len() == other.targets.len()
            && one.targets.iter().zip(&other.targets).all(|(one, other)| same_target(one, other))
    };
    for wire in &after.references {
        let same = before.references.iter().any(|known| {
            known.reference == wire.reference
                && known.interface == wire.interface
                && known.deadline == wire.deadline
                && same_targets(known, wire)
        });
        if !same {
            differences.push(Difference::Reference(wire.reference.clone()));
        }
    }
    differences
}

/// True if a property has the same value: one that is absent has its default.
fn is_same(
    component: &ComponentSpec,
    name: &str,
    before: Option<&PropertyValue>,
    after: Option<&PropertyValue>,
) -> bool {
    let ((Some(only), None) | (None, Some(only))) = (before, after) else { return before == after };
    is_default(component, name, only)
}

/// True if this is the value that a property has unless a composite gives it another one.
pub(super) fn is_default(component: &ComponentSpec, name: &str, value: &PropertyValue) -> bool {
    let declared = component.class.declaration().property(name);
    let default = declared.and_then(|one| one.check(one.default.as_deref()?).ok());
    default.is_some_and(|default| *value == PropertyValue::from(default))
}

/// The value of a property that a component has; `None` where it has the default.
pub(crate) fn value<'a>(component: &'a ComponentSpec, name: &str) -> Option<&'a PropertyValue> {
    component.values.iter().find(|(known, _)| known == name).map(|(_, value)| value)
}
