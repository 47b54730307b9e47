//! What came from outside in an earlier run, from the file of `saoms run --journal`: it happens again.

use std::time::Duration;

use saoms_api::host::format_duration;
use saoms_core::schedule::{Order, is_from_outside};
use serde_json::Value;

use super::site_of;

/// True if a file that begins with these bytes is a journal.
pub(super) fn is_head(start: &[u8]) -> bool {
    let line = start.split(|byte| *byte == b'\n').next().unwrap_or_default();
    serde_json::from_slice::<Value>(line).is_ok_and(|head| head["journal"].is_number())
}

/// The line of events for a line of a journal; `None` if it says nothing that came from outside.
///
/// # Errors
/// It is no line of a journal.
pub(super) fn event(line: &str) -> Result<Option<String>, String> {
    let record: Value =
        serde_json::from_str(line).map_err(|error| format!("it is not a record of a journal: {error}"))?;
    let (Some(component), Some(text)) = (record["component"].as_str(), record["text"].as_str()) else {
        return Ok(None);
    };
    if !is_from_outside(component, record["record"].as_str()) {
        return Ok(None);
    }
    let seconds = record["time_s"].as_f64().filter(|time| *time >= 0.0);
    let seconds = seconds.ok_or("the record has no time")?;
    // Times are whole nanoseconds, which the number of seconds holds for the first hundred days.
    let time = format_duration(Duration::from_nanos((seconds * 1e9).round() as u64));
    Ok(Some(match (Order::read(text), site_of(text)) {
        (Some(_), _) | (None, ("", _)) => format!("at {time} {text}"),
        (None, (site, event)) => format!("{site}: at {time} {}", event.trim_start()),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_of_what_came_from_outside_become_lines() {
        let line = |component: &str, text: &str| {
            let record = serde_json::json!({"id": 3, "time_s": 3.000000001, "component": component, "text": text});
            event(&record.to_string()).unwrap()
        };
        assert_eq!(line("(outside)", "luggage (1,2) to (3,4)").unwrap(), "at 3000000001ns luggage (1,2) to (3,4)");
        assert_eq!(line("(outside)", "North: landing 3").unwrap(), "North: at 3000000001ns landing 3");
        assert_eq!(line("(outside)", "set A text=a: b").unwrap(), "at 3000000001ns set A text=a: b");
        assert_eq!(line("Robot7", "luggage (1,2) to (3,4)"), None);
        let change =
            r#"{"time_s": 1.0, "component": "(outside)", "record": "fleet_changed", "text": "change: 1 added (A)"}"#;
        assert_eq!(event(change), Ok(None), "a change of the fleet does not happen again");
        assert_eq!(event("{\"end\":{\"records\":3}}"), Ok(None));
        assert!(event("{\"id\":").is_err());
        assert!(is_head(b"{\"clock\":\"virtual\",\"journal\":1}\n{}") && !is_head(b"{\n  \"seed\": 1"));
    }
}
