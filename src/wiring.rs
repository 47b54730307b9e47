//! The wiring report of `saoms check --wiring`: every topic with its writers and readers.

use std::collections::HashMap;
use std::time::Duration;

use saoms_api::format_duration;
use saoms_core::assembly::{Assembly, End, Topic, Traffic};
use serde_json::{Value, json};

/// Components of one class that use a topic alike.
struct Group<'a> {
    class: &'a str,
    period: Option<Duration>,
    parts: u32,
    paths: Vec<&'a str>,
}

fn groups<'a>(ends: &[End], assembly: &'a Assembly) -> Vec<Group<'a>> {
    let mut all: Vec<Group<'a>> = Vec::new();
    let mut places: HashMap<(&str, Option<Duration>, u32), usize> = HashMap::new();
    for end in ends {
        let component = &assembly.components[end.component];
        let class = component.class.name();
        let place = *places.entry((class, end.period, end.parts)).or_insert(all.len());
        if place == all.len() {
            all.push(Group { class, period: end.period, parts: end.parts, paths: Vec::new() });
        }
        all[place].paths.push(&component.path);
    }
    all
}

/// The topics for people, one below the other.
pub(crate) fn text(assembly: &Assembly) -> String {
    let traffic = Traffic::of(assembly);
    let mut out = String::new();
    for topic in &traffic.topics {
        out += &format!("{}  {} topic of {}", topic.name, topic.kind.name(), topic.message);
        if !topic.writers.is_empty() {
            out += &format!(", {} messages/s at one an execution", rate(topic));
        }
        out += "\n";
        for (does, ends) in [("published by", &topic.writers), ("read by", &topic.readers)] {
            let groups = groups(ends, assembly);
            if groups.is_empty() {
                out += &format!("  {does} nobody\n");
            }
            for group in &groups {
                out += &format!("  {does} {}\n", shown(group));
            }
        }
    }
    match out.is_empty() {
        true => "no topics\n\n".to_owned(),
        false => out + "\n",
    }
}

fn shown(group: &Group<'_>) -> String {
    let every = group.period.map_or_else(String::new, |period| format!(" every {}", format_duration(period)));
    match group.paths[..] {
        [only] => format!("{only} ({}{every})", group.class),
        [first, .., last] => format!("{} of {}{every}: {first} to {last}", group.paths.len(), group.class),
        [] => String::new(),
    }
}

/// With as many digits as matter.
fn rate(topic: &Topic) -> String {
    let rate = topic.rate();
    if rate < 10.0 { format!("{}", (rate * 10.0).round() / 10.0) } else { format!("{rate:.0}") }
}

/// The topics for machines.
pub(crate) fn value(assembly: &Assembly) -> Value {
    let ends = |ends: &[End]| -> Vec<Value> {
        let group = |group: Group<'_>| {
            json!({
                "class": group.class,
                "period_us": group.period.map(|period| u64::try_from(period.as_micros()).unwrap_or(u64::MAX)),
                "messages_per_execution": group.parts,
                "components": group.paths,
            })
        };
        groups(ends, assembly).into_iter().map(group).collect()
    };
    let topic = |topic: &Topic| {
        json!({
            "name": topic.name,
            "kind": topic.kind.name(),
            "message": topic.message,
            "messages_per_second": topic.rate(),
            "writers": ends(&topic.writers),
            "readers": ends(&topic.readers),
        })
    };
    json!({ "topics": Traffic::of(assembly).topics.iter().map(topic).collect::<Vec<_>>() })
}
