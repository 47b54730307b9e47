//! Which loops each component has: those of its class, changed by what the composite says.

mod list;
mod order;
mod team;

use std::collections::HashMap;
use std::sync::Arc;

use smol_str::SmolStr;

use super::checked::{Checks, Elsewhere, Kept};
use super::classes::ClassIndex;
use super::findings::Subject;
use super::fleet::{Fleet, Kind, Member};
use super::parameters::Parameters;
use super::properties::{self, Giver};
use super::report::Report;
use super::slots::Slots;
use super::values::Values;
use crate::assembly::LoopSpec;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Loop, Property};
use crate::registry::{LoopClass, Registry};

/// The loops of a component, resolved.
pub(super) struct Resolved<'a> {
    /// In their order; components that say nothing about them share those of their class.
    pub(super) specs: Arc<[LoopSpec]>,
    /// Those that the composite says something about: a pointer of one word, as few components have any.
    #[expect(clippy::box_collection, reason = "of a large fleet, a word of each component matters")]
    changed: Option<Box<Vec<Changed<'a>>>>,
}

/// A loop that the composite says something about.
struct Changed<'a> {
    place: usize,
    element: &'a Loop,
    /// Its values that are not one text in the composite, for their places.
    elsewhere: Vec<Elsewhere>,
}

impl Resolved<'_> {
    /// Those that the composite says something about, for the judgement of their constructors: the others are as their class has them.
    pub(super) fn changed(&self) -> impl Iterator<Item = (&LoopClass, Subject<'_>)> {
        self.changed.iter().flat_map(|changed| changed.iter()).map(|one| {
            let (spec, Loop { name, properties, .. }) = (&self.specs[one.place], one.element);
            let (values, elsewhere, properties) = (&spec.values, &one.elsewhere, properties);
            (&*spec.class, Subject { what: "loop", name, at: name.location, values, properties, elsewhere })
        })
    }
}

/// A loop of a component in the making.
struct Planned<'a> {
    name: &'a str,
    /// `None` where it is unknown, which is reported.
    class: Option<&'a Arc<LoopClass>>,
    element: Option<&'a Loop>,
}

/// A place among the classes, and the value that chooses among the lists of loops that the class has.
type Choice = (usize, Option<SmolStr>);

/// The loops as they are where the composite says nothing about them.
#[derive(Clone)]
struct Usual {
    of: Choice,
    /// The place of the class together with these loops.
    with: usize,
    specs: Arc<[LoopSpec]>,
}

