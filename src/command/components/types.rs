//! The types of messages, arguments and replies: the fields of each struct, the constants of each enumeration.

use std::fmt::Write;

use saoms_lang::registry::{ClassTopic, InterfaceDeclaration, type_name};
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
        let inner = of.get("optional").or_else(|| of.get("sequence"));
        if let Some(inner) = inner {
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
            self.names.push(name);
            self.described.push(text);
            fields.iter().for_each(|one| self.add(&one["type"]));
        }
    }
}

/// The name of a type; the constants of an enumeration.
pub(super) fn described(of: &Value) -> String {
    if let Some(inner) = of.get("optional") {
        return format!("{}, or none", described(inner));
    }
    if let Some(inner) = of.get("sequence") {
        return format!("sequence of {}", described(inner));
    }
    match constants(of) {
        Some(constants) => format!("{} ({})", type_name(of), constants.join(", ")),
        None => type_name(of),
    }
}

/// The constants of an enumeration with their numbers, the lowest first.
fn constants(of: &Value) -> Option<Vec<String>> {
    of.get("enumeration")?;
    let mut all: Vec<(i64, &String)> =
        of.get("values")?.as_object()?.iter().map(|(name, value)| (value.as_i64().unwrap_or(i64::MAX), name)).collect();
    all.sort();
    Some(all.into_iter().map(|(value, name)| format!("{name} = {value}")).collect())
}
