//! The wiring report of `saoms check --wiring`: every topic with its writers and readers, and what a stop reaches.

use std::collections::HashMap;
use std::fmt;
use std::time::Duration;

use saoms_api::host::{format_duration, one_line};
use saoms_lang::assembly::{Assembly, TopicEnd, Traffic, TrafficTopic};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use super::stops::{StopReport, stopped};

/// Components of one class that use a topic in the same way.
struct Group<'a> {
    class: &'a str,
    period: Option<Duration>,
    parts: u32,
    paths: Vec<&'a str>,
}

fn groups<'a>(ends: &[TopicEnd], assembly: &'a Assembly) -> Vec<Group<'a>> {
    let mut all: Vec<Group<'a>> = Vec::new();
    let mut places: HashMap<(&str, Option<Duration>, u32), usize> = HashMap::new();
    for end in ends {
        let component = &assembly.components[end.component()];
        let class = component.class.name();
        let place = *places.entry((class, end.period(), end.parts)).or_insert(all.len());
        if place == all.len() {
            all.push(Group { class, period: end.period(), parts: end.parts, paths: Vec::new() });
        }
        all[place].paths.push(&component.path);
    }
    all
}

/// The report about a fleet: text for people, and data for machines. It is made while it is written, as it can be
/// larger than the fleet.
pub(crate) struct Wiring<'a>(pub(crate) &'a Assembly);

impl fmt::Display for Wiring<'_> {
    /// The topics one below the other.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let traffic = Traffic::of(self.0);
        if traffic.topics.is_empty() {
            return write!(out, "no topics\n\n{}", StopReport(self.0));
        }
        for topic in &traffic.topics {
            write!(out, "{}  {} topic of {}", one_line(&topic.name), topic.kind.name(), topic.message)?;
            if !topic.writers.is_empty() {
                write!(out, ", {} messages/s if each execution sends one", rate(topic))?;
            }
            writeln!(out)?;
            for (does, ends) in [("published by", &topic.writers), ("read by", &topic.readers)] {
                let groups = groups(ends, self.0);
                if groups.is_empty() {
                    writeln!(out, "  {does} no component")?;
                }
                for group in &groups {
                    writeln!(out, "  {does} {group}")?;
                }
            }
        }
        write!(out, "\n{}", StopReport(self.0))
    }
}

impl fmt::Display for Group<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let every = self.period.map_or_else(String::new, |period| format!(" every {}", format_duration(period)));
        match self.paths[..] {
            [only] => write!(out, "{} ({}{every})", one_line(only), self.class),
            [first, .., last] => {
                let (first, last) = (one_line(first), one_line(last));
                write!(out, "{} of {}{every}: {first} to {last}", self.paths.len(), self.class)
            }
            [] => Ok(()),
        }
    }
}

/// The rate, with as many digits as are significant.
fn rate(topic: &TrafficTopic) -> String {
    let rate = topic.rate();
    if rate < 10.0 { format!("{}", (rate * 10.0).round() / 10.0) } else { format!("{rate:.0}") }
}

impl Serialize for Wiring<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        /// A topic in the JSON report.
        #[derive(Serialize)]
        struct Row<'a> {
            kind: &'static str,
            message: &'a str,
            messages_per_second: f64,
            name: &'a str,
            readers: Vec<Group<'a>>,
            writers: Vec<Group<'a>>,
        }
        struct Rows<'a>(&'a Traffic, &'a Assembly);
        impl Serialize for Rows<'_> {
            fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                let Rows(traffic, assembly) = *self;
                to.collect_seq(traffic.topics.iter().map(|topic| Row {
                    kind: topic.kind.name(),
                    message: &topic.message,
                    messages_per_second: topic.rate(),
                    name: &topic.name,
                    readers: groups(&topic.readers, assembly),
                    writers: groups(&topic.writers, assembly),
                }))
            }
        }
        let mut object = to.serialize_map(Some(2))?;
        object.serialize_entry("emergency_stop", &stopped(self.0))?;
        object.serialize_entry("topics", &Rows(&Traffic::of(self.0), self.0))?;
        object.end()
    }
}

impl Serialize for Group<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let period = self.period.map(|period| u64::try_from(period.as_micros()).unwrap_or(u64::MAX));
        let mut object = to.serialize_map(Some(4))?;
        object.serialize_entry("class", self.class)?;
        object.serialize_entry("components", &self.paths)?;
        object.serialize_entry("messages_per_execution", &self.parts)?;
        object.serialize_entry("period_us", &period)?;
        object.end()
    }
}
