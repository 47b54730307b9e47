//! Rules of plugins and component crates over the whole fleet.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;
use std::sync::Arc;

use saoms_api::rule::{ClassView, ComponentView, FleetView};

use crate::assembly::{self, LoopSpec, on_bus};
use crate::check::component::ComponentCheck;
use crate::check::fleet::{Fleet, Member, class_index::ClassIndex};
use crate::check::properties::findings::{Subject, diagnostic};
use crate::check::report::Report;
use crate::check::tasks::unique_values::RepeatedValues;
use crate::check::wiring::Wiring;
use crate::diagnostic::{Diagnostic, Severity};
use crate::registry::{RegisteredClass, RegisteredRule};
use crate::source::{FileId, Location};
use crate::syntax::ElementId;

/// The declaration of a class and of those that it extends.
fn declarations<'c>(class: &'c ClassIndex<'_>) -> Vec<&'c str> {
    std::iter::once(class.class.declaration_json()).chain(class.class.extended_json()).collect()
}

/// The components of a site, or of sites that are connected.
#[derive(Default)]
struct Site<'s> {
    /// Those that are resolved, in document order.
    parts: Vec<usize>,
    /// The classes of the others, and of those whose wires are not known: one of each is enough, and `None` for all
    /// whose class is not known.
    missing: HashMap<Option<*const RegisteredClass>, Option<&'s ClassIndex<'s>>>,
    /// True if there are others.
    is_part: bool,
}

impl<'s> Site<'s> {
    fn miss(&mut self, class: Option<&'s ClassIndex<'s>>, is_part: bool) {
        self.is_part |= is_part;
        self.missing.entry(class.map(|class| Arc::as_ptr(class.class))).or_insert(class);
    }
}

/// Asks the rules about the components of each site that are resolved; where some are not, or where their wires lead is
/// not known, only the rules that can judge a part of a fleet.
pub(crate) fn check<'s>(
    fleet: &'s Fleet<'_>,
    checks: &'s [ComponentCheck<'_>],
    wiring: &'s Wiring,
    repeated: &'s RepeatedValues,
    rules: impl Iterator<Item = &'s RegisteredRule>,
    report: &mut Report<'_>,
) {
    let mut sites: BTreeMap<&str, Site<'s>> = BTreeMap::new();
    let around = |scope: usize| fleet.scopes[scope].owner.map_or("", |owner| &fleet.members[owner].site);
    // What is inside a component, nobody knows, may be wired to what is around it.
    let outer = |member: &Member<'_>| (!member.component.references.is_empty()).then(|| around(member.scope));
    for (scope, unknown) in fleet.scopes.iter().enumerate().filter(|(_, one)| one.fault.is_some()) {
        let owner = unknown.owner.and_then(|owner| outer(&fleet.members[owner]));
        owner.into_iter().chain([around(scope)]).for_each(|site| sites.entry(site).or_default().miss(None, true));
    }
    for (place, (member, check)) in fleet.members.iter().zip(checks).enumerate().filter(|(_, (one, _))| one.runs()) {
        let (site, class) = (sites.entry(&member.site).or_default(), fleet.class_of(place));
        // Which of two components of one name is meant is not known.
        let is_repeated = member.repeated.is_some() || repeated.has_inside(fleet, place);
        if is_repeated || !check.is_sound() || class.is_none() {
            site.miss(class, true);
            if let Some(site) = outer(member).filter(|_| class.is_none()) {
                sites.entry(site).or_default().miss(None, true);
            }
            continue;
        }
        site.parts.push(place);
        if wiring[place].iter().any(Option::is_none) {
            site.miss(class, false);
        }
    }
    let rules: Vec<&RegisteredRule> = rules.collect();
    let mut told = Told::default();
    let sites = connected(sites, (fleet, checks, wiring));
    let is_site_of_several = sites.len() > 1;
    for Site { parts, missing, is_part } in sites {
        let missing = missing.into_values().map(|class| class.map(declarations)).collect();
        let facts = Facts { fleet, checks, wiring, repeated, missing, is_site_of_several };
        facts.check_sites(
            &parts,
            rules.iter().copied().filter(|rule| rule.judges_parts() || !is_part),
            &mut told,
            report,
        );
    }
}

