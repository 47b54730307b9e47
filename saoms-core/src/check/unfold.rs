//! From composites to the components that they come to: what is included stands where it is included, and a component that a
//! composite implements has the components of it inside.

use std::collections::HashMap;

use super::fleet::{Fleet, Kind, Member, Scope, Unit};
use super::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Component, Composite, Contribution, Include, Link, Missing, Naming};
use crate::source::Location;

/// Components that inner composites may come to: a few lines of text can name a composite of composites of composites.
const MOST_MEMBERS: usize = 1_000_000;
/// Composites inside each other.
const MOST_DEEP: usize = 250;

/// Collects the components and checks that names are unique.
pub(super) fn unfold<'a>(
    contribution: &'a Contribution,
    assume_classes: bool,
    report: &mut Report<'_>,
) -> Fleet<'a> {
    let asked_for = contribution.asked_for();
    let count = asked_for.iter().map(|composite| composite.components.len()).sum();
    let fleet = Fleet {
        contribution,
        scopes: vec![Scope { members: Vec::with_capacity(count), ..Scope::default() }],
        units: Vec::with_capacity(asked_for.len()),
        members: Vec::with_capacity(count),
        by_name: HashMap::with_capacity(count),
    };
    let mut unfolding =
        Unfolding { fleet, open: Vec::new(), is_full: false, assume_classes, sizes: HashMap::new() };
    repeated_composites(asked_for, report);
    let included = included(contribution);
    for (place, composite) in asked_for.iter().enumerate() {
        // It stands where it is included.
        if !included[place] {
            let unit = unfolding.unit(0);
            unfolding.open(place, composite, unit, None);
            unfolding.walk(report);
        }
    }
    let fleet = unfolding.fleet;
    paths(&fleet, report);
    fleet
}

/// Checks that no two components have one path. Where nobody gives one, names alone see to that.
fn paths(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    if fleet.members.iter().all(|member| member.component.path.is_none()) {
        return;
    }
    let mut first: HashMap<&str, Location> = HashMap::with_capacity(fleet.members.len());
    for member in fleet.members.iter().filter(|member| !member.component.name.is_empty()) {
        let given = member.component.path.as_deref();
        let place = given.unwrap_or(&member.component.name).location;
        let earlier = first.entry(member.path()).or_insert(place);
        if *earlier != place && given.is_some() {
            let message = format!("there are two components of the path {}", quoted(member.path()));
            let one = Diagnostic::new(&codes::COMPONENT_REPEATED, place, message);
            report.push(one.label(*earlier, "the first").help("give each its own path, or none"));
        }
    }
}

fn repeated_composites(composites: &[Composite], report: &mut Report<'_>) {
    let mut names: HashMap<(&str, &str), &Composite> = HashMap::new();
    for composite in composites.iter().filter(|composite| !composite.name.is_empty()) {
        let name = (composite.namespace(), composite.name.as_str());
        let Some(first) = names.get(&name) else {
            names.insert(name, composite);
            continue;
        };
        let message = format!("there are two composites {} in one namespace", quoted(name.1));
        report.push(
            Diagnostic::new(&codes::COMPOSITE_REPEATED, composite.name.location, message)
                .label(first.name.location, "the first")
                .help("give each its own name; was one file given twice?"),
        );
    }
}

/// Which of the composites that were asked for another one of them includes, directly or not.
fn included(contribution: &Contribution) -> Vec<bool> {
    let all = contribution.composites();
    let mut included = vec![false; all.len()];
    for start in 0..contribution.asked_for().len() {
        let mut seen = vec![false; all.len()];
        let mut waiting = vec![start];
        while let Some(place) = waiting.pop() {
            for include in &all[place].includes {
                if let Some(&Link::To(inner)) = contribution.link(include.origin)
                    && !std::mem::replace(&mut seen[inner], true)
                {
                    included[inner] |= inner != start;
                    waiting.push(inner);
                }
            }
        }
    }
    // A circle of includes has to start somewhere.
    if !included.is_empty() && included.iter().take(contribution.asked_for().len()).all(|one| *one) {
        included[0] = false;
    }
    included
}

struct Unfolding<'a> {
    fleet: Fleet<'a>,
    /// From the outermost composite to the one at hand.
    open: Vec<Open<'a>>,
    /// Whether there are too many components; reported.
    is_full: bool,
    assume_classes: bool,
    /// How many components the composites come to that were asked about.
    sizes: HashMap<usize, usize>,
}

/// How many components a composite comes to, known before they are made.
fn size(contribution: &Contribution, place: usize, deep: usize, known: &mut HashMap<usize, usize>) -> usize {
    if let Some(size) = known.get(&place) {
        return *size;
    }
    // What is in a circle, or too deep, is reported otherwise.
    known.insert(place, 0);
    let composite = &contribution.composites()[place];
    let mut size = composite.components.len();
    for naming in composite.namings() {
        if let Some(Link::To(inner)) = contribution.link(naming.origin)
            && deep <= MOST_DEEP
        {
            size = size.saturating_add(self::size(contribution, *inner, deep + 1, known));
        }
    }
    known.insert(place, size);
    size
}

