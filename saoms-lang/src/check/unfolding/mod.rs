//! From composites to the components that they come to: what is included stands where it is included, and a component
//! that a composite implements has the components of it inside.

pub(crate) mod append_list;
pub(crate) mod conditions;
mod inner;
pub(crate) mod members;
mod names;
pub(crate) mod remove_absent;
pub(crate) mod replica_expansion;
pub(crate) mod replica_plan;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use crate::check::fleet::{Fleet, Scope, Unit};
use crate::check::judged::Faulty;
use crate::check::options::Options;
use crate::check::parameters::Parameters;
use crate::check::report::{Report, severities::Severities};
use crate::check::unfolding::append_list::{AppendList, Appender};
use crate::check::unfolding::replica_plan::Plan;
use crate::check::values::replica::Replica;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::limits::{Budget, PATH_ELEMENTS, REPLICAS};
use crate::model::{ComponentElement, Composite, Contribution, Include, Link, Naming, SAOMS_NAMESPACE};
use crate::source::{FileId, Location};
use smol_str::SmolStr;

/// Collects the components and checks that names are unique.
pub(crate) fn unfold<'a>(
    contribution: &'a Contribution,
    options: &'a Options,
    severities: &Severities,
    replicas: &'a AppendList<Replica>,
    report: &mut Report<'_>,
) -> Fleet<'a> {
    let asked_for = contribution.asked_for();
    let elements = Rc::new(Budget::of(PATH_ELEMENTS));
    let fleet = Fleet {
        contribution,
        scopes: vec![Scope::default()],
        units: Vec::new(),
        members: Vec::new(),
        classes: Vec::new(),
        groups: BTreeMap::new(),
        absent: HashMap::default(),
        absent_wires: HashSet::new(),
        conditional: HashMap::new(),
        misread: severities.is_misread(report.diagnostics()).then_some(Faulty),
        names: Vec::new(),
        faulty_values: Rc::default(),
        elements: Rc::clone(&elements),
        registry: None,
        wanted_tables: Vec::new(),
    };
    let mut unfolding = Unfolding {
        fleet,
        open: Vec::new(),
        is_full: false,
        wrong_prefixes: HashSet::new(),
        wrong_names: HashSet::new(),
        options,
        report,
        lowers_attributes: severities.mentions(&codes::UNKNOWN_ATTRIBUTE),
        sizes: HashMap::new(),
        replicas: replicas.end(),
        replicas_left: Budget::of(REPLICAS),
        parameters: Parameters::new(options, &elements).unbounded(),
    };
    let again = names::composites(asked_for, unfolding.report);
    let used = used(contribution);
    for (place, composite) in asked_for.iter().enumerate() {
        // It stands where it is used.
        if !used[place] && !again.contains(&place) {
            let unit = unfolding.unit(0);
            unfolding.open(place, composite, unit, None);
            unfolding.walk();
        }
    }
    let fleet = unfolding.fleet;
    names::paths(&fleet, report);
    fleet
}

/// The composites that another one of those asked for includes or has inside, directly or not.
fn used(contribution: &Contribution) -> Vec<bool> {
    let all = contribution.composites();
    let asked_for = contribution.asked_for().len();
    let mut used = vec![false; all.len()];
    for start in 0..asked_for {
        let mut seen = HashSet::from([start]);
        let mut waiting = vec![start];
        while let Some(place) = waiting.pop() {
            for naming in all[place].namings() {
                if let Some(&Link::To(inner)) = contribution.link(naming.origin)
                    && seen.insert(inner)
                {
                    used[inner] = true;
                    waiting.push(inner);
                }
            }
        }
    }
    // A circle has to start somewhere.
    if asked_for > 0 && used[..asked_for].iter().all(|one| *one) {
        used[0] = false;
    }
    used
}

pub(crate) struct Unfolding<'a, 'r, 's> {
    pub(crate) fleet: Fleet<'a>,
    /// From the outermost composite to the one at hand.
    pub(crate) open: Vec<Open<'a>>,
    /// True if there are too many components; reported.
    pub(crate) is_full: bool,
    /// The declarations of prefixes for which names lead nowhere; reported.
    wrong_prefixes: HashSet<Location>,
    /// The names of composites that lead nowhere, by their files; reported.
    wrong_names: HashSet<(FileId, SmolStr)>,
    pub(crate) options: &'a Options,
    pub(crate) report: &'r mut Report<'s>,
    /// True if errors about unknown attributes may be let pass.
    pub(crate) lowers_attributes: bool,
    /// Numbers of components in composites, by the places of these, as far as they were asked for.
    sizes: HashMap<usize, usize>,
    pub(crate) replicas: Appender<'a, Replica>,
    pub(crate) replicas_left: Budget,
    /// The properties for what expressions take while composites are unfolded. Their faults are reported later, when
    /// the properties of the whole fleet are found.
    pub(crate) parameters: Parameters<'a>,
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
        if let Some(include) = include
            && component.is_none_or(|component| include.origin.element < component.origin.element)
        {
            self.next_include += 1;
            return Some(Next::Include(include));
        }
        self.next_component += 1;
        component.map(Next::Component)
    }
}

