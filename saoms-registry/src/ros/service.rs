//! Operations of interfaces as services of ROS 2: the request has the arguments, the answer has the reply.

use serde_json::{Value, json};

use super::definition::Definitions;
use super::names::camel;
use crate::OperationSchema;
use crate::schema::SchemaError;

/// An operation as a service of ROS 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosService {
    /// Its name, of those of the interface and the operation: `GpsPosition`.
    pub name: String,
    /// The text of its file `.srv`.
    pub text: String,
    /// The definitions of the types that it names: package and type, and the text of a file `.msg`.
    pub definitions: Vec<(String, String)>,
}

/// An operation of an interface, as its declaration has it, as a service of ROS 2.
///
/// ```
/// use saoms_registry::ros::ros_operation;
///
/// let add = serde_json::json!({"name": "add", "reply": "int16",
///     "arguments": [{"name": "a", "type": "int8"}, {"name": "b", "type": "int8"}]});
/// let service = ros_operation("example.Clock", &add)?;
/// assert_eq!((&*service.name, &*service.text), ("ClockAdd", "int8 a\nint8 b\n---\nint16 reply\n"));
/// # Ok::<(), saoms_registry::schema::SchemaError>(())
/// ```
///
/// # Errors
/// A type in it is none.
pub fn ros_operation(interface: &str, operation: &Value) -> Result<RosService, SchemaError> {
    // What is no schema ends here.
    let schema = OperationSchema::of(operation, 0)?;
    let own = interface.rsplit(['.', '/']).next().unwrap_or_default();
    let name = camel(own) + &camel(&schema.name);
    let arguments = operation["arguments"].as_array().cloned().unwrap_or_default();
    let reply = Some(&operation["reply"]).filter(|reply| !reply.is_null());
    let reply: Vec<Value> = reply.map(|reply| json!({"name": "reply", "type": reply})).into_iter().collect();
    let mut definitions = Definitions::default();
    let mut part = |end: &str, fields: Vec<Value>| {
        // Nothing is generated of a field that stands for none.
        let is_empty = fields.is_empty();
        definitions.message(&json!({"name": format!("{name}{end}"), "fields": fields}));
        let text = definitions.done.pop().map(|one| one.text()).unwrap_or_default();
        if is_empty { String::new() } else { text }
    };
    let text = format!("{}---\n{}", part("Request", arguments), part("Response", reply));
    let definitions = definitions.done.into_iter().map(|one| (one.name.clone(), one.text())).collect();
    Ok(RosService { name, text, definitions })
}
