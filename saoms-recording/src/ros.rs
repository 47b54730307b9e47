//! Schemas of messages as definitions of ROS 2 (`ros2msg`): the text of the type, and those of the types in it.
//!
//! What ROS 2 does not have, it gets in the form that has the same bytes: something optional is a list of one at most,
//! an enumeration a number with constants, a list of lists a list of messages with one field, and a message without
//! fields the field that ROS 2 gives it.

use std::fmt::Write;

use saoms_registry::schema::{Schema, SchemaError};
use serde_json::Value;

/// The package of the types that name none.
const PACKAGE: &str = "saoms_msgs";
/// The line before the text of a type in another one.
const LINE: &str = "================================================================================";

/// A message type as ROS 2 has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosType {
    /// Its name, as `saoms_msgs/msg/Position`.
    pub name: String,
    /// Its text, with those of the types in it.
    pub text: String,
}

impl RosType {
    /// The type of a schema, which is a text of a declaration.
    ///
    /// ```
    /// use saoms_recording::RosType;
    ///
    /// let schema = r#"{"name":"Lamp","fields":[{"name":"on","type":"bool"},
    ///     {"name":"note","type":{"optional":"string"}}]}"#;
    /// let lamp = RosType::of(schema)?;
    /// assert_eq!((&*lamp.name, &*lamp.text), ("saoms_msgs/msg/Lamp", "bool on\nstring[<=1] note\n"));
    /// # Ok::<(), saoms_registry::schema::SchemaError>(())
    /// ```
    ///
    /// # Errors
    /// The text is no schema.
    pub fn of(schema: &str) -> Result<RosType, SchemaError> {
        // What is no schema ends here: all that follows rests on its form.
        Schema::parse(schema)?;
        let value: Value = serde_json::from_str(schema).unwrap_or_default();
        let mut definitions = Definitions::default();
        let name = definitions.message(&value);
        let mut text = definitions.done.pop().map(|one| one.body).unwrap_or_default();
        for Definition { name, body } in definitions.done {
            // Writing to a text does not fail.
            let _ = write!(text, "{LINE}\nMSG: {name}\n{body}");
        }
        Ok(RosType { name: name.replacen('/', "/msg/", 1), text })
    }
}

/// The types of a text so far, those that others need before these.
#[derive(Default)]
struct Definitions {
    done: Vec<Definition>,
}

struct Definition {
    /// Package and type, as `saoms_msgs/Position`.
    name: String,
    body: String,
}

/// The type of a field: its name, and what makes a list of it.
struct Kind {
    base: String,
    list: String,
}

impl Definitions {
    /// Adds the type of a message; its package and name.
    fn message(&mut self, value: &Value) -> String {
        let name = type_name(value["name"].as_str().unwrap_or_default());
        let mut body = Body::default();
        for constant in value["constants"].as_array().into_iter().flatten() {
            let kind = constant["type"].as_str().unwrap_or_default();
            let is_plain = constant["value"].is_number() || constant["value"].is_boolean();
            if let (true, Some(name)) = (is_plain && kind != "string", constant["name"].as_str()) {
                body.constant(kind, name, &constant["value"]);
            }
        }
        for field in value["fields"].as_array().into_iter().flatten() {
            let field_name = body.field_name(field["name"].as_str().unwrap_or_default());
            let kind = self.kind(&field["type"], (&name, &field_name), &mut body);
            if field["type"] == "time" {
                body.text.push_str("# Nanoseconds since the start of the run.\n");
            }
            let _ = writeln!(body.text, "{}{} {field_name}", kind.base, kind.list);
        }
        if value["fields"].as_array().is_none_or(Vec::is_empty) {
            body.text.push_str("uint8 structure_needs_at_least_one_member\n");
        }
        self.add(name, body.text)
    }

