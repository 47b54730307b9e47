//! Contradictions within a declaration.
//!
//! The derives exclude most of them; a declaration written by hand, as that of a plugin in C, can have all.

use saoms_api::event::{ORDERS, is_event_name};
use saoms_api::host::{RESERVED, TopicKind};
use std::collections::HashSet;

use saoms_api::host::declaration::PropertyKind;

use super::{ClassDeclaration, ClassTopic, DeclaredEntry, LoopDeclaration, PropertyDeclaration, TakenEvent, simple};
use crate::schema::Schema;

/// The first contradiction.
pub(super) fn class(class: &ClassDeclaration) -> Result<(), String> {
    if class.name.trim().is_empty() {
        return Err("the class has no name".to_owned());
    }
    properties(&class.properties)?;
    if let Some(taken) = class.properties.iter().find(|one| class.is_periodic() && RESERVED.contains(&&*one.name)) {
        return Err(format!(
            "property `{}` has a name that is reserved for the task of a periodic component: give it another one",
            taken.name
        ));
    }
    unique("service", class.services.iter().map(|service| service.name.as_str()))?;
    unique("reference", class.references.iter().map(|reference| reference.name.as_str()))?;
    unique("published topic", class.publishes.iter().map(|topic| topic.name.as_str()))?;
    unique("subscribed topic", class.subscribes.iter().map(|topic| topic.name.as_str()))?;
    schemas(class.publishes.iter().chain(&class.subscribes))?;
    events(class)?;
    loops(class)?;
    for alias in &class.also {
        if alias.name.trim().is_empty() {
            return Err("an alternative name is empty".to_owned());
        }
        for (name, value) in &alias.preset {
            let Some(property) = class.property(name) else {
                return Err(format!("`{}` presets `{name}`, which is not a property", alias.name));
            };
            let checked = property.check(value).map(|_| ());
            checked.map_err(|message| format!("`{}` presets `{name}`: {message}", alias.name))?;
        }
    }
    Ok(())
}

/// Checks the events that it takes.
fn events(class: &ClassDeclaration) -> Result<(), String> {
    unique("event under `takes`", class.takes.iter().map(|taken| taken.event.as_str()))?;
    for TakenEvent { event, topic, .. } in &class.takes {
        if !is_event_name(event) {
            return Err(format!("the event `{event}` needs a letter, then letters, digits, `_` and `-` as its name"));
        }
        if ORDERS.contains(&event.as_str()) {
            return Err(format!(
                "the event `{event}` has the name of an order to a running fleet: give it another name"
            ));
        }
        let Some(found) = class.subscribes.iter().find(|known| known.name == *topic) else {
            return Err(format!(
                "the event `{event}` comes by the topic `{topic}`, to which the class does not subscribe"
            ));
        };
        if found.kind != TopicKind::Event {
            return Err(format!("the event `{event}` needs an event topic, but `{topic}` is a state topic"));
        }
    }
    Ok(())
}

/// Checks the entries and the loops that are named.
fn loops(class: &ClassDeclaration) -> Result<(), String> {
    match &class.knowledge {
        Some(knowledge) => entries(&knowledge.entries)?,
        None if class.loops.all().any(|(_, list)| !list.is_empty()) => {
            return Err("the class has loops but no knowledge".to_owned());
        }
        None => {}
    }
    if let Some(name) = &class.loops.property {
        let Some(property) = class.property(name) else {
            return Err(format!("its loops are chosen by `{name}`, which is not a property"));
        };
        if let Some(value) = class.loops.lists.keys().find(|value| property.check(*value).is_err()) {
            return Err(format!("its loops are chosen by `{name}`, which cannot be `{value}`"));
        }
    }
    class.loops.all().try_for_each(|(_, list)| unique("loop", list.iter().map(|name| simple(name))))
}

/// The first contradiction in the declaration of a loop.
pub(super) fn looping(one: &LoopDeclaration) -> Result<(), String> {
    if one.short_name().trim().is_empty() {
        return Err("the loop has no name".to_owned());
    }
    properties(&one.properties)?;
    entries(&one.entries)?;
    unique("reference", one.references.iter().map(|reference| reference.name.as_str()))?;
    unique("published topic", one.publishes.iter().map(|topic| topic.name.as_str()))?;
    unique("subscribed topic", one.subscribes.iter().map(|topic| topic.name.as_str()))?;
    schemas(one.publishes.iter().chain(&one.subscribes))?;
    unique("entry under `senses`", one.senses.iter().map(String::as_str))?;
    unique("entry under `effects`", one.effects.iter().map(String::as_str))
}

/// Checks the types of messages.
fn schemas<'a>(mut topics: impl Iterator<Item = &'a ClassTopic>) -> Result<(), String> {
    topics.try_for_each(|topic| {
        Schema::of(&topic.schema).map_err(|error| format!("the schema of topic `{}`: {error}", topic.name))?;
        let speakers = topic.speakers.iter().try_for_each(|one| one.check(&topic.schema));
        speakers.map_err(|error| format!("topic `{}`: {error}", topic.name))
    })
}

fn entries(all: &[DeclaredEntry]) -> Result<(), String> {
    unique("entry", all.iter().map(|entry| entry.name.as_str()))
}

fn properties(all: &[PropertyDeclaration]) -> Result<(), String> {
    unique("property", all.iter().map(|property| property.name.as_str()))?;
    for property in all {
        let name = &property.name;
        if (property.kind == PropertyKind::Complex) == property.properties.is_empty() {
            return Err(format!("property `{name}` of type {} has the wrong inner properties", property.kind.name()));
        }
        if property.speaker && (property.many || !matches!(property.kind, PropertyKind::Integer | PropertyKind::String))
        {
            return Err(format!("property `{name}` cannot be `speaker`: it is neither one integer nor one text"));
        }
        if let Some(default) = &property.default {
            property.check(default).map_err(|message| format!("the default of property `{name}`: {message}"))?;
        }
        for bound in [&property.min, &property.max, &property.exclusive_max].into_iter().flatten() {
            if saoms_api::host::declaration::parse_scalar(property.kind, &bound.into()).is_none() {
                return Err(format!("the bound `{bound}` of property `{name}` is not a {}", property.kind.name()));
            }
        }
        if let Some(min) = &property.min {
            property.check(min).map_err(|message| format!("property `{name}` can have no value: {message}"))?;
        }
        properties(&property.properties)?;
    }
    Ok(())
}

fn unique<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Result<(), String> {
    let mut seen = HashSet::new();
    for name in names {
        if name.is_empty() {
            return Err(format!("a {what} has no name"));
        }
        if !seen.insert(name) {
            return Err(format!("{what} `{name}` is declared twice"));
        }
    }
    Ok(())
}
