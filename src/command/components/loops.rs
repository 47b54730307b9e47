//! Loops and their knowledge.

use std::fmt::Write;

use saoms_lang::registry::{ClassDeclaration, DeclaredEntry, RegisteredLoop, type_name};

use super::{first_sentence, interface_lines, library_line, property_lines, section, topic_line, types, wrapped};

/// A line per loop.
pub(super) fn listed(loops: &[&RegisteredLoop]) -> String {
    let width = loops.iter().map(|one| one.name().len()).max().unwrap_or(0);
    let line = |one: &&RegisteredLoop| {
        format!("{:width$}  loop      {}\n", one.name(), first_sentence(&one.declaration().doc))
    };
    loops.iter().map(line).collect()
}

/// Everything about one loop.
pub(super) fn described(one: &RegisteredLoop) -> String {
    let declaration = one.declaration();
    let mut text = format!("{} (loop)\n", one.name());
    text.push_str(&library_line(one.origin()));
    for line in wrapped(&declaration.doc, 100) {
        let _ = writeln!(text, "  {line}");
    }
    let _ = match &declaration.knowledge {
        Some(knowledge) => writeln!(text, "  works on the knowledge {knowledge}"),
        None => writeln!(text, "  works on any knowledge that has its entries"),
    };
    let properties = declaration.properties.iter().map(|property| property_lines((property, None)));
    section(&mut text, "Properties", properties.collect());
    let names = |names: &[String]| names.iter().map(|name| format!("  {name}\n")).collect();
    section(&mut text, "Senses", names(&declaration.senses));
    section(&mut text, "Effects", names(&declaration.effects));
    section(&mut text, "Adds the entries", declaration.entries.iter().map(entry_lines).collect());
    section(&mut text, "Publishes", declaration.publishes.iter().map(topic_line).collect());
    section(&mut text, "Subscribes to", declaration.subscribes.iter().map(topic_line).collect());
    let references = declaration.references.iter();
    let references = references.map(|reference| interface_lines(&reference.name, "", &reference.interface));
    section(&mut text, "References", references.collect());
    types::section_of(
        &mut text,
        declaration.publishes.iter().chain(&declaration.subscribes).collect(),
        declaration.references.iter().map(|reference| &reference.interface).collect(),
    );
    text
}

/// The loops of a class in their order, and their knowledge.
pub(super) fn of_class(class: &ClassDeclaration, text: &mut String) {
    for (value, names) in class.loops.all() {
        let title = match (&class.loops.property, value) {
            (Some(property), Some(value)) => format!("Loops, in order, where {property} is {value}"),
            _ => "Loops, in order".to_owned(),
        };
        let short = |name: &str| name.rsplit('.').next().unwrap_or(name).to_owned();
        let width = names.iter().map(|name| short(name).len()).max().unwrap_or(0);
        let lines = names.iter().map(|name| format!("  {:width$}  {name}\n", short(name)));
        section(text, &title, lines.collect());
    }
    if let Some(knowledge) = &class.knowledge {
        let title = format!("Knowledge {}", knowledge.name);
        section(text, &title, knowledge.entries.iter().map(entry_lines).collect());
    }
}

fn entry_lines(entry: &DeclaredEntry) -> String {
    let mut facts = vec![type_name(&entry.of)];
    facts.extend(entry.unit.as_ref().map(|unit| format!("in {unit}")));
    if entry.effector {
        facts.push("effector".to_owned());
    }
    if entry.quiet {
        facts.push("quiet".to_owned());
    }
    let mut text = format!("  {}: {}\n", entry.name, facts.join(", "));
    for line in wrapped(&entry.doc, 96) {
        let _ = writeln!(text, "      {line}");
    }
    text
}
