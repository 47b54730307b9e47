//! Values of events that are drawn from a range.

use std::time::Duration;

use super::{Argument, EventCall};
use crate::Chance;
use crate::host::{format_duration, parse_duration};

impl EventCall {
    /// The text of the event with a value drawn from each range, both ends included. One space is between its words.
    pub fn drawn(&self, chance: &mut Chance) -> String {
        let mut text = self.name.text.clone();
        for one in &self.arguments {
            text.push_str(&format!(" {}={}", one.name.text, one.drawn(chance)));
        }
        if let Some(component) = &self.to {
            text.push_str(&format!(" to {}", component.text));
        }
        text
    }
}

impl Argument {
    fn drawn(&self, chance: &mut Chance) -> String {
        match &self.ends()[..] {
            [least, most] => between(&least.text, &most.text, chance),
            _ => self.value.text.clone(),
        }
    }
}

/// A value between two others of one type. Where they have none in common, which a check has refused, it is the first.
fn between(least: &str, most: &str, chance: &mut Chance) -> String {
    if let (Some(first), Some(last)) = (parts(least), parts(most)) {
        // Corners of an area, or of whatever the parts are.
        let parts: Vec<String> = first.iter().zip(&last).map(|(one, other)| between(one, other, chance)).collect();
        return format!("({})", parts.join(","));
    }
    if let (Ok(one), Ok(other)) = (least.parse::<i64>(), most.parse::<i64>()) {
        return chance.range(one.min(other)..=one.max(other)).to_string();
    }
    if let (Ok(one), Ok(other)) = (least.parse::<f64>(), most.parse::<f64>()) {
        return (one + (other - one) * chance.unit()).to_string();
    }
    if let (Ok(one), Ok(other)) = (parse_duration(least), parse_duration(most)) {
        let nanos = |duration: Duration| u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        let (one, other) = (nanos(one), nanos(other));
        return format_duration(Duration::from_nanos(chance.range(one.min(other)..=one.max(other))));
    }
    least.to_owned()
}

/// The parts of a group such as `(3,4)`.
fn parts(text: &str) -> Option<Vec<&str>> {
    let inner = text.strip_prefix('(')?.strip_suffix(')')?;
    Some(inner.split(',').map(str::trim).collect())
}
