//! The task properties of a component: what goes beyond each value alone.

pub(crate) mod broker_address;
pub(crate) mod renames;
mod taken_events;
#[cfg(test)]
mod tests;
pub(crate) mod topic_types;
mod trigger;
pub(crate) mod unique_values;

use std::collections::HashSet;

use saoms_api::host::{declaration::Scalar, format_duration};

use crate::assembly::{OF_RESTART, Restart, TaskProperties, TopicRenames};
use crate::check::component::{ComponentCheck, ComponentState};
use crate::check::fleet::{Fleet, Kind, class_index::ClassIndex};
use crate::check::properties::{findings::Renamed, given_values::PropertyValues};
use crate::check::report::{Report, list};
use crate::check::tasks::renames::Renames;
use crate::check::tasks::unique_values::{RepeatedValues, Unique};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{ComponentElement, Part};
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// The task of a component of a periodic class.
pub(crate) struct Task<'t, 'a> {
    pub(crate) component: &'t ComponentElement,
    pub(crate) class: &'t ClassIndex<'a>,
    pub(crate) given: &'t PropertyValues,
}

impl Task<'_, '_> {
    pub(crate) fn text(&self, name: &str) -> Option<Text> {
        self.given.get(name)?.text()
    }

    pub(crate) fn place(&self, name: &str) -> Option<Location> {
        Some(self.given.get(name)?.place)
    }

    /// Checks all values, each alone and those that have to go together: the properties, where they are sound.
    fn check(&self, renamed: &[Renamed], report: &mut Report<'_>) -> Option<TaskProperties> {
        if let Some(url) = self.text("url") {
            self.url(&url, report);
        }
        self.use_jms(report);
        trigger::check(self, report);
        if !self.given.is_sound {
            return None;
        }
        let renames = renamed.iter().map(|one| (one.old.to_string(), one.new.to_string())).collect();
        match TaskProperties::read(self.given.of_task(&self.class.table), TopicRenames(renames)) {
            Ok(mut properties) => {
                if self.given.get("delay").is_none() {
                    let alternates = self.class.class.declaration().alternates;
                    properties.delay = TaskProperties::usual_delay(properties.period, alternates);
                }
                self.deadline(&properties, report);
                self.restart(&properties, report);
                self.credentials(&properties, report);
                Some(properties)
            }
            // Not reached with sound properties; and if it is, it is reported.
            Err(failure) => {
                let name = &self.component.name;
                let message = format!("component {}: {failure}", quoted(name));
                report.push(Diagnostic::new(&codes::CONSTRUCTION, name.location, message));
                None
            }
        }
    }

    /// Reports a component that has topics and must not use them.
    fn use_jms(&self, report: &mut Report<'_>) {
        let Some(given) = self.given.get("useJMS") else { return };
        if !self.class.has_topics() || *given.as_task() != Scalar::Boolean(false).into() {
            return;
        }
        let mut uses = Vec::new();
        for (verb, topics) in [("publishes", &self.class.publishes), ("subscribes to", &self.class.subscribes)] {
            // Where loops declare a topic in other ways, which is reported, it is there several times.
            let mut seen = HashSet::new();
            let names: Vec<&str> =
                topics.iter().map(|one| one.name.as_str()).filter(|name| seen.insert(*name)).collect();
            if !names.is_empty() {
                uses.push(format!("{verb} {}", list(names)));
            }
        }
        let message =
            format!("`useJMS` is false, but component {} {}", quoted(&self.component.name), uses.join(" and "));
        let one = Diagnostic::new(&codes::USE_JMS, given.place, message);
        report.push(one.help("set `useJMS` to true: without it a component cannot publish or subscribe"));
    }

    fn deadline(&self, properties: &TaskProperties, report: &mut Report<'_>) {
        if let Some(deadline) = properties.deadline
            && deadline > properties.period
        {
            let [deadline, period] = [deadline, properties.period].map(format_duration);
            let message = format!(
                "the deadline of {deadline} is longer than the period of {period}: the next execution is due before it"
            );
            let at = self.place("deadline").unwrap_or(self.component.tag());
            let one = Diagnostic::new(&codes::DEADLINE, at, message);
            let one = one.help("shorten the deadline: it can be at most the period");
            report.push(match self.place("period") {
                Some(period) => one.label(period, "the period"),
                None => one,
            });
        }
    }

    fn restart(&self, properties: &TaskProperties, report: &mut Report<'_>) {
        if properties.restart == Restart::Never {
            for name in OF_RESTART {
                if let Some(place) = self.place(name) {
                    let message = format!("{} has no effect: the component is never restarted", quoted(name));
                    let one = Diagnostic::new(&codes::RESTART_UNUSED, place, message);
                    report.push(one.help("set `restart` to `onFailure`"));
                }
            }
        }
    }

