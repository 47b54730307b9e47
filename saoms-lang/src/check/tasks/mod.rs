//! The task properties of a component: what goes beyond each value alone.

pub(crate) mod broker_address;
#[cfg(test)]
mod tests;
pub(crate) mod topic_types;
pub(crate) mod unused_renames;

use std::collections::HashSet;
use std::rc::Rc;

use saoms_api::PropertyField;
use saoms_api::host::PropertyValue;

use crate::assembly::{OF_RESTART, Restart, TaskProperties, TopicRenames, topic_rename};
use crate::check::component::{ComponentCheck, State};
use crate::check::fleet::classes::ClassIndex;
use crate::check::fleet::{Fleet, Kind};
use crate::check::properties::given_values::PropertyValues;
use crate::check::report::{Report, list, replacing};
use crate::check::rules::unique_values::Unique;
use crate::check::tasks::unused_renames::{Listed, Unused};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{ComponentElement, Part};
use crate::registry::ClassTopic;
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// The task of a component, and the places where its topics got their names.
pub(crate) struct Task<'a> {
    /// `None` where the properties are not sound.
    pub(crate) settings: Option<TaskProperties>,
    /// The old and the new name of each topic that is renamed.
    pub(crate) renames: TopicRenames,
    /// The place of the new name of each of `renames`.
    pub(crate) renamed_at: Vec<Location>,
    /// The old names, with those that the class does not have.
    pub(crate) listed: Vec<Listed<'a>>,
}

/// The task of a component of a periodic class. Faults are reported.
pub(crate) fn check<'a>(
    component: &ComponentElement,
    class: &ClassIndex<'a>,
    checked: &PropertyValues,
    report: &mut Report<'_>,
) -> Task<'a> {
    let text = |name: &str| {
        checked.get(&class.table, name).and_then(|given| given.text()).filter(|text| !text.trim().is_empty())
    };
    if let Some(url) = text("url") {
        check_url(&url, report);
    }
    let (renames, renamed_at, listed) = match text("topicRename") {
        Some(text) => renames(&text, class, report),
        None => Default::default(),
    };
    use_jms(component, class, checked, report);
    let settings = checked.is_sound.then(|| settings(component, class, checked, report)).flatten();
    Task { settings, renames, renamed_at, listed }
}

/// The settings of a component whose properties are sound.
fn settings(
    component: &ComponentElement,
    class: &ClassIndex<'_>,
    checked: &PropertyValues,
    report: &mut Report<'_>,
) -> Option<TaskProperties> {
    let values = checked.of_task(&class.table).map(|(name, value)| (name, value.clone()));
    let mut values: Vec<_> = values.collect();
    for (name, value) in class.table.presets {
        if class
            .table
            .place(name)
            .is_some_and(|place| class.table.all[place].task.is_some() && checked.at(place).is_none())
        {
            values.push((name.clone(), value.clone()));
        }
    }
    let settings = match TaskProperties::read(values) {
        Ok(settings) => settings,
        // Not reached with sound properties; and if it is, somebody hears of it.
        Err(failure) => {
            let message = format!("component {}: {failure}", quoted(&component.name));
            report.push(Diagnostic::new(&codes::CONSTRUCTION, component.name.location, message));
            return None;
        }
    };
    combinations(component, class, checked, &settings, report);
    Some(settings)
}

fn check_url(url: &Text, report: &mut Report<'_>) {
    let Some(fault) = broker_address::fault(url) else {
        if !broker_address::is_loopback(url) {
            let message =
                format!("messages do not leave this program yet: {} is not connected to", quoted(url));
            report.push(
                Diagnostic::new(&codes::NOT_SUPPORTED_YET, url.location, message)
                    .help("the topics are served inside the program: let it run the whole fleet"),
            );
        }
        return;
    };
    let at = report.part(url, fault.at);
    let message = format!("{} is no address of a message broker: {}", quoted(url), fault.message);
    let one = Diagnostic::new(&codes::BROKER_URL, at, message)
        .help("an address is `host:port`, as in `localhost:61616`, with a port from 1 to 65535");
    report.push(match fault.instead {
        Some(instead) if instead.is_empty() => one.suggest("remove it", at, instead),
        Some(instead) => one.suggest(format!("replace it with {}", quoted(&instead)), at, escaped(&instead)),
        None => one,
    });
}

