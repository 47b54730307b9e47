//! Values that must not occur twice in a fleet.

use std::collections::{BTreeMap, HashMap, HashSet};

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use crate::check::fleet::{Fleet, Member, class_index::ClassIndex, property_table::TableEntry};
use crate::check::properties::given_values::PropertyValues;
use crate::check::report::Report;
use crate::check::unfolding::replica_plan::with_index;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::expression::{INDEX, has_expression, names};
use crate::model::Property;
use crate::registry::PropertyDeclaration;
use crate::source::Location;

/// The values of a component that others must not have, where each is, and which property has it.
fn uses<'u, 'r>(
    member: &'u Member<'_>,
    class: &'u ClassIndex<'r>,
    given: &'u PropertyValues,
) -> impl Iterator<Item = (SmolStr, Location, &'u TableEntry<'r>)> {
    let table = class.table.unique.iter().filter(|_| !member.is_partial);
    table.filter_map(move |&place| {
        let entry = &class.table.all[place];
        let (value, place) = match given.get(&entry.name) {
            Some(given) => (given.value, given.place),
            None => (class.table.preset(&entry.name)?, member.component.name.location),
        };
        Some((canonical(value)?, place, entry))
    })
}

/// Collects values that components must not share.
#[derive(Default)]
pub(crate) struct Unique<'a> {
    /// By site, the first user of each value of a property with a word, which says what must have a value of its own.
    words: HashMap<(SmolStr, &'a str, SmolStr), User>,
    /// By site, the first task with each ID, and the word of its property.
    tasks: HashMap<(SmolStr, SmolStr), (User, Option<&'a str>)>,
    /// The places of two tasks that are told to share an ID: in other sites it is the same mistake.
    told: HashSet<[Location; 2]>,
    /// The places of values that several uses of one composite have, which are told once.
    of_uses: HashSet<Location>,
    pub(crate) repeated: RepeatedValues,
}

/// What components share and must not, which is reported. Rules over it report nothing else.
#[derive(Default)]
pub(crate) struct RepeatedValues {
    /// The places of values, with whether replicas have them.
    places: HashMap<Location, bool>,
    /// What is wrong with uses of a composite that have the site of an earlier use, and values of it.
    pub(crate) sites: BTreeMap<usize, Diagnostic>,
    /// The uses of composites whose components have values of those of an earlier use, whatever the use gives them.
    alike: HashSet<usize>,
}

impl RepeatedValues {
    /// True if the value at this place is one of them.
    pub(crate) fn contains(&self, at: Location) -> bool {
        self.places.contains_key(&at)
    }

    /// True if a component is inside such a use.
    pub(crate) fn has_inside(&self, fleet: &Fleet<'_>, member: usize) -> bool {
        !self.sites.is_empty() && around(fleet, member).any(|around| self.sites.contains_key(&around))
    }

    /// Notes that two components have a value. True if that comes of two uses of a composite in one site.
    fn is_of_site(&mut self, fleet: &Fleet<'_>, value: &str, users: [User; 2], severity: Severity) -> bool {
        let Some([first, other]) = apart(fleet, users) else { return false };
        let [one, two] = [first, other].map(|user| &fleet.members[user]);
        if one.site != two.site || users[0].place != users[1].place {
            return false;
        }
        let (Some(there), Some(here)) = (&one.component.site, &two.component.site) else {
            if !self.alike.contains(&other) {
                return false;
            }
            let known = self.sites.entry(other).or_insert_with(|| without_site([one, two], value, severity));
            known.severity = severity.max(known.severity);
            return true;
        };
        let known = self.sites.entry(other).or_insert_with(|| {
            let [one, two, site, value] = [one.path(), two.path(), &two.site, value].map(quoted);
            let message = format!("{one} and {two} are both in the site {site}, and both have a component {value}");
            let one = Diagnostic::new(&codes::NOT_UNIQUE, here.location, message);
            let one = match there.location == here.location {
                // Of replicas.
                true => one.replace(here, here.location, &with_index(here)),
                false => one.label(there.location, "the first"),
            };
            one.help("give each its own `saoms:site`: IDs need to differ only within a site").severity(severity)
        });
        known.severity = severity.max(known.severity);
        true
    }

    /// Finds uses of one composite that cannot be in one site: their components have values that must differ there, and
    /// that no property of the use changes.
    fn find_alike<'u>(
        &mut self,
        fleet: &Fleet<'_>,
        given: impl Iterator<Item = &'u PropertyValues>,
        report: &Report<'_>,
    ) {
        let mut first: HashMap<(SmolStr, &str, SmolStr), User> = HashMap::new();
        // The values that replicas share in one use already.
        let mut of_replicas: HashSet<Location> = HashSet::new();
        for (member, given) in given.enumerate() {
            let Some(class) = fleet.class_of(member) else { continue };
            for (value, place, entry) in uses(&fleet.members[member], class, given) {
                let Some(word) = entry.main.unique.as_deref() else { continue };
                let user = User { member, place };
                let earlier = *first.entry((fleet.members[member].site.clone(), word, value)).or_insert(user);
                if earlier.member == member || earlier.place != place {
                    continue;
                }
                let Some([one, two]) = apart(fleet, [earlier, user]) else { continue };
                if fleet.members[earlier.member].scope == fleet.members[member].scope {
                    of_replicas.insert(place);
                }
                let main = |member: usize| fleet.inner(member).map(|inner| inner.main().origin);
                let is_one = main(one).is_some() && main(one) == main(two);
                let is_written = names(report.written(place)).iter().all(|name| name == INDEX);
                let is_own = |member: usize| fleet.members[member].instance.is_none();
                if is_one && is_written && is_own(one) && is_own(two) && !of_replicas.contains(&place) {
                    self.alike.insert(two);
                }
            }
        }
    }

    /// True if replicas share the value at this place.
    pub(crate) fn is_of_replicas(&self, at: Location) -> bool {
        self.places.get(&at) == Some(&true)
    }
}

