//! The names that a registry knows, each with what there is to say about it.

use std::collections::BTreeMap;

use saoms_lang::assembly::TaskProperties;
use saoms_lang::registry::{InterfaceDeclaration, PropertyDeclaration, RegisteredClass, Registry};

/// Names of one sort with their documentation, sorted.
pub(super) type Names = BTreeMap<String, String>;

/// All names by their sorts.
#[derive(Debug, Default)]
pub(super) struct Words {
    pub(super) classes: Names,
    pub(super) properties: Names,
    pub(super) services: Names,
    pub(super) references: Names,
    pub(super) interfaces: Names,
    pub(super) loops: Names,
    pub(super) loop_classes: Names,
    /// Texts that properties allow, where they allow some only.
    pub(super) values: Names,
}

/// Texts about names, each with the names that it is about.
type Said = BTreeMap<String, Vec<(String, Vec<String>)>>;

impl Words {
    pub(super) fn of(registry: &Registry) -> Self {
        let mut words = Self::default();
        let (mut properties, mut services, mut references) = (Said::new(), Said::new(), Said::new());
        for class in registry.iter() {
            words.classes.insert(class.name().to_owned(), about_class(class));
        }
        // Further names of a class have what it has.
        for class in registry.iter().filter(|class| !class.is_alias()) {
            let declaration = class.declaration();
            let of = class.name();
            for property in &declaration.properties {
                say(&mut properties, &property.name, about_property(property), of);
            }
            for service in declaration.offers() {
                say(&mut services, &service.name, offers(&service.interface), of);
                words.interface(&service.interface);
            }
            for reference in &declaration.references {
                let text = calls(&reference.interface, reference.optional, reference.many);
                say(&mut references, &reference.name, text, of);
                words.interface(&reference.interface);
            }
        }
        for property in TaskProperties::declarations() {
            say(&mut properties, &property.name, about_property(property), "every periodic class");
        }
        for one in registry.loops() {
            let declaration = one.declaration();
            words.loop_classes.insert(one.name().to_owned(), paragraph(&declaration.doc));
            let short = words.loops.entry(declaration.short_name().to_owned()).or_default();
            add(short, &format!("{}: {}", one.name(), paragraph(&declaration.doc)));
            for property in &declaration.properties {
                say(&mut properties, &property.name, about_property(property), one.name());
            }
            for reference in &declaration.references {
                let text = calls(&reference.interface, reference.optional, reference.many);
                say(&mut references, &reference.name, text, one.name());
                words.interface(&reference.interface);
            }
        }
        let classes = registry.iter().filter(|class| !class.is_alias());
        let of_classes = classes.flat_map(|class| &class.declaration().properties);
        let of_loops = registry.loops().flat_map(|one| &one.declaration().properties);
        for property in of_classes.chain(of_loops).chain(TaskProperties::declarations()) {
            words.allowed(property);
        }
        words.properties = joined(properties);
        words.services = joined(services);
        words.references = joined(references);
        words
    }

    fn interface(&mut self, interface: &InterfaceDeclaration) {
        let operations = interface.operations.as_array().into_iter().flatten();
        let names: Vec<&str> = operations.filter_map(|one| one["name"].as_str()).collect();
        let text = format!("Operations: {}.", names.join(", "));
        self.interfaces.entry(interface.name.clone()).or_insert(text);
    }

    fn allowed(&mut self, property: &PropertyDeclaration) {
        for text in &property.allowed {
            let said = self.values.entry(text.clone()).or_insert_with(|| "A value of".to_owned());
            let name = format!("`{}`", property.name);
            if !said.contains(&name) {
                said.push_str(if said.ends_with("of") { " " } else { ", " });
                said.push_str(&name);
            }
        }
        property.properties.iter().for_each(|inner| self.allowed(inner));
    }
}

fn say(all: &mut Said, name: &str, text: String, of: &str) {
    let said = all.entry(name.to_owned()).or_default();
    match said.iter_mut().find(|(known, _)| *known == text) {
        Some((_, whose)) => whose.push(of.to_owned()),
        None => said.push((text, vec![of.to_owned()])),
    }
}

/// A line for each thing that is said.
fn joined(all: Said) -> Names {
    let line = |(text, whose): (String, Vec<String>)| format!("{}: {text}", whose.join(", "));
    all.into_iter().map(|(name, said)| (name, said.into_iter().map(line).collect::<Vec<_>>().join("\n"))).collect()
}

fn add(text: &mut String, line: &str) {
    if !text.is_empty() {
        text.push('\n');
    }
    text.push_str(line);
}

fn paragraph(doc: &str) -> String {
    doc.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn about_class(class: &RegisteredClass) -> String {
    let declaration = class.declaration();
    let mut text = String::new();
    if class.is_alias() {
        add(&mut text, &format!("Another name of {}.", declaration.name));
    }
    if let Some(alias) = declaration.also.iter().find(|alias| alias.name == class.name()) {
        for (property, value) in &alias.preset {
            add(&mut text, &format!("The default of `{property}` is {value}."));
        }
    }
    add(&mut text, &paragraph(&declaration.doc));
    let required = declaration.properties.iter();
    let task = TaskProperties::declarations().iter().filter(|_| declaration.is_periodic());
    let required = required.chain(task).filter(|property| property.required);
    let mut required: Vec<String> = required.map(|property| format!("`{}`", property.name)).collect();
    required.dedup();
    if !required.is_empty() {
        add(&mut text, &format!("Required: {}.", required.join(", ")));
    }
    text
}

fn about_property(property: &PropertyDeclaration) -> String {
    let mut text = property.expected();
    if property.many {
        text.push_str(", any number of values");
    }
    match &property.default {
        Some(default) if !default.is_empty() => text.push_str(&format!(", `{default}` unless given")),
        _ if property.required => text.push_str(", required"),
        _ => {}
    }
    text.push_str(". ");
    text.push_str(&paragraph(&property.doc));
    for inner in &property.properties {
        add(&mut text, &format!("- {}: {}", inner.name, about_property(inner)));
    }
    text.trim_end().to_owned()
}

fn offers(interface: &InterfaceDeclaration) -> String {
    format!("offers {}.", interface.name)
}

fn calls(interface: &InterfaceDeclaration, optional: bool, many: bool) -> String {
    let targets = match (optional, many) {
        (true, true) => "any number of targets",
        (true, false) => "a target or none",
        (false, true) => "one target or more",
        (false, false) => "one target",
    };
    format!("calls {}, of {targets}.", interface.name)
}
