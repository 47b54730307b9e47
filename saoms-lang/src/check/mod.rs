//! From the model to an assembly: what can be wrong with a fleet before anything runs.
//!
//! [`check`] is pure: it knows no clock, no thread, no network, and reads nothing but what it is given. It goes from cheap
//! rules to dear ones and looks at everything, so that all faults come in one run. What depends on something that is wrong
//! is not looked at: one mistake gives one diagnostic.

mod absent;
mod agree;
mod arena;
mod astray;
mod autowire;
mod beyond;
mod binding;
mod bindings;
mod census;
mod checked;
mod circle;
mod classes;
mod construct;
mod contracts;
mod cycles;
mod described;
mod endpoint;
mod findings;
mod fleet;
mod given;
mod global;
mod instance;
mod lacking;
mod levels;
mod lexical;
mod loops;
mod misread;
mod multiplicity;
mod names;
mod naming;
mod offer;
mod once;
mod options;
mod parameters;
mod path;
mod presence;
mod promotable;
mod promote;
mod properties;
mod raw;
mod rename;
mod renames;
mod replicas;
mod replicate;
mod report;
mod room;
mod rules;
mod setting;
mod severities;
mod similar;
mod slots;
mod target;
mod task;
#[cfg(test)]
mod tests;
mod topics;
mod traffic;
mod type_name;
mod unfold;
mod unique;
mod value_type;
mod values;
mod variable;
mod whole;
mod wire;
mod wires;
mod written;

use std::collections::HashSet;
use std::sync::Arc;

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use crate::assembly::{Assembly, ComponentSpec, Target, Wire};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes};
use crate::model::{Component, Contribution};
use crate::registry::Registry;
use crate::source::{Location, Sources};

use arena::Arena;
pub use census::{Census, TopicUse};
use checked::{Checks, Elsewhere, Kept};
use classes::ClassIndex;
use findings::Subject;
use fleet::{Fleet, Kind, Member};
pub use options::Options;
use parameters::Parameters;
use properties::Giver;
use report::Report;
pub use setting::Setting;
use severities::Severities;
pub use severities::SeveritySetting;
use task::{Settled, Task};
use values::Values;
pub use variable::Variable;
use wires::Wiring;

