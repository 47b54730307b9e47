//! Messages as rosbridge has them in JSON, and as CDR. What is not as in the rest of the program: bytes are a text
//! (base64), a number that JSON does not have is `null`, and what is left out is 0, empty or false.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use saoms_registry::schema::Schema;
use saoms_transport::{Failure, Topic};
use serde_json::{Map, Value, json};

/// The type of the messages of a topic.
#[derive(Clone, Debug)]
pub(crate) struct Form {
    /// Its name, as `std_msgs/msg/String`.
    pub(crate) kind: String,
    schema: Schema,
    /// The schema as it is declared.
    shape: Value,
}

impl Form {
    pub(crate) fn of(topic: &Topic) -> Result<Form, Failure> {
        let schema = Schema::of(&topic.schema).map_err(Failure::failed)?;
        Ok(Form { kind: topic.kind.clone(), schema, shape: topic.schema.clone() })
    }

    /// True for the name of this type, also as ROS 1 has it: `std_msgs/String`.
    pub(crate) fn is_named(&self, name: &str) -> bool {
        let parts = |name: &str| {
            let (package, rest) = name.split_once('/')?;
            let own = rest.strip_prefix("msg/").unwrap_or(rest);
            Some((package.to_owned(), own.to_owned()))
        };
        parts(name).is_some_and(|found| Some(found) == parts(&self.kind))
    }

    /// A message in JSON.
    pub(crate) fn to_json(&self, message: &[u8]) -> Result<Value, String> {
        let mut value = self.schema.decode(message).map_err(|error| error.to_string())?;
        outward(&self.shape, &mut value);
        Ok(value)
    }

    /// A message in CDR.
    pub(crate) fn to_cdr(&self, value: Value) -> Result<Vec<u8>, String> {
        self.schema.encode(&inward(&self.shape, Some(value))).map_err(|faults| faults.to_string())
    }
}

/// What a list has: its elements, and how many if that is fixed.
fn element(kind: &Value) -> Option<(&Value, Option<u64>)> {
    let list = kind.get("sequence").or_else(|| kind.get("bounded")?.get("sequence"));
    list.map(|element| (element, None)).or_else(|| Some((kind.get("array")?, kind["length"].as_u64())))
}

fn is_float(kind: &Value) -> bool {
    kind == "float32" || kind == "float64"
}

/// Makes a value what rosbridge has.
fn outward(kind: &Value, value: &mut Value) {
    if is_float(kind) {
        if value.is_string() {
            *value = Value::Null;
        }
    } else if let Some((element, _)) = element(kind) {
        let Value::Array(list) = value else { return };
        if element == "uint8" {
            let bytes: Vec<u8> = list.iter().map(|one| one.as_u64().unwrap_or_default() as u8).collect();
            *value = STANDARD.encode(bytes).into();
        } else {
            list.iter_mut().for_each(|one| outward(element, one));
        }
    } else if let (Some(fields), Value::Object(object)) = (kind["fields"].as_array(), value) {
        for field in fields {
            if let Some(value) = field["name"].as_str().and_then(|name| object.get_mut(name)) {
                outward(&field["type"], value);
            }
        }
    }
}

/// Makes of a value of rosbridge one of the schema.
fn inward(kind: &Value, value: Option<Value>) -> Value {
    let Some(value) = value else { return absent(kind) };
    if is_float(kind) {
        return if value.is_null() { "NaN".into() } else { value };
    }
    if let Some((element, _)) = element(kind) {
        return match value {
            Value::String(text) if element == "uint8" => match STANDARD.decode(&text) {
                Ok(bytes) => bytes.into(),
                Err(_) => text.into(),
            },
            Value::Array(list) => list.into_iter().map(|one| inward(element, Some(one))).collect(),
            other => other,
        };
    }
    let Some(fields) = kind["fields"].as_array() else { return value };
    let Value::Object(mut object) = value else { return value };
    if kind["name"].as_str().is_some_and(|name| name.starts_with("builtin_interfaces/msg/")) {
        // As ROS 1 has times, and `roslibpy` makes them.
        for (old, new) in [("secs", "sec"), ("nsecs", "nanosec")] {
            if let Some(value) = object.remove(old) {
                object.insert(new.to_owned(), value);
            }
        }
    }
    for field in fields {
        let Some(name) = field["name"].as_str() else { continue };
        let value = inward(&field["type"], object.remove(name));
        object.insert(name.to_owned(), value);
    }
    Value::Object(object)
}

/// The value of what is left out.
fn absent(kind: &Value) -> Value {
    match kind.as_str() {
        Some("bool") => return false.into(),
        Some("string") => return "".into(),
        Some(_) => return 0.into(),
        None => {}
    }
    if kind["fields"].is_array() {
        return inward(kind, Some(Value::Object(Map::new())));
    }
    match element(kind) {
        Some((element, length)) => (0..length.unwrap_or_default()).map(|_| absent(element)).collect(),
        // A text with a bound.
        None => json!(""),
    }
}
