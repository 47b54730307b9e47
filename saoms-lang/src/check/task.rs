//! The task properties of a component: what goes beyond each value alone.

use std::collections::HashSet;
use std::rc::Rc;
use std::time::Duration;

use saoms_api::PropertyField;
use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use super::checked::Checked;
use super::classes::ClassIndex;
use super::renames::{Listed, Unused};
use super::report::{Report, list, replacing};
use super::{endpoint, rename};
use crate::assembly::{Restart, TaskSettings};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Component, Part};
use crate::registry::TopicDeclaration;
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// How a component runs, and where its topics got their names.
pub(super) struct Task<'a> {
    /// `None` where the properties are not sound.
    pub(super) settings: Option<Settled>,
    /// The old and the new name of each topic that is renamed.
    pub(super) renames: Vec<(String, String)>,
    /// Where each of `renames` has its new name.
    pub(super) renamed_at: Vec<Location>,
    /// The old names, with those that the class does not have.
    pub(super) listed: Vec<Listed<'a>>,
}

impl Task<'_> {
    /// The settings, and the new names of topics with their places.
    #[inline]
    pub(super) fn into_parts(self) -> (Option<Settled>, Vec<(String, Location)>) {
        if self.renames.is_empty() {
            return (self.settings, Vec::new());
        }
        let names = self.renames.into_iter().map(|(_, new)| new);
        (self.settings, names.zip(self.renamed_at).collect())
    }
}

/// How a component runs: mostly as others of its class do but for its ID, so that these share the rest.
pub(super) struct Settled {
    id: SmolStr,
    /// Whatever ID stands here counts for nothing.
    shared: Rc<TaskSettings>,
}

impl Settled {
    fn of(settings: TaskSettings) -> Self {
        Self { id: SmolStr::new(&settings.id), shared: Rc::new(settings) }
    }

    /// From one due execution to the next.
    pub(super) fn period(&self) -> Duration {
        self.shared.period
    }

    /// Whether its messages go to a broker.
    pub(super) fn has_broker(&self) -> bool {
        self.shared.url.is_some()
    }

    pub(super) fn into_settings(self) -> TaskSettings {
        TaskSettings { id: self.id.into(), ..Rc::unwrap_or_clone(self.shared) }
    }
}

/// The properties of which nothing is to be said that goes beyond their own values.
const ALONE: &[&str] =
    &["ID", "period", "delay", "runOnStartup", "mayInterruptIfRunning", "overrun", "queue", "loss"];

/// The newest task of properties that stand alone: that of the next component mostly differs in its ID, and nothing else.
#[derive(Default)]
pub(super) struct Before(Option<Known>);

struct Known {
    /// The place of its class.
    index: usize,
    /// What is given but the ID, with the places of the properties.
    others: Vec<(usize, PropertyValue)>,
    settings: Rc<TaskSettings>,
}

impl Before {
    /// The settings of the task before with the ID of this component, where all else is the same.
    fn with_id(&self, index: usize, class: &ClassIndex<'_>, checked: Checked<'_>) -> Option<Settled> {
        let Known { others, settings, .. } = self.0.as_ref().filter(|known| known.index == index)?;
        let mut id = None;
        let mut others = others.iter();
        for (place, value) in checked.of_task(&class.slots) {
            if class.slots.all[place].is_task_id {
                id = Some(value);
            } else if !others.next().is_some_and(|(known, same)| *known == place && same == value) {
                return None;
            }
        }
        match (id, others.next()) {
            (Some(PropertyValue::Text(id)), None) => {
                Some(Settled { id: id.clone(), shared: Rc::clone(settings) })
            }
            _ => None,
        }
    }

    fn keep(&mut self, index: usize, class: &ClassIndex<'_>, checked: Checked<'_>, settings: &Settled) {
        let values = || checked.of_task(&class.slots);
        if !values().all(|(place, _)| ALONE.contains(&class.slots.all[place].name.as_str())) {
            return;
        }
        let others = values().filter(|(place, _)| !class.slots.all[*place].is_task_id);
        let others = others.map(|(place, value)| (place, value.clone())).collect();
        self.0 = Some(Known { index, others, settings: Rc::clone(&settings.shared) });
    }
}

