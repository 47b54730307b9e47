//! `saoms components`: the classes, loops and rules that a composite can name, from their declarations.

mod loops;
mod rules;
mod types;

use std::fmt::Write;
use std::path::Path;

use clap::Args;
use saoms_api::Properties;
use saoms_api::event::{Event, EventField};
use saoms_lang::assembly::TaskProperties;
use saoms_lang::registry::{
    ClassTopic, InterfaceDeclaration, PropertyDeclaration, RegisteredClass, RegisteredLoop, RegisteredRule, Registry,
};
use serde_json::{Value, json};

use crate::Exit;
use crate::arguments::{Format, PluginArguments};
use crate::output::{eprint, print, print_json};
use crate::plugins::registry;

const EXIT_CODES: &str = "\
Exit codes:
  0  listed or described
  1  standard output could not be written
  2  there is no such class or loop, or a plugin cannot be used";

/// List the component classes, or describe one: properties, topics, services, references
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ComponentsArguments {
    /// The class to describe, by any of its names
    pub(crate) name: Option<String>,

    #[command(flatten)]
    pub(crate) plugins: PluginArguments,

    /// Text for people, or JSON
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub(crate) format: Format,
}

pub(crate) fn components(arguments: &ComponentsArguments) -> Exit {
    let registry = match registry(&arguments.plugins) {
        Ok(registry) => registry,
        Err(exit) => return exit,
    };
    let (chosen, loops): (Vec<&RegisteredClass>, Vec<&RegisteredLoop>) = match &arguments.name {
        None => (
            registry.iter().map(AsRef::as_ref).filter(|class| !class.is_alias()).collect(),
            registry.loops().map(AsRef::as_ref).collect(),
        ),
        // A class and a loop never have the same name.
        Some(name) => match (registry.get(name), registry.get_loop(name)) {
            (Some(class), _) => (vec![class], Vec::new()),
            (None, Some(one)) => (Vec::new(), vec![one]),
            (None, None) => {
                eprint(&unknown(name, &registry));
                return Exit::WrongInput;
            }
        },
    };
    match arguments.format {
        Format::Json => {
            let classes: Vec<Value> = chosen.into_iter().map(as_json).collect();
            let loops: Vec<Value> =
                loops.into_iter().map(|one| serde_json::from_str(one.declaration_json()).unwrap_or_default()).collect();
            let rules: Vec<Value> = match arguments.name {
                Some(_) => Vec::new(),
                None => registry.rules().iter().map(rules::as_json).collect(),
            };
            print_json(&json!({ "components": classes, "loops": loops, "rules": rules }));
        }
        Format::Human if arguments.name.is_some() => {
            chosen.into_iter().for_each(|class| print(&described(class)));
            loops.into_iter().for_each(|one| print(&loops::described(one)));
        }
        Format::Human => print(&listed(&chosen, &loops, registry.rules())),
    }
    Exit::Done
}

fn unknown(name: &str, registry: &Registry) -> String {
    let mut text = format!("error: there is no component class or loop `{name}`\n");
    let mut nearest = registry.nearest(name);
    nearest.extend(registry.nearest_loops(name));
    if !nearest.is_empty() {
        let _ = writeln!(text, "help: did you mean `{}`?", nearest.join("` or `"));
    }
    text.push_str("help: `saoms components` lists all of them\n");
    text
}

/// A line per class, then one per loop, then one per rule of a plugin.
fn listed(classes: &[&RegisteredClass], loops: &[&RegisteredLoop], rules: &[RegisteredRule]) -> String {
    let width = classes.iter().map(|class| class.name().len()).max().unwrap_or(0);
    let mut text = String::new();
    for class in classes {
        let declaration = class.declaration();
        let _ = writeln!(text, "{:width$}  {:8}  {}", class.name(), kind(class), first_sentence(&declaration.doc));
        if !declaration.also.is_empty() {
            let names: Vec<&str> = declaration.also.iter().map(|alias| alias.name.as_str()).collect();
            for line in wrapped(&format!("also {}", names.join(", ")), 100) {
                let _ = writeln!(text, "{:width$}            {line}", "");
            }
        }
    }
    if !loops.is_empty() {
        text.push('\n');
        text.push_str(&loops::listed(loops));
    }
    text.push_str(&rules::listed(rules));
    text.push_str("\n`saoms components NAME` describes one of them.\n");
    text
}

/// An event with its meaning and its fields.
fn event_lines(event: &Event) -> String {
    let mut text = format!("  {}\n", event.sample());
    for line in wrapped(&event.doc, 96) {
        let _ = writeln!(text, "      {line}");
    }
    for EventField { name, of, .. } in &event.fields {
        let optional = if of.is_optional() { ", optional" } else { "" };
        let _ = writeln!(text, "      {name}: {}{optional}", of.expected());
    }
    text
}

fn first_sentence(doc: &str) -> String {
    let words: Vec<&str> = doc.split_whitespace().collect();
    let end = words.iter().position(|word| word.ends_with('.')).map_or(words.len(), |last| last + 1);
    words[..end].join(" ").trim_end_matches('.').to_owned()
}

fn kind(class: &RegisteredClass) -> &'static str {
    if class.declaration().is_periodic() { "periodic" } else { "passive" }
}