/// The sites in document order, those that wires or topics connect together: robots of several sites may have one
/// world, and those of two sites hear each other on a topic outside of both. What a site says outside of it may be
/// heard in one that is not known. A site that publishes a topic to nobody is together with those that hear it from
/// nobody: a component may be in the wrong one.
fn connected<'s>(
    mut sites: BTreeMap<&str, Site<'s>>,
    (fleet, checks, wiring): (&Fleet<'_>, &[ComponentCheck<'_>], &Wiring),
) -> Vec<Site<'s>> {
    // A site that another one is connected to leads to it.
    let mut leads: HashMap<&str, &str> = sites.keys().map(|site| (*site, *site)).collect();
    let mut first: HashMap<Cow<'_, str>, &str> = HashMap::new();
    // Whether components of a site publish a topic, and whether some subscribe to it.
    let mut sides: BTreeMap<&str, BTreeMap<&str, [bool; 2]>> = BTreeMap::new();
    let unknown: Vec<&str> = sites.iter().filter(|(_, one)| one.is_part).map(|(site, _)| *site).collect();
    let all = sites.iter().filter(|_| leads.len() > 1);
    let all: Vec<(&str, usize)> = all.flat_map(|(site, one)| one.parts.iter().map(|place| (*site, *place))).collect();
    for (site, place) in all {
        for provider in wiring[place].iter().flatten().flatten() {
            join(&mut leads, site, &fleet.members[provider.member].site);
        }
        let Some(class) = fleet.class_of(place) else { continue };
        for (topics, side) in [(&class.publishes, 0), (&class.subscribes, 1)] {
            for topic in topics {
                sides.entry(topic.name.as_str()).or_default().entry(site).or_insert([false; 2])[side] = true;
            }
        }
        for (_, on_bus) in topics(&fleet.members[place], &checks[place], class) {
            let is_inside = on_bus.strip_prefix(site).is_some_and(|rest| site.is_empty() || rest.starts_with('/'));
            if !first.contains_key(&on_bus) && !is_inside {
                unknown.iter().for_each(|other| join(&mut leads, site, other));
            }
            let other = *first.entry(on_bus).or_insert(site);
            join(&mut leads, site, other);
        }
    }
    for sites in sides.values() {
        let one_side = |side| sites.iter().find(|(_, has)| **has == side).map(|(site, _)| *site);
        let (Some(publishes), Some(hears)) = (one_side([true, false]), one_side([false, true])) else { continue };
        let apart = sites.iter().filter(|(_, has)| has[0] != has[1]);
        apart.for_each(|(site, has)| join(&mut leads, site, if has[0] { hears } else { publishes }));
    }
    let mut groups: BTreeMap<&str, Site<'s>> = BTreeMap::new();
    while let Some((site, one)) = sites.pop_first() {
        let group = groups.entry(end(&mut leads, site)).or_default();
        group.parts.extend(one.parts);
        group.missing.extend(one.missing);
        group.is_part |= one.is_part;
    }
    let mut groups: Vec<Site<'s>> = groups.into_values().collect();
    groups.iter_mut().for_each(|group| group.parts.sort_unstable());
    groups.sort_unstable_by_key(|group| group.parts.first().copied());
    groups
}

/// Connects two sites.
fn join<'s>(leads: &mut HashMap<&'s str, &'s str>, site: &'s str, other: &'s str) {
    if site != other {
        let (site, other) = (end(leads, site), end(leads, other));
        leads.insert(site.max(other), site.min(other));
    }
}

/// The site to which one leads at last, with path halving. One without components that are judged leads to itself.
fn end<'s>(leads: &mut HashMap<&'s str, &'s str>, mut site: &'s str) -> &'s str {
    while let Some(next) = leads.get(site).copied().filter(|next| *next != site) {
        let after = leads.get(next).copied().unwrap_or(next);
        leads.insert(site, after);
        site = after;
    }
    site
}

/// The scope in which a code was told at a place of a component, by this and the component.
type Told = HashMap<(&'static str, Location, (FileId, ElementId)), usize>;

/// The findings of earlier phases that rules are told of.
struct Facts<'s, 'f> {
    fleet: &'s Fleet<'f>,
    checks: &'s [ComponentCheck<'f>],
    wiring: &'s Wiring,
    repeated: &'s RepeatedValues,
    /// The declarations of the classes of components that are not resolved, each once.
    missing: Vec<Option<Vec<&'s str>>>,
    is_site_of_several: bool,
}

