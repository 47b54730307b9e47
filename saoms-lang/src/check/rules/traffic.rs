//! The wiring report of topics: ends without a counterpart, names that are nearly the same, queues that overflow.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;
use std::time::Duration;

use saoms_api::host::{TopicKind, format_duration};

use crate::assembly::{Assembly, Loss, TaskProperties, TopicEnd, Traffic, TrafficTopic, on_bus};
use crate::check::component::ComponentCheck;
use crate::check::fleet::{Fleet, Member};
use crate::check::properties::findings::Renamed;
use crate::check::report::Report;
use crate::check::rules::similar_names::{Name, Similar};
use crate::check::tasks::Task;
use crate::check::tasks::broker_address::is_of_topics;
use crate::check::tasks::topic_types::described;
use crate::diagnostic::{Code, Diagnostic, codes, quoted};
use crate::source::Location;

/// The places of a component, and of the names of its topics.
pub(crate) struct ComponentPlaces {
    pub(crate) name: Location,
    pub(crate) renamed: Rc<[Renamed]>,
    site: Option<Location>,
    /// The place of its `queue`.
    pub(crate) queue: Option<Location>,
}

/// The places of the components of the assembly.
pub(crate) fn places(fleet: &Fleet<'_>, checks: &[ComponentCheck<'_>]) -> Vec<ComponentPlaces> {
    let runs = fleet.members.iter().enumerate().filter(|(_, member)| member.runs());
    let place = |(place, member): (usize, &Member<'_>)| {
        let (component, check) = (member.component, &checks[place]);
        let renamed = Rc::clone(&check.renamed);
        let class = fleet.class_of(place).filter(|class| class.class.declaration().is_periodic());
        let task = class.map(|class| Task { component, class, given: &check.given });
        let site = component.site.as_ref().map(|site| site.location);
        ComponentPlaces {
            name: component.name.location,
            renamed,
            site,
            queue: task.and_then(|task| task.place("queue")),
        }
    };
    runs.map(place).collect()
}

/// Looks at all topics of a fleet; `places` are those of its components.
pub(crate) fn check(assembly: &Assembly, places: &[ComponentPlaces], report: &mut Report<'_>) {
    let traffic = Traffic::of(assembly);
    let all = All { assembly, places };
    let mut similar = Similar::of(&traffic, |topic| topic.ends().all(|end| all.is_renamed(end, topic)));
    let mut reported: HashSet<&str> = all.known(&traffic, report);
    let is_known = |topic: &TrafficTopic| reported.contains(topic.name.as_str());
    let has_writer = |topic: &TrafficTopic| !topic.writers.is_empty() || all.comes_from_outside(topic);
    let is_lone = |topic: &&TrafficTopic| (!has_writer(topic) || topic.readers.is_empty()) && !is_known(topic);
    let mut lone: HashMap<&str, &TrafficTopic> =
        traffic.topics.iter().filter(is_lone).map(|topic| (topic.name.as_str(), topic)).collect();
    for topic in &traffic.topics {
        if lone.contains_key(topic.name.as_str())
            && let Some(meant) = meant(topic, &mut similar)
        {
            for name in [topic.name.as_str(), meant.name.as_str()] {
                lone.remove(name);
                reported.insert(name);
            }
            all.near(topic, meant, report);
        }
    }
    for topic in &traffic.topics {
        if !reported.contains(topic.name.as_str())
            && let Some(meant) = left(topic, &mut similar).or_else(|| all.missed(topic, &mut similar))
        {
            all.alone(topic, meant, report);
        }
        if lone.contains_key(topic.name.as_str()) {
            if !topic.is_optional {
                all.lone(topic, report);
            }
        } else {
            all.rates(topic, report);
        }
    }
}

struct All<'a> {
    assembly: &'a Assembly,
    places: &'a [ComponentPlaces],
}

