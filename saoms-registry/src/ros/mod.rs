//! Schemas of messages as types of ROS 2: their definitions (`ros2msg`) and descriptions, and the schema that has their
//! names. Operations as its services, and its files of interfaces (`.msg` and `.srv`), which are read here.
//!
//! What ROS 2 does not have, it gets in the form that has the same bytes: something optional is a list of one at most,
//! an enumeration a number with constants, a list of lists a list of messages with one field, and a message without
//! fields the field that ROS 2 gives it.

mod definition;
mod description;
mod names;
mod read;
mod service;
#[cfg(test)]
mod tests;

use std::fmt::Write;

use serde_json::Value;

use crate::schema::{Schema, SchemaError};
use definition::Definitions;

pub use names::{is_package, ros_topic};
pub use read::{RosBase, RosConstant, RosDefinition, RosFault, RosField, RosList, read_ros_file};
pub use service::{RosService, ros_operation};

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
    /// Its type description as the JSON text whose SHA-256 is its hash (`RIHS01`).
    pub description: String,
    /// The definitions of this type and of those in it: package and type, as `saoms_msgs/Position`, and the text of a
    /// file `.msg`.
    pub definitions: Vec<(String, String)>,
    /// Its schema: that of the message, with the names and forms that ROS 2 has.
    pub schema: Value,
}

impl RosType {
    /// The type of a schema, which is a text of a declaration.
    ///
    /// ```
    /// use saoms_registry::ros::RosType;
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
        let (name, schema) = definitions.message(&value);
        let mut others = definitions.done;
        let own = others.pop().unwrap_or_default();
        let mut text = own.text();
        for other in &others {
            // Writing to a text does not fail.
            let _ = write!(text, "{LINE}\nMSG: {}\n{}", other.name, other.text());
        }
        let description = description::of(&own, &others);
        let definitions = std::iter::once(&own).chain(&others).map(|one| (one.name.clone(), one.text())).collect();
        Ok(RosType { name: full_name(&name), text, description, definitions, schema })
    }
}

/// The name of a type as messages have it: `saoms_msgs/Position` is `saoms_msgs/msg/Position`.
fn full_name(name: &str) -> String {
    name.replacen('/', "/msg/", 1)
}