/// A composite whose components are being collected.
struct Open<'a> {
    place: usize,
    composite: &'a Composite,
    unit: usize,
    /// What the composites around it say of autowire, its own word before theirs.
    autowire: bool,
    /// What names it.
    by: Option<Naming<'a>>,
    next_component: usize,
    next_include: usize,
}

enum Next<'a> {
    Component(&'a Component),
    Include(&'a Include),
}

impl<'a> Open<'a> {
    /// What stands next in the composite.
    fn next(&mut self) -> Option<Next<'a>> {
        let component = self.composite.components.get(self.next_component);
        let include = self.composite.includes.get(self.next_include);
        match (component, include) {
            (Some(component), Some(include)) if include.origin.element < component.origin.element => {
                self.next_include += 1;
                Some(Next::Include(include))
            }
            (Some(component), _) => {
                self.next_component += 1;
                Some(Next::Component(component))
            }
            (None, Some(include)) => {
                self.next_include += 1;
                Some(Next::Include(include))
            }
            (None, None) => None,
        }
    }
}

impl<'a> Unfolding<'a> {
    fn unit(&mut self, scope: usize) -> usize {
        self.fleet.units.push(Unit { scope, composites: Vec::with_capacity(1) });
        let unit = self.fleet.units.len() - 1;
        self.fleet.scopes[scope].units.push(unit);
        unit
    }

    fn open(&mut self, place: usize, composite: &'a Composite, unit: usize, by: Option<Naming<'a>>) {
        // An included composite without a word of its own does as the one around it.
        let around = self.open.last().filter(|around| around.unit == unit);
        let around = around.is_some_and(|around| around.autowire);
        let autowire = composite.autowire.map_or(around, |autowire| autowire.value);
        self.fleet.units[unit].composites.push(composite);
        self.open.push(Open { place, composite, unit, autowire, by, next_component: 0, next_include: 0 });
    }

    fn walk(&mut self, report: &mut Report<'_>) {
        while let Some(open) = self.open.last_mut() {
            match open.next() {
                None => _ = self.open.pop(),
                Some(Next::Include(include)) => self.include(include, report),
                Some(Next::Component(component)) => self.component(component, report),
            }
        }
    }

    fn include(&mut self, include: &'a Include, report: &mut Report<'_>) {
        let Some(naming) = Naming::of_include(include) else { return };
        let Some(open) = self.open.last() else { return };
        let (unit, around) = (open.unit, open.composite);
        let Some((place, composite)) = self.find(naming, report) else { return };
        if self.is_circle(place, naming, report) {
            return;
        }
        let is_again = self.fleet.units[unit].composites.iter().any(|known| std::ptr::eq(*known, composite));
        if is_again {
            let message = format!("the composite {} is included twice", quoted(&composite.name));
            let one = Diagnostic::new(&codes::INCLUDED_TWICE, naming.name.location, message);
            return report
                .push(one.help("remove one of the includes: all of its components are there already"));
        }
        if composite.local.is_some_and(|local| local.value) && around.local.is_none_or(|local| !local.value) {
            let message = format!(
                "the composite {} is `local`, and the one that includes it is not",
                quoted(&composite.name)
            );
            let one = Diagnostic::new(&codes::INCLUDE_LOCAL, naming.name.location, message)
                .help("give both composites the same `local`");
            report.push(match composite.local {
                Some(local) => one.label(local.location, "said here"),
                None => one,
            });
        }
        self.open(place, composite, unit, Some(naming));
    }

    fn component(&mut self, component: &'a Component, report: &mut Report<'_>) {
        let Some(open) = self.open.last() else { return };
        let (composite, unit, autowire) = (open.composite, open.unit, open.autowire);
        let scope = self.fleet.units[unit].scope;
        let index = self.fleet.members.len();
        let mut member = Member::new(composite, unit, scope, component);
        member.autowire = autowire;
        let own = component.path.as_deref().unwrap_or(&component.name);
        match self.fleet.scopes[scope].owner {
            Some(owner) => member.set_path(format!("{}/{own}", self.fleet.members[owner].path())),
            None if component.path.is_some() => member.set_path(own.to_string()),
            None => {}
        }
        self.fleet.members.push(member);
        self.fleet.scopes[scope].members.push(index);
        let name = component.name.as_str();
        if !name.is_empty() {
            match self.fleet.by_name.get(&(scope, name)) {
                None => _ = self.fleet.by_name.insert((scope, name), index),
                Some(&first) => self.repeated(component, first, report),
            }
        }
        if let Some(naming) = Naming::of_component(component) {
            self.inner(index, naming, report);
        }
    }