/// Everything about one class.
fn described(class: &RegisteredClass) -> String {
    let declaration = class.declaration();
    let mut text = format!("{} ({})\n", class.name(), kind(class));
    if class.is_alias() {
        let _ = writeln!(text, "  another name of {}", declaration.name);
    }
    if !declaration.extends.is_empty() {
        let _ = writeln!(text, "  extends {}", declaration.extends.join(", which extends "));
    }
    text.push_str(&library_line(class.origin()));
    for line in wrapped(&declaration.doc, 100) {
        let _ = writeln!(text, "  {line}");
    }
    let own = declaration.properties.iter().map(|property| (property, preset(class, &property.name)));
    section(&mut text, "Properties", own.map(property_lines).collect());
    if declaration.is_periodic() {
        let task = TaskProperties::declarations_of(declaration).iter();
        let task = task.filter(|property| declaration.property(&property.name).is_none());
        let lines = task.map(|property| property_lines((property, preset(class, &property.name)))).collect();
        section(&mut text, "Task properties", lines);
    }
    section(&mut text, "Publishes", declaration.publishes.iter().map(topic_line).collect());
    section(&mut text, "Subscribes to", declaration.subscribes.iter().map(topic_line).collect());
    section(&mut text, "Takes the events", declaration.events().map(|event| event_lines(&event)).collect());
    let services = declaration.offers().map(|service| interface_lines(&service.name, "", &service.interface));
    section(&mut text, "Services", services.collect());
    let references = declaration.references.iter().map(|reference| {
        interface_lines(
            &reference.name,
            match (reference.optional, reference.many) {
                (true, true) => ", optional, many",
                (true, false) => ", optional",
                (false, true) => ", many",
                (false, false) => "",
            },
            &reference.interface,
        )
    });
    section(&mut text, "References", references.collect());
    if declaration.reacts {
        text.push_str("\nReacts to messages of the topics in `trigger`.\n");
    }
    if declaration.stops {
        text.push_str("\nRegisters functions that stop its hardware.\n");
    }
    types::section_of(
        &mut text,
        declaration.publishes.iter().chain(&declaration.subscribes).collect(),
        declaration
            .offers()
            .map(|service| &service.interface)
            .chain(declaration.references.iter().map(|reference| &reference.interface))
            .collect(),
    );
    loops::of_class(declaration, &mut text);
    if !class.is_alias() {
        let names = declaration.also.iter().map(|alias| {
            let values: Vec<String> = alias.preset.iter().map(|(name, value)| format!("{name}={value}")).collect();
            format!("  {}  {}\n", alias.name, values.join(" "))
        });
        section(&mut text, "Also known as", names.collect());
    }
    text
}

/// The value that the class's name presets for the property.
fn preset<'a>(class: &'a RegisteredClass, property: &str) -> Option<&'a str> {
    let declaration = class.declaration();
    let alias = declaration.also.iter().find(|alias| alias.name == class.name())?;
    alias.preset.get(property).map(String::as_str)
}

fn section(text: &mut String, title: &str, entries: Vec<String>) {
    if !entries.is_empty() {
        let _ = writeln!(text, "\n{title}");
        entries.iter().for_each(|entry| text.push_str(entry));
    }
}

fn property_lines((property, preset): (&PropertyDeclaration, Option<&str>)) -> String {
    let mut facts = vec![property.expected()];
    if property.many {
        facts.push("any number of values".to_owned());
    }
    match (preset, &property.default) {
        (Some(preset), _) => facts.push(format!("preset {preset}")),
        (None, Some(default)) if default.is_empty() => facts.push("default is empty".to_owned()),
        (None, Some(default)) => facts.push(format!("default {default}")),
        (None, None) if property.required => facts.push("required".to_owned()),
        (None, None) => facts.push("optional".to_owned()),
    }
    if let Some(scope) = &property.unique {
        facts.push(format!("unique as {scope}"));
    }
    if property.speaker {
        facts.push("identifies the sender".to_owned());
    }
    let mut text = format!("  {}: {}\n", property.name, facts.join(", "));
    for line in wrapped(&property.doc, 96) {
        let _ = writeln!(text, "      {line}");
    }
    text
}

/// The library that a class or loop comes from.
fn library_line(origin: Option<&Path>) -> String {
    origin.map_or_else(String::new, |path| format!("  from the library {}\n", path.display()))
}

fn topic_line(topic: &ClassTopic) -> String {
    let mut text = format!("  {} ({} topic of {})\n", topic.name, topic.kind.name(), topic.message);
    for speaker in &topic.speakers {
        let _ = writeln!(text, "      sender: {speaker}");
    }
    text
}

fn interface_lines(name: &str, more: &str, interface: &InterfaceDeclaration) -> String {
    let mut text = format!("  {name}: {}{more}\n", interface.name);
    for operation in interface.operations.as_array().into_iter().flatten() {
        let arguments: Vec<String> = operation["arguments"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|argument| format!("{}: {}", plain(&argument["name"]), types::described(&argument["type"])))
            .collect();
        let reply = match types::described(&operation["reply"]) {
            reply if reply.is_empty() => reply,
            reply => format!(" -> {reply}"),
        };
        let _ = writeln!(text, "      {}({}){reply}", plain(&operation["name"]), arguments.join(", "));
    }
    text
}

fn plain(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// The class's declaration; that of a periodic class includes the task properties.
fn as_json(class: &RegisteredClass) -> Value {
    let mut declaration: Value = serde_json::from_str(class.declaration_json()).unwrap_or_default();
    if class.declaration().is_periodic() {
        declaration["taskProperties"] = serde_json::from_str(TaskProperties::DECLARATION).unwrap_or_default();
    }
    declaration
}

/// The text, wrapped into lines of at most `width` characters, broken between words.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