impl<'a> Unfolding<'a, '_, '_> {
    fn unit(&mut self, scope: usize) -> usize {
        self.fleet.units.push(Unit { scope, composites: Vec::new(), is_absent: false, hides_names: false });
        let unit = self.fleet.units.len() - 1;
        self.fleet.scopes[scope].units.push(unit);
        unit
    }

    fn open(&mut self, place: usize, composite: &'a Composite, unit: usize, by: Option<Naming<'a>>) {
        // An included composite without a word of its own does as the one around it.
        let around = self.open.last().filter(|around| around.unit == unit);
        let around = around.is_some_and(|around| around.autowire);
        let autowire = composite.autowire.map_or(around, |autowire| autowire.value);
        let is_absent = self.fleet.units[unit].is_absent;
        self.fleet.units[unit].composites.push(composite);
        let hidden = self.report.diagnostics().hidden_in(composite.file());
        self.fleet.units[unit].hides_names |= hidden.others;
        if hidden.components {
            self.fault(unit);
        }
        // The second name of a component may be the one that is meant.
        let twice = composite.components.iter().flat_map(|one| {
            let attributes = one.origin.element(&composite.document).written_attributes();
            attributes.filter(|one| one.name() == "name").skip(1).map(|name| name.value().to_string())
        });
        let scope = self.fleet.units[unit].scope;
        self.fleet.scopes[scope].missing.extend(twice);
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
        self.wires(composite, unit);
    }

    fn walk(&mut self) {
        while let Some(last) = self.open.len().checked_sub(1) {
            if let Some(mut plan) = self.open[last].plan.take() {
                if let Some(index) = plan.left.next()
                    && self.replica(&plan, index)
                {
                    self.open[last].plan = Some(plan);
                }
                continue;
            }
            match self.open[last].next() {
                None => _ = self.open.pop(),
                Some(Next::Include(include)) => self.include(include),
                Some(Next::Component(component)) => self.component(component),
            }
        }
    }

    fn include(&mut self, include: &'a Include) {
        let Some(open) = self.open.last() else { return };
        let Some(naming) = Naming::of_include(include) else {
            // It names nothing, which is reported.
            return self.miss(open.unit, "*".to_owned());
        };
        let (unit, around) = (open.unit, open.composite);
        let Some((place, composite)) = self.find(naming) else {
            // Names that lead nowhere may be those of its components.
            return self.miss(unit, "*".to_owned());
        };
        if self.is_circle(place, naming) {
            return;
        }
        if !self.is_there(include.condition.as_ref(), include.origin, unit) {
            // Its components see what they would see, and no other sees them.
            let unit = self.absent_unit(unit);
            return self.open(place, composite, unit, Some(naming));
        }
        let is_again = self.fleet.units[unit].composites.iter().any(|known| std::ptr::eq(*known, composite));
        // What makes no copy of it is reported.
        let element = include.origin.element(&around.document);
        if is_again
            && ["site", "node", "count"].iter().any(|name| element.attribute_in(SAOMS_NAMESPACE, name).is_some())
        {
            return;
        }
        if is_again {
            let message = format!("the composite {} is included twice", quoted(&composite.name));
            let one = Diagnostic::new(&codes::INCLUDED_TWICE, naming.name.location, message);
            return self.report.push(one.help("remove one of the includes: all of its components are there already"));
        }
        if let Some(local) = composite.local.filter(|local| local.value)
            && around.local.is_none_or(|local| !local.value)
        {
            let message =
                format!("the composite {} is `local`, and the one that includes it is not", quoted(&composite.name));
            let one = Diagnostic::new(&codes::INCLUDE_LOCAL, naming.name.location, message)
                .help("give both composites the same `local`");
            self.report.push(one.label(local.location, "`local` is set here"));
        }
        self.open(place, composite, unit, Some(naming));
    }
}
