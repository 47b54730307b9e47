//! From composites to the components that they come to: what is included stands where it is included, and a component that a
//! composite implements has the components of it inside.

pub(crate) mod append_list;
pub(crate) mod conditions;
pub(crate) mod expression_scope;
pub(crate) mod remove_absent;
pub(crate) mod replica;
pub(crate) mod replica_expansion;
pub(crate) mod replica_plan;

use std::collections::{BTreeMap, HashMap, HashSet};

use crate::check::fleet::composite_names;
use crate::check::fleet::unique_names;
use crate::check::fleet::{Fleet, Kind, Member, Scope, Unit};
use crate::check::options::Options;
use crate::check::report::Report;
use crate::check::report::severities::Severities;
use crate::check::unfolding::append_list::{AppendList, Appender};
use crate::check::unfolding::conditions::{Presence, UnitProperties};
use crate::check::unfolding::replica::{Instance, Replica};
use crate::check::unfolding::replica_plan::{MOST_REPLICAS, Plan};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{ComponentElement, Composite, Contribution, Include, Link, Naming};
use crate::source::Location;
use crate::syntax::Element;

/// Components that inner composites may come to: a few lines of text can name a composite of composites of composites.
pub(crate) const MOST_MEMBERS: usize = 1_000_000;
/// Composites of one circle that are named.
const SHOWN: usize = 8;
/// Composites inside each other.
const MOST_DEEP: usize = 250;

/// Collects the components and checks that names are unique.
pub(crate) fn unfold<'a>(
    contribution: &'a Contribution,
    options: &'a Options,
    severities: &Severities,
    replicas: &'a AppendList<Replica>,
    report: &mut Report<'_>,
) -> Fleet<'a> {
    let asked_for = contribution.asked_for();
    let count = asked_for.iter().map(|composite| composite.components.len()).sum();
    let fleet = Fleet {
        contribution,
        scopes: vec![Scope { members: Vec::with_capacity(count), ..Scope::default() }],
        units: Vec::with_capacity(asked_for.len()),
        members: Vec::with_capacity(count),
        classes: Vec::new(),
        groups: BTreeMap::new(),
        absent: HashMap::default(),
        absent_wires: HashSet::new(),
        conditional: HashMap::new(),
        is_misread: severities.is_misread(report.diagnostics()),
        names: Vec::new(),
    };
    let mut unfolding = Unfolding {
        fleet,
        open: Vec::new(),
        is_full: false,
        options,
        lowers_attributes: severities.mentions(&codes::UNKNOWN_ATTRIBUTE),
        sizes: HashMap::new(),
        loose: HashSet::new(),
        replicas: replicas.end(),
        replicas_left: MOST_REPLICAS,
        known: Vec::new(),
    };
    let again = unique_names::composites(asked_for, report);
    let included = included(contribution);
    for (place, composite) in asked_for.iter().enumerate() {
        // It stands where it is included.
        if !included[place] && !again.contains(&place) {
            let unit = unfolding.unit(0);
            unfolding.open(place, composite, unit, None, report);
            unfolding.walk(report);
        }
    }
    let fleet = unfolding.fleet;
    unique_names::paths(&fleet, report);
    fleet
}

/// Which of the composites that were asked for another one of them includes, directly or not.
fn included(contribution: &Contribution) -> Vec<bool> {
    let all = contribution.composites();
    let asked_for = contribution.asked_for().len();
    // Of each the first two that lead to it: where one of them is another one than it, it is included.
    let mut starts: Vec<[Option<usize>; 2]> = vec![[None; 2]; all.len()];
    let mut waiting: Vec<(usize, usize)> = (0..asked_for).map(|start| (start, start)).collect();
    while let Some((place, start)) = waiting.pop() {
        let known = &mut starts[place];
        let Some(free) = known.iter_mut().find(|one| one.is_none_or(|one| one == start)) else { continue };
        if free.replace(start).is_some() {
            continue;
        }
        for include in &all[place].includes {
            if let Some(&Link::To(inner)) = contribution.link(include.origin) {
                waiting.push((inner, start));
            }
        }
    }
    let is_other = |place: usize| move |start: &usize| *start != place;
    let included = starts.iter().enumerate();
    let included = included.map(|(place, starts)| starts.iter().flatten().any(is_other(place)));
    let mut included: Vec<bool> = included.collect();
    // A circle of includes has to start somewhere.
    if !included.is_empty() && included.iter().take(contribution.asked_for().len()).all(|one| *one) {
        included[0] = false;
    }
    included
}

