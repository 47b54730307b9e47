//! Topics of a fleet with their writers and readers.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

use saoms_api::host::TopicKind;

use smol_str::SmolStr;

use super::{Assembly, ComponentSpec, on_bus};
use crate::registry::ClassTopic;

/// The topics of a fleet by the names they have after renaming, sorted.
#[derive(Clone, Debug)]
pub struct Traffic {
    /// The topics.
    pub topics: Vec<TrafficTopic>,
}

/// A topic of a fleet.
#[derive(Clone, Debug)]
pub struct TrafficTopic {
    /// Its name.
    pub name: String,
    /// The site that is a part of the name; empty outside all sites.
    pub site: SmolStr,
    /// State or event.
    pub kind: TopicKind,
    /// The name of the type of its messages.
    pub message: String,
    /// True if it needs no reader, or no publisher: all that use it say so, and it has the name that they give it.
    pub is_optional: bool,
    /// Its publishers, in the order of the assembly.
    pub writers: Vec<TopicEnd>,
    /// Its subscribers, in the order of the assembly.
    pub readers: Vec<TopicEnd>,
}

/// A component that uses a topic. It is small, as a fleet has one for each component and topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TopicEnd {
    component: u32,
    /// The number of its parts that declare the topic: itself and its loops, each of which can send one message in an
    /// execution, or more.
    pub parts: u32,
    /// From one execution to the next, in nanoseconds; 0 for a passive component.
    period: u64,
}

impl TopicEnd {
    /// Its index in the assembly.
    pub fn component(&self) -> usize {
        self.component as usize
    }

    /// From one execution to the next; `None` for a passive component.
    pub fn period(&self) -> Option<Duration> {
        (self.period > 0).then(|| Duration::from_nanos(self.period))
    }
}

impl Traffic {
    /// The topics of an assembly.
    pub fn of(assembly: &Assembly) -> Self {
        let mut all = Known::default();
        for (component, spec) in assembly.components.iter().enumerate() {
            let loops = || spec.loops.iter().map(|one| one.class.declaration());
            let own = spec.class.declaration();
            let written = own.publishes.iter().chain(loops().flat_map(|one| &one.publishes));
            let read = own.subscribes.iter().chain(loops().flat_map(|one| &one.subscribes));
            for declared in written {
                let topic = all.topic(declared, spec);
                topic.note_whether_optional(declared, spec);
                add(&mut topic.writers, component, spec);
            }
            for declared in read {
                let topic = all.topic(declared, spec);
                topic.note_whether_optional(declared, spec);
                add(&mut topic.readers, component, spec);
            }
        }
        let mut topics = all.topics;
        topics.sort_unstable_by(|one, other| one.name.cmp(&other.name));
        Self { topics }
    }
}

/// Topics, with their places by their names.
#[derive(Default)]
struct Known<'a> {
    topics: Vec<TrafficTopic>,
    places: HashMap<Cow<'a, str>, usize>,
}

impl<'a> Known<'a> {
    /// The topic that a component uses under the name that it gives it.
    fn topic(&mut self, declared: &'a ClassTopic, spec: &'a ComponentSpec) -> &mut TrafficTopic {
        let name = spec.topic(&declared.name);
        let is_inside = name.strip_prefix(&*spec.site).is_some_and(|rest| rest.starts_with('/'));
        let place = *self.places.entry(name.clone()).or_insert(self.topics.len());
        if place == self.topics.len() {
            self.topics.push(TrafficTopic {
                name: name.into_owned(),
                site: if is_inside { spec.site.clone() } else { SmolStr::default() },
                kind: declared.kind,
                message: declared.message.clone(),
                is_optional: true,
                writers: Vec::new(),
                readers: Vec::new(),
            });
        }
        &mut self.topics[place]
    }
}

/// Adds a component to the ends of a topic.
fn add(ends: &mut Vec<TopicEnd>, component: usize, spec: &ComponentSpec) {
    match ends.last_mut().filter(|last| last.component() == component) {
        Some(last) => last.parts += 1,
        None => {
            // Where each component has topics of its own, there is one end to each.
            if ends.is_empty() {
                ends.reserve_exact(1);
            }
            // The limits of composites keep numbers of components far below, and a period is at most a day.
            let component = u32::try_from(component).unwrap_or(u32::MAX);
            let period = spec.task.as_ref().map_or(0, |task| u64::try_from(task.period.as_nanos()).unwrap_or(u64::MAX));
            ends.push(TopicEnd { component, parts: 1, period });
        }
    }
}

impl TrafficTopic {
    /// Who gives it another name means somebody at its other end.
    fn note_whether_optional(&mut self, declared: &ClassTopic, spec: &ComponentSpec) {
        self.is_optional &= declared.optional && self.name == on_bus(&spec.site, &declared.name);
    }

    /// Its users: writers, then readers.
    pub fn ends(&self) -> impl Iterator<Item = &TopicEnd> {
        self.writers.iter().chain(&self.readers)
    }

    /// The rate of its writers.
    pub fn pace(&self) -> Pace {
        let mut parts: BTreeMap<u128, u64> = BTreeMap::new();
        for writer in &self.writers {
            if let Some(period) = writer.period() {
                *parts.entry(period.as_nanos().max(1)).or_default() += u64::from(writer.parts);
            }
        }
        Pace { parts: parts.into_iter().collect() }
    }

    /// The number of messages a second if each part of each writer sends one in each execution.
    pub fn rate(&self) -> f64 {
        let rates = self.writers.iter().filter_map(|writer| Some((writer.parts, writer.period()?)));
        // The sum of none is `-0.0`.
        rates.map(|(parts, period)| f64::from(parts) / period.as_secs_f64()).sum::<f64>() + 0.0
    }
}

/// The rate of the writers of a topic if each part of each sends one message in each execution.
#[derive(Clone, Debug)]
pub struct Pace {
    /// The number of parts that send in each period, in nanoseconds; the shortest first.
    parts: Vec<(u128, u64)>,
}

impl Pace {
    /// The number of messages between two executions of a reader with this period.
    pub fn burst(&self, period: Duration) -> u64 {
        self.sums(period).last().unwrap_or(0)
    }

    /// True if these are more than so many. Most often a part of the writers says it.
    pub fn exceeds(&self, period: Duration, room: u64) -> bool {
        self.sums(period).any(|sum| sum > room)
    }

    /// The messages of the first writers, of those and the next ones, and so on.
    fn sums(&self, period: Duration) -> impl Iterator<Item = u64> {
        let messages = self.parts.iter().map(move |(own, parts)| {
            let executions = period.as_nanos().div_ceil(*own);
            u64::try_from(executions).unwrap_or(u64::MAX).saturating_mul(*parts)
        });
        messages.scan(0, |sum: &mut u64, more| {
            *sum = sum.saturating_add(more);
            Some(*sum)
        })
    }
}