    fn url(&self, url: &Text, report: &mut Report<'_>) {
        if let Some(fault) = broker_address::fault(url) {
            let at = report.part(url, fault.at);
            let (what, help) = match broker_address::peers(url) {
                Some(_) => (
                    "a list of peers",
                    "write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of \
                     a node or of a composite's file, and where this program listens",
                ),
                None => (
                    "an address of a message broker",
                    "write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535",
                ),
            };
            let message = format!("{} is not {what}: {}", quoted(url), fault.message);
            let one = Diagnostic::new(&codes::BROKER_URL, at, message).help(help);
            report.push(match fault.instead {
                Some(instead) if instead.is_empty() => one.suggest("remove it", at, instead),
                Some(instead) => one.suggest(format!("replace it with {}", quoted(&instead)), at, escaped(&instead)),
                None => one,
            });
        }
    }

    fn credentials(&self, properties: &TaskProperties, report: &mut Report<'_>) {
        let (user, password) = (self.place("user").filter(|_| properties.user.is_some()), self.text("password"));
        let (password, file) = (password.map(|text| text.location), self.place("passwordFile"));
        let file = file.filter(|_| properties.password_file.is_some());
        let (given, message, help) = match (user, password, file) {
            (None, None, None) => return self.tls(properties, report),
            (_, Some(_), Some(file)) => (file, "`password` and `passwordFile` are both given", "keep one of them"),
            (None, Some(password), _) => (password, "`password` is given without `user`", "give both, or neither"),
            (None, None, Some(file)) => (file, "`passwordFile` is given without `user`", "give both, or neither"),
            (Some(user), None, None) if properties.url.is_none() => {
                (user, "`user` has no effect: there is no `url` of a message broker", "leave it out, or give all three")
            }
            (Some(user), None, None) => (user, "`user` is given without `password`", "give both, or neither"),
            (Some(user), ..) if properties.url.is_none() => (
                user,
                "`user` and `password` have no effect: there is no `url` of a message broker",
                "give the `url` of the broker, or leave them out",
            ),
            _ => return self.tls(properties, report),
        };
        report.push(Diagnostic::new(&codes::CREDENTIALS, given, message).help(help));
    }

    /// Reports files for TLS without a network.
    fn tls(&self, properties: &TaskProperties, report: &mut Report<'_>) {
        let given = [
            ("tlsCa", &properties.tls_ca),
            ("tlsCertificate", &properties.tls_certificate),
            ("tlsKey", &properties.tls_key),
        ];
        let mut given = given.into_iter().filter(|(_, value)| value.is_some());
        if let Some((name, at)) = given.find_map(|(name, _)| Some((name, self.place(name)?)))
            && properties.url.is_none()
        {
            let message = format!("`{name}` has no effect: there is no `url` of a message broker");
            let one = Diagnostic::new(&codes::CREDENTIALS, at, message);
            report.push(one.help("give the `url` of the broker, or leave it out"));
        }
    }
}

/// Checks the tasks and topics of all components, and which are sound. The values that they share and must not.
pub(crate) fn check_all<'a>(
    fleet: &Fleet<'a>,
    checks: &mut [ComponentCheck<'a>],
    report: &mut Report<'_>,
) -> RepeatedValues {
    let mut unique = Unique::of(fleet, checks.iter().map(|check| &check.given), report);
    let mut topics = topic_types::Topics::default();
    let mut taken = taken_events::TakenEvents::default();
    let mut renames = Renames::default();
    for (place, (member, check)) in fleet.members.iter().zip(checks).enumerate() {
        report.about(member);
        let Kind::Class(index) = member.kind else { continue };
        let (class, component) = (&fleet.classes[index], member.component);
        unique.add((place, fleet), class, &check.given, report);
        let is_periodic = class.class.declaration().is_periodic();
        if is_periodic {
            let task = Task { component, class, given: &check.given };
            if let Some(text) = task.text("topicRename") {
                check.renamed = renames.add(place, &text, report);
            }
            check.task = task.check(&check.renamed, report);
        }
        topics.add(member, (index, class), &check.renamed, report);
        taken.add(member, (index, class), report);
        let is_sound = check.given.is_sound && check.loops.is_some();
        check.state = match is_sound && is_periodic == check.task.is_some() {
            true => ComponentState::Sound,
            false => ComponentState::Faulty,
        };
    }
    report.about_all();
    renames.finish(fleet, report);
    unique.repeated.sites.values().for_each(|one| report.push(one.clone()));
    unique.repeated
}
