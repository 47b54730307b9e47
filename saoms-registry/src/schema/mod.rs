//! Messages that this program knows by their schema alone: those of plugins and of other programs.
//!
//! A [`Schema`] is read from the text that a declaration carries (see [`saoms_api::host::declaration`]). It tells
//! whether bytes are such a message ([`Schema::check`]), and turns them into JSON and back, for tools and people.

mod json;
mod json_fault;
mod json_schema;
mod read;
mod sample;
#[cfg(test)]
mod tests;
mod times;

use std::fmt;

use saoms_api::host::cdr::{DecodeError, Reader};
use serde::Deserialize;
use serde_json::Value;

pub use json_fault::{JsonFault, JsonFaults};

/// A message type.
///
/// ```
/// use saoms_registry::schema::Schema;
///
/// let schema = r#"{"name":"Position","fields":[{"name":"robot","type":"uint32"},
///     {"name":"blocks","type":{"sequence":"int16"}}]}"#;
/// let schema = Schema::parse(schema)?;
/// let bytes = schema.encode(&serde_json::json!({"robot": 7, "blocks": [1, -1]}))?;
/// assert_eq!(schema.decode(&bytes)?.to_string(), r#"{"blocks":[1,-1],"robot":7}"#);
/// assert!(schema.check(&bytes[..9]).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schema {
    name: String,
    /// Place of the field that is the key of a state topic.
    key: Option<usize>,
    /// Place of the field that is the block of a message.
    place: Option<usize>,
    fields: Vec<Field>,
    /// True if it has times of a run, in its nested messages, too.
    has_times: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Field {
    name: String,
    kind: Type,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Type {
    Bool,
    Number(Number),
    /// Nanoseconds of a run, as a `uint64`.
    Time,
    String,
    Sequence(Box<Type>),
    Array(Box<Type>, usize),
    /// A string or a sequence of at most so many bytes or elements.
    Bounded(Box<Type>, usize),
    Optional(Box<Type>),
    Enumeration(Number, Vec<(String, i128)>),
    Message(Schema),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    Int8,
    Int16,
    Int32,
    Int64,
    Uint8,
    Uint16,
    Uint32,
    Uint64,
    Float32,
    Float64,
}

/// A fault of a text that is no schema, or of a value that is no message of one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SchemaError(String);

impl SchemaError {
    pub(crate) fn new(message: String) -> SchemaError {
        SchemaError(message)
    }
}

impl fmt::Display for SchemaError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for SchemaError {}

/// Messages within messages go no deeper: schemas come from libraries that anybody may have built.
const DEEPEST: usize = 32;
/// No message has so many bytes: arrays make large ones of short schemas.
const LARGEST: usize = 64 << 20;

impl Schema {
    /// Reads the text of a schema.
    ///
    /// # Errors
    /// It is none, or nested more than 32 deep.
    pub fn parse(text: &str) -> Result<Schema, SchemaError> {
        let value: Value = serde_json::from_str(text).map_err(|error| SchemaError(error.to_string()))?;
        Schema::of(&value)
    }

    /// Reads a schema that is a part of a declaration.
    ///
    /// # Errors
    /// As [`parse`](Schema::parse).
    pub fn of(value: &Value) -> Result<Schema, SchemaError> {
        message(value, DEEPEST)
    }

    /// The name of the message type.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The key under which a state topic keeps a message that is given as bytes; `None` where its type declares none.
    pub fn key(&self, bytes: &[u8]) -> Option<u64> {
        let key = self.key?;
        read::key(self, key, &mut Reader::new(bytes).ok()?)
    }

    /// The name of the field that is the key of a message.
    pub fn key_name(&self) -> Option<&str> {
        self.key.map(|key| self.fields[key].name.as_str())
    }

    /// Column and row of the block of a message that is given as bytes; `None` where its type declares no place.
    pub fn place(&self, bytes: &[u8]) -> Option<(i32, i32)> {
        let place = self.place?;
        read::block(self, place, &mut Reader::new(bytes).ok()?)
    }

    /// True if messages have a block: a field that is their place.
    pub fn has_place(&self) -> bool {
        self.place.is_some()
    }

    /// True if these bytes are such a message.
    ///
    /// # Errors
    /// An error says the fault, and the byte.
    pub fn check(&self, bytes: &[u8]) -> Result<(), DecodeError> {
        let mut reader = Reader::new(bytes)?;
        read::skip_message(self, &mut reader)?;
        reader.finish()
    }
}

fn message(value: &Value, deepest: usize) -> Result<Schema, SchemaError> {
    #[derive(Deserialize)]
    struct Shape {
        name: String,
        key: Option<String>,
        place: Option<String>,
        fields: Vec<FieldShape>,
    }
    #[derive(Deserialize)]
    struct FieldShape {
        name: String,
        #[serde(rename = "type")]
        kind: Value,
    }
    let shape = Shape::deserialize(value).map_err(|error| SchemaError(format!("a schema of a message: {error}")))?;
    let Some(deepest) = deepest.checked_sub(1) else {
        return Err(SchemaError(format!("message `{}` is nested more than {DEEPEST} deep", shape.name)));
    };
    let fields = shape.fields.into_iter().map(|field| {
        let kind = kind(&field.kind, deepest).map_err(|SchemaError(error)| {
            SchemaError(format!("field `{}` of `{}`: {error}", field.name, shape.name))
        })?;
        Ok(Field { name: field.name, kind })
    });
    let fields = fields.collect::<Result<Vec<Field>, _>>()?;
    let field = |name: &String, role: &str| {
        let found = fields.iter().position(|field| field.name == *name);
        found.ok_or_else(|| {
            SchemaError(format!("the {role} of `{}` is `{name}`, which is not one of its fields", shape.name))
        })
    };
    let place = shape.place.as_ref().map(|place| field(place, "place")).transpose()?;
    if let Some(place) = place.filter(|place| !is_block(&fields[*place].kind)) {
        let name = &fields[place].name;
        return Err(SchemaError(format!(
            "the place of `{}` is `{name}`, which is not a message with two fields of type int32",
            shape.name
        )));
    }
    let key = shape.key.as_ref().map(|key| field(key, "key")).transpose()?;
    let what = match key.map(|key| &fields[key].kind) {
        Some(Type::Number(number)) if number.is_float() => Some("not an integer"),
        None | Some(Type::Number(_) | Type::Enumeration(..) | Type::Bool) => None,
        Some(_) => Some("not a number"),
    };
    if let (Some(key), Some(what)) = (key, what) {
        let name = &fields[key].name;
        return Err(SchemaError(format!("the key of `{}` is `{name}`, which is {what}", shape.name)));
    }
    let has_times = fields.iter().any(|field| field.kind.has_times());
    Ok(Schema { fields, key, place, has_times, name: shape.name })
}

/// True if a field is a column and a row.
fn is_block(kind: &Type) -> bool {
    let is_number = |field: &Field| field.kind == Type::Number(Number::Int32);
    matches!(kind, Type::Message(block) if block.fields.len() == 2 && block.fields.iter().all(is_number))
}

fn kind(value: &Value, deepest: usize) -> Result<Type, SchemaError> {
    let unknown = || {
        SchemaError(format!(
            "found the type {value}, expected one of ROS 2 interfaces, a sequence, an enumeration or a message"
        ))
    };
    if let Some(name) = value.as_str() {
        return match name {
            "bool" => Ok(Type::Bool),
            "string" => Ok(Type::String),
            "time" => Ok(Type::Time),
            name => Number::of(name).map(Type::Number).ok_or_else(unknown),
        };
    }
    let inner = |of: &Value| {
        let deepest =
            deepest.checked_sub(1).ok_or_else(|| SchemaError(format!("it is nested more than {DEEPEST} deep")))?;
        kind(of, deepest).map(Box::new)
    };
    let number = |name| value.get(name).and_then(Value::as_u64).and_then(|number| usize::try_from(number).ok());
    if let Some(element) = value.get("sequence") {
        return inner(element).map(Type::Sequence);
    }
    if let Some(element) = value.get("optional") {
        return inner(element).map(Type::Optional);
    }
    if let Some(element) = value.get("array") {
        let length = number("length").filter(|length| *length > 0).ok_or_else(unknown)?;
        let array = Type::Array(inner(element)?, length);
        return match array.least_size() {
            0..=LARGEST => Ok(array),
            _ => Err(SchemaError(format!("found an array of {length}, which takes more than {LARGEST} bytes"))),
        };
    }
    if let Some(content) = value.get("bounded") {
        let content = inner(content)?;
        let is_bounded = matches!(*content, Type::String | Type::Sequence(_));
        return match number("most").filter(|_| is_bounded) {
            Some(most) => Ok(Type::Bounded(content, most)),
            None => Err(unknown()),
        };
    }
    if let Some(number) = value.get("enumeration") {
        let number = number.as_str().and_then(Number::of).filter(|number| !number.is_float()).ok_or_else(unknown)?;
        let values = value.get("values").and_then(Value::as_object).ok_or_else(unknown)?;
        let values = values.iter().map(|(name, value)| {
            let value =
                value.as_i64().map(i128::from).or_else(|| value.as_u64().map(i128::from)).ok_or_else(unknown)?;
            Ok((name.clone(), value))
        });
        return Ok(Type::Enumeration(number, values.collect::<Result<_, SchemaError>>()?));
    }
    if value.get("fields").is_some() {
        return message(value, deepest).map(Type::Message);
    }
    Err(unknown())
}

impl Number {
    fn of(name: &str) -> Option<Number> {
        Some(match name {
            "int8" => Number::Int8,
            "int16" => Number::Int16,
            "int32" => Number::Int32,
            "int64" => Number::Int64,
            "uint8" => Number::Uint8,
            "uint16" => Number::Uint16,
            "uint32" => Number::Uint32,
            "uint64" => Number::Uint64,
            "float32" => Number::Float32,
            "float64" => Number::Float64,
            _ => return None,
        })
    }

    const fn is_float(self) -> bool {
        matches!(self, Number::Float32 | Number::Float64)
    }

    const fn size(self) -> usize {
        match self {
            Number::Int8 | Number::Uint8 => 1,
            Number::Int16 | Number::Uint16 => 2,
            Number::Int32 | Number::Uint32 | Number::Float32 => 4,
            Number::Int64 | Number::Uint64 | Number::Float64 => 8,
        }
    }

    /// The least and the greatest value of an integer.
    const fn bounds(self) -> (i128, i128) {
        match self {
            Number::Int8 => (i8::MIN as i128, i8::MAX as i128),
            Number::Int16 => (i16::MIN as i128, i16::MAX as i128),
            Number::Int32 => (i32::MIN as i128, i32::MAX as i128),
            Number::Int64 => (i64::MIN as i128, i64::MAX as i128),
            Number::Uint8 => (0, u8::MAX as i128),
            Number::Uint16 => (0, u16::MAX as i128),
            Number::Uint32 => (0, u32::MAX as i128),
            Number::Uint64 => (0, u64::MAX as i128),
            Number::Float32 | Number::Float64 => (0, 0),
        }
    }
}

impl Type {
    /// The least number of bytes that a value takes.
    fn least_size(&self) -> usize {
        match self {
            Type::Bool => 1,
            Type::Number(number) | Type::Enumeration(number, _) => number.size(),
            Type::Time => Number::Uint64.size(),
            Type::String | Type::Sequence(_) | Type::Bounded(..) | Type::Optional(_) => 4,
            Type::Array(element, length) => element.least_size().saturating_mul(*length),
            Type::Message(schema) => {
                let sizes = schema.fields.iter().map(|field| field.kind.least_size());
                sizes.fold(0, usize::saturating_add).max(1)
            }
        }
    }
}