    /// Adds a type, unless it is there; its name, which no other one has.
    fn add(&mut self, name: String, body: String) -> String {
        let mut own = name.clone();
        for number in 2_u32.. {
            match self.done.iter().position(|one| one.name == own) {
                None => break,
                Some(place) if self.done[place].body == body => return own,
                Some(_) => own = format!("{name}{number}"),
            }
        }
        self.done.push(Definition { name: own.clone(), body });
        own
    }

    /// The type of a field of a message; its constants come before it.
    fn kind(&mut self, value: &Value, (of, field): (&str, &str), body: &mut Body) -> Kind {
        let plain = |base: &str| Kind { base: base.to_owned(), list: String::new() };
        if let Some(name) = value.as_str() {
            return plain(if name == "time" { "uint64" } else { name });
        }
        if let Some(number) = value["enumeration"].as_str() {
            for (name, constant) in value["values"].as_object().into_iter().flatten() {
                body.constant(number, &format!("{field}_{name}"), constant);
            }
            return plain(number);
        }
        if value.get("fields").is_some() {
            return Kind { base: self.message(value), list: String::new() };
        }
        let most = value["most"].as_u64().unwrap_or_default();
        let (element, list) = match (value.get("sequence"), value.get("optional"), value.get("array")) {
            (Some(element), ..) => (element, "[]".to_owned()),
            (_, Some(element), _) => (element, "[<=1]".to_owned()),
            (.., Some(element)) => (element, format!("[{}]", value["length"])),
            _ if value["bounded"] == "string" => return plain(&format!("string<={most}")),
            _ => (&value["bounded"]["sequence"], format!("[<={most}]")),
        };
        let element = self.kind(element, (of, field), body);
        if element.list.is_empty() {
            return Kind { base: element.base, list };
        }
        let (package, outer) = of.split_once('/').unwrap_or((PACKAGE, of));
        let name = format!("{package}/{outer}{}", camel(field));
        let inner = self.add(name, format!("{}{} value\n", element.base, element.list));
        Kind { base: inner, list }
    }
}

/// The text of a type, and the names in it.
#[derive(Default)]
struct Body {
    text: String,
    names: Vec<String>,
}

impl Body {
    fn constant(&mut self, kind: &str, name: &str, value: &Value) {
        let name = words(name).to_ascii_uppercase();
        let is_name = name.starts_with(|first: char| first.is_ascii_alphabetic());
        if is_name && !self.names.contains(&name) {
            let _ = writeln!(self.text, "{kind} {name}={value}");
            self.names.push(name);
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

/// Package and type of a name: `nav_msgs/msg/Odometry` is `nav_msgs/Odometry`.
fn type_name(name: &str) -> String {
    let (package, own) = name.rsplit_once('/').unwrap_or((PACKAGE, name));
    let package = words(package.split('/').next().unwrap_or_default()).to_ascii_lowercase();
    let is_name = package.starts_with(|first: char| first.is_ascii_alphabetic());
    let own = camel(own);
    let own = if own.starts_with(|first: char| first.is_ascii_alphabetic()) { own } else { format!("Message{own}") };
    format!("{}/{own}", if is_name { &package } else { PACKAGE })
}

/// A name as words with single underscores between: `startX` is `start_X`.
fn words(name: &str) -> String {
    let mut text = String::new();
    let mut before = '_';
    for letter in name.chars() {
        let letter = if letter.is_ascii_alphanumeric() { letter } else { '_' };
        if before != '_' && (letter == '_' || before.is_ascii_lowercase() && letter.is_ascii_uppercase()) {
            text.push('_');
        }
        if letter != '_' {
            text.push(letter);
        }
        before = letter;
    }
    text.trim_end_matches('_').to_owned()
}

/// A name as one word, whose parts begin with capital letters.
fn camel(name: &str) -> String {
    let mut text = String::new();
    for part in name.split(|one: char| !one.is_ascii_alphanumeric()) {
        let mut letters = part.chars();
        text.extend(letters.next().map(|first| first.to_ascii_uppercase()));
        text.push_str(letters.as_str());
    }
    text
}