pub(crate) struct Unfolding<'a> {
    pub(crate) fleet: Fleet<'a>,
    /// From the outermost composite to the one at hand.
    pub(crate) open: Vec<Open<'a>>,
    /// True if there are too many components; reported.
    pub(crate) is_full: bool,
    pub(crate) options: &'a Options,
    /// True if errors about unknown attributes may be let pass.
    pub(crate) lowers_attributes: bool,
    /// The number of components the composites come to that were asked about.
    sizes: HashMap<usize, usize>,
    /// The names that were told to mean something else than what they lead to.
    loose: HashSet<Location>,
    pub(crate) replicas: Appender<'a, Replica>,
    pub(crate) replicas_left: u64,
    /// The properties of units that have expressions.
    pub(crate) known: Vec<Option<UnitProperties<'a>>>,
}

/// The number of components a composite comes to, known before they are made.
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

/// True if two elements say the same in the same words, however they are laid out.
fn is_same(one: Element<'_>, other: Element<'_>) -> bool {
    let says = |element: Element<'_>| {
        let attributes: Vec<_> = element
            .written_attributes()
            .map(|one| (one.name().to_owned(), one.value().into_owned()))
            .collect();
        let text = element.trimmed_text().map(|text| text.value);
        (element.name().to_owned(), attributes, text, element.children().count())
    };
    let (mut mine, mut others) = (one.descendants(), other.descendants());
    loop {
        match (mine.next(), others.next()) {
            (None, None) => return true,
            (Some(one), Some(other)) if says(one) == says(other) => {}
            _ => return false,
        }
    }
}

/// A composite whose components are being collected.
pub(crate) struct Open<'a> {
    place: usize,
    pub(crate) composite: &'a Composite,
    pub(crate) unit: usize,
    /// The `autowire` of the composite, or else of those around it.
    autowire: bool,
    /// The element that names it.
    by: Option<Naming<'a>>,
    next_component: usize,
    next_include: usize,
    /// Replicas of the last component that are still to be made.
    pub(crate) plan: Option<Plan<'a>>,
    /// True if a condition keeps it away.
    is_absent: bool,
}

