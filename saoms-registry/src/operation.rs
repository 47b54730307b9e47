//! Operations of interfaces that are known by their declaration alone: arguments and reply are JSON or CDR.

use saoms_api::host::cdr;
use saoms_api::host::cdr::DecodeError;
use serde_json::{Map, Value, json};

use crate::registry::{InterfaceDeclaration, signature};
use crate::schema::{JsonFaults, Schema, SchemaError};

/// The name of the one field of a message that stands for a reply.
const REPLY: &str = "reply";

/// An operation of an interface, with the forms of its arguments and its reply.
///
/// ```
/// use saoms_registry::{OperationSchema, registry::InterfaceDeclaration};
/// use serde_json::json;
///
/// let text = r#"{"name":"Clock","operations":[
///     {"name":"add","arguments":[{"name":"a","type":"int8"},{"name":"b","type":"int8"}],"reply":"int16"}]}"#;
/// let interface: InterfaceDeclaration = serde_json::from_str(text)?;
/// let add = OperationSchema::find(&interface, "add").ok_or("none")??;
/// let bytes = add.encode_arguments(&json!({"a": 1, "b": 2}))?;
/// assert_eq!(add.decode_arguments(&bytes)?, json!({"a": 1, "b": 2}));
/// assert_eq!(add.decode_reply(&add.encode_reply(&json!(3))?)?, json!(3));
/// assert!(add.encode_arguments(&json!({"a": 1, "c": 2})).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OperationSchema {
    /// Its name.
    pub name: String,
    /// Its number: the place in its interface.
    pub number: u32,
    /// As authors write it, as `add(a: int8, b: int8) -> int16`.
    pub signature: String,
    arguments: Schema,
    /// `None` for one without arguments, whose bytes are those of `()`.
    has_arguments: bool,
    /// A message with the reply as its one field; `None` for an operation without one.
    reply: Option<Schema>,
}

impl OperationSchema {
    /// The operations of an interface, in their order.
    ///
    /// # Errors
    /// A type in one of them is none.
    pub fn all(interface: &InterfaceDeclaration) -> Result<Vec<OperationSchema>, SchemaError> {
        let declared = interface.operations.as_array().map(Vec::as_slice).unwrap_or_default();
        declared.iter().zip(0..).map(|(one, number)| OperationSchema::of(one, number)).collect()
    }

    /// The operation of this name.
    ///
    /// # Errors
    /// A type in it is none.
    pub fn find(interface: &InterfaceDeclaration, name: &str) -> Option<Result<OperationSchema, SchemaError>> {
        let declared = interface.operations.as_array()?;
        let place = declared.iter().position(|one| one["name"] == name)?;
        Some(OperationSchema::of(&declared[place], place as u32))
    }

    /// The operation with this number.
    ///
    /// # Errors
    /// A type in it is none.
    pub fn numbered(interface: &InterfaceDeclaration, number: u32) -> Option<Result<OperationSchema, SchemaError>> {
        let declared = interface.operations.as_array()?.get(number as usize)?;
        Some(OperationSchema::of(declared, number))
    }

    /// An operation as a declaration has it.
    ///
    /// # Errors
    /// A type in it is none.
    pub fn of(declared: &Value, number: u32) -> Result<OperationSchema, SchemaError> {
        let name = declared["name"].as_str().unwrap_or_default().to_owned();
        let fields = declared["arguments"].as_array().cloned().unwrap_or_default();
        let has_arguments = !fields.is_empty();
        let arguments = Schema::of(&json!({"name": name, "fields": fields}))?;
        let reply = Some(&declared["reply"]).filter(|reply| !reply.is_null());
        let reply = reply.map(|reply| json!({"name": REPLY, "fields": [{"name": REPLY, "type": reply}]}));
        let reply = reply.map(|reply| Schema::of(&reply)).transpose()?;
        Ok(OperationSchema { name, number, signature: signature(declared), arguments, has_arguments, reply })
    }

    /// True if it has a reply.
    pub fn has_reply(&self) -> bool {
        self.reply.is_some()
    }

    /// The arguments as CDR, from JSON: an object with each by its name.
    ///
    /// # Errors
    /// Arguments are missing, unknown or of another type; all faults are told.
    pub fn encode_arguments(&self, value: &Value) -> Result<Vec<u8>, JsonFaults> {
        let bytes = self.arguments.encode(value)?;
        Ok(if self.has_arguments { bytes } else { cdr::encode(&()) })
    }

    /// The arguments as JSON, from CDR.
    ///
    /// # Errors
    /// The bytes are none.
    pub fn decode_arguments(&self, bytes: &[u8]) -> Result<Value, DecodeError> {
        if self.has_arguments { self.arguments.decode(bytes) } else { Ok(Value::Object(Map::new())) }
    }

    /// The reply as CDR, from JSON; that of an operation without one is `null`.
    ///
    /// # Errors
    /// It is of another type; all faults are told.
    pub fn encode_reply(&self, value: &Value) -> Result<Vec<u8>, JsonFaults> {
        match &self.reply {
            Some(schema) => schema.encode(&json!({REPLY: value})),
            None => Ok(cdr::encode(&())),
        }
    }

    /// The reply as JSON, from CDR; `null` for an operation without one.
    ///
    /// # Errors
    /// The bytes are none.
    pub fn decode_reply(&self, bytes: &[u8]) -> Result<Value, DecodeError> {
        let Some(schema) = &self.reply else { return Ok(Value::Null) };
        let mut message = schema.decode(bytes)?;
        Ok(message[REPLY].take())
    }

    /// The JSON Schema of the arguments: an object with each by its name.
    pub fn arguments_schema(&self) -> Value {
        self.arguments.json_schema()
    }

    /// The JSON Schema of the reply; `None` for an operation without one.
    pub fn reply_schema(&self) -> Option<Value> {
        self.reply.as_ref()?.field_schema(REPLY)
    }
}
