//! What a fault needs in a fleet.

use std::collections::{HashMap, HashSet};

use super::{FaultCall, FaultKind, NODE_SIGN, is_named, names_component};
use crate::event::Word;
use crate::extension::LineFault;
use crate::rule::nearest;

/// The components and topics of a fleet, which faults name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaultSubjects {
    /// The components.
    pub components: Vec<SubjectComponent>,
    /// The topics.
    pub topics: Vec<SubjectTopic>,
    /// False where the fleet may have others: what is not found is not wrong then.
    pub is_complete: bool,
}

/// A component of a fleet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SubjectComponent {
    /// Its path.
    pub path: String,
    /// Its node; empty in a fleet without nodes.
    pub node: String,
    /// True if it has executions.
    pub is_periodic: bool,
}

impl SubjectComponent {
    fn is_named(&self, name: &Word) -> bool {
        names_component(&name.text, &self.path, &self.node)
    }
}

/// A topic of a fleet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SubjectTopic {
    /// Its name, as it is after renaming.
    pub name: String,
    /// The paths of the components that publish it.
    pub writers: Vec<String>,
    /// The paths of those that read it.
    pub readers: Vec<String>,
}

impl FaultSubjects {
    /// The topic of this name, which is added where it is not known.
    pub fn topic(&mut self, name: String) -> &mut SubjectTopic {
        let place = self.topics.iter().position(|topic| topic.name == name);
        let place = place.unwrap_or_else(|| {
            self.topics.push(SubjectTopic { name, ..SubjectTopic::default() });
            self.topics.len() - 1
        });
        &mut self.topics[place]
    }

    /// Judges the names of a fault.
    ///
    /// # Errors
    /// The first name that means nothing, or a link that no message takes.
    pub fn check(&self, call: &FaultCall) -> Result<(), LineFault> {
        if !self.is_complete {
            return Ok(());
        }
        for name in call.from.iter().chain(&call.to) {
            self.component(name, !call.kind.is_of_messages())?;
        }
        if let Some(topic) = &call.topic {
            self.known_topic(topic)?;
        }
        if call.kind.is_of_messages() { self.link(call) } else { Ok(()) }
    }

    fn component(&self, name: &Word, has_executions: bool) -> Result<(), LineFault> {
        let mut named = self.components.iter().filter(|one| one.is_named(name)).peekable();
        if named.peek().is_some() {
            if !has_executions || named.any(|one| one.is_periodic) {
                return Ok(());
            }
            let message = match name.text.starts_with(NODE_SIGN) {
                true => format!("all components of `{}` are passive: they have no executions", name.text),
                false => format!("component `{}` is passive: it has no executions", name.text),
            };
            return Err(LineFault::new(name.bytes.clone(), message).help("name the component that calls it"));
        }
        if let Some(node) = name.text.strip_prefix(NODE_SIGN) {
            let fault = LineFault::new(name.bytes.clone(), format!("the fleet has no node `{node}`"));
            let mut nodes: Vec<String> = self
                .components
                .iter()
                .map(|one| format!("{NODE_SIGN}{}", one.node))
                .filter(|one| one.len() > 1)
                .collect();
            nodes.sort_unstable();
            nodes.dedup();
            return Err(match nodes.is_empty() {
                true => fault.help("no component has a `saoms:node`, and no other composite is on a network"),
                false => near(fault, &name.text, nodes.iter().map(String::as_str)),
            });
        }
        let fault = LineFault::new(name.bytes.clone(), format!("the fleet has no component `{}`", name.text));
        let paths = || self.components.iter().map(|one| one.path.as_str());
        Err(near(fault, &name.text, paths().chain(paths().filter_map(|path| path.rsplit('/').next()))))
    }

    fn known_topic(&self, name: &Word) -> Result<(), LineFault> {
        if self.topics.iter().any(|topic| is_named(&name.text, &topic.name)) {
            return Ok(());
        }
        let fault = LineFault::new(name.bytes.clone(), format!("the fleet has no topic `{}`", name.text));
        let names = || self.topics.iter().map(|topic| topic.name.as_str());
        Err(near(fault, &name.text, names().chain(names().filter_map(|name| name.rsplit('/').next()))))
    }

