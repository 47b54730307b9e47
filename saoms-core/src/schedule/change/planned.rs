//! What a change would do, for people and programs that decide about it.

use std::collections::BTreeSet;
use std::sync::Arc;

use saoms_api::extension::ChangeObjection;
use saoms_api::host::{PropertyValue, WriteProperties};
use saoms_lang::assembly::{ComponentSpec, TaskProperties};
use saoms_lang::registry::PropertyDeclaration;
use serde::Serialize;

use crate::assemble::{ChangePlan, Difference, Replacement, value};

/// What a change would do to a running fleet. Components, wires and topics are in the order in which they come and go.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PlannedChanges {
    /// Components that join the fleet.
    pub added: Vec<PlannedMember>,
    /// Components that end.
    pub removed: Vec<PlannedMember>,
    /// Components with new instances.
    pub replaced: Vec<PlannedReplacement>,
    /// Properties that components take while they run.
    pub set: Vec<PlannedValue>,
    /// Wires that are drawn, as `Robot7.world -> World.hardware`.
    pub wires_added: Vec<String>,
    /// Wires that are cut.
    pub wires_removed: Vec<String>,
    /// Topics that nobody published or read before.
    pub topics_added: Vec<String>,
    /// Topics that nobody publishes or reads afterwards.
    pub topics_removed: Vec<String>,
    /// What follows of that in the domain of the components, as their crate tells it; a line each.
    pub consequences: Vec<String>,
    /// Why it cannot be done while the fleet runs; empty where it can.
    pub refused: Vec<PlannedRefusal>,
}

/// A reason why a change cannot be made while the fleet runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedRefusal {
    /// The reason.
    pub reason: String,
    /// The path of the component that it is about, where it is about one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub component: Option<String>,
    /// Where that component is written, as `FILE:LINE:COLUMN`, for whoever knows the files; the fleet does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
}

impl PlannedRefusal {
    /// A reason that is about no component alone.
    pub(super) fn of_fleet(reason: String) -> PlannedRefusal {
        PlannedRefusal { reason, component: None, at: None }
    }
}

impl From<ChangeObjection> for PlannedRefusal {
    fn from(ChangeObjection { reason, component }: ChangeObjection) -> PlannedRefusal {
        PlannedRefusal { reason, component, at: None }
    }
}

/// A component that joins or ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedMember {
    /// Its path.
    pub component: String,
    /// Its class.
    pub class: String,
}

/// A component that gets a new instance.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedReplacement {
    /// Its path.
    pub component: String,
    /// Its class in the wanted fleet.
    pub class: String,
    /// What differs: `class`, `site`, `loops`, a reference, or a property.
    pub differences: Vec<PlannedDifference>,
    /// What becomes of its state.
    pub state: HandedOver,
}

/// What becomes of the state of a component that is replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum HandedOver {
    /// The new instance goes on from it.
    Kept,
    /// The new instance begins without it.
    Lost,
    /// There is none: the component does not run.
    None,
}

/// Something in which a component differs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedDifference {
    /// What it is.
    pub what: String,
    /// What it is now, where that is one text; without it the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// What it will be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
}

/// A value that a component takes while it runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedValue {
    /// Its path.
    pub component: String,
    /// What changes.
    #[serde(flatten)]
    pub value: PlannedDifference,
}

/// A fleet with numbers that wires lead to.
type Fleet = [Option<Arc<ComponentSpec>>];

impl PlannedChanges {
    /// True if nothing would change.
    pub fn is_empty(&self) -> bool {
        self.added.is_empty() && self.removed.is_empty() && self.replaced.is_empty() && self.set.is_empty()
    }

    /// The numbers of components that change, in words: `2 added, 1 set`.
    pub fn summary(&self) -> String {
        let mut set: Vec<&str> = self.set.iter().map(|one| one.component.as_str()).collect();
        set.dedup();
        let counts = [
            (self.added.len(), "added"),
            (self.removed.len(), "removed"),
            (self.replaced.len(), "replaced"),
            (set.len(), "set"),
        ];
        let words = counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
        let words: Vec<String> = words.collect();
        if words.is_empty() { "nothing to do".to_owned() } else { words.join(", ") }
    }

