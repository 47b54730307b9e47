//! The types of messages, arguments and replies: the fields of each struct, the constants of each enumeration.

use std::fmt::Write;

use saoms_lang::registry::{ClassTopic, InterfaceDeclaration, inner_type, type_name, type_words};
use serde_json::Value;

use super::section;

/// Each struct and enumeration in these topics and interfaces once, after the first one that uses it.
pub(super) fn section_of(text: &mut String, topics: Vec<&ClassTopic>, interfaces: Vec<&InterfaceDeclaration>) {
    let mut all = Types::default();
    topics.into_iter().for_each(|topic| all.add(&topic.schema));
    for operation in interfaces.iter().flat_map(|one| one.operations.as_array().into_iter().flatten()) {
        let arguments = operation["arguments"].as_array().into_iter().flatten();
        arguments.for_each(|argument| all.add(&argument["type"]));
        all.add(&operation["reply"]);
    }
    section(text, "Types", all.described);
}

#[derive(Default)]
struct Types {
    names: Vec<String>,
    described: Vec<String>,
}

impl Types {
    fn add(&mut self, of: &Value) {
        if let Some(inner) = inner_type(of) {
            return self.add(inner);
        }
        if let Some(fields) = of.get("fields").and_then(Value::as_array) {
            let name = type_name(of);
            if self.names.contains(&name) {
                return;
            }
            let mut text = format!("  {name}\n");
            for one in fields {
                let field = one["name"].as_str().unwrap_or_default();
                let _ = writeln!(text, "      {field}: {}", described(&one["type"]));
            }
            for one in of["constants"].as_array().into_iter().flatten() {
                let name = one["name"].as_str().unwrap_or_default();
                let _ = writeln!(text, "      {name} = {} ({})", one["value"], type_name(&one["type"]));
            }
            self.names.push(name);
            self.described.push(text);
            fields.iter().for_each(|one| self.add(&one["type"]));
        }
    }
}

/// The name of a type; the constants of an enumeration.
pub(super) fn described(of: &Value) -> String {
    type_words(of, &|of| match constants(of) {
        Some(constants) => format!("{} ({})", type_name(of), constants.join(", ")),
        None => type_name(of),
    })
}

/// The constants of an enumeration with their numbers, the lowest first.
fn constants(of: &Value) -> Option<Vec<String>> {
    of.get("enumeration")?;
    let mut all: Vec<(i64, &String)> =
        of.get("values")?.as_object()?.iter().map(|(name, value)| (value.as_i64().unwrap_or(i64::MAX), name)).collect();
    all.sort();
    Some(all.into_iter().map(|(value, name)| format!("{name} = {value}")).collect())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::Types;

    #[test]
    fn types_of_ros_are_said_in_words() {
        let mut types = Types::default();
        types.add(&json!({"name": "Scan", "fields": [
            {"name": "matrix", "type": {"array": "float64", "length": 36}},
            {"name": "names", "type": {"bounded": {"sequence": {"bounded": "string", "most": 8}}, "most": 4}},
            {"name": "corners", "type": {"array": {"name": "Point", "fields": [{"name": "x", "type": "int8"}]}, "length": 2}},
        ], "constants": [{"name": "OFF", "type": "uint8", "value": 0}, {"name": "A", "type": "string", "value": "a"}]}));
        let scan = "  Scan\n      matrix: array of 36 float64\n      names: sequence of at most 4 string of at most 8 bytes\n      \
            corners: array of 2 Point\n      OFF = 0 (uint8)\n      A = \"a\" (string)\n";
        assert_eq!(types.described, [scan, "  Point\n      x: int8\n"]);
    }
}