impl<'s, 'f> Facts<'s, 'f> {
    /// Asks the rules about the components of sites that are connected.
    fn check_sites(
        &self,
        parts: &[usize],
        rules: impl Iterator<Item = &'s RegisteredRule>,
        told: &mut Told,
        report: &mut Report<'_>,
    ) {
        let Self { fleet, checks, wiring, repeated, missing, .. } = self;
        let indices: HashMap<usize, usize> = parts.iter().copied().zip(0..).collect();
        let part = |place: &usize| Some((*place, &checks[*place], fleet.class_of(*place)?));
        let subject = |index: usize| {
            let place = *parts.get(index)?;
            let member = &fleet.members[place];
            // Rules judge the values of the task, too.
            let values = checks[place].given.all();
            Some(Subject { name: member.path(), values, ..checks[place].subject(member) })
        };
        let Some(first) = subject(0) else { return };
        let all = || parts.iter().filter_map(part);
        let wires: Vec<Vec<(&str, usize)>> = all()
            .map(|(place, _, class)| {
                let ends = class.references.iter().zip(&wiring[place]);
                let known = ends.flat_map(|(reference, targets)| {
                    let known = targets.iter().flatten().filter_map(|provider| indices.get(&provider.member));
                    known.map(|index| (reference.name.as_str(), *index))
                });
                known.collect()
            })
            .collect();
        let mut classes = ClassViews::new();
        let renamed: Vec<_> = all().map(|(place, check, class)| renamed(&fleet.members[place], check, class)).collect();
        let pairs = renamed.iter().map(|all| all.iter().map(|(declared, on_bus)| (*declared, &**on_bus)).collect());
        let renamed: Vec<Vec<(&str, &str)>> = pairs.collect();
        let views =
            all().zip(wires.iter().zip(&renamed)).map(|((place, check, class), (wires, renamed))| ComponentView {
                path: fleet.members[place].path(),
                class: class_view(&mut classes, class, check),
                values: check.given.own(),
                period: check.task.as_ref().map(|task| task.period),
                starts: check.task.as_ref().is_none_or(|task| task.run_on_startup),
                restarts: check.task.as_ref().is_some_and(|task| task.restarts() > 0),
                node: &fleet.members[place].node,
                has_broker: fleet.members[place].node.is_empty()
                    && check.task.as_ref().is_some_and(|task| task.url.is_some()),
                renamed,
                wires,
            });
        let views: Vec<_> = views.collect();
        let view = FleetView::new(&views).without(missing).of_several(self.is_site_of_several);
        for rule in rules {
            let findings = rule.check(&view).unwrap_or_else(|failure| {
                let message = format!("the rule {} failed: {failure}", rule.code().name);
                let one = Diagnostic::new(rule.code(), first.at, message).severity(Severity::Warning);
                report.push(one.help("this is a fault of the rule, not of the fleet"));
                Vec::new()
            });
            for finding in &findings {
                let severity = finding.own_severity().unwrap_or(rule.code().severity);
                let own = finding.place().component_index().and_then(subject).unwrap_or(first);
                match finding.place().component_index().and_then(|index| parts.get(index)) {
                    Some(place) => report.about(&fleet.members[*place]),
                    None => report.about_all(),
                }
                let one = diagnostic(rule.code(), severity, finding, own, &subject, report);
                // A value that two components share is faulty already.
                let Some(one) = one.filter(|one| !repeated.contains(one.location)) else { continue };
                // Of several uses of a composite the first is told, if what is wrong is written in the composite.
                let place = finding.place().component_index().and_then(|index| parts.get(index));
                let element = place.map(|place| &fleet.members[*place]);
                let used = element.filter(|member| fleet.scopes[member.scope].owner.is_some() && !member.is_copy);
                if let Some(member) = used.filter(|member| one.location.file == member.component.origin.file()) {
                    let origin = (member.component.origin.file(), member.component.origin.element);
                    let first = told.entry((one.code.id, one.location, origin)).or_insert(member.scope);
                    if *first != member.scope {
                        continue;
                    }
                }
                report.push(one);
            }
        }
    }
}

/// The topics of a component that have another name on the bus, and that name.
fn renamed<'s>(
    member: &'s Member<'_>,
    check: &'s ComponentCheck<'_>,
    class: &ClassIndex<'s>,
) -> Vec<(&'s str, Cow<'s, str>)> {
    let renames = check.task.as_ref().map(|task| &task.topic_rename);
    if member.site.is_empty() && renames.is_none_or(|renames| renames.0.is_empty()) {
        return Vec::new();
    }
    let mut topics: Vec<_> = topics(member, check, class).filter(|(declared, on_bus)| declared != on_bus).collect();
    topics.sort_unstable();
    topics.dedup();
    topics
}

/// The topics of a component, and their names on the bus.
fn topics<'s>(
    member: &'s Member<'_>,
    check: &'s ComponentCheck<'_>,
    class: &ClassIndex<'s>,
) -> impl Iterator<Item = (&'s str, Cow<'s, str>)> {
    let renames = check.task.as_ref().map(|task| &task.topic_rename);
    let all = class.publishes.iter().chain(&class.subscribes).map(|topic| topic.name.as_str());
    all.map(move |name| (name, on_bus(&member.site, renames.map_or(name, |renames| renames.name(name)))))
}

/// The views of classes with their loops, each made once.
type ClassViews<'s> = HashMap<(*const RegisteredClass, *const LoopSpec), Rc<ClassView<'s>>>;

/// The view of the class of a component.
fn class_view<'s>(
    known: &mut ClassViews<'s>,
    class: &ClassIndex<'s>,
    check: &'s ComponentCheck<'_>,
) -> Rc<ClassView<'s>> {
    let class: &'s RegisteredClass = class.class;
    let loops: &'s [LoopSpec] = check.loops.as_ref().map_or(&[], |loops| &loops.specs);
    Rc::clone(known.entry((class, loops.as_ptr())).or_insert_with(|| Rc::new(assembly::class_view(class, loops))))
}