    /// The components that would lose their state.
    pub fn losses(&self) -> impl Iterator<Item = &PlannedReplacement> {
        self.replaced.iter().filter(|one| one.state == HandedOver::Lost)
    }

    /// What a plan between two fleets does; `state` says what becomes of the state of a component, whose class saves it
    /// or not.
    pub(super) fn of(
        plan: &ChangePlan,
        current: &Fleet,
        wanted: &Fleet,
        state: impl Fn(usize, bool) -> HandedOver,
    ) -> PlannedChanges {
        let member = |fleet: &Fleet, number: &usize| {
            let spec = fleet.get(*number)?.as_ref()?;
            Some(PlannedMember { component: spec.path.clone(), class: spec.class.name().to_owned() })
        };
        let replaced = plan.replace.iter().filter_map(|one| {
            let (before, after) = (current[one.current].as_ref()?, wanted[one.wanted].as_ref()?);
            let state = match state(one.current, one.hands_over(after)) {
                // An instance of another class or site goes on from nothing of it.
                HandedOver::Kept if one.is_anew() => HandedOver::Lost,
                state => state,
            };
            Some(replacement(one, (current, before), (wanted, after), state))
        });
        let set = plan.update.iter().flat_map(|one| {
            let ends = current[one.current].as_ref().zip(wanted[one.wanted].as_ref());
            let values = ends.into_iter().flat_map(|(before, after)| {
                one.properties.iter().map(|name| PlannedValue {
                    component: after.path.clone(),
                    value: difference_of_value(name, before, after),
                })
            });
            values.collect::<Vec<_>>()
        });
        let [wires_before, wires_after] = [current, wanted].map(wires);
        let [topics_before, topics_after] = [current, wanted].map(topics);
        let without = |all: &BTreeSet<String>, others: &BTreeSet<String>| all.difference(others).cloned().collect();
        PlannedChanges {
            added: plan.add.iter().filter_map(|number| member(wanted, number)).collect(),
            removed: plan.remove.iter().filter_map(|number| member(current, number)).collect(),
            replaced: replaced.collect(),
            set: set.collect(),
            wires_added: without(&wires_after, &wires_before),
            wires_removed: without(&wires_before, &wires_after),
            topics_added: without(&topics_after, &topics_before),
            topics_removed: without(&topics_before, &topics_after),
            consequences: Vec::new(),
            refused: Vec::new(),
        }
    }
}

fn replacement(
    one: &Replacement,
    (current, before): (&Fleet, &ComponentSpec),
    (wanted, after): (&Fleet, &ComponentSpec),
    state: HandedOver,
) -> PlannedReplacement {
    let plain =
        |what: &str, from: Option<String>, to: Option<String>| PlannedDifference { what: what.into(), from, to };
    let targets = |fleet: &Fleet, spec: &ComponentSpec, reference: &str| {
        let ends = wire_ends(fleet, spec, reference);
        (!ends.is_empty()).then(|| ends.join(", "))
    };
    let differences = one.differences.iter().flat_map(|difference| match difference {
        Difference::Class => {
            vec![plain("class", Some(before.class.name().to_owned()), Some(after.class.name().to_owned()))]
        }
        Difference::Site => {
            let name = |spec: &ComponentSpec| Some(spec.site.to_string()).filter(|site| !site.is_empty());
            vec![plain("site", name(before), name(after))]
        }
        Difference::Value(name) => vec![difference_of_value(name, before, after)],
        Difference::Task => differences_of_task(before, after),
        Difference::Reference(name) => {
            vec![plain(name, targets(current, before, name), targets(wanted, after, name))]
        }
        Difference::Web => {
            let paths = |spec: &ComponentSpec| {
                let paths: Vec<String> = spec.web.iter().map(|service| service.path.to_string()).collect();
                (!paths.is_empty()).then(|| paths.join(", "))
            };
            vec![plain("services on the web", paths(before), paths(after))]
        }
        Difference::Loops => {
            let names = |spec: &ComponentSpec| {
                let names: Vec<&str> = spec.loops.iter().map(|one| one.name.as_str()).collect();
                Some(names.join(", "))
            };
            let (from, to) = (names(before), names(after));
            // The same loops differ in a value.
            let is_same = from == to;
            vec![plain("loops", from.filter(|_| !is_same), to.filter(|_| !is_same))]
        }
    });
    PlannedReplacement {
        component: after.path.clone(),
        class: after.class.name().to_owned(),
        differences: differences.collect(),
        state,
    }
}