/// Checks composites as one fleet, and resolves them when there is no error among `diagnostics`, those from before
/// included, and nothing had to be taken as given.
///
/// ```
/// use saoms_lang::check::{Options, check};
/// use saoms_lang::{diagnostic::Diagnostics, load::load_file, model::Contribution, registry::Registry, source::Sources};
///
/// let text = r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" name="fleet" targetNamespace="urn:fleet">
///     <component name="Robot001"><implementation.java class="robot.Robot001"/></component>
/// </composite>"#;
/// let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
/// let file = sources.add("fleet.composite", text);
/// let fleet = load_file(file, &sources, &mut diagnostics).unwrap();
/// let fleet = Contribution::of(vec![fleet]);
/// let assembly = check(&fleet, &Registry::new(), &Options::default(), &sources, &mut diagnostics);
/// assert!(assembly.is_none());
/// assert_eq!(diagnostics.iter().next().unwrap().message, "there is no class `robot.Robot001`");
/// ```
pub fn check(
    contribution: &Contribution,
    registry: &Registry,
    options: &Options,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<Assembly> {
    examine(contribution, registry, options, sources, diagnostics, |sound, severities, report| {
        let places = if options.wiring { sound.places() } else { Vec::new() };
        let assembly = sound.assemble(|one| classes::library(one, contribution, sources))?;
        if options.wiring {
            let known = report.diagnostics().len();
            traffic::check(&assembly, &places, report);
            severities.apply(known, report.diagnostics());
        }
        Some(assembly)
    })
}

/// As [`check`] for the diagnostics alone, which needs no assembly: the number of components of the fleet that there would be.
///
/// What [`Options::wiring`] asks for is told of assemblies only.
pub fn count(
    contribution: &Contribution,
    registry: &Registry,
    options: &Options,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    examine(contribution, registry, options, sources, diagnostics, |sound, _, _| sound.count())
}

/// Looks at everything, and makes something of a fleet without errors.
fn examine<T>(
    contribution: &Contribution,
    registry: &Registry,
    options: &Options,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
    make: impl FnOnce(Sound<'_, '_>, &mut Severities, &mut Report<'_>) -> Option<T>,
) -> Option<T> {
    let mut severities = Severities::of(contribution, options, registry, diagnostics);
    let report = &mut Report::new(sources, diagnostics);
    report.assumes = options.assume_classes;
    report.tells_echoes = severities.mentions(&codes::NOT_UNIQUE);
    report.lowers_attributes = severities.mentions(&codes::UNKNOWN_ATTRIBUTE);
    let replicas = Arena::new();
    let mut fleet = unfold::unfold(contribution, options, &replicas, report);
    let mut parameters = Parameters::of(&fleet, options, report);
    let mut classes = classes::resolve(&mut fleet, contribution, registry, options.assume_classes, report);
    let mut checks = properties(&fleet, &classes, &mut parameters, report);
    let loops = loops::resolve(&mut fleet, &mut classes, &checks, registry, &mut parameters, report);
    parameters.finish(&fleet, report);
    let (of, loops) = absent::remove(&mut fleet, std::mem::take(&mut checks.of), loops);
    checks.of = of;
    let (resolved, halves) = components(&fleet, &classes, checks, loops, report);
    written::check(&fleet, report);
    let is_misread = |one: &Diagnostic| one.code.id.starts_with("S10") && !severities.mentions(one.code);
    let misread = report.diagnostics().iter().any(is_misread);
    let known = report.errors();
    contracts::check(&fleet, &classes, report);
    bindings::check(&fleet, report);
    described::check(&fleet, &classes, report);
    let promoted = promote::check(&fleet, &classes, report);
    let wiring = wires::check(&fleet, &classes, &promoted, report);
    let has_open_wires = misread || report.errors() > known;
    saoms_api::host::contain::install_hook();
    for (member, resolved) in fleet.members.iter().zip(&resolved) {
        report.about(member);
        if let (Kind::Class(class), Some(resolved)) = (member.kind, resolved) {
            let without = options.without_plugin_code;
            construct::component(resolved.subject(member), &classes[class], without, report);
            for (class, subject) in resolved.loops.changed() {
                construct::looping(subject, class, without, report);
            }
        }
    }
    for Half { member, values, elsewhere, unsure } in &halves {
        let member = &fleet.members[*member];
        if let Kind::Class(class) = member.kind {
            report.about(member);
            let subject = Subject::of(member, values, elsewhere);
            construct::partly(subject, &classes[class], unsure, options.without_plugin_code, report);
        }
    }
    report.about_all();
    let rules =
        registry.rules().iter().filter(|rule| !options.without_plugin_code || rule.origin().is_none());
    rules::check(&fleet, &classes, &resolved, (&wiring, has_open_wires), rules, report);
    if options.assume_classes {
        elsewhere(&fleet, report);
    }
    report.finish();
    severities.apply(0, report.diagnostics());
    if report.has_errors() {
        severities.overruled(report.diagnostics());
        return None;
    }
    let sound = Sound { fleet: &fleet, classes: &classes, resolved, wiring: &wiring };
    let made = make(sound, &mut severities, report);
    severities.finish(options.wiring, report.diagnostics());
    severities.overruled(report.diagnostics());
    made.filter(|_| !report.has_errors())
}

/// The files of values of components that are taken as given may come with what implements them: that they are not there is a warning.
fn elsewhere(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let given = fleet.members.iter().filter(|member| member.kind == Kind::Given);
    let properties = given.flat_map(|member| &member.component.properties);
    let places: HashSet<Location> = properties.filter_map(|one| Some(one.file()?.location)).collect();
    report.diagnostics().adjust(0, |one| {
        if one.code == &codes::FILE_NOT_FOUND && places.contains(&one.location) {
            one.severity = Severity::Warning;
        }
    });
}

/// What the properties of a component come to.
struct Resolved<'r> {
    /// The values of the class's own properties.
    values: Vec<(SmolStr, PropertyValue)>,
    task: Option<Settled>,
    loops: loops::Resolved<'r>,
    /// What few have.
    more: Option<Box<More>>,
}

/// What the properties of few components come to.
struct More {
    /// The values that are not one text in the composite, for their places.
    elsewhere: Vec<Elsewhere>,
    /// Where its topics got other names.
    renamed: Vec<(String, Location)>,
    /// Where its `queue` is written.
    queue: Option<Location>,
}

/// What is known of the properties of a component with a fault.
struct Half {
    /// The place of the component.
    member: usize,
    values: Vec<(SmolStr, PropertyValue)>,
    elsewhere: Vec<Elsewhere>,
    /// The places of the properties whose values are not known.
    unsure: Vec<usize>,
}

impl Resolved<'_> {
    fn subject<'s>(&'s self, member: &Member<'s>) -> Subject<'s> {
        let elsewhere = self.more.as_ref().map_or(&[][..], |more| &more.elsewhere);
        Subject::of(member, &self.values, elsewhere)
    }
}