/// Finds the loops of all components; `None` where something about them is wrong. The class of a component with loops becomes one that uses
/// the topics and references of these as well.
pub(super) fn resolve<'a>(
    fleet: &mut Fleet<'a>,
    classes: &mut Vec<ClassIndex<'a>>,
    checks: &Checks,
    registry: &'a Registry,
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) -> Vec<Option<Resolved<'a>>> {
    let mut values = Values::default();
    // The class of each place together with these loops.
    let mut known: HashMap<(usize, Vec<&str>), usize> = HashMap::new();
    // The same with the loops that components of a class have by this choice where the composite says nothing about them.
    let mut usual: HashMap<Choice, Usual> = HashMap::default();
    // Those of the component before, which this one mostly has as well.
    let mut before: Option<Usual> = None;
    let mut all = Vec::with_capacity(fleet.members.len());
    for place in 0..fleet.members.len() {
        let member = &fleet.members[place];
        report.about(member);
        let (Kind::Class(index), Some(checked)) = (member.kind, checks.get(place)) else {
            without_class(member, parameters, report);
            all.push(None);
            continue;
        };
        let class = &classes[index];
        // A component that says nothing about its loops has them as those have that were there before it.
        let has_none = member.component.loops().is_empty();
        let plain = has_none.then(|| (index, list::choice(class, checked)));
        if let Some((index, choice)) = plain {
            let is_same = |one: &&Usual| one.of.0 == index && one.of.1.as_deref() == choice;
            if before.as_ref().filter(is_same).is_none() {
                before = usual.get(&(index, choice.map(SmolStr::new))).cloned();
            }
            if let Some(Usual { with, specs, .. }) = &before {
                fleet.members[place].kind = Kind::Class(*with);
                all.push(Some(Resolved { specs: Arc::clone(specs), changed: None }));
                continue;
            }
        }
        let plain = plain.map(|(index, choice)| (index, choice.map(SmolStr::new)));
        let (loops, is_planned) = list::plan(member, class, checked, registry, report);
        let is_team = is_planned && team::check(member, class, &loops, report);
        let used: Vec<&Arc<LoopClass>> = loops.iter().filter_map(|one| one.class).collect();
        let mut with = index;
        if !used.is_empty() {
            let key = (index, used.iter().map(|one| one.name()).collect());
            with = *known.entry(key).or_insert_with(|| {
                let with = classes[index].with(used.iter().map(|one| one.declaration()));
                classes.push(with);
                classes.len() - 1
            });
            fleet.members[place].kind = Kind::Class(with);
        }
        let resolved = resolved(&loops, &fleet.members[place], parameters, &mut values, report);
        let resolved = resolved.filter(|_| is_team);
        if let (Some(of), Some(resolved)) = (plain, &resolved) {
            usual.insert(of.clone(), Usual { of, with, specs: Arc::clone(&resolved.specs) });
        }
        all.push(resolved);
    }
    report.about_all();
    all
}

/// Loops with their values; `None` where any of them is wrong.
fn resolved<'a>(
    planned: &[Planned<'a>],
    member: &Member<'a>,
    parameters: &mut Parameters<'a>,
    values: &mut Values<'a>,
    report: &mut Report<'_>,
) -> Option<Resolved<'a>> {
    let mut specs = Vec::with_capacity(planned.len());
    let mut changed = Vec::new();
    for one in planned {
        let Some(class) = one.class else {
            let properties = one.element.into_iter().flat_map(|element| &element.properties);
            sources(properties, member, parameters, report);
            continue;
        };
        let mut spec = LoopSpec { name: one.name.to_owned(), class: Arc::clone(class), values: Vec::new() };
        if let Some(element) = one.element {
            let slots = Slots::of_loop(class);
            let giver = Giver::looping(element, member);
            let mut own = Checks::default();
            properties::check(&giver, &slots, parameters, values, &mut own, report);
            if own.get(0).is_none_or(|checked| !checked.is_sound) {
                continue;
            }
            let Kept { values, elsewhere, .. } = own.take(0).unwrap_or_default();
            spec.values = values;
            changed.push(Changed { place: specs.len(), element, elsewhere });
        }
        specs.push(spec);
    }
    let changed = (!changed.is_empty()).then(|| Box::new(changed));
    (specs.len() == planned.len()).then(|| Resolved { specs: specs.into(), changed })
}

/// Looks at where the properties of loops without a class take their values from.
fn sources<'a>(
    properties: impl Iterator<Item = &'a Property>,
    member: &Member<'a>,
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) {
    for source in properties.filter_map(|property| property.source()) {
        let _ = parameters.resolve(member.unit, source, report);
    }
}

/// What can be said of the loops of a component that has no class.
fn without_class<'a>(member: &Member<'a>, parameters: &mut Parameters<'a>, report: &mut Report<'_>) {
    let loops = member.component.loops();
    sources(loops.iter().flat_map(|one| &one.properties), member, parameters, report);
    if let (Kind::Composite(_), Some(first)) = (member.kind, loops.first()) {
        let message =
            format!("component {} is a composite, which has no loops", quoted(&member.component.name));
        let one = Diagnostic::new(&codes::LOOP_KNOWLEDGE, first.origin.tag, message);
        report.push(one.help("write it in the component that has the loops"));
    }
}