/// The topics of a class, each once.
fn topics<'c, 'a>(class: &'c ClassIndex<'a>) -> impl Iterator<Item = &'a ClassTopic> + Clone + use<'c, 'a> {
    let published = |name: &str| class.publishes.iter().any(|topic| topic.name == name);
    let others = class.subscribes.iter().filter(move |topic| !published(&topic.name));
    class.publishes.iter().chain(others).copied()
}

fn renames<'a>(
    text: &Text,
    class: &ClassIndex<'a>,
    report: &mut Report<'_>,
) -> (TopicRenames, Vec<Location>, Vec<Listed<'a>>) {
    let (pairs, faults) = topic_rename::parse(text);
    let parts = report.parts(text);
    for fault in faults {
        let at = parts.part(fault.at.clone());
        let mut one =
            Diagnostic::new(&codes::TOPIC_RENAME, at, format!("bad `topicRename`: {}", fault.message));
        match fault.other {
            Some((other, what)) => one = one.label(parts.part(other), what),
            None => {
                one = one.help("write `OLD,new` for each topic, and `::` between two of them");
                let pair = text.get(fault.at.clone()).unwrap_or_default();
                if let Some(meant) = topic_rename::pairs_of(pair) {
                    one = one.suggest(replacing(pair, &meant), at, escaped(&meant));
                }
            }
        }
        report.push(one);
    }
    let renamed: HashSet<&str> = pairs.iter().map(|pair| pair.old.text).collect();
    let mut others: Option<Rc<[&str]>> = None;
    let listed = pairs.iter().map(|pair| {
        let name = pair.old.text;
        let is_used = topics(class).any(|topic| topic.name == name);
        let unused = || {
            let names = topics(class).map(|topic| topic.name.as_str());
            let others = others.get_or_insert_with(|| names.filter(|name| !renamed.contains(name)).collect());
            Unused { class: class.class.name(), others: Rc::clone(others) }
        };
        let at = parts.part(pair.old.at.clone());
        Listed { name: name.to_owned(), at, unused: (!is_used).then(unused) }
    });
    let listed = listed.collect();
    let places = pairs.iter().map(|pair| parts.part(pair.new.at.clone())).collect();
    let names = pairs.iter().map(|pair| (pair.old.text.to_owned(), pair.new.text.to_owned()));
    (names.collect(), places, listed)
}

/// Reports a component that has topics and must not use them.
fn use_jms(
    component: &ComponentElement,
    class: &ClassIndex<'_>,
    checked: &PropertyValues,
    report: &mut Report<'_>,
) {
    let Some(given) = checked.get(&class.table, "useJMS") else { return };
    if !class.has_topics() || bool::from_value(&given.value) != Ok(false) {
        return;
    }
    let mut uses = Vec::new();
    for (verb, topics) in [("publishes", &class.publishes), ("subscribes to", &class.subscribes)] {
        // Where loops declare a topic in other ways, which is reported, it is there several times.
        let mut names: Vec<&str> = Vec::new();
        for topic in topics {
            if !names.contains(&topic.name.as_str()) {
                names.push(&topic.name);
            }
        }
        if !names.is_empty() {
            uses.push(format!("{verb} {}", list(names)));
        }
    }
    let message =
        format!("`useJMS` is false, and component {} {}", quoted(&component.name), uses.join(" and "));
    report.push(
        Diagnostic::new(&codes::USE_JMS, given.place, message)
            .help("set `useJMS` to true: without it a component cannot publish or subscribe"),
    );
}

