//! Loops of each component: those of its class, with the changes of the composite.

mod list;
mod order;
mod team;
mod unserved;

use std::collections::HashMap;
use std::sync::Arc;

use crate::assembly::LoopSpec;
use crate::check::fleet::{Fleet, Kind, Member, property_table::PropertyTable};
use crate::check::options::Options;
use crate::check::parameters::Parameters;
use crate::check::properties::findings::Subject;
use crate::check::properties::given_values::{PropertyValues, ValuePlace};
use crate::check::properties::{self, Giver};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{LoopElement, Property};
use crate::registry::{RegisteredLoop, Registry};

/// The loops of a component, resolved.
pub(crate) struct Resolved<'a> {
    /// In their order; components that say nothing about them share those of their class.
    pub(crate) specs: Arc<[LoopSpec]>,
    changed: Vec<Changed<'a>>,
}

/// A loop that the composite says something about.
struct Changed<'a> {
    place: usize,
    element: &'a LoopElement,
    /// The place of each of its values.
    places: Vec<ValuePlace>,
}

impl Resolved<'_> {
    /// Those that the composite says something about, whose constructors have to be judged.
    pub(crate) fn changed(&self) -> impl Iterator<Item = (&RegisteredLoop, Subject<'_>)> {
        self.changed.iter().map(|one| {
            let (spec, name) = (&self.specs[one.place], &one.element.name);
            let (values, places) = (&spec.values, &one.places);
            let subject = Subject {
                what: "loop",
                name,
                at: name.location,
                element: None,
                renamed: &[],
                values,
                places,
                site: "",
            };
            (&*spec.class, subject)
        })
    }
}

/// A loop of a component in the making.
struct Planned<'a> {
    name: &'a str,
    /// `None` where it is unknown, which is reported.
    class: Option<&'a Arc<RegisteredLoop>>,
    element: Option<&'a LoopElement>,
    /// The loop of the class whose place it takes.
    replaced: Option<&'a Arc<RegisteredLoop>>,
}

/// Finds the loops of all components. The class of a component with loops becomes one that uses the topics and
/// references of these as well. `None` for loops with a fault, which is reported, and for components without a class.
pub(crate) fn resolve<'a>(
    fleet: &mut Fleet<'a>,
    given: &[PropertyValues],
    (registry, options): (&'a Registry, &Options),
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) -> Vec<Option<Resolved<'a>>> {
    // The class of each place together with these loops.
    let mut known: HashMap<(usize, Vec<&str>), usize> = HashMap::new();
    // The loops of components that say nothing about them, with the place of their class together with these: by the
    // place of the class alone, and which of its lists of loops it is.
    let mut usual = HashMap::new();
    let mut all = Vec::with_capacity(given.len());
    for (place, given) in given.iter().enumerate() {
        let member = &fleet.members[place];
        report.about(member);
        let Kind::Class(index) = member.kind else {
            without_class(member, parameters, report);
            all.push(None);
            continue;
        };
        let class = &fleet.classes[index];
        let says_nothing = member.component.loops.is_empty();
        let list = class.class.declaration().loops_of(given.own());
        let choice = says_nothing.then_some((index, list.as_ptr()));
        if let Some((with, specs)) = choice.as_ref().and_then(|choice| usual.get(choice)) {
            fleet.members[place].kind = Kind::Class(*with);
            all.push(Some(Resolved { specs: Arc::clone(specs), changed: Vec::new() }));
            continue;
        }
        let (loops, is_planned) = list::plan(member, class, given, (registry, options), report);
        let is_team = is_planned && team::check(member, class, &loops, report);
        if is_team {
            unserved::check(class, &loops, report);
        }
        let used: Vec<&Arc<RegisteredLoop>> = loops.iter().filter_map(|one| one.class).collect();
        let mut with = index;
        if !used.is_empty() {
            let key = (index, used.iter().map(|one| one.name()).collect());
            with = *known.entry(key).or_insert_with(|| {
                let with = fleet.classes[index].with(used.iter().map(|one| one.declaration()));
                fleet.classes.push(with);
                fleet.classes.len() - 1
            });
            fleet.members[place].kind = Kind::Class(with);
        }
        let resolved = resolved(&loops, &fleet.members[place], parameters, report);
        let resolved = resolved.filter(|_| is_team);
        if let (Some(choice), Some(resolved)) = (choice, &resolved) {
            usual.insert(choice, (with, Arc::clone(&resolved.specs)));
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
    report: &mut Report<'_>,
) -> Option<Resolved<'a>> {
    let mut specs = Vec::with_capacity(planned.len());
    let mut changed = Vec::new();
    for one in planned {
        let Some(class) = one.class else {
            one.element.into_iter().for_each(|element| sources(element, member, parameters, report));
            continue;
        };
        let (values, written) = Default::default();
        let mut spec = LoopSpec { name: one.name.to_owned(), class: Arc::clone(class), values, written };
        if let Some(element) = one.element {
            let table = PropertyTable::of_loop(class);
            let giver = Giver::looping(element, member);
            let given = properties::check(&giver, &table, parameters, report);
            if !given.is_sound {
                continue;
            }
            let places;
            (spec.values, spec.written, places) = given.into_own();
            changed.push(Changed { place: specs.len(), element, places });
        }
        specs.push(spec);
    }
    (specs.len() == planned.len()).then(|| Resolved { specs: specs.into(), changed })
}

/// Looks at where the properties of a loop without a class take their values from.
fn sources<'a>(one: &LoopElement, member: &Member<'a>, parameters: &mut Parameters<'a>, report: &mut Report<'_>) {
    for source in one.properties.iter().filter_map(Property::source) {
        let _ = parameters.resolve(member.unit, source, report);
    }
}

/// Checks the loops of a component that has no class, as far as that is possible.
fn without_class<'a>(member: &Member<'a>, parameters: &mut Parameters<'a>, report: &mut Report<'_>) {
    let loops = &member.component.loops;
    loops.iter().for_each(|one| sources(one, member, parameters, report));
    if let (Kind::Composite(_), Some(first)) = (member.kind, loops.first()) {
        let message = format!("component {} is a composite, which has no loops", quoted(&member.component.name));
        let one = Diagnostic::new(&codes::LOOP_KNOWLEDGE, first.origin.tag, message);
        report.push(one.help("write it in the component that has the loops"));
    }
}