/// Says that two uses of a composite are in one site, where none of them says a site.
fn without_site([one, two]: [&Member<'_>; 2], value: &str, severity: Severity) -> Diagnostic {
    let [first, other, value] = [one.path(), two.path(), value].map(quoted);
    let message =
        format!("{first} and {other} are uses of one composite in one site, and both have a component {value}");
    let name = &two.component.name;
    let own = "give their components IDs of their own by a property of the composite";
    let targets = |member: &Member<'_>| -> HashSet<SmolStr> {
        let all = member.component.references.iter().flat_map(|reference| &reference.targets);
        all.map(|target| target.value.clone()).collect()
    };
    // What they are both wired to would be in another site than one of them.
    let help = match targets(one).is_disjoint(&targets(two)) {
        true => format!(
            "give each its own site, such as `saoms:site=\"{name}\"`: IDs need to differ only within a site; to let them \
             work together, {own}"
        ),
        false => format!("both are wired to one component, so they work together: {own}"),
    };
    Diagnostic::new(&codes::NOT_UNIQUE, name.location, message)
        .label(one.component.name.location, "the first")
        .help(help)
        .severity(severity)
}

/// The component that has a value.
#[derive(Clone, Copy)]
struct User {
    member: usize,
    place: Location,
}

impl<'a> Unique<'a> {
    /// None yet, with what is known of the uses of composites.
    pub(crate) fn of<'u>(
        fleet: &Fleet<'_>,
        given: impl Iterator<Item = &'u PropertyValues>,
        report: &Report<'_>,
    ) -> Self {
        let mut unique = Self::default();
        unique.repeated.find_alike(fleet, given, report);
        unique
    }

    /// Adds what a component gives, or what its class presets.
    pub(crate) fn add(
        &mut self,
        (member, fleet): (usize, &Fleet<'_>),
        class: &ClassIndex<'a>,
        given: &PropertyValues,
        report: &mut Report<'_>,
    ) {
        // That there are two components of one name is reported.
        let is_other = |first: &User| fleet.members[first.member].path() != fleet.members[member].path();
        let site = &fleet.members[member].site;
        for (value, place, entry) in uses(&fleet.members[member], class, given) {
            let user = User { member, place };
            let word = entry.main.unique.as_deref();
            if let Some(word) = word {
                let first = *self.words.entry((site.clone(), word, value.clone())).or_insert(user);
                if is_other(&first) && !self.repeated.is_of_site(fleet, &value, [first, user], Severity::Error) {
                    let is_copy = fleet.members[member].is_copy;
                    *self.repeated.places.entry(place).or_default() |= is_copy;
                    if first.place == place && !is_copy && !self.of_uses.insert(place) {
                        continue;
                    }
                    shared(&value, word, [first, user], entry.main, fleet, report);
                }
            }
            if entry.is_task_id() {
                let (first, of_first) = *self.tasks.entry((site.clone(), value.clone())).or_insert((user, word));
                let is_reported = word.is_some() && word == of_first;
                if is_other(&first)
                    && !is_reported
                    && !self.repeated.is_of_site(fleet, &value, [first, user], Severity::Warning)
                {
                    let places = [first.place, user.place];
                    if first.place == user.place || self.told.insert(places) {
                        task(&value, [first, user], fleet, report);
                    }
                }
            }
        }
    }
}

