//! Occurrences of the parts of composites in a fleet, and the topics of its components, for pictures.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use crate::assembly::{TopicRenames, on_bus};
use crate::check::classes;
use crate::check::fleet::Fleet;
use crate::check::loops;
use crate::check::options::Options;
use crate::check::parameters::Parameters;
use crate::check::properties;
use crate::check::report::Report;
use crate::check::report::severities::Severities;
use crate::check::tasks::Task;
use crate::check::unfolding;
use crate::check::unfolding::append_list::AppendList;
use crate::diagnostic::Diagnostics;
use crate::model::{Contribution, Origin};
use crate::registry::{ClassTopic, Registry};
use crate::source::{FileId, Location, Sources};
use crate::syntax::ElementId;

/// The number of times each replicated or conditional part of the composites is in a fleet, and which topics its
/// components use.
#[derive(Clone, Debug, Default)]
pub struct Occurrences {
    counts: HashMap<(FileId, ElementId), usize>,
    /// The fewest and the most in one of the composites around them.
    ranges: HashMap<ElementPath, (usize, usize)>,
    topics: HashMap<ElementPath, Vec<TopicUse>>,
    /// Where secrets are written.
    secrets: HashSet<Location>,
}

/// A component, with those around it that composites implement before it, the outermost first.
type ElementPath = Vec<(FileId, ElementId)>;

/// A topic that a component publishes or subscribes to, itself or by one of its loops.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicUse {
    /// Its name, after renaming.
    pub name: String,
    /// Its declaration in the component's class or loop.
    pub declared: Rc<ClassTopic>,
    /// True if it is published; it is subscribed to otherwise.
    pub is_published: bool,
}

impl Occurrences {
    /// Counts the parts of the fleet that these composites come to with these options. What is wrong with replicas,
    /// conditions and settings is reported.
    pub fn of(
        contribution: &Contribution,
        registry: &Registry,
        options: &Options,
        sources: &Sources,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut severities = Severities::of(contribution, options, registry, diagnostics);
        let report = &mut Report::new(sources, diagnostics);
        let replicas = AppendList::new();
        let mut fleet = unfolding::unfold(contribution, options, &severities, &replicas, report);
        let parameters = Parameters::of(&fleet, options, report);
        report.finish();
        severities.apply(0, report.diagnostics());
        let paths = paths(&fleet);
        let given = Options { assume_classes: true, ..options.clone() };
        let topics = topics(&mut fleet, &paths, parameters, (registry, &given), sources);
        let mut counts: HashMap<(FileId, ElementId), usize> = HashMap::new();
        for composite in contribution.composites() {
            let special = composite.components.iter();
            let special = special.filter(|one| one.replicas.is_some() || one.condition.is_some());
            counts.extend(special.map(|one| ((one.origin.file(), one.origin.element), 0)));
        }
        let mut here: HashMap<(usize, (FileId, ElementId)), usize> = HashMap::new();
        for member in fleet.members.iter().filter(|member| !member.is_absent) {
            let place = place(member.component.origin);
            if let Some(count) = counts.get_mut(&place) {
                *count += 1;
                *here.entry((member.scope, place)).or_default() += 1;
            }
        }
        let mut ranges: HashMap<ElementPath, (usize, usize)> = HashMap::new();
        for (at, (path, scope)) in paths.iter().zip(&fleet.scopes).enumerate() {
            if scope.owner.is_some_and(|owner| fleet.members[owner].is_absent) {
                continue;
            }
            let composites = scope.units.iter().flat_map(|unit| &fleet.units[*unit].composites);
            let components = composites.flat_map(|composite| &composite.components).map(|one| place(one.origin));
            for place in components.filter(|place| counts.contains_key(place)) {
                let count = here.get(&(at, place)).copied().unwrap_or_default();
                let (least, most) = ranges.entry(within(path, place)).or_insert((count, count));
                (*least, *most) = ((*least).min(count), (*most).max(count));
            }
        }
        counts.extend(fleet.conditional.iter().map(|(place, is_there)| (*place, usize::from(*is_there))));
        Self { counts, ranges, topics, secrets: sources.secrets().collect() }
    }

