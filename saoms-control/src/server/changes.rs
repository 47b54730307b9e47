//! What differs in a fleet from what a client got before: a page that shows a thousand components is not sent all of
//! them again and again.

use std::collections::HashSet;
use std::sync::Arc;

use saoms_core::observe::SentMessage;
use saoms_core::status::{ComponentStatus, FleetStatus};
use saoms_lang::schema::Schema;
use serde_json::{Map, Value, json};

use crate::content::content;

/// The parts of a component's status that are sent as soon as they differ. All others, which count, differ each time:
/// they are sent now and then.
const AT_ONCE: &[&str] = &["name", "state", "emergency_stop", "period_ms", "waits_for", "values"];

/// The status that a client got.
#[derive(Default)]
pub(super) struct StatusChanges {
    /// The last one; `None` before the first.
    last: Option<Arc<FleetStatus>>,
    /// The last one with what counts.
    counted: Option<Arc<FleetStatus>>,
}

impl StatusChanges {
    /// The fleet, with those components of which something differs, by what differs; `is_whole` also has what counts. A
    /// client that knows other components gets all, and `all` is true.
    pub(super) fn next(&mut self, status: &Arc<FleetStatus>, is_whole: bool) -> Value {
        let all = self.last.as_ref().is_none_or(|last| !names(last).eq(names(status)));
        if all {
            (self.last, self.counted) = (None, None);
        }
        let is_whole = is_whole || all;
        let mut components = Vec::new();
        for (index, one) in status.components.iter().enumerate() {
            let mut fields = at_once(one, self.last.as_ref().and_then(|last| last.components.get(index)));
            if is_whole {
                let known = self.counted.as_ref().and_then(|counted| counted.components.get(index));
                let known = known.map(object).unwrap_or_default();
                let differs = |field: &str, value: &Value| !AT_ONCE.contains(&field) && known.get(field) != Some(value);
                fields.extend(object(one).into_iter().filter(|(field, value)| differs(field, value)));
            }
            if all || !fields.is_empty() {
                fields.insert("name".to_owned(), Value::from(&*one.report.name));
                components.push(Value::Object(fields));
            }
        }
        self.last = Some(Arc::clone(status));
        if is_whole {
            self.counted = Some(Arc::clone(status));
        }
        json!({
            "time_s": status.time_s,
            "phase": status.phase,
            "paused": status.paused,
            "speed": status.speed,
            "summaries": status.summaries,
            "all": all,
            "components": components,
        })
    }
}

fn names(status: &FleetStatus) -> impl Iterator<Item = &str> {
    status.components.iter().map(|one| one.report.name.as_str())
}

fn object(component: &ComponentStatus) -> Map<String, Value> {
    match serde_json::to_value(component) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    }
}

/// The parts that are sent at once, where they differ from what the client knows.
fn at_once(one: &ComponentStatus, known: Option<&ComponentStatus>) -> Map<String, Value> {
    let mut fields = Map::new();
    let mut put = |name: &str, differs: bool, value: Value| {
        if differs {
            fields.insert(name.to_owned(), value);
        }
    };
    let differs = |is: fn(&ComponentStatus, &ComponentStatus) -> bool| known.is_none_or(|known| !is(one, known));
    put("state", differs(|a, b| a.state == b.state), json!(one.state));
    put("emergency_stop", differs(|a, b| a.emergency_stop == b.emergency_stop), json!(one.emergency_stop));
    put("period_ms", differs(|a, b| a.period_ms == b.period_ms), json!(one.period_ms));
    if differs(|a, b| a.waits_for == b.waits_for) {
        put("waits_for", true, json!(one.waits_for));
    }
    if differs(|a, b| a.values == b.values) {
        put("values", true, json!(*one.values));
    }
    fields
}

/// The messages of a state topic that a client got.
pub(super) struct RetainedChanges {
    pub(super) topic: String,
    pub(super) schema: Schema,
    /// Kept, so that no other message has the place of one of these in memory.
    known: Vec<SentMessage>,
}

impl RetainedChanges {
    pub(super) fn of(topic: String, schema: Schema) -> RetainedChanges {
        RetainedChanges { topic, schema, known: Vec::new() }
    }

    /// Those messages that the client has not got; `None` if it has all.
    pub(super) fn next(&mut self, retained: Vec<SentMessage>) -> Option<Value> {
        let place = |sent: &SentMessage| sent.message.bytes().as_ptr();
        let known: HashSet<_> = self.known.iter().map(place).collect();
        let new = retained.iter().filter(|sent| !known.contains(&place(sent)));
        let messages: Vec<Value> = new.map(|sent| message(sent, &self.schema)).collect();
        self.known = retained;
        (!messages.is_empty()).then(|| json!({"topic": self.topic, "messages": messages}))
    }
}

/// A message as clients get it. Its key and numbers that a browser does not have are texts.
fn message(sent: &SentMessage, schema: &Schema) -> Value {
    let message = content(sent, schema);
    let time = sent.message.header().sent.as_secs_f64();
    let key = sent.message.key().map(|key| key.to_string());
    json!({"time_s": time, "component": &*sent.component, "key": key, "message": message})
}

#[cfg(test)]
mod tests {
    use saoms_core::status::FleetPhase;

    use super::*;

    fn status() -> Arc<FleetStatus> {
        Arc::new(FleetStatus {
            time_s: 1.0,
            phase: FleetPhase::Running,
            paused: false,
            speed: None,
            summaries: Vec::new(),
            components: Vec::new(),
        })
    }

    #[test]
    fn a_client_gets_the_fleet_once_without_components() {
        let mut changes = StatusChanges::default();
        let first = changes.next(&status(), true);
        assert_eq!((first["all"].clone(), first["components"].clone()), (true.into(), json!([])));
        assert_eq!(changes.next(&status(), true)["all"], false);
    }
}
