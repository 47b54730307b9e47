//! An assembly as rules see a fleet.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ptr;
use std::rc::Rc;

use saoms_api::rule::{ClassView, ComponentView, FleetView};

use super::{Assembly, ComponentSpec, LoopSpec};
use crate::registry::RegisteredClass;

/// Shows the components of a site, or all where its name is empty, to somebody who judges them.
pub fn seen<R>(assembly: &Assembly, site: &str, judge: impl FnOnce(&FleetView<'_>) -> R) -> R {
    let all = assembly.all().enumerate();
    let seen: Vec<(usize, &ComponentSpec)> =
        all.filter(|(_, spec)| site.is_empty() || spec.site.as_str() == site).collect();
    let indices: HashMap<usize, usize> = seen.iter().map(|(place, _)| *place).zip(0..).collect();
    let wires = seen.iter().map(|(_, spec)| {
        let ends = spec.references.iter().flat_map(|wire| wire.targets.iter().map(|end| (&wire.reference, end)));
        let known = ends.filter_map(|(name, end)| Some((name.as_str(), *indices.get(&end.component)?)));
        known.collect()
    });
    let wires: Vec<Vec<(&str, usize)>> = wires.collect();
    let renamed: Vec<Vec<(&str, Cow<'_, str>)>> = seen.iter().map(|(_, spec)| renamed(spec)).collect();
    let pairs = renamed.iter().map(|all| all.iter().map(|(declared, on_bus)| (*declared, &**on_bus)).collect());
    let renamed: Vec<Vec<(&str, &str)>> = pairs.collect();
    let mut classes = HashMap::new();
    let views = seen.iter().zip(wires.iter().zip(&renamed)).map(|((_, spec), (wires, renamed))| {
        let key = (ptr::from_ref(&*spec.class), spec.loops.as_ptr());
        let class = classes.entry(key).or_insert_with(|| Rc::new(class_view(&spec.class, &spec.loops)));
        ComponentView {
            path: &spec.path,
            class: Rc::clone(class),
            values: &spec.values,
            period: spec.task.as_ref().map(|task| task.period),
            starts: spec.task.as_ref().is_none_or(|task| task.run_on_startup),
            restarts: spec.task.as_ref().is_some_and(|task| task.restarts() > 0),
            node: &spec.node,
            has_broker: spec.node.is_empty() && spec.task.as_ref().is_some_and(|task| task.url.is_some()),
            renamed,
            wires,
        }
    });
    judge(&FleetView::new(&views.collect::<Vec<_>>()))
}

/// The topics of a component that have another name on the bus, and that name.
fn renamed(spec: &ComponentSpec) -> Vec<(&str, Cow<'_, str>)> {
    let named = spec.publishes().chain(spec.subscribes()).map(|topic| (topic.name.as_str(), spec.topic(&topic.name)));
    let mut renamed: Vec<_> = named.filter(|(declared, on_bus)| declared != on_bus).collect();
    renamed.sort_unstable();
    renamed.dedup();
    renamed
}

/// A class with these loops, as rules see it.
pub(crate) fn class_view<'s>(class: &'s RegisteredClass, loops: &'s [LoopSpec]) -> ClassView<'s> {
    let of_loops = || loops.iter().map(|one| one.class.declaration());
    let published = class.declaration().publishes.iter().chain(of_loops().flat_map(|one| &one.publishes));
    let read = class.declaration().subscribes.iter().chain(of_loops().flat_map(|one| &one.subscribes));
    ClassView {
        name: &class.declaration().name,
        declaration: class.declaration_json(),
        extends: class.extended_json().collect(),
        publishes: published.map(|topic| topic.name.as_str()).collect(),
        subscribes: read.map(|topic| topic.name.as_str()).collect(),
        loops: loops.iter().map(|one| one.class.name()).collect(),
        takes: class.declaration().events().collect(),
    }
}