    /// The paths of the components that are named; `None` without a name, where all are.
    fn named(&self, names: &[Word]) -> Option<HashSet<&str>> {
        let is_named = |one: &&SubjectComponent| names.iter().any(|name| one.is_named(name));
        (!names.is_empty()).then(|| self.components.iter().filter(is_named).map(|one| one.path.as_str()).collect())
    }

    /// Finds a topic with a sender and a reader that the fault concerns.
    fn link(&self, call: &FaultCall) -> Result<(), LineFault> {
        let topics = || {
            let on = |topic: &&SubjectTopic| call.topic.as_ref().is_none_or(|word| is_named(&word.text, &topic.name));
            self.topics.iter().filter(on)
        };
        let (from, to) = (self.named(&call.from), self.named(&call.to));
        let is_in = |named: &Option<HashSet<&str>>, path: &str| named.as_ref().is_none_or(|all| all.contains(path));
        let nodes: HashMap<&str, &str> = match call.names_nodes() {
            true => self.components.iter().map(|one| (one.path.as_str(), one.node.as_str())).collect(),
            false => HashMap::new(),
        };
        let is_link = |one: &str, other: &str| match nodes.is_empty() {
            true => one != other,
            false => nodes.get(one) != nodes.get(other),
        };
        let carries = |topic: &SubjectTopic, from: &Option<HashSet<&str>>, to: &Option<HashSet<&str>>| {
            let senders = topic.writers.iter().filter(|path| is_in(from, path));
            let mut links = senders.flat_map(|one| topic.readers.iter().map(move |other| (one, other)));
            links.any(|(one, other)| is_link(one, other) && is_in(to, other))
        };
        let is_both_ways = call.kind == FaultKind::Part;
        if topics().any(|topic| carries(topic, &from, &to) || is_both_ways && carries(topic, &to, &from)) {
            return Ok(());
        }
        let on = call.topic.as_ref().map(|topic| format!(" on `{}`", topic.text)).unwrap_or_default();
        for name in &call.from {
            let named = self.named(std::slice::from_ref(name));
            if !is_both_ways && !topics().any(|topic| topic.writers.iter().any(|path| is_in(&named, path))) {
                let message = format!("{} publishes nothing{on}", who(name));
                let fault = LineFault::new(name.bytes.clone(), message);
                return Err(near_end(fault, topics().flat_map(|topic| &topic.writers), "its publishers are"));
            }
        }
        for name in &call.to {
            let named = self.named(std::slice::from_ref(name));
            if !is_both_ways && !topics().any(|topic| topic.readers.iter().any(|path| is_in(&named, path))) {
                let message = format!("{} reads nothing{on}", who(name));
                let fault = LineFault::new(name.bytes.clone(), message);
                return Err(near_end(fault, topics().flat_map(|topic| &topic.readers), "its readers are"));
            }
        }
        let place = call.from.iter().chain(&call.to).chain(&call.topic).next();
        let place = place.map_or_else(|| call.bytes.clone(), |word| word.bytes.clone());
        Err(LineFault::new(place, format!("no message{on} takes this way, so the fault has no effect"))
            .help("`from` names components that publish a topic, `to` others that read it"))
    }
}

/// The components of a name, for people.
fn who(name: &Word) -> String {
    match name.text.strip_prefix(NODE_SIGN) {
        Some(node) => format!("node `{node}`"),
        None => format!("component `{}`", name.text),
    }
}

fn near<'n>(fault: LineFault, name: &str, known: impl Iterator<Item = &'n str> + Clone) -> LineFault {
    match nearest(name, known.clone()) {
        Some(meant) => fault.instead(meant),
        None => {
            let mut listed: Vec<String> = Vec::new();
            for one in known.map(|one| format!("`{one}`")) {
                if listed.len() < 8 && !listed.contains(&one) {
                    listed.push(one);
                }
            }
            match listed.is_empty() {
                true => fault,
                false => fault.help(format!("it has {}", listed.join(", "))),
            }
        }
    }
}

fn near_end<'n>(fault: LineFault, ends: impl Iterator<Item = &'n String>, what: &str) -> LineFault {
    let mut ends: Vec<String> = ends.map(|path| format!("`{path}`")).collect();
    ends.sort_unstable();
    ends.dedup();
    ends.truncate(8);
    if ends.is_empty() { fault } else { fault.help(format!("{what} {}", ends.join(", "))) }
}
