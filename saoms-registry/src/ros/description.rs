//! The description of a type, as `type_description_interfaces/msg/TypeDescription` has it: in JSON of the form over
//! which ROS 2 makes its hashes (REP 2011), with fields alone.

use std::fmt::Write;

use super::definition::{Definition, Field, List};
use super::full_name;

/// The numbers of `type_description_interfaces/msg/FieldType`.
const NESTED: u8 = 1;
const STRING: u8 = 17;
const BOUNDED_STRING: u8 = 21;
const PLAIN: [(&str, u8); 11] = [
    ("int8", 2),
    ("uint8", 3),
    ("int16", 4),
    ("uint16", 5),
    ("int32", 6),
    ("uint32", 7),
    ("int64", 8),
    ("uint64", 9),
    ("float32", 10),
    ("float64", 11),
    ("bool", 15),
];
/// What a list adds to the number of its elements.
const ARRAY: u8 = 48;
const BOUNDED: u8 = 96;
const UNBOUNDED: u8 = 144;

/// The description of a type and of those in it.
pub(super) fn of(own: &Definition, others: &[Definition]) -> String {
    let mut others: Vec<&Definition> = others.iter().collect();
    others.sort_by_key(|one| full_name(&one.name));
    let others: Vec<String> = others.into_iter().map(one).collect();
    let others = others.join(", ");
    format!("{{\"type_description\": {}, \"referenced_type_descriptions\": [{others}]}}", one(own))
}

fn one(definition: &Definition) -> String {
    let fields: Vec<String> = definition.fields().map(field).collect();
    format!("{{\"type_name\": \"{}\", \"fields\": [{}]}}", full_name(&definition.name), fields.join(", "))
}

/// A field; no name in it has a character that JSON would escape.
fn field(field: &Field) -> String {
    let (mut id, string_capacity, nested) = base(&field.base);
    let capacity = match field.list {
        List::None => 0,
        List::Length(length) => {
            id += ARRAY;
            length
        }
        List::Most(most) => {
            id += BOUNDED;
            most
        }
        List::Unbounded => {
            id += UNBOUNDED;
            0
        }
    };
    let mut text = format!("{{\"name\": \"{}\", \"type\": {{\"type_id\": {id}, \"capacity\": {capacity}, ", field.name);
    // Writing to a text does not fail.
    let _ = write!(text, "\"string_capacity\": {string_capacity}, \"nested_type_name\": \"{nested}\"}}}}");
    text
}

/// The number of a type that is no list, the bound of a string, and the name of a message.
fn base(base: &str) -> (u8, u64, String) {
    if base == "string" {
        return (STRING, 0, String::new());
    }
    if let Some(most) = base.strip_prefix("string<=") {
        return (BOUNDED_STRING, most.parse().unwrap_or_default(), String::new());
    }
    match PLAIN.iter().find(|(name, _)| *name == base) {
        Some((_, id)) => (*id, 0, String::new()),
        None => (NESTED, 0, full_name(base)),
    }
}
