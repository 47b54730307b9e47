//! What is wrong with a value of JSON, and where in it.

use std::fmt;

use serde_json::Value;

/// Faults of one value that are told, at most.
const MOST: usize = 20;
/// Characters of a value that a fault shows, at most.
const SHOWN: usize = 100;

/// A fault of a value of JSON.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonFault {
    /// Its place as a pointer (RFC 6901), as `/blocks/2/x`; empty for the whole value.
    pub pointer: String,
    /// What was found there, and what was expected.
    pub message: String,
    /// The place as people write it, as `blocks[2].x`; `None` where the message names it.
    shown: Option<String>,
}

/// The faults of a value of JSON, at least one.
///
/// ```
/// use saoms_registry::schema::Schema;
///
/// let block = r#"{"name":"Block","fields":[{"name":"x","type":"int8"},{"name":"y","type":"int8"}]}"#;
/// let faults = Schema::parse(block)?.encode(&serde_json::json!({"x": 200, "Y": 1})).unwrap_err();
/// let pointers: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
/// assert_eq!(pointers, ["/Y", "/x"]);
/// assert!(faults.to_string().starts_with("`Block` has no field `Y`; did you mean `y`?; field `x`: found 200"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JsonFaults {
    faults: Vec<JsonFault>,
    /// The number of those that are not told.
    more: usize,
}

/// A place in a value.
pub(super) enum At<'a> {
    Root,
    Field(&'a At<'a>, &'a str),
    Element(&'a At<'a>, usize),
}

impl At<'_> {
    fn pointer(&self) -> String {
        match self {
            At::Root => String::new(),
            At::Field(parent, name) => format!("{}/{}", parent.pointer(), name.replace('~', "~0").replace('/', "~1")),
            At::Element(parent, place) => format!("{}/{place}", parent.pointer()),
        }
    }

    fn shown(&self) -> String {
        match self {
            At::Root => String::new(),
            At::Field(At::Root, name) => (*name).to_owned(),
            At::Field(parent, name) => format!("{}.{name}", parent.shown()),
            At::Element(parent, place) => format!("{}[{place}]", parent.shown()),
        }
    }
}

impl JsonFaults {
    /// The faults, in the order of the schema.
    pub fn iter(&self) -> impl Iterator<Item = &JsonFault> {
        self.faults.iter()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// Adds a fault of a value that is of another kind than expected.
    pub(super) fn wrong(&mut self, at: &At<'_>, value: &Value, expected: &str) {
        let shown = (!matches!(at, At::Root)).then(|| at.shown());
        self.push(at, shown, || format!("found {}, expected {expected}", short(value)));
    }

    /// Adds a fault whose message says the place.
    pub(super) fn add(&mut self, at: &At<'_>, message: String) {
        self.push(at, None, || message);
    }

    fn push(&mut self, at: &At<'_>, shown: Option<String>, message: impl FnOnce() -> String) {
        if self.faults.len() == MOST {
            self.more += 1;
            return;
        }
        self.faults.push(JsonFault { pointer: at.pointer(), message: message(), shown });
    }
}

/// A value as text, of which a long one loses its end.
fn short(value: &Value) -> String {
    let mut text = value.to_string();
    if let Some((end, _)) = text.char_indices().nth(SHOWN) {
        text.truncate(end);
        text.push_str("...");
    }
    text
}

impl fmt::Display for JsonFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.shown {
            Some(shown) => write!(out, "field `{shown}`: {}", self.message),
            None => out.write_str(&self.message),
        }
    }
}

impl fmt::Display for JsonFaults {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, fault) in self.faults.iter().enumerate() {
            write!(out, "{}{fault}", if place > 0 { "; " } else { "" })?;
        }
        if self.more > 0 {
            write!(out, "; and {} more", self.more)?;
        }
        Ok(())
    }
}

impl std::error::Error for JsonFaults {}
