//! The events that are known, and what a line with one of them has to be.

use std::cmp::Ordering;

use super::{Argument, EventCall, EventField, FieldValue, Word};
use crate::extension::LineFault;
use crate::host::declaration::Scalar;
use crate::rule::nearest;

/// An event that a class takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Its name.
    pub name: String,
    /// Its meaning.
    pub doc: String,
    /// Its fields, those of its message.
    pub fields: Vec<EventField>,
    /// The classes that take it.
    pub classes: Vec<String>,
}

/// Events by their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Events {
    all: Vec<Event>,
}

/// The order that a component gives itself by [`Context::unschedule`](crate::Context::unschedule).
pub const STOP: &str = "stop";

/// The words of orders to a running fleet, such as `start` in `saoms start`: no event has one of them as its name.
pub const ORDERS: [&str; 7] = ["start", STOP, "set", "call", "publish", "estop", "release"];

/// True if an event can have this name: a letter, then letters, digits, `_` and `-`.
pub const fn is_event_name(name: &str) -> bool {
    let bytes = name.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        let fits = match bytes[at] {
            byte if byte.is_ascii_alphabetic() => true,
            byte => at > 0 && (byte.is_ascii_digit() || byte == b'_' || byte == b'-'),
        };
        if !fits {
            return false;
        }
        at += 1;
    }
    !bytes.is_empty()
}

impl Event {
    /// A line with this event, as an example: `fire at=(1,1) size=1`.
    pub fn sample(&self) -> String {
        let fields = self.fields.iter().filter(|field| !field.of.is_optional());
        let fields = fields.map(|field| format!(" {}={}", field.name, field.of.sample()));
        format!("{}{}", self.name, fields.collect::<String>())
    }

    /// Its meaning, its fields and the classes that take it, in Markdown.
    pub fn described(&self) -> String {
        let mut text = format!("`{}`: {}", self.sample(), self.doc);
        for EventField { name, of, .. } in &self.fields {
            let optional = if of.is_optional() { ", optional" } else { "" };
            text.push_str(&format!("\n- `{name}`: {}{optional}", of.expected()));
        }
        let classes: Vec<String> = self.classes.iter().map(|class| format!("`{class}`")).collect();
        text + &format!("\n\nTaken by {}.", classes.join(", "))
    }

    /// Judges the fields of an event of this name.
    ///
    /// # Errors
    /// A field is unknown, missing or has a wrong value: at its place.
    pub fn check(&self, call: &EventCall) -> Result<(), LineFault> {
        for one in &call.arguments {
            let names = || self.fields.iter().map(|field| field.name.as_str());
            let Some(field) = self.fields.iter().find(|field| field.name == one.name.text) else {
                let message = format!("event `{}` has no field `{}`", self.name, one.name.text);
                let listed = names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
                let fault = LineFault::new(one.name.bytes.clone(), message);
                // A field that is there already is not meant once more.
                let is_given = |name: &str| call.arguments.iter().any(|one| one.name.text == name);
                return Err(match nearest(&one.name.text, names().filter(|name| !is_given(name))) {
                    Some(meant) => fault.instead(meant),
                    None if listed.is_empty() => fault.help("remove it: the event has no fields"),
                    None => fault.help(format!("its fields are {listed}")),
                });
            };
            check_value(field, one)?;
        }
        let is_given = |field: &&EventField| call.arguments.iter().any(|one| one.name.text == field.name);
        let missing = self.fields.iter().filter(|field| !field.of.is_optional());
        let missing: Vec<&EventField> = missing.filter(|field| !is_given(field)).collect();
        if missing.is_empty() {
            return Ok(());
        }
        let names: Vec<String> = missing.iter().map(|field| format!("`{}`", field.name)).collect();
        let message = format!("event `{}` needs its fields: {} missing", self.name, are(&names));
        let samples: Vec<String> =
            missing.iter().map(|field| format!("`{}={}`", field.name, field.of.sample())).collect();
        let fault = LineFault::new(call.name.bytes.clone(), message);
        Err(fault.help(format!("add {}, with {}", samples.join(" and "), expectations(&missing))))
    }
}

/// `a` is, `a` and `b` are.
fn are(names: &[String]) -> String {
    match names {
        [one] => format!("{one} is"),
        many => format!("{} are", many.join(" and ")),
    }
}

