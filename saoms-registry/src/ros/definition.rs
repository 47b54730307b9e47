//! The definitions of a type: its own, and those of the types in it.

use std::fmt::Write;

use serde_json::{Value, json};

use super::names::{camel, type_name, words};
use super::{PACKAGE, full_name};

/// The types of a text so far, those that others need before these.
#[derive(Default)]
pub(super) struct Definitions {
    pub(super) done: Vec<Definition>,
}

/// A type.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Definition {
    /// Package and type, as `saoms_msgs/Position`.
    pub(super) name: String,
    pub(super) lines: Vec<Line>,
}

/// A line of a definition.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Line {
    Constant { kind: String, name: String, value: Value },
    Field(Field),
}

/// A field of a type.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    /// What it is, or each element of its list: `uint8`, `string<=5` or `saoms_msgs/Position`.
    pub(super) base: String,
    pub(super) list: List,
    /// True for a time of a run.
    is_time: bool,
}

/// What makes a list of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum List {
    None,
    Length(u64),
    Most(u64),
    Unbounded,
}

/// The type of a field, and its schema with the names of ROS 2.
struct Kind {
    base: String,
    list: List,
    schema: Value,
}

impl Definition {
    /// Its text.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for line in &self.lines {
            // Writing to a text does not fail.
            let _ = match line {
                Line::Constant { kind, name, value } => writeln!(text, "{kind} {name}={value}"),
                Line::Field(Field { name, base, list, is_time }) => {
                    let comment = if *is_time { "# Nanoseconds since the start of the run.\n" } else { "" };
                    let list = match list {
                        List::None => String::new(),
                        List::Length(length) => format!("[{length}]"),
                        List::Most(most) => format!("[<={most}]"),
                        List::Unbounded => "[]".to_owned(),
                    };
                    writeln!(text, "{comment}{base}{list} {name}")
                }
            };
        }
        text
    }

    /// Its fields.
    pub(super) fn fields(&self) -> impl Iterator<Item = &Field> {
        self.lines.iter().filter_map(|line| match line {
            Line::Field(field) => Some(field),
            Line::Constant { .. } => None,
        })
    }
}

impl Definitions {
    /// Adds the type of a message; its package and name, and its schema.
    pub(super) fn message(&mut self, value: &Value) -> (String, Value) {
        let name = type_name(value["name"].as_str().unwrap_or_default());
        let (mut body, mut schemas) = (Body::default(), Vec::new());
        for constant in value["constants"].as_array().into_iter().flatten() {
            let kind = constant["type"].as_str().unwrap_or_default();
            let is_plain = constant["value"].is_number() || constant["value"].is_boolean();
            if let (true, Some(name)) = (is_plain && kind != "string", constant["name"].as_str()) {
                body.constant(kind, name, &constant["value"]);
            }
        }
        for field in value["fields"].as_array().into_iter().flatten() {
            let field_name = body.field_name(field["name"].as_str().unwrap_or_default());
            let Kind { base, list, schema } = self.kind(&field["type"], (&name, &field_name), &mut body);
            schemas.push(json!({"name": field_name, "type": schema}));
            let is_time = field["type"] == "time";
            body.lines.push(Line::Field(Field { name: field_name, base, list, is_time }));
        }
        if schemas.is_empty() {
            let name = "structure_needs_at_least_one_member".to_owned();
            let (base, list) = ("uint8".to_owned(), List::None);
            body.lines.push(Line::Field(Field { name, base, list, is_time: false }));
        }
        let name = self.add(name, body.lines);
        let schema = json!({"name": full_name(&name), "fields": schemas});
        (name, schema)
    }

    /// Adds a type, unless it is there; its name, which no other one has.
    fn add(&mut self, name: String, lines: Vec<Line>) -> String {
        let mut own = name.clone();
        for number in 2_u32.. {
            match self.done.iter().position(|one| one.name == own) {
                None => break,
                Some(place) if self.done[place].lines == lines => return own,
                Some(_) => own = format!("{name}{number}"),
            }
        }
        self.done.push(Definition { name: own.clone(), lines });
        own
    }

    /// The type of a field of a message; its constants come before it.
    fn kind(&mut self, value: &Value, (of, field): (&str, &str), body: &mut Body) -> Kind {
        let plain = |base: &str, schema: Value| Kind { base: base.to_owned(), list: List::None, schema };
        if let Some(name) = value.as_str() {
            let base = if name == "time" { "uint64" } else { name };
            return plain(base, base.into());
        }
        if let Some(number) = value["enumeration"].as_str() {
            for (name, constant) in value["values"].as_object().into_iter().flatten() {
                body.constant(number, &format!("{field}_{name}"), constant);
            }
            return plain(number, number.into());
        }
        if value.get("fields").is_some() {
            let (base, schema) = self.message(value);
            return Kind { base, list: List::None, schema };
        }
        let most = value["most"].as_u64().unwrap_or_default();
        let (element, list) = match (value.get("sequence"), value.get("optional"), value.get("array")) {
            (Some(element), ..) => (element, List::Unbounded),
            (_, Some(element), _) => (element, List::Most(1)),
            (.., Some(element)) => (element, List::Length(value["length"].as_u64().unwrap_or_default())),
            _ if value["bounded"] == "string" => return plain(&format!("string<={most}"), value.clone()),
            _ => (&value["bounded"]["sequence"], List::Most(most)),
        };
        let Kind { mut base, list: inner, mut schema } = self.kind(element, (of, field), body);
        if inner != List::None {
            let (package, outer) = of.split_once('/').unwrap_or((PACKAGE, of));
            let name = format!("{package}/{outer}{}", camel(field));
            let value = Field { name: "value".to_owned(), base, list: inner, is_time: false };
            base = self.add(name, vec![Line::Field(value)]);
            schema = json!({"name": full_name(&base), "fields": [{"name": "value", "type": schema}]});
        }
        let schema = match list {
            List::Length(length) => json!({"array": schema, "length": length}),
            List::Most(most) => json!({"bounded": {"sequence": schema}, "most": most}),
            List::Unbounded | List::None => json!({"sequence": schema}),
        };
        Kind { base, list, schema }
    }
}

/// The lines of a type, and the names in it.
#[derive(Default)]
struct Body {
    lines: Vec<Line>,
    names: Vec<String>,
}

impl Body {
    fn constant(&mut self, kind: &str, name: &str, value: &Value) {
        let name = words(name).to_ascii_uppercase();
        let is_name = name.starts_with(|first: char| first.is_ascii_alphabetic());
        if is_name && !self.names.contains(&name) {
            self.names.push(name.clone());
            self.lines.push(Line::Constant { kind: kind.to_owned(), name, value: value.clone() });
        }
    }

    /// The name of a field as ROS 2 may have it.
    fn field_name(&mut self, name: &str) -> String {
        let mut found = words(name).to_ascii_lowercase();
        if !found.starts_with(|first: char| first.is_ascii_alphabetic()) {
            found = format!("field_{found}").trim_end_matches('_').to_owned();
        }
        let mut own = found.clone();
        for number in 2_u32.. {
            if !self.names.contains(&own) {
                break;
            }
            own = format!("{found}_{number}");
        }
        self.names.push(own.clone());
        own
    }
}