/// Checks the properties of all components; `None` for one without a class.
fn properties<'a>(
    fleet: &Fleet<'a>,
    classes: &[ClassIndex<'a>],
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) -> Checks {
    let mut values = Values::default();
    let with_class = || fleet.members.iter().filter(|member| matches!(member.kind, Kind::Class(_)));
    let given = with_class().map(|member| member.component.properties.len()).sum();
    let mut all = Checks::with_capacity(fleet.members.len(), with_class().count(), given);
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        parameters.types(member, report);
        if let Kind::Class(index) = member.kind {
            let (slots, described) = (&classes[index].slots, fleet.component_type(place));
            let giver = Giver::component(member, described);
            properties::check(&giver, slots, parameters, &mut values, &mut all, report);
            continue;
        }
        properties::repeated(member.component, report);
        match fleet.inner(place) {
            Some(inner) => properties::of_composite(member, inner, report),
            None => given::properties(member, fleet.known(place), parameters, report),
        }
        all.add_none();
    }
    report.about_all();
    all
}

/// Checks everything else about components that needs no look at wires; `None` for one with a fault, of which what is known stands in
/// the second list.
fn components<'f, 'a>(
    fleet: &'f Fleet<'a>,
    classes: &'f [ClassIndex<'a>],
    mut checks: Checks,
    loops: Vec<Option<loops::Resolved<'a>>>,
    report: &mut Report<'_>,
) -> (Vec<Option<Box<Resolved<'a>>>>, Vec<Half>) {
    let mut halves = Vec::new();
    let mut unique = unique::Unique::default();
    let mut topics = topics::Topics::default();
    let mut before = task::Before::default();
    let mut listed = renames::Renames::default();
    let mut all = Vec::with_capacity(fleet.members.len());
    for (place, (member, loops)) in fleet.members.iter().zip(loops).enumerate() {
        report.about(member);
        let (Kind::Class(index), Some(checked)) = (member.kind, checks.get(place)) else {
            all.push(None);
            continue;
        };
        let class = &classes[index];
        unique.add((place, fleet), class, checked, report);
        let is_periodic = class.class.declaration().is_periodic();
        let mut task =
            is_periodic.then(|| task::check(member.component, (index, class), checked, &mut before, report));
        if let Some(task) = task.as_mut().filter(|task| !task.listed.is_empty()) {
            listed.add(place, std::mem::take(&mut task.listed));
        }
        if !topics.has(index, task.as_ref()) {
            topics.add(member, index, class, task.as_ref(), report);
        }
        let (task, renamed) = task.map_or_else(Default::default, Task::into_parts);
        let sound = checked.is_sound && is_periodic == task.is_some();
        let queue = class.slots.queue.and_then(|queue| checked.at(queue)).map(|given| given.place);
        let Kept { mut values, elsewhere, unsure } = checks.take(place).unwrap_or_default();
        for preset in class.slots.presets {
            if values.iter().all(|(name, _)| *name != preset.0) {
                values.push(preset.clone());
            }
        }
        let resolved = match loops.filter(|_| sound) {
            Some(loops) => {
                let has_more = !elsewhere.is_empty() || !renamed.is_empty() || queue.is_some();
                let more = has_more.then(|| Box::new(More { elsewhere, renamed, queue }));
                Some(Box::new(Resolved { values, task, loops, more }))
            }
            None if member.has_open_values() => None,
            None => {
                halves.push(Half { member: place, values, elsewhere, unsure });
                None
            }
        };
        all.push(resolved);
    }
    report.about_all();
    listed.finish(fleet, report);
    (all, halves)
}