impl All<'_> {
    /// True if a reader takes an event by the topic: scenarios and people bring its messages.
    fn comes_from_outside(&self, topic: &TrafficTopic) -> bool {
        topic.readers.iter().any(|end| {
            let spec = &self.assembly.components[end.component()];
            spec.class.declaration().takes.iter().any(|taken| spec.topic(&taken.topic) == topic.name)
        })
    }

    /// The topics with other names than in the rest of the fleet, for a `topicRename` or a site that a rule told of.
    fn known<'t>(&self, traffic: &'t Traffic, report: &mut Report<'_>) -> HashSet<&'t str> {
        let places = report
            .diagnostics()
            .iter()
            .flat_map(|one| std::iter::once(one.location).chain(one.labels.iter().map(|label| label.location)));
        let told: HashSet<Location> = places.collect();
        let base = |topic: &'t TrafficTopic| topic.name.rsplit('/').next();
        let bases = |topic: &'t TrafficTopic| {
            topic.ends().find_map(|end| {
                let renamed = self.renamed(end, topic);
                let mut at = renamed.map(|one| one.new.location).into_iter().chain(self.places[end.component()].site);
                at.any(|at| told.contains(&at)).then(|| [base(topic), renamed.map(|one| one.old.as_str())])
            })
        };
        let bases: HashSet<&str> = traffic.topics.iter().filter_map(bases).flatten().flatten().collect();
        let all = traffic.topics.iter().filter(|topic| base(topic).is_some_and(|base| bases.contains(base)));
        all.map(|topic| topic.name.as_str()).collect()
    }

    /// The place from which a component has the name of a topic.
    fn at(&self, end: &TopicEnd, topic: &TrafficTopic) -> Location {
        self.renamed(end, topic).map_or(self.places[end.component()].name, |one| one.new.location)
    }

    /// `component X`, or `component X and 3 others`.
    fn who(&self, ends: &[TopicEnd]) -> String {
        let first = ends.first().map_or("", |end| self.assembly.components[end.component()].path.as_str());
        match ends.len() {
            0 | 1 => format!("component {}", quoted(first)),
            2 => format!("component {} and another one", quoted(first)),
            count => format!("component {} and {} others", quoted(first), count - 1),
        }
    }

    /// The same with what they do: `component X reads`, or `component X and 3 others read`.
    fn who_does(&self, ends: &[TopicEnd], does: &str) -> String {
        let does = match (ends.len(), does) {
            (0 | 1, does) => does,
            (_, "reads") => "read",
            _ => "publish",
        };
        format!("{} {does}", self.who(ends))
    }

    /// The topic that those who use this one meant by a `topicRename`: of the same messages, with nearly its name,
    /// which is the one that it has without renaming. Names that only add something to another one, or differ in their
    /// numbers, keep parts of a fleet apart.
    fn missed<'t>(&self, topic: &TrafficTopic, similar: &mut Similar<'t>) -> Option<&'t TrafficTopic> {
        if topic.writers.is_empty() || topic.readers.is_empty() || !topic.ends().all(|end| self.is_renamed(end, topic))
        {
            return None;
        }
        let name = Name::of(&topic.name);
        similar.nearest(topic, |other| !other.is_renamed && !other.is_apart(&name))
    }

    fn is_renamed(&self, end: &TopicEnd, topic: &TrafficTopic) -> bool {
        self.renamed(end, topic).is_some()
    }

    /// The pair of `topicRename` from which a component has the name of a topic.
    fn renamed(&self, end: &TopicEnd, topic: &TrafficTopic) -> Option<&Renamed> {
        let site = &self.assembly.components[end.component()].site;
        self.places[end.component()].renamed.iter().find(|one| on_bus(site, &one.new) == topic.name)
    }

    /// The name of a topic as the `topicRename` of a component has it.
    fn local<'t>(&self, end: &TopicEnd, topic: &'t TrafficTopic) -> Cow<'t, str> {
        let site = &self.assembly.components[end.component()].site;
        match topic.name.strip_prefix(site.as_str()).and_then(|rest| rest.strip_prefix('/')) {
            _ if site.is_empty() => topic.name.as_str().into(),
            Some(inside) => inside.into(),
            None => format!("/{}", topic.name).into(),
        }
    }

    fn alone(&self, topic: &TrafficTopic, meant: &TrafficTopic, report: &mut Report<'_>) {
        let (Some(end), Some(other)) = (topic.writers.first(), meant.ends().next()) else { return };
        let mut users: Vec<TopicEnd> = topic.ends().copied().collect();
        users.sort_by_key(|end| end.component());
        users.dedup_by_key(|end| end.component());
        let hear = match users.len() {
            1 => "receives only its own messages",
            _ => "receive only their own messages",
        };
        let message =
            format!("{} {hear} on topic {}: others use {}", self.who(&users), quoted(&topic.name), quoted(&meant.name));
        let one = Diagnostic::new(&codes::TOPIC_NEAR, self.at(end, topic), message)
            .label(self.at(other, meant), format!("uses {}", quoted(&meant.name)));
        report.push(one.help("correct `topicRename`: remove a pair, or change its new name"));
    }

    fn near(&self, lone: &TrafficTopic, meant: &TrafficTopic, report: &mut Report<'_>) {
        let (does, ends, others, do_not) = match lone.writers.is_empty() {
            true => ("reads", &lone.readers, &meant.writers, "publishes"),
            false => ("publishes", &lone.writers, &meant.readers, "reads"),
        };
        let (Some(end), Some(other)) = (ends.first(), others.first()) else { return };
        let message = format!(
            "{} topic {}, which no component {do_not}: there is {}",
            self.who_does(ends, does),
            quoted(&lone.name),
            quoted(&meant.name)
        );
        let at = self.at(end, lone);
        let one = Diagnostic::new(&codes::TOPIC_NEAR, at, message)
            .label(self.at(other, meant), format!("{do_not} {}", quoted(&meant.name)));
        report.push(match self.is_renamed(end, lone) {
            true => one.replace(&self.local(end, lone), at, &self.local(end, meant)),
            false => one.help("connect the two topics with `topicRename`"),
        });
    }

    /// Reports a topic without writers or without readers.
    fn lone(&self, topic: &TrafficTopic, report: &mut Report<'_>) {
        let (code, does, ends, missing): (&'static Code, _, _, _) = match topic.writers.is_empty() {
            true => (&codes::TOPIC_UNWRITTEN, "reads", &topic.readers, "publishes"),
            false => (&codes::TOPIC_UNREAD, "publishes", &topic.writers, "reads"),
        };
        let Some(end) = ends.first() else { return };
        // Programs that are no part of the fleet are the other end.
        let url = |end: &TopicEnd| self.assembly.components[end.component()].url();
        if ends.iter().any(|end| url(end).is_some_and(is_of_topics)) {
            return;
        }
        let message =
            format!("{} topic {}, which no component {missing}", self.who_does(ends, does), quoted(&topic.name));
        let one = Diagnostic::new(code, self.at(end, topic), message);
        report.push(one.help(format!("it is {} of {}", described(topic.kind), quoted(&topic.message))));
    }

    /// Compares how often a topic is written and read.
    fn rates(&self, topic: &TrafficTopic, report: &mut Report<'_>) {
        let fastest = topic.writers.iter().filter_map(|writer| writer.period()).min();
        let pace = topic.pace();
        let parts: u64 = topic.writers.iter().map(|writer| u64::from(writer.parts)).sum();
        // Those of one period, and of these those that lose messages with one queue: each is reported once, since a
        // fleet of robots says the same.
        let mut alike: HashMap<Duration, Vec<TopicEnd>> = HashMap::new();
        let mut queues: HashMap<(Duration, usize), Vec<TopicEnd>> = HashMap::new();
        let default = TaskProperties::default_queue(topic.writers.len() + topic.readers.len());
        let losing = |reader: &TopicEnd| {
            let task = self.assembly.components[reader.component()].task.as_ref()?;
            (topic.kind == TopicKind::Event && task.loss == Loss::Fail).then(|| task.queue.unwrap_or(default))
        };
        for reader in &topic.readers {
            let Some(period) = reader.period() else { continue };
            alike.entry(period).or_default().push(*reader);
            if let Some(queue) = losing(reader) {
                queues.entry((period, queue)).or_default().push(*reader);
            }
        }
        for reader in &topic.readers {
            let Some(period) = reader.period() else { continue };
            let queue = losing(reader);
            let at = self.places[reader.component()].queue.unwrap_or(self.at(reader, topic));
            if let Some(queue) = queue.filter(|queue| pace.exceeds(period, *queue as u64))
                && let Some(readers) = queues.remove(&(period, queue))
                && !report.diagnostics().skip(&codes::QUEUE, codes::QUEUE.severity, at)
            {
                let burst = pace.burst(period);
                let message = format!(
                    "up to {burst} messages of topic {} can arrive between two executions of {}, and the queue holds {}",
                    quoted(&topic.name),
                    self.who(&readers),
                    queue
                );
                let in_all = match parts == topic.writers.len() as u64 {
                    true => String::new(),
                    false => format!(", {parts} components and loops in all"),
                };
                let writers = self.who_does(&topic.writers, "publishes");
                let one = Diagnostic::new(&codes::QUEUE, at, message).help(format!(
                    "{writers} it{in_all}: this is the case if each sends one message per execution; usually there \
                    are fewer"
                ));
                report.push(one.help(format!(
                    "if a run reports lost messages, give the readers a `queue` of {burst}, or a shorter `period`"
                )));
            }
            if let Some(fastest) = fastest.filter(|fastest| period < *fastest)
                && let Some(readers) = alike.remove(&period)
            {
                let message = format!(
                    "{} topic {} every {}, but no component publishes it more often than every {}",
                    self.who_does(&readers, "reads"),
                    quoted(&topic.name),
                    format_duration(period),
                    format_duration(fastest)
                );
                let one = Diagnostic::new(&codes::READER_FASTER, self.at(reader, topic), message);
                report.push(one.help("some of its executions receive nothing new"));
            }
        }
    }
}

/// The topic that the name of a lone one probably stands for: of the same messages, with the end that the lone one
/// lacks.
fn meant<'t>(lone: &TrafficTopic, similar: &mut Similar<'t>) -> Option<&'t TrafficTopic> {
    similar.nearest(lone, |other| match lone.writers.is_empty() {
        true => !other.topic.writers.is_empty(),
        false => !other.topic.readers.is_empty(),
    })
}

/// The topic that a component has left that uses this one alone and hears only itself: of the same messages, with
/// nearly its name, and used by several others.
fn left<'t>(topic: &TrafficTopic, similar: &mut Similar<'t>) -> Option<&'t TrafficTopic> {
    let only = topic.writers.first()?.component();
    if topic.readers.is_empty() || topic.ends().any(|end| end.component() != only) {
        return None;
    }
    let name = Name::of(&topic.name);
    similar.nearest(topic, |other| {
        if other.has_other_numbers(&name) {
            return false;
        }
        let mut others = other.topic.ends().map(|end| end.component()).filter(|other| *other != only);
        let first = others.next();
        others.any(|other| Some(other) != first)
    })
}