enum Next<'a> {
    Component(&'a ComponentElement),
    Include(&'a Include),
}

impl<'a> Open<'a> {
    /// The next element of the composite.
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
        self.fleet.units.push(Unit { scope, composites: Vec::with_capacity(1), is_absent: false });
        let unit = self.fleet.units.len() - 1;
        self.fleet.scopes[scope].units.push(unit);
        unit
    }

    fn open(
        &mut self,
        place: usize,
        composite: &'a Composite,
        unit: usize,
        by: Option<Naming<'a>>,
        report: &mut Report<'_>,
    ) {
        // An included composite without a word of its own does as the one around it.
        let around = self.open.last().filter(|around| around.unit == unit);
        let around = around.is_some_and(|around| around.autowire);
        let autowire = composite.autowire.map_or(around, |autowire| autowire.value);
        let is_absent = self.fleet.units[unit].is_absent;
        self.fleet.units[unit].composites.push(composite);
        self.open.push(Open {
            place,
            composite,
            unit,
            autowire,
            by,
            next_component: 0,
            next_include: 0,
            plan: None,
            is_absent,
        });
        self.wires(composite, unit, report);
    }

    fn walk(&mut self, report: &mut Report<'_>) {
        while let Some(last) = self.open.len().checked_sub(1) {
            if let Some(mut plan) = self.open[last].plan.take() {
                if let Some(index) = plan.next()
                    && self.replica(&plan, index, report)
                {
                    self.open[last].plan = Some(plan);
                }
                continue;
            }
            match self.open[last].next() {
                None => _ = self.open.pop(),
                Some(Next::Include(include)) => self.include(include, report),
                Some(Next::Component(component)) => self.component(component, report),
            }
        }
    }

    fn include(&mut self, include: &'a Include, report: &mut Report<'_>) {
        let Some(open) = self.open.last() else { return };
        let Some(naming) = Naming::of_include(include) else {
            // It names nothing, which is reported.
            return self.miss(open.unit, "*".to_owned());
        };
        let (unit, around) = (open.unit, open.composite);
        let Some((place, composite)) = self.find(naming, report) else {
            // Names that lead nowhere may be those of its components.
            return self.miss(unit, "*".to_owned());
        };
        if self.is_circle(place, naming, report) {
            return;
        }
        if !self.is_there(include.condition.as_ref(), include.origin, unit, report) {
            // Its components see what they would see, and nobody sees them.
            let unit = self.absent_unit(unit);
            return self.open(place, composite, unit, Some(naming), report);
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
        self.open(place, composite, unit, Some(naming), report);
    }

    /// Adds a component as it is `written`, and what is inside it.
    pub(crate) fn member(
        &mut self,
        written: &'a ComponentElement,
        component: &'a ComponentElement,
        instance: Option<&'a Instance>,
        presence: Presence,
        report: &mut Report<'_>,
    ) {
        let Some(open) = self.open.last() else { return };
        let (composite, unit, autowire) = (open.composite, open.unit, open.autowire);
        let is_seen = presence != Presence::Absent && !open.is_absent;
        let scope = self.fleet.units[unit].scope;
        let index = self.fleet.members.len();
        let mut member = Member::new(composite, unit, scope, component);
        let owner = self.fleet.scopes[scope].owner;
        member.autowire = autowire;
        member.instance = instance;
        member.is_absent = !is_seen;
        member.is_partial = presence == Presence::Unknown
            || instance.is_some_and(|instance| instance.partial.is_some())
            || owner.is_some_and(|owner| self.fleet.members[owner].is_partial);
        let is_partial = member.is_partial;
        member.is_copy = instance.is_some() || owner.is_some_and(|owner| self.fleet.members[owner].is_copy);
        let own = component.path().unwrap_or(&component.name);
        match owner {
            Some(owner) => member.set_path(format!("{}/{own}", self.fleet.members[owner].path())),
            None if component.path().is_some() => member.set_path(own.to_string()),
            None => {}
        }
        self.fleet.members.push(member);
        let name = component.name.as_str();
        if is_seen {
            self.fleet.scopes[scope].members.push(index);
        }
        let by_name = &mut self.fleet.scopes[scope].by_name;
        let first = by_name.get(name).copied();
        if first.is_none() && is_seen && !name.is_empty() {
            by_name.insert(component.name.value.clone(), index);
        }
        match first {
            _ if name.is_empty() => {}
            None if is_seen => {}
            Some(_) if is_seen && is_partial => {}
            Some(first) if is_seen && self.fleet.members[first].is_partial => {
                self.fleet.scopes[scope].by_name.insert(component.name.value.clone(), index);
            }
            Some(first) if is_seen => {
                self.fleet.members[index].is_repeated = true;
                report.about(&self.fleet.members[index]);
                self.repeated(component, first, report);
                report.about_all();
            }
            _ => {
                let condition = written.condition().map_or(component.name.location, |text| text.location);
                self.fleet.absent.insert((scope, name), condition);
            }
        }
        if let Some(naming) = Naming::of_component(component) {
            self.inner(index, naming, !is_seen, report);
        }
    }

    fn repeated(&self, component: &ComponentElement, first: usize, report: &mut Report<'_>) {
        let first = &self.fleet.members[first];
        let message = format!("there are two components {}", quoted(&component.name));
        let mut one = Diagnostic::new(&codes::COMPONENT_REPEATED, component.name.location, message)
            .label(first.component.name.location, "the first");
        let by = self.open.last().and_then(|open| open.by.filter(|_| self.open.len() > 1));
        if let Some(by) = by.filter(|_| first.composite.file() != component.origin.file()) {
            one = one.label(by.name.location, "included here");
        }
        let here = self.open.last().map(|open| component.origin.element(&open.composite.document));
        let there = first.component.origin.element(&first.composite.document);
        report.push(match here {
            Some(here) if !first.is_copy && is_same(here, there) => {
                let at = here.span().in_file(component.origin.file());
                one.suggest("remove the second: both are the same, word for word", at, "")
            }
            _ => one.help("give each its own name"),
        });
    }

    /// Opens the composite that implements a component.
    fn inner(&mut self, member: usize, naming: Naming<'a>, is_absent: bool, report: &mut Report<'_>) {
        let Some((place, composite)) = self.find(naming, report) else {
            let is_given = self.options.assume_classes
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
        self.fleet.units[unit].is_absent = is_absent;
        self.open(place, composite, unit, Some(naming), report);
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
    fn find(&mut self, naming: Naming<'a>, report: &mut Report<'_>) -> Option<(usize, &'a Composite)> {
        let contribution = self.fleet.contribution;
        let link = contribution.link(naming.origin)?;
        let around = self.open.last()?.composite;
        match link {
            Link::To(place) => {
                let composite = &contribution.composites()[*place];
                if !composite_names::is_exact(naming, around, composite)
                    && self.loose.insert(naming.name.location)
                {
                    report.push(composite_names::loose(naming, around, composite));
                }
                Some((*place, composite))
            }
            Link::Faulty => None,
            Link::Missing(missing) => {
                report.push(composite_names::not_found(naming, missing, around, self.options.assume_classes));
                None
            }
        }
    }

    fn is_circle(&self, place: usize, naming: Naming<'a>, report: &mut Report<'_>) -> bool {
        let Some(start) = self.open.iter().position(|open| open.place == place) else { return false };
        let circle = &self.open[start..];
        let mut names: Vec<String> =
            circle.iter().take(SHOWN).map(|open| quoted(&open.composite.name)).collect();
        if circle.len() > SHOWN {
            names.push(format!("{} more", circle.len() - SHOWN));
        }
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