/// A fleet without errors. Components of it may have no class where that is taken as given.
struct Sound<'s, 'a> {
    fleet: &'s Fleet<'a>,
    classes: &'s [ClassIndex<'a>],
    resolved: Vec<Option<Box<Resolved<'a>>>>,
    wiring: &'s Wiring,
}

impl Sound<'_, '_> {
    /// How many components there are; `None` when something is taken as given.
    fn count(&self) -> Option<usize> {
        let runs = self.fleet.members.iter().zip(&self.resolved).filter(|(member, _)| member.runs());
        runs.map(|(_, resolved)| resolved.as_ref().map(|_| 1)).sum()
    }

    /// Where the components of the assembly stand.
    fn places(&self) -> Vec<traffic::Place> {
        let runs = self.fleet.members.iter().zip(&self.resolved).filter(|(member, _)| member.runs());
        let places = runs.filter_map(|(member, resolved)| {
            let more = resolved.as_ref()?.more.as_deref();
            let renamed = more.map_or_else(Vec::new, |more| more.renamed.clone());
            let queue = more.and_then(|more| more.queue);
            Some(traffic::Place { name: member.component.name.location, renamed, queue })
        });
        places.collect()
    }

    /// The assembly; `None` when something is taken as given.
    fn assemble(self, library: impl Fn(&Component) -> Option<String>) -> Option<Assembly> {
        let Self { fleet, classes, resolved, wiring } = self;
        // Components that composites implement are not there in a run: the others close ranks.
        let mut count = 0;
        let places = fleet.members.iter().map(|member| {
            count += usize::from(member.runs());
            count.saturating_sub(1)
        });
        let places: Vec<usize> = places.collect();
        let mut components = Vec::with_capacity(count);
        for (place, resolved) in resolved.into_iter().enumerate() {
            if !fleet.members[place].runs() {
                continue;
            }
            let class = fleet.class_of(place, classes)?;
            let Resolved { values, task, loops, .. } = *resolved?;
            let references = class.references.iter().zip(wiring.of(place));
            let references = references.map(|(declared, providers)| Wire {
                reference: declared.name.clone(),
                interface: declared.interface.name.clone(),
                targets: providers
                    .iter()
                    .filter_map(|provider| {
                        let class = fleet.class_of(provider.member, classes)?;
                        let service = class.services[provider.service].name.clone();
                        Some(Target { component: places[provider.member], service })
                    })
                    .collect(),
            });
            let member = &fleet.members[place];
            let class = Arc::clone(class.class);
            components.push(ComponentSpec {
                path: member.path().to_owned(),
                class,
                library: library(member.component),
                values,
                task: task.map(Settled::into_settings),
                references: references.collect(),
                loops: loops.specs,
            });
        }
        Some(Assembly { components })
    }
}
