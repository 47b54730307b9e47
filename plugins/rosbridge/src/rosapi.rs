//! The services by which clients ask what topics there are: those of `rosapi` that need no more than these.

use serde_json::{Value, json};

use crate::op::bare;
use crate::session::Topics;

/// The answer to a call; `None` where there is no such service.
pub(crate) fn answer(topics: &Topics, service: &str, arguments: &Value) -> Option<Value> {
    let all = || topics.all.iter().map(|(name, known)| (format!("/{name}"), known.form.kind.clone()));
    match bare(service) {
        "rosapi/topics" => {
            let (names, types): (Vec<String>, Vec<String>) = all().unzip();
            Some(json!({"topics": names, "types": types}))
        }
        "rosapi/topic_type" => {
            let wanted = arguments["topic"].as_str().map(bare).unwrap_or_default();
            let kind = topics.all.get(wanted).map(|known| known.form.kind.as_str());
            Some(json!({"type": kind.unwrap_or_default()}))
        }
        "rosapi/topics_for_type" => {
            let wanted = arguments["type"].as_str().unwrap_or_default();
            let names = topics.all.iter().filter(|(_, known)| known.form.is_named(wanted));
            Some(json!({"topics": names.map(|(name, _)| format!("/{name}")).collect::<Vec<_>>()}))
        }
        _ => None,
    }
}
