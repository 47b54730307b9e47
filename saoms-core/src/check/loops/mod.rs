//! Which loops each component has: those of its class, changed by what the composite says.

mod list;
mod order;
mod team;

use std::collections::HashMap;
use std::sync::Arc;

use super::classes::ClassIndex;
use super::findings::Subject;
use super::fleet::{Fleet, Kind, Member};
use super::parameters::Parameters;
use super::properties::{self, Checked, Giver, Written};
use super::report::Report;
use super::slots::Slots;
use super::values::Values;
use crate::assembly::LoopSpec;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Loop;
use crate::registry::{LoopClass, Registry};

/// A loop of a component, resolved.
pub(super) struct Resolved<'a> {
    pub(super) spec: LoopSpec,
    /// What the composite says about it, if anything.
    element: Option<&'a Loop>,
    /// Where the composite gives its values.
    written: Vec<Written<'a>>,
}

impl Resolved<'_> {
    /// For the judgement of its constructor; `None` where the composite says nothing about it, so that all is as its class has it.
    pub(super) fn subject(&self) -> Option<Subject<'_>> {
        let name = &self.element?.name;
        let (values, written) = (&self.spec.values, &self.written);
        Some(Subject { what: "loop", name, at: name.location, values, written })
    }
}

/// A loop of a component in the making.
struct Planned<'a> {
    name: &'a str,
    /// `None` where it is unknown, which is reported.
    class: Option<&'a Arc<LoopClass>>,
    element: Option<&'a Loop>,
}

/// Finds the loops of all components; `None` where something about them is wrong. The class of a component with loops becomes one that uses
/// the topics and references of these as well.
pub(super) fn resolve<'a>(
    fleet: &mut Fleet<'a>,
    classes: &mut Vec<ClassIndex<'a>>,
    checked: &[Option<Checked>],
    registry: &'a Registry,
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) -> Vec<Option<Vec<Resolved<'a>>>> {
    let mut values = Values::default();
    // The class of each place together with these loops.
    let mut known: HashMap<(usize, Vec<&str>), usize> = HashMap::new();
    let mut all = Vec::with_capacity(fleet.members.len());
    for (place, checked) in checked.iter().enumerate() {
        let member = &fleet.members[place];
        report.about(member);
        let (Kind::Class(index), Some(checked)) = (member.kind, checked) else {
            without_class(member, parameters, report);
            all.push(None);
            continue;
        };
        let class = &classes[index];
        let (loops, is_planned) = list::plan(member, class, checked, registry, report);
        let is_team = is_planned && team::check(member, class, &loops, report);
        let used: Vec<&Arc<LoopClass>> = loops.iter().filter_map(|one| one.class).collect();
        if !used.is_empty() {
            let key = (index, used.iter().map(|one| one.name()).collect());
            let with = *known.entry(key).or_insert_with(|| {
                let with = classes[index].with(used.iter().map(|one| one.declaration()));
                classes.push(with);
                classes.len() - 1
            });
            fleet.members[place].kind = Kind::Class(with);
        }
        let member = &fleet.members[place];
        let resolved: Vec<_> =
            loops.iter().map(|one| resolved(one, member, parameters, &mut values, report)).collect();
        all.push(resolved.into_iter().collect::<Option<Vec<_>>>().filter(|_| is_team));
    }
    report.about_all();
    all
}

/// A loop with its values; `None` where they are wrong.
fn resolved<'a>(
    planned: &Planned<'a>,
    member: &Member<'a>,
    parameters: &mut Parameters<'a>,
    values: &mut Values,
    report: &mut Report<'_>,
) -> Option<Resolved<'a>> {
    let class = planned.class?;
    let mut spec = LoopSpec { name: planned.name.to_owned(), class: Arc::clone(class), values: Vec::new() };
    let Some(element) = planned.element else {
        return Some(Resolved { spec, element: None, written: Vec::new() });
    };
    let slots = Slots::of_loop(class);
    let checked = properties::check(&Giver::looping(element, member), &slots, parameters, values, report);
    spec.values = checked.values(&slots, |slot| slot.own);
    checked.is_sound.then(|| Resolved { spec, element: planned.element, written: checked.places(&slots) })
}

/// What can be said of the loops of a component that has no class.
fn without_class<'a>(member: &Member<'a>, parameters: &mut Parameters<'a>, report: &mut Report<'_>) {
    let loops = &member.component.loops;
    for source in loops.iter().flat_map(|one| &one.properties).filter_map(|property| property.source()) {
        let _ = parameters.resolve(member.unit, source, report);
    }
    if let (Kind::Composite(_), Some(first)) = (member.kind, loops.first()) {
        let message =
            format!("component {} is a composite, which has no loops", quoted(&member.component.name));
        let one = Diagnostic::new(&codes::LOOP_KNOWLEDGE, first.origin.tag, message);
        report.push(one.help("write it in the component that has the loops"));
    }
}