/// What the task properties of a component of a periodic class come to. Faults are reported.
pub(super) fn check<'a>(
    component: &Component,
    (index, class): (usize, &ClassIndex<'a>),
    checked: Checked<'_>,
    before: &mut Before,
    report: &mut Report<'_>,
) -> Task<'a> {
    if checked.is_sound
        && let Some(settings) = before.with_id(index, class, checked)
    {
        let settings = Some(settings);
        return Task { settings, renames: Vec::new(), renamed_at: Vec::new(), listed: Vec::new() };
    }
    let text = |name: &str| {
        checked.get(&class.slots, name).and_then(|given| given.text()).filter(|text| !text.trim().is_empty())
    };
    if let Some(url) = text("url") {
        check_url(&url, report);
    }
    let (renames, renamed_at, listed) = match text("topicRename") {
        Some(text) => renames(&text, class, report),
        None => Default::default(),
    };
    use_jms(component, class, checked, report);
    let settings = checked.is_sound.then(|| settings(component, class, checked, &renames, report)).flatten();
    let settings = settings.map(Settled::of);
    if let Some(settings) = &settings {
        before.keep(index, class, checked, settings);
    }
    Task { settings, renames, renamed_at, listed }
}

/// The settings of a component whose properties are sound.
fn settings(
    component: &Component,
    class: &ClassIndex<'_>,
    checked: Checked<'_>,
    renames: &[(String, String)],
    report: &mut Report<'_>,
) -> Option<TaskSettings> {
    let values = checked.of_task(&class.slots);
    let values = values.map(|(place, value)| (class.slots.all[place].name.clone(), value.clone()));
    let mut values: Vec<_> = values.collect();
    for (name, value) in class.slots.presets {
        if class
            .slots
            .place(name)
            .is_some_and(|place| class.slots.all[place].task.is_some() && checked.at(place).is_none())
        {
            values.push((name.clone(), value.clone()));
        }
    }
    let settings = match TaskSettings::from_values(&values, renames.to_vec()) {
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
    let Some(fault) = endpoint::fault(url) else {
        if !endpoint::is_loopback(url) {
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
fn topics<'c, 'a>(
    class: &'c ClassIndex<'a>,
) -> impl Iterator<Item = &'a TopicDeclaration> + Clone + use<'c, 'a> {
    let published = |name: &str| class.publishes.iter().any(|topic| topic.name == name);
    let others = class.subscribes.iter().filter(move |topic| !published(&topic.name));
    class.publishes.iter().chain(others).copied()
}

fn renames<'a>(
    text: &Text,
    class: &ClassIndex<'a>,
    report: &mut Report<'_>,
) -> (Vec<(String, String)>, Vec<Location>, Vec<Listed<'a>>) {
    let (pairs, faults) = rename::parse(text);
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
                if let Some(meant) = rename::pairs_of(pair) {
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
fn use_jms(component: &Component, class: &ClassIndex<'_>, checked: Checked<'_>, report: &mut Report<'_>) {
    let Some(given) = checked.get(&class.slots, "useJMS") else { return };
    if !class.has_topics() || bool::from_value(given.value) != Ok(false) {
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
    component: &Component,
    class: &ClassIndex<'_>,
    checked: Checked<'_>,
    settings: &TaskSettings,
    report: &mut Report<'_>,
) {
    let place = |name: &str| checked.get(&class.slots, name).map(|given| given.place);
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
        for name in ["restartBackoff", "restartLimit"] {
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
    checked: Checked<'_>,
    class: &ClassIndex<'_>,
    settings: &TaskSettings,
    report: &mut Report<'_>,
) {
    let is_empty =
        |value: &PropertyValue| matches!(value, PropertyValue::Text(text) if text.trim().is_empty());
    let given = |name: &str| checked.get(&class.slots, name).filter(|given| !is_empty(given.value));
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
