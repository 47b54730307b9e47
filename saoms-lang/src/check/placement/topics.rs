//! Rule: components of different nodes that use a topic are on one network.

use std::collections::{HashMap, HashSet};

use super::place;
use crate::assembly::on_bus;
use crate::check::component::ComponentCheck;
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Location;

/// The first component of a node and network that uses a topic.
#[derive(Clone, Copy)]
struct User<'f> {
    member: usize,
    node: &'f str,
    url: Option<&'f str>,
    publishes: bool,
    subscribes: bool,
}

impl User<'_> {
    fn is_like(&self, other: &User<'_>) -> bool {
        (self.node, self.url) == (other.node, other.url)
    }

    /// True if one of the two should hear the other over a network, and does not.
    fn misses(&self, other: &User<'_>) -> bool {
        let talk = self.publishes && other.subscribes || self.subscribes && other.publishes;
        let is_joined = self.url.is_some() && self.url == other.url;
        self.node != other.node && talk && !is_joined
    }
}

/// The topics of a fleet, with their users of each node and network.
type Users<'f> = HashMap<String, Vec<User<'f>>>;

/// Reports components that use a topic with those of another node, and do not hear each other.
pub(super) fn check(fleet: &Fleet<'_>, checks: &[ComponentCheck<'_>], report: &mut Report<'_>) {
    let mut users = Users::new();
    let mut seen = HashSet::new();
    let mut all: Vec<(usize, Vec<(String, User<'_>)>)> = Vec::new();
    for (place, member) in fleet.members.iter().enumerate() {
        let (check, Some(class)) = (&checks[place], fleet.class_of(place)) else { continue };
        if !member.runs() || member.node.is_empty() || !check.is_sound() {
            continue;
        }
        let task = check.task.as_ref();
        let (url, renames) = (task.and_then(|task| task.url.as_deref()), task.map(|task| &task.topic_rename));
        let topics =
            class.publishes.iter().map(|one| (one, true)).chain(class.subscribes.iter().map(|one| (one, false)));
        let used = topics.map(|(topic, publishes)| {
            let declared = topic.name.as_str();
            let name = on_bus(&member.site, renames.map_or(declared, |renames| renames.name(declared)));
            (name.into_owned(), User { member: place, node: &member.node, url, publishes, subscribes: !publishes })
        });
        let used: Vec<_> = used.collect();
        // Of those of one class one speaks for all.
        if check.renamed.is_empty() && !seen.insert((&member.site, &member.node, url, std::ptr::from_ref(class))) {
            all.push((place, used));
            continue;
        }
        for (name, user) in &used {
            let known = users.entry(name.clone()).or_default();
            match known.iter_mut().find(|one| one.is_like(user)) {
                Some(one) => {
                    one.publishes |= user.publishes;
                    one.subscribes |= user.subscribes;
                }
                None => known.push(*user),
            }
        }
        all.push((place, used));
    }
    let mut told: HashSet<Location> = HashSet::new();
    for (index, used) in &all {
        let found = used.iter().find_map(|(name, user)| {
            let others = users.get(name)?;
            // Of two networks the later one is told.
            let is_told = |other: &&User<'_>| user.url.is_none() || other.url.is_some() && other.member < user.member;
            Some((name, user, others.iter().filter(|other| user.misses(other)).find(is_told)?))
        });
        let Some((topic, user, other)) = found else { continue };
        let (member, peer) = (&fleet.members[*index], &fleet.members[other.member]);
        report.about(member);
        let at = checks[*index].given.get("url").map(|given| given.place).filter(|_| user.url.is_some());
        let at = at.unwrap_or(member.component.name.location);
        if !told.insert(at) {
            continue;
        }
        let (mine, theirs) = (quoted(member.path()), quoted(peer.path()));
        let (node, other_node) = (quoted(user.node), quoted(other.node));
        let both = format!("{mine} of node {node} and {theirs} of node {other_node} use topic {}", quoted(topic));
        let (message, help) = match (user.url, other.url) {
            (None, Some(url)) => (
                format!("{both}, but {mine} has no `url`: they do not hear each other"),
                format!("give it the property `url` with the value {}", quoted(url)),
            ),
            (None, None) => (
                format!("{both}, but have no `url`: they do not hear each other"),
                "give both the property `url` with the address of a message broker, such as `localhost:61616`"
                    .to_owned(),
            ),
            (Some(own), Some(url)) => (
                format!("{both}, but their `url` is {} and {}: they do not hear each other", quoted(own), quoted(url)),
                "give both the same text: a network is named by it".to_owned(),
            ),
            // Told at the other one.
            (Some(_), None) => continue,
        };
        let one = Diagnostic::new(&codes::TOPIC_BETWEEN_NODES, at, message);
        report.push(one.label(place(fleet, peer), "the other node").help(help));
    }
    report.about_all();
}
