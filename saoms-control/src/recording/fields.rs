//! What fields of a recording hold that each page shows: those of the fleet and of its components. What components say
//! of themselves, and messages, may be anything.

use super::COUNTED;

/// Kinds of values. Each field may also hold nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FieldKind {
    /// A text.
    Text,
    /// A number.
    Number,
    /// True or false.
    Truth,
    /// A list of texts.
    Texts,
    /// Any value.
    Any,
}

impl FieldKind {
    /// The kind of a field of the fleet; `None` where it has no such field.
    pub(super) fn of_fleet(names: &[String]) -> Option<FieldKind> {
        match names {
            [name] if name == "summaries" => Some(FieldKind::Texts),
            [name] if name == "paused" => Some(FieldKind::Truth),
            _ => None,
        }
    }

    /// The same of a component.
    pub(super) fn of_component(names: &[String]) -> Option<FieldKind> {
        match names {
            [name] if ["class", "site", "state", "waits_for"].contains(&name.as_str()) => Some(FieldKind::Text),
            [name] if name == "emergency_stop" => Some(FieldKind::Truth),
            [name] if name == "period_ms" || COUNTED.contains(&name.as_str()) => Some(FieldKind::Number),
            [name, _] if name == "late_us" => Some(FieldKind::Number),
            [name, _] if name == "values" => Some(FieldKind::Any),
            _ => None,
        }
    }

    /// True if a value is of this kind, as JSON.
    pub(super) fn fits(self, json: &str) -> bool {
        json == "null"
            || match self {
                FieldKind::Text => json.starts_with('"'),
                FieldKind::Number => json.starts_with(|first: char| first == '-' || first.is_ascii_digit()),
                FieldKind::Truth => json == "true" || json == "false",
                FieldKind::Texts => serde_json::from_str::<Vec<String>>(json).is_ok(),
                FieldKind::Any => true,
            }
    }

    /// What is expected, in words.
    pub(super) fn expected(self) -> &'static str {
        match self {
            FieldKind::Text => "a text",
            FieldKind::Number => "a number",
            FieldKind::Truth => "true or false",
            FieldKind::Texts => "a list of texts",
            FieldKind::Any => "a value",
        }
    }
}
