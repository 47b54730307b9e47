//! The topic that is probably meant by the name of another one: of the same messages, with nearly its name.

use std::collections::HashMap;

use crate::assembly::{Traffic, TrafficTopic};
use crate::diagnostic::{Candidates, nearest};

/// The topics of a fleet, to be found by what they are like.
pub(crate) struct Similar<'t> {
    /// Those of one site and kind with one type of messages, in the order of their names.
    groups: HashMap<Key<'t>, Vec<Known<'t>>>,
    /// The rest of the names that are looked at for all topics together: in a fleet in which each robot has topics of
    /// its own every search goes through those of all others.
    candidates: Candidates,
}

/// A topic with what is asked of it.
pub(crate) struct Known<'t> {
    pub(crate) topic: &'t TrafficTopic,
    /// True if all who use it gave it its name.
    pub(crate) is_renamed: bool,
    name: Name,
}

impl<'t> Similar<'t> {
    pub(crate) fn of(traffic: &'t Traffic, is_renamed: impl Fn(&TrafficTopic) -> bool) -> Self {
        let mut groups: HashMap<_, Vec<Known<'t>>> = HashMap::new();
        for topic in &traffic.topics {
            let known = Known { topic, is_renamed: is_renamed(topic), name: Name::of(&topic.name) };
            groups.entry(key(topic)).or_default().push(known);
        }
        Self { groups, candidates: Candidates::default() }
    }

    /// The topic with the most similar name among those that fit.
    pub(crate) fn nearest(
        &mut self,
        topic: &TrafficTopic,
        fits: impl Fn(&Known<'t>) -> bool,
    ) -> Option<&'t TrafficTopic> {
        let group = self.groups.get(&key(topic))?;
        if !self.candidates.admit(group.len()) {
            return None;
        }
        let fitting = group.iter().filter(|other| other.topic.name != topic.name && fits(other));
        let name = nearest(&topic.name, fitting.map(|other| other.topic.name.as_str()))?;
        let place = group.binary_search_by_key(&name, |other| other.topic.name.as_str()).ok()?;
        Some(group[place].topic)
    }
}

impl Known<'_> {
    /// True if its name and another one are different on purpose: one adds something to the other, or they differ in
    /// their numbers.
    pub(crate) fn is_apart(&self, name: &Name) -> bool {
        let adds = |long: &str, short: &str| long != short && (long.starts_with(short) || long.ends_with(short));
        adds(&self.name.lower, &name.lower) || adds(&name.lower, &self.name.lower) || self.has_other_numbers(name)
    }

    /// True if its name and another one differ in their numbers alone.
    pub(crate) fn has_other_numbers(&self, name: &Name) -> bool {
        self.name.lower != name.lower && self.name.without_numbers == name.without_numbers
    }
}

/// A name without case, and without its numbers as well.
pub(crate) struct Name {
    lower: String,
    without_numbers: String,
}

impl Name {
    pub(crate) fn of(name: &str) -> Self {
        let lower = name.to_lowercase();
        Self { without_numbers: lower.replace(|c: char| c.is_ascii_digit(), ""), lower }
    }
}

/// Site, kind and type of the messages of a topic.
type Key<'t> = (&'t str, &'static str, &'t str);

fn key(topic: &TrafficTopic) -> Key<'_> {
    (&topic.site, topic.kind.name(), &topic.message)
}