    fn repeated(&self, component: &Component, first: usize, report: &mut Report<'_>) {
        let first = &self.fleet.members[first];
        let message = format!("there are two components {}", quoted(&component.name));
        let mut one = Diagnostic::new(&codes::COMPONENT_REPEATED, component.name.location, message)
            .label(first.component.name.location, "the first");
        let by = self.open.last().and_then(|open| open.by.filter(|_| self.open.len() > 1));
        if let Some(by) = by.filter(|_| first.composite.file() != component.origin.file()) {
            one = one.label(by.name.location, "included here");
        }
        report.push(one.help("give each its own name"));
    }

    /// Opens the composite that implements a component.
    fn inner(&mut self, member: usize, naming: Naming<'a>, report: &mut Report<'_>) {
        let Some((place, composite)) = self.find(naming, report) else {
            let is_given = self.assume_classes
                && !matches!(self.fleet.contribution.link(naming.origin), Some(Link::Faulty));
            if is_given {
                self.fleet.members[member].kind = Kind::Given;
            }
            return;
        };
        if self.is_circle(place, naming, report) || self.is_full(place, naming, report) {
            return;
        }
        let scope = self.fleet.scopes.len();
        self.fleet.scopes.push(Scope { owner: Some(member), ..Scope::default() });
        self.fleet.members[member].kind = Kind::Composite(scope);
        let unit = self.unit(scope);
        self.open(place, composite, unit, Some(naming));
    }

    fn is_full(&mut self, place: usize, naming: Naming<'a>, report: &mut Report<'_>) -> bool {
        let is_too_deep = self.open.len() > MOST_DEEP;
        let more = size(self.fleet.contribution, place, self.open.len(), &mut self.sizes);
        if !is_too_deep && self.fleet.members.len().saturating_add(more) <= MOST_MEMBERS {
            return false;
        }
        if !std::mem::replace(&mut self.is_full, true) {
            let message = match is_too_deep {
                true => format!("composites are inside each other more than {MOST_DEEP} deep"),
                false => format!("inner composites come to more than {MOST_MEMBERS} components"),
            };
            let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, naming.name.location, message);
            report.push(one.help("a composite inside a composite multiplies: is this what is meant?"));
        }
        true
    }

    /// The composite that a name leads to. A name that leads nowhere is reported.
    fn find(&self, naming: Naming<'a>, report: &mut Report<'_>) -> Option<(usize, &'a Composite)> {
        let contribution = self.fleet.contribution;
        match contribution.link(naming.origin)? {
            Link::To(place) => Some((*place, &contribution.composites()[*place])),
            Link::Faulty => None,
            Link::Missing(missing) => {
                let composite = self.open.last()?.composite;
                report.push(not_found(naming, missing, composite, self.assume_classes));
                None
            }
        }
    }

    fn is_circle(&self, place: usize, naming: Naming<'a>, report: &mut Report<'_>) -> bool {
        let Some(start) = self.open.iter().position(|open| open.place == place) else { return false };
        let names = self.open[start..].iter().map(|open| quoted(&open.composite.name));
        let mut names: Vec<String> = names.collect();
        names.push(names[0].clone());
        let message = format!("composites hold each other in a circle: {}", names.join(" -> "));
        let mut one = Diagnostic::new(&codes::COMPOSITE_CIRCLE, naming.name.location, message)
            .help("a composite cannot be a part of itself: remove one of these");
        for by in self.open[start + 1..].iter().filter_map(|open| open.by).take(8) {
            one = one.label(by.name.location, "through this");
        }
        report.push(one);
        true
    }
}

fn not_found(
    naming: Naming<'_>,
    missing: &Missing,
    composite: &Composite,
    assume_classes: bool,
) -> Diagnostic {
    let name = naming.name;
    let (namespaces, local) = composite.resolve_name(naming);
    let of = match &namespaces {
        None => String::new(),
        Some(all) => match all.first().map_or("", |namespace| namespace.as_str()) {
            "" => " in no namespace".to_owned(),
            namespace => format!(" in the namespace {}", quoted(namespace)),
        },
    };
    let is_include = naming.origin.element(&composite.document).local_name() == "include";
    let code = if is_include { &codes::INCLUDE_NOT_FOUND } else { &codes::COMPOSITE_NOT_FOUND };
    let message = format!("there is no composite {}{of}", quoted(local));
    let mut one = Diagnostic::new(code, name.location, message);
    // What is spelt alike is meant; anything else may come from another contribution.
    if assume_classes && missing.near.is_empty() {
        one = one.severity(Severity::Warning);
    }
    if namespaces.is_none() {
        let prefix = name.split(':').next().unwrap_or_default();
        one = one.help(format!("the prefix {} is bound to no namespace", quoted(prefix)));
    }
    for near in &missing.near {
        let replacement = super::report::escaped(near);
        one = one.suggest(super::report::replacing(name, near), name.location, replacement);
    }
    for searched in &missing.searched {
        one = one.help(searched.clone());
    }
    if missing.searched.is_empty() {
        one = one.help("name the file of the composite beside this one");
    }
    one
}