    /// The fewest and the most of a component in one of the composites that implement `around`, the outermost first;
    /// `None` for one that is neither replicated nor conditional.
    pub fn range(&self, around: &[Origin], origin: Origin) -> Option<(usize, usize)> {
        self.counts.get(&place(origin))?;
        Some(self.ranges.get(&path_of(around, origin)).copied().unwrap_or_default())
    }

    /// True if what is written at a place is a secret, which no picture shows.
    pub fn is_secret(&self, at: Location) -> bool {
        self.secrets.contains(&at)
    }

    /// True if a part is there at all.
    pub fn is_there(&self, origin: Origin) -> bool {
        self.counts.get(&place(origin)) != Some(&0)
    }

    /// The topics that a component in the composites that implement `around` and its loops use, those of all its
    /// replicas.
    pub fn topics(&self, around: &[Origin], origin: Origin) -> &[TopicUse] {
        self.topics.get(&path_of(around, origin)).map_or(&[], Vec::as_slice)
    }
}

fn place(origin: Origin) -> (FileId, ElementId) {
    (origin.file(), origin.element)
}

fn path_of(around: &[Origin], origin: Origin) -> ElementPath {
    around.iter().copied().chain([origin]).map(place).collect()
}

fn within(path: &[(FileId, ElementId)], place: (FileId, ElementId)) -> ElementPath {
    path.iter().copied().chain([place]).collect()
}

/// The components around each scope.
fn paths(fleet: &Fleet<'_>) -> Vec<ElementPath> {
    let mut all: Vec<ElementPath> = Vec::with_capacity(fleet.scopes.len());
    for scope in &fleet.scopes {
        // A scope comes behind that of the component that it implements.
        let path = scope.owner.map(|owner| {
            let owner = &fleet.members[owner];
            within(&all[owner.scope], place(owner.component.origin))
        });
        all.push(path.unwrap_or_default());
    }
    all
}

/// The topics of all components whose classes are known, found in the way in which the checker finds them. What is
/// wrong with them is left to it.
fn topics<'a>(
    fleet: &mut Fleet<'a>,
    paths: &[ElementPath],
    mut parameters: Parameters<'a>,
    (registry, options): (&'a Registry, &Options),
    sources: &Sources,
) -> HashMap<ElementPath, Vec<TopicUse>> {
    let mut dropped = Diagnostics::new();
    let report = &mut Report::new(sources, &mut dropped);
    classes::resolve(fleet, registry, options, report);
    let given = properties::check_all(fleet, &mut parameters, report);
    loops::resolve(fleet, &given, (registry, options), &mut parameters, report);
    let mut declared: HashMap<*const ClassTopic, Rc<ClassTopic>> = HashMap::new();
    let mut all: HashMap<ElementPath, Vec<TopicUse>> = HashMap::new();
    for (at, member) in fleet.members.iter().enumerate().filter(|(_, member)| !member.is_absent) {
        let Some(class) = fleet.class_of(at) else { continue };
        let is_periodic = class.class.declaration().is_periodic();
        let task = Task { component: member.component, class, given: &given[at] };
        let text = task.text("topicRename").filter(|_| is_periodic);
        let renames = text.map(|text| TopicRenames::of(&text)).unwrap_or_default();
        let published = class.publishes.iter().map(|topic| (*topic, true));
        let topics = published.chain(class.subscribes.iter().map(|topic| (*topic, false)));
        let uses = topics.map(|(topic, is_published)| {
            let declared = declared.entry(topic).or_insert_with(|| Rc::new(topic.clone()));
            let name = on_bus(&member.site, renames.name(&topic.name)).into_owned();
            TopicUse { name, declared: Rc::clone(declared), is_published }
        });
        all.entry(within(&paths[member.scope], place(member.component.origin))).or_default().extend(uses);
    }
    // Each topic of a component, whose replicas may have several, once for its writer, once for its reader.
    for uses in all.values_mut() {
        let mut seen = HashSet::new();
        uses.retain(|one| seen.insert((one.name.clone(), one.is_published)));
    }
    all
}
