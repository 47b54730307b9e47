//! What rules of crates of components find in the fleet as a whole.

use std::collections::HashSet;
use std::rc::Rc;

use saoms_api::rule::{ClassView, ComponentView, FleetView};

use super::Resolved;
use super::classes::ClassIndex;
use super::findings::{Subject, diagnostic};
use super::fleet::Fleet;
use super::report::Report;
use super::task::Settled;
use super::wires::Wiring;
use crate::assembly::LoopSpec;
use crate::diagnostic::{Diagnostic, Severity, codes};
use crate::registry::{Class, Rule};

/// No place among those that rules look at.
const NONE: u32 = u32::MAX;

/// The declaration of a class and of those that it extends.
fn declarations<'c>(class: &'c ClassIndex<'_>) -> Vec<&'c str> {
    std::iter::once(class.class.declaration_json()).chain(class.class.extended_json()).collect()
}

/// Asks the rules about the components that are resolved; where some are not, only the rules that can judge a part of a fleet. With the wiring it
/// is said whether faults leave some of it open.
pub(super) fn check<'s>(
    fleet: &'s Fleet<'_>,
    classes: &'s [ClassIndex<'_>],
    resolved: &'s [Option<Box<Resolved<'_>>>],
    (wiring, has_open_wires): (&Wiring, bool),
    rules: impl Iterator<Item = &'s Rule>,
    report: &mut Report<'_>,
) {
    // Fleets are limited to fewer components than a `u32` counts.
    let mut parts: Vec<u32> = Vec::with_capacity(fleet.members.len());
    let mut indices: Vec<u32> = Vec::with_capacity(fleet.members.len());
    // One of each class is enough, and one for all of which nobody knows the class.
    let mut missing: Vec<Option<Vec<&'s str>>> = Vec::new();
    let mut known: HashSet<Option<*const ClassIndex<'_>>> = HashSet::new();
    let mut missed: Option<Option<*const ClassIndex<'_>>> = None;
    let mut miss = |missing: &mut Vec<_>, class: Option<&'s ClassIndex<'_>>| {
        let key = class.map(std::ptr::from_ref);
        if missed.replace(key) != Some(key) && known.insert(key) {
            missing.push(class.map(declarations));
        }
    };
    if fleet.scopes.iter().any(|scope| scope.is_faulty) {
        miss(&mut missing, None);
    }
    for (place, (member, resolved)) in fleet.members.iter().zip(resolved).enumerate() {
        let class = fleet.class_of(place, classes);
        // Of two components of one name nobody can say which is meant.
        if member.runs() && !member.is_repeated && resolved.is_some() && class.is_some() {
            indices.push(parts.len() as u32);
            parts.push(place as u32);
            continue;
        }
        indices.push(NONE);
        if member.runs() {
            miss(&mut missing, class);
        }
    }
    let part = |place: &u32| {
        let place = *place as usize;
        Some((place, resolved[place].as_deref()?, fleet.class_of(place, classes)?))
    };
    let subject = |index: usize| {
        let (place, resolved, _) = part(parts.get(index)?)?;
        let member = &fleet.members[place];
        Some(Subject { name: member.path(), ..resolved.subject(member) })
    };
    let Some(first) = subject(0) else { return };
    let is_whole = missing.is_empty();
    let all = || parts.iter().filter_map(part);
    if has_open_wires {
        let open = all().filter(|(place, ..)| wiring.of(*place).any(<[_]>::is_empty));
        open.for_each(|(.., class)| miss(&mut missing, Some(class)));
    }
    let mut before = Before::default();
    let mut wires: Vec<(&str, usize)> = Vec::with_capacity(wiring.count());
    let mut ends = Vec::with_capacity(parts.len());
    for (place, _, class) in all() {
        for (reference, providers) in class.references.iter().zip(wiring.of(place)) {
            let known =
                providers.iter().map(|provider| indices[provider.member]).filter(|index| *index != NONE);
            wires.extend(known.map(|index| (reference.name.as_str(), index as usize)));
        }
        ends.push(wires.len());
    }
    let mut start = 0;
    let mut views: Vec<ComponentView<'_>> = Vec::with_capacity(parts.len());
    views.extend(all().zip(ends).map(|((place, resolved, class), end)| ComponentView {
        path: fleet.members[place].path(),
        class: before.of(class, resolved),
        values: &resolved.values,
        period: resolved.task.as_ref().map(Settled::period),
        has_broker: resolved.task.as_ref().is_some_and(Settled::has_broker),
        wires: &wires[std::mem::replace(&mut start, end)..end],
    }));
    let view = FleetView::new(&views).without(&missing);
    for rule in rules.filter(|rule| rule.judges_parts() || is_whole) {
        let findings = match rule.check(&view) {
            Ok(findings) => findings,
            Err(failure) => {
                let message = format!("the rule {} failed: {failure}", rule.code().name);
                let one = Diagnostic::new(rule.code(), first.at, message).severity(Severity::Warning);
                report.push(one.help("this is a fault of the rule, not of the fleet"));
                continue;
            }
        };
        for finding in &findings {
            let severity = finding.own_severity().unwrap_or(rule.code().severity);
            let own = finding.place().component_index().and_then(subject).unwrap_or(first);
            match finding.place().component_index().and_then(|index| parts.get(index)) {
                Some(place) => report.about(&fleet.members[*place as usize]),
                None => report.about_all(),
            }
            let Some(one) = diagnostic(rule.code(), severity, finding, own, &subject, report) else {
                continue;
            };
            // What comes of a value that two components share is not told beside that, unless somebody lets that pass.
            let is_echo = report.has_told(&codes::NOT_UNIQUE, one.location);
            if !is_echo || report.tells_echoes {
                report.push(one);
            }
        }
    }
}

/// The class of the component before, with its loops: most components have those of the one before.
#[derive(Default)]
struct Before<'s>(Option<(&'s Class, &'s [LoopSpec], Rc<ClassView<'s>>)>);

impl<'s> Before<'s> {
    /// The class of a component.
    fn of(&mut self, class: &ClassIndex<'s>, resolved: &'s Resolved<'_>) -> Rc<ClassView<'s>> {
        let (class, loops): (&'s Class, &'s [LoopSpec]) = (class.class, &resolved.loops.specs);
        if let Some((of, with, view)) = &self.0
            && std::ptr::eq(*of, class)
            && std::ptr::eq(*with, loops)
        {
            return Rc::clone(view);
        }
        let of_loops = loops.iter().flat_map(|one| &one.class.declaration().publishes);
        let published = class.declaration().publishes.iter().chain(of_loops);
        let view = Rc::new(ClassView {
            name: &class.declaration().name,
            declaration: class.declaration_json(),
            extends: class.extended_json().collect(),
            publishes: published.map(|topic| topic.name.as_str()).collect(),
            loops: loops.iter().map(|one| one.class.name()).collect(),
        });
        self.0 = Some((class, loops, Rc::clone(&view)));
        view
    }
}