fn expectations(fields: &[&EventField]) -> String {
    let one = |field: &&EventField| format!("{} for `{}`", field.of.expected(), field.name);
    fields.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Judges the value of a field, or both ends of its range.
fn check_value(field: &EventField, one: &Argument) -> Result<(), LineFault> {
    let ends = one.ends();
    if ends.len() > 1 && !field.of.has_ranges() {
        let message = format!(
            "field `{}`: found the range `{}`, expected one value: {}",
            field.name,
            one.value.text,
            field.of.expected()
        );
        return Err(LineFault::new(one.value.bytes.clone(), message));
    }
    if let [first, last] = &ends[..]
        && last.bytes.start == first.bytes.end + 2
        && last.text.starts_with('.')
    {
        // `.4` behind them is a number, too, but not the one that is meant.
        let meant = last.text.trim_start_matches('.');
        let found = &one.value.text;
        let message = format!("field `{}`: found `{found}`, expected `..` between the two ends of a range", field.name);
        return Err(LineFault::new(one.value.bytes.clone(), message).instead(format!("{}..{meant}", first.text)));
    }
    let mut values = Vec::new();
    for end in &ends {
        match field.of.read(&end.text) {
            Ok(value) => values.push(value),
            Err(error) => return Err(wrong_value(field, end, &error)),
        }
    }
    let is_real = values.iter().all(|value| matches!(value, FieldValue::Scalar(Scalar::Float(_))));
    if let [least, most] = &ends[..]
        && is_real
        && ends.iter().all(|end| end.text.parse::<i64>().is_ok())
    {
        let message = format!("field `{}`: found a range of whole numbers, expected real numbers", field.name);
        let fault = LineFault::new(one.value.bytes.clone(), message);
        return Err(fault.instead(format!("{}.0..{}.0", least.text, most.text)));
    }
    if let [least, most] = &values[..]
        && let Some(Ordering::Greater) = least.order(most)
    {
        let message = format!("field `{}`: found `{}`, expected the smaller value first", field.name, one.value.text);
        let fault = LineFault::new(one.value.bytes.clone(), message);
        return Err(fault.instead(format!("{}..{}", ends[1].text, ends[0].text)));
    }
    Ok(())
}

fn wrong_value(field: &EventField, found: &Word, error: &str) -> LineFault {
    let fault = LineFault::new(found.bytes.clone(), format!("field `{}`: {error}", field.name));
    match nearest(&found.text, field.of.choices()) {
        Some(meant) => fault.instead(meant),
        None => fault.help(format!("write a value such as `{}={}`", field.name, field.of.sample())),
    }
}

impl Events {
    /// These events; of several with one name the first counts, and takes over the classes of those with its fields.
    pub fn of(events: impl IntoIterator<Item = Event>) -> Events {
        let mut all: Vec<Event> = Vec::new();
        for event in events {
            match all.binary_search_by(|known| known.name.cmp(&event.name)) {
                Ok(place) if all[place].fields == event.fields => {
                    let known = &mut all[place].classes;
                    known.extend(event.classes.into_iter().filter(|class| !known.contains(class)).collect::<Vec<_>>());
                }
                Ok(_) => {}
                Err(place) => all.insert(place, event),
            }
        }
        Events { all }
    }

    /// The event of this name.
    pub fn get(&self, name: &str) -> Option<&Event> {
        let place = self.all.binary_search_by(|known| known.name.as_str().cmp(name)).ok()?;
        Some(&self.all[place])
    }

    /// The event that a line has.
    ///
    /// # Errors
    /// No class takes it: its name.
    pub fn find(&self, call: &EventCall) -> Result<&Event, LineFault> {
        let name = &call.name.text;
        self.get(name).ok_or_else(|| {
            let fault = LineFault::new(call.name.bytes.clone(), format!("no class takes the event `{name}`"));
            match nearest(name, self.names()) {
                Some(meant) => fault.instead(meant),
                None => match self.all.is_empty() {
                    true => fault.help("a class takes an event where it declares it under `takes`"),
                    false => fault.help(format!("the events are {}", self.listed())),
                },
            }
        })
    }

    /// The names in words: `fire`, `flood`.
    fn listed(&self) -> String {
        self.names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    }

    /// All of them, sorted by name.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Event> {
        self.all.iter()
    }

    /// The names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|event| event.name.as_str())
    }
}