/// Settings that do not go together.
fn combinations(
    component: &ComponentElement,
    class: &ClassIndex<'_>,
    checked: &PropertyValues,
    settings: &TaskProperties,
    report: &mut Report<'_>,
) {
    let place = |name: &str| checked.get(&class.table, name).map(|given| given.place);
    if let Some(deadline) = settings.deadline
        && deadline > settings.period
    {
        let shown = |duration| saoms_api::host::format_duration(duration);
        let message = format!(
            "the deadline of {} is behind the period of {}: the next execution is due before it",
            shown(deadline),
            shown(settings.period)
        );
        let one = Diagnostic::new(&codes::DEADLINE, place("deadline").unwrap_or(component.tag()), message)
            .help("a deadline is at most the period");
        report.push(match place("period") {
            Some(period) => one.label(period, "the period"),
            None => one,
        });
    }
    if settings.restart == Restart::Never {
        for name in OF_RESTART {
            if let Some(place) = place(name) {
                let message = format!("{} has no effect: the component is never restarted", quoted(name));
                let one = Diagnostic::new(&codes::RESTART_UNUSED, place, message);
                report.push(one.help("set `restart` to `onFailure`"));
            }
        }
    }
    credentials(checked, class, settings, report);
}

fn credentials(
    checked: &PropertyValues,
    class: &ClassIndex<'_>,
    settings: &TaskProperties,
    report: &mut Report<'_>,
) {
    let is_empty =
        |value: &PropertyValue| matches!(value, PropertyValue::Text(text) if text.trim().is_empty());
    let given = |name: &str| checked.get(&class.table, name).filter(|given| !is_empty(&given.value));
    let (user, password) = (given("user"), given("password"));
    let fault = match (user, password) {
        (Some(user), None) => Some((user, "`user` is given without `password`", "give both, or neither")),
        (None, Some(password)) => {
            Some((password, "`password` is given without `user`", "give both, or neither"))
        }
        (Some(user), Some(_)) if settings.url.is_none() => Some((
            user,
            "`user` and `password` have no effect: there is no `url` of a message broker",
            "give the `url` of the broker, or leave them out",
        )),
        _ => None,
    };
    if let Some((given, message, help)) = fault {
        report.push(Diagnostic::new(&codes::CREDENTIALS, given.place, message).help(help));
    }
}

/// Checks the tasks and topics of all components, and says which components are sound.
pub(crate) fn check_all<'a>(
    fleet: &Fleet<'a>,
    classes: &[ClassIndex<'a>],
    checks: &mut [ComponentCheck<'a>],
    report: &mut Report<'_>,
) {
    let mut unique = Unique::default();
    let mut topics = topic_types::Topics::default();
    let mut listed = unused_renames::Renames::default();
    for (place, (member, check)) in fleet.members.iter().zip(checks).enumerate() {
        report.about(member);
        let Kind::Class(index) = member.kind else { continue };
        let class = &classes[index];
        unique.add((place, fleet), class, &check.given, report);
        let is_periodic = class.class.declaration().is_periodic();
        let mut task = is_periodic.then(|| self::check(member.component, class, &check.given, report));
        if let Some(task) = &mut task {
            listed.add(place, std::mem::take(&mut task.listed));
        }
        topics.add(member, (index, class), task.as_ref(), report);
        (check.values, check.origins) = check.given.of_class(&class.table);
        check.queue = check.given.get(&class.table, "queue").map(|given| given.place);
        let is_sound = check.given.is_sound && check.loops.is_some();
        if let Some(task) = task {
            let names = task.renames.0.into_iter().map(|(_, new)| new);
            check.renamed = names.zip(task.renamed_at).collect();
            check.task = task.settings;
        }
        check.state = match is_sound && is_periodic == check.task.is_some() {
            true => State::Sound,
            false => State::Faulty,
        };
    }
    report.about_all();
    listed.finish(fleet, report);
}
