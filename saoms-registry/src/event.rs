//! Events that classes take, by the schemas of their messages.
//!
//! The fields of an event are those of the message by which it comes; its value travels as that message.

use saoms_api::event::{Event, EventCall, EventField, FieldType, FieldValue};
use saoms_api::host::declaration::{PropertyKind, Scalar};
use serde_json::{Map, Value};

use crate::registry::{ClassDeclaration, ClassTopic, TakenEvent};
use crate::schema::{Schema, SchemaError};

/// The message whose value an event writes as a duration, as in `2s`.
const DURATION: &str = "builtin_interfaces/msg/Duration";

impl ClassDeclaration {
    /// The events that it takes, with their fields.
    pub fn events(&self) -> impl Iterator<Item = Event> {
        self.taken().map(|(taken, topic)| Event {
            name: taken.event.clone(),
            doc: taken.doc.clone(),
            fields: fields(&topic.schema),
            classes: vec![self.name.clone()],
        })
    }

    /// The events that it takes, and the topic of each.
    pub fn taken(&self) -> impl Iterator<Item = (&TakenEvent, &ClassTopic)> {
        let topic = |name: &String| self.subscribes.iter().find(|topic| topic.name == *name);
        self.takes.iter().filter_map(move |taken| Some((taken, topic(&taken.topic)?)))
    }
}

/// The fields of a message, as an event writes them.
fn fields(schema: &Value) -> Vec<EventField> {
    let all = schema["fields"].as_array().into_iter().flatten();
    let field = |field: &Value| {
        let of = &field["type"];
        EventField { name: text(&field["name"]), of: field_type(of), message: struct_name(of) }
    };
    all.map(field).collect()
}

/// The name of the struct that a type is, or is made of.
fn struct_name(mut value: &Value) -> String {
    while let Some(inner) = ["optional", "sequence", "array", "bounded"].iter().find_map(|of| value.get(of)) {
        value = inner;
    }
    if value.get("fields").is_some() { text(&value["name"]) } else { String::new() }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// The type of a field; the schema is a sound one.
fn field_type(value: &Value) -> FieldType {
    let length = |name| value.get(name).and_then(Value::as_u64).and_then(|number| usize::try_from(number).ok());
    if let Some(of) = value.get("optional") {
        return FieldType::Optional(Box::new(field_type(of)));
    }
    if let Some(of) = value.get("sequence") {
        return FieldType::List { of: Box::new(field_type(of)), least: 0, most: None };
    }
    if let Some(of) = value.get("array") {
        let length = length("length");
        return FieldType::List { of: Box::new(field_type(of)), least: length.unwrap_or(0), most: length };
    }
    if let Some(of) = value.get("bounded") {
        let most = length("most");
        return match field_type(of) {
            FieldType::List { of, least, .. } => FieldType::List { of, least, most },
            _ => FieldType::Scalar { kind: PropertyKind::String, bounds: None, allowed: Vec::new(), most },
        };
    }
    if let Some(values) = value.get("values").and_then(Value::as_object) {
        let allowed = values.keys().cloned().collect();
        return FieldType::Scalar { kind: PropertyKind::Enumeration, bounds: None, allowed, most: None };
    }
    if value.get("fields").is_some() {
        return match value["name"] == DURATION {
            true => FieldType::scalar(PropertyKind::Duration),
            false => FieldType::Group(fields(value)),
        };
    }
    let bounds = |least: i128, most: i128| Some((least.to_string(), most.to_string()));
    let bounds = match value.as_str().unwrap_or_default() {
        "bool" => return FieldType::scalar(PropertyKind::Boolean),
        "string" => return FieldType::scalar(PropertyKind::String),
        "float32" | "float64" => return FieldType::scalar(PropertyKind::Float),
        "int8" => bounds(i8::MIN.into(), i8::MAX.into()),
        "int16" => bounds(i16::MIN.into(), i16::MAX.into()),
        "int32" => bounds(i32::MIN.into(), i32::MAX.into()),
        "uint8" => bounds(0, u8::MAX.into()),
        "uint16" => bounds(0, u16::MAX.into()),
        "uint32" => bounds(0, u32::MAX.into()),
        "uint64" | "time" => bounds(0, u64::MAX.into()),
        _ => bounds(i64::MIN.into(), i64::MAX.into()),
    };
    FieldType::Scalar { kind: PropertyKind::Integer, bounds, allowed: Vec::new(), most: None }
}

/// The message of an event that was found to be right.
///
/// # Errors
/// A field is missing, unknown or of another type.
pub fn message(event: &Event, call: &EventCall, schema: &Schema) -> Result<Vec<u8>, SchemaError> {
    let mut fields = Map::new();
    for field in &event.fields {
        let given = call.arguments.iter().find(|one| one.name.text == field.name);
        let value = match given.map(|one| field.of.read(&one.value.text)) {
            Some(Ok(value)) => json(value),
            Some(Err(error)) => return Err(SchemaError::new(format!("field `{}`: {error}", field.name))),
            None => Value::Null,
        };
        fields.insert(field.name.clone(), value);
    }
    schema.encode(&Value::Object(fields)).map_err(|faults| SchemaError::new(faults.to_string()))
}

/// A value as messages are written in JSON.
fn json(value: FieldValue) -> Value {
    match value {
        FieldValue::None => Value::Null,
        FieldValue::List(values) => values.into_iter().map(json).collect(),
        FieldValue::Group(fields) => Value::Object(fields.into_iter().map(|(name, one)| (name, json(one))).collect()),
        FieldValue::Scalar(Scalar::Boolean(value)) => value.into(),
        // Each integer is within the bounds of its type, of which none is wider.
        FieldValue::Scalar(Scalar::Integer(number)) => {
            i64::try_from(number.get()).map_or_else(|_| (number.get() as u64).into(), Value::from)
        }
        FieldValue::Scalar(Scalar::Float(number)) => number.into(),
        FieldValue::Scalar(Scalar::Text(text)) => text.as_str().into(),
        FieldValue::Scalar(Scalar::Duration(duration)) => {
            let sec = i32::try_from(duration.as_secs()).unwrap_or(i32::MAX);
            serde_json::json!({"sec": sec, "nanosec": duration.subsec_nanos()})
        }
    }
}