fn difference_of_value(name: &str, before: &ComponentSpec, after: &ComponentSpec) -> PlannedDifference {
    let text = |spec: &ComponentSpec| {
        let declared = spec.class.declaration().property(name);
        let default = || declared.and_then(|one| one.default.clone());
        value(spec, name).map(|value| shown(declared, value)).or_else(default)
    };
    PlannedDifference { what: name.to_owned(), from: text(before), to: text(after) }
}

fn differences_of_task(before: &ComponentSpec, after: &ComponentSpec) -> Vec<PlannedDifference> {
    let values = |spec: &ComponentSpec| spec.task.as_ref().map(WriteProperties::to_values).unwrap_or_default();
    let (before, after) = (values(before), values(after));
    let all = TaskProperties::declarations().iter();
    let differing = all.filter_map(|declared| {
        let of = |values: &[(_, PropertyValue)]| {
            let found =
                values.iter().find(|(known, _): &&(saoms_api::host::SmolStr, _)| *known == declared.name.as_str());
            found.map(|(_, value)| value.clone())
        };
        let (from, to) = (of(&before), of(&after));
        let text = |value: Option<PropertyValue>| value.map(|value| shown(Some(declared), &value));
        (from != to).then(|| PlannedDifference { what: declared.name.clone(), from: text(from), to: text(to) })
    });
    differing.collect()
}

/// A value as people read it; a secret as nobody does.
fn shown(declared: Option<&PropertyDeclaration>, value: &PropertyValue) -> String {
    if declared.is_some_and(|one| one.secret) {
        return "***".to_owned();
    }
    match value {
        PropertyValue::Scalar(scalar) => scalar.text().to_string(),
        PropertyValue::Many(values) => {
            let all: Vec<String> = values.iter().map(|one| shown(declared, one)).collect();
            format!("[{}]", all.join(", "))
        }
        PropertyValue::Complex(parts) => {
            let inside = |name: &str| declared.and_then(|one| one.properties.iter().find(|part| part.name == name));
            let all: Vec<String> =
                parts.iter().map(|(name, one)| format!("{name}={}", shown(inside(name), one))).collect();
            format!("{{{}}}", all.join(", "))
        }
    }
}

/// The services to which a reference leads.
fn wire_ends(fleet: &Fleet, spec: &ComponentSpec, reference: &str) -> Vec<String> {
    let wires = spec.references.iter().filter(|wire| wire.reference == reference);
    let ends = wires.flat_map(|wire| {
        let here = wire.targets.iter().filter_map(|end| {
            let provider = fleet.get(end.component)?.as_ref()?;
            Some(format!("{}.{}", provider.path, end.service))
        });
        let there = wire.elsewhere.iter().map(|end| format!("{}.{}", end.component, end.service));
        here.chain(there).chain(wire.web.iter().map(|target| target.address.to_string()))
    });
    ends.collect()
}

fn wires(fleet: &Fleet) -> BTreeSet<String> {
    let specs = fleet.iter().flatten();
    let all = specs.flat_map(|spec| {
        let ends = spec.references.iter().flat_map(|wire| {
            let ends = wire_ends(fleet, spec, &wire.reference).into_iter();
            ends.map(|end| format!("{}.{} -> {end}", spec.path, wire.reference))
        });
        ends.collect::<Vec<_>>()
    });
    all.collect()
}

/// The topics that a fleet publishes or reads, as its classes declare them.
fn topics(fleet: &Fleet) -> BTreeSet<String> {
    let specs = fleet.iter().flatten();
    specs
        .flat_map(|spec| spec.publishes().chain(spec.subscribes()).map(|topic| spec.topic(&topic.name).into_owned()))
        .collect()
}