/// Reports a value that a word forbids to share.
fn shared(
    value: &str,
    word: &str,
    [first, user]: [User; 2],
    declaration: &PropertyDeclaration,
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) {
    let [earlier, later] = [first, user].map(|one| &fleet.members[one.member]);
    let message = format!(
        "components {} and {} have the same {} {}",
        quoted(earlier.path()),
        quoted(later.path()),
        quoted(&declaration.name),
        quoted(value)
    );
    let one = Diagnostic::new(&codes::NOT_UNIQUE, user.place, message);
    let is_unread = later.instance.is_none() && has_expression(report.written(user.place));
    let one = match is_unread {
        // They are the same for that alone.
        true => {
            report.withdraw(&codes::EXPRESSION_UNREAD, user.place);
            one.help(
                "`${...}` is evaluated only in components with a `saoms:count`: put the value together in the component \
                 around it, and take it with `source`",
            )
        }
        false => one,
    };
    let whose = if word.ends_with(&*declaration.name) { "component" } else { word };
    let one = one.help(format!("give every {whose} its own {}", quoted(&declaration.name)));
    let own = later.component.properties.iter().filter_map(Property::only_text);
    let is_own = earlier.scope == later.scope && own.clone().any(|text| text.location == user.place);
    report.push(match first.place == user.place {
        // Of replicas, whose expression is not different for each.
        true if later.instance.is_some() && is_own && has_expression(report.written(user.place)) => {
            one.help("this value is the same for several replicas: `${index}` is different for each")
        }
        // Of replicas.
        true if later.instance.is_some() && is_own => {
            let meant = if declaration.is_number() { "${index}".to_owned() } else { with_index(value) };
            one.replace(value, user.place, &meant)
        }
        _ => in_uses(one.other(first.place, "the first"), [first, user], fleet),
    });
}

/// The same with the uses of composites that these two are in, which may be files of others: there people can act, too.
fn in_uses(mut one: Diagnostic, users: [User; 2], fleet: &Fleet<'_>) -> Diagnostic {
    let uses = apart(fleet, users).into_iter().flatten().filter(|member| fleet.inner(*member).is_some());
    let mut names: Vec<String> = Vec::new();
    for component in uses.map(|member| fleet.members[member].component) {
        if one.labels.iter().all(|label| label.location != component.name.location) {
            one = one.label(component.name.location, "used here");
        }
        names.push(quoted(&component.name));
    }
    match users[0].place == users[1].place || names.is_empty() {
        true => one,
        false => one.help(format!("or make {} a site of its own with `saoms:site`", names.join(" or "))),
    }
}

/// A component and those that it is inside of.
fn around(fleet: &Fleet<'_>, member: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(member), |member| fleet.scopes[fleet.members[*member].scope].owner)
}

/// The outermost components around these two, or they themselves, that are different.
fn apart(fleet: &Fleet<'_>, users: [User; 2]) -> Option<[usize; 2]> {
    let [first, other] = users.map(|user| around(fleet, user.member).collect::<Vec<usize>>());
    let mut both = first.into_iter().rev().zip(other.into_iter().rev());
    both.find(|(first, other)| first != other).map(Into::into)
}

/// Tasks that share an ID run all the same, but people cannot tell them apart.
fn task(value: &str, [first, user]: [User; 2], fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let [earlier, later] = [first, user].map(|one| quoted(fleet.members[one.member].path()));
    let message = format!("components {earlier} and {later} share the ID {}", quoted(value));
    let one = Diagnostic::new(&codes::TASK_ID_SHARED, user.place, message);
    let [first_member, member] = [first, user].map(|one| &fleet.members[one.member]);
    if first.place == user.place && first_member.scope == member.scope && member.instance.is_some() {
        // Of replicas.
        return report.push(one.replace(value, user.place, &with_index(value)));
    }
    let one = one.other(first.place, "the first");
    let help = "give each its own ID: messages and reports name tasks by their ID";
    report.push(in_uses(one, [first, user], fleet).help(help));
}

/// The canonical form of a value: `07` and `7` are one number, and blanks around a text do not count.
fn canonical(value: &PropertyValue) -> Option<SmolStr> {
    let PropertyValue::Scalar(scalar) = value else { return None };
    Some(scalar.as_text().map_or_else(|| scalar.text(), |text| text.trim().into()))
}
