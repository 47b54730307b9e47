//! Types of topics: two ends of one topic have to agree.

use std::collections::{HashMap, HashSet};

use saoms_api::host::TopicKind;
use smol_str::SmolStr;

use crate::assembly::on_bus;
use crate::check::fleet::Member;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::properties::findings::Renamed;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::registry::ClassTopic;
use crate::source::Location;

/// The topics of a fleet by the names they have after renaming.
#[derive(Default)]
pub(crate) struct Topics<'a> {
    ends: HashMap<String, End<'a>>,
    /// By site, the classes whose topics were added under their own names: one component speaks for all others of its
    /// class.
    plain: HashSet<(SmolStr, usize)>,
}

/// The component that uses a topic first.
#[derive(Clone, Copy)]
struct End<'a> {
    component: &'a str,
    place: Location,
    declaration: &'a ClassTopic,
    verb: &'static str,
}

impl<'a> Topics<'a> {
    /// Adds the topics of a component.
    pub(crate) fn add(
        &mut self,
        member: &'a Member<'_>,
        (index, class): (usize, &ClassIndex<'a>),
        renamed: &[Renamed],
        report: &mut Report<'_>,
    ) {
        if renamed.is_empty() && !self.plain.insert((member.site.clone(), index)) {
            return;
        }
        let published = class.publishes.iter().map(|topic| ("publishes", *topic));
        // What is published as well has been held against the others once.
        let subscribed = class.subscribes.iter().copied().filter(|topic| !class.publishes.contains(topic));
        let subscribed = subscribed.map(|topic| ("subscribes to", topic));
        for (verb, topic) in published.chain(subscribed) {
            let renamed = renamed.iter().find(|one| *one.old == *topic.name);
            let name = on_bus(&member.site, renamed.map_or(&topic.name, |renamed| &renamed.new));
            let place = renamed.map_or(member.component.name.location, |renamed| renamed.new.location);
            let end = End { component: member.path(), place, declaration: topic, verb };
            match self.ends.get(&*name) {
                None => _ = self.ends.insert(name.into_owned(), end),
                Some(first) => compare(&name, first, &end, report),
            }
        }
    }
}

/// A topic of a kind, for messages.
pub(crate) const fn described(kind: TopicKind) -> &'static str {
    match kind {
        TopicKind::State => "a state topic",
        TopicKind::Event => "an event topic",
    }
}

fn compare(name: &str, first: &End<'_>, second: &End<'_>, report: &mut Report<'_>) {
    let (one, other) = (first.declaration, second.declaration);
    let difference = if std::ptr::eq(one, other) {
        return;
    } else if one.kind != other.kind {
        (described(one.kind).to_owned(), described(other.kind).to_owned())
    } else if one.message != other.message {
        (quoted(&one.message), quoted(&other.message))
    } else if one.schema != other.schema {
        (format!("{} with other fields", quoted(&one.message)), quoted(&other.message))
    } else {
        return;
    };
    let message = format!(
        "component {} {} topic {} as {}, and {} as {}",
        quoted(second.component),
        second.verb,
        quoted(name),
        difference.1,
        match first.component == second.component {
            true => "itself".to_owned(),
            false => format!("component {}", quoted(first.component)),
        },
        difference.0
    );
    let does = first.verb.trim_end_matches(" to");
    let one = Diagnostic::new(&codes::TOPIC_MISMATCH, second.place, message);
    report.push(one.label(first.place, format!("{does} it as {}", difference.0)).help(
        "a topic has one kind and one type of messages for all components; give one of them another topic with \
        `topicRename`",
    ));
}
