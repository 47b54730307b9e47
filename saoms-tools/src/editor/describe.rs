//! Documentation of classes, properties, loops and elements in Markdown, for hovering and completion.

use std::fmt::Write;

use saoms_lang::assembly::TaskProperties;
use saoms_lang::diagnostic::Code;
use saoms_lang::load::vocabulary::{Kind, Known, children};
use saoms_lang::registry::{ClassDeclaration, ClassTopic, PropertyDeclaration, RegisteredClass, RegisteredLoop};

/// A class, all about it.
pub(crate) fn class(class: &RegisteredClass) -> String {
    let declaration = class.declaration();
    let kind = if declaration.is_periodic() { "periodic" } else { "passive" };
    let mut text = format!("**{}** ({kind} class)\n\n{}\n", class.name(), declaration.doc);
    if class.is_alias() {
        let _ = write!(text, "\nAnother name of `{}`", declaration.name);
        let presets = presets(class);
        text.push_str(&if presets.is_empty() { ".\n".to_owned() } else { format!(", with {presets}.\n") });
    }
    if let Some(origin) = class.origin() {
        let _ = writeln!(text, "\nFrom the plugin `{}`.", origin.display());
    }
    let required = properties(declaration).filter(|one| one.required && preset(class, &one.name).is_none());
    list(&mut text, "Needs", required.map(|one| one.name.as_str()));
    let own = declaration.properties.iter().filter(|one| !one.required);
    list(&mut text, "Properties", own.map(|one| one.name.as_str()));
    list(&mut text, "Publishes", declaration.publishes.iter().map(|one| one.name.as_str()));
    list(&mut text, "Subscribes to", declaration.subscribes.iter().map(|one| one.name.as_str()));
    list(&mut text, "Takes the events", declaration.takes.iter().map(|one| one.event.as_str()));
    list(&mut text, "Services", declaration.offers().map(|one| one.name.as_str()));
    list(&mut text, "References", declaration.references.iter().map(|one| one.name.as_str()));
    for (value, names) in declaration.loops.all() {
        let property = declaration.loops.property.as_deref().unwrap_or_default();
        let title = value.map_or_else(|| "Loops".to_owned(), |value| format!("Loops where {property} is `{value}`"));
        list(&mut text, &title, names.iter().map(String::as_str));
    }
    text
}

/// Its own properties, then those of every task where it is one.
pub(crate) fn properties(class: &ClassDeclaration) -> impl Iterator<Item = &PropertyDeclaration> {
    let task = TaskProperties::declarations_of(class);
    let inherited = task.iter().filter(|one| class.property(&one.name).is_none());
    class.properties.iter().chain(inherited)
}

/// The preset of the property by the name of the class.
pub(crate) fn preset<'a>(class: &'a RegisteredClass, property: &str) -> Option<&'a str> {
    let also = class.declaration().also.iter().find(|alias| alias.name == class.name())?;
    also.preset.get(property).map(String::as_str)
}

fn presets(class: &RegisteredClass) -> String {
    let also = class.declaration().also.iter().find(|alias| alias.name == class.name());
    let presets = also.iter().flat_map(|alias| &alias.preset);
    let shown: Vec<String> = presets.map(|(name, value)| format!("`{name}` = `{value}`")).collect();
    shown.join(", ")
}

/// A property: what it expects, its default, what it is for.
pub(crate) fn property(one: &PropertyDeclaration, preset: Option<&str>) -> String {
    let mut text = format!("**{}**: {}\n\n{}\n", one.name, facts(one, preset), one.doc);
    if let Some(scope) = &one.unique {
        let _ = writeln!(text, "\nNo two components of the fleet have the same ({scope}).");
    }
    text
}

/// The type of a property and its default, in a line.
pub(crate) fn facts(one: &PropertyDeclaration, preset: Option<&str>) -> String {
    let mut facts = vec![one.expected()];
    if one.many {
        facts.push("any number of values".to_owned());
    }
    facts.push(match (preset, &one.default) {
        (Some(preset), _) => format!("preset `{preset}`"),
        (None, Some(default)) if default.is_empty() => "default is empty".to_owned(),
        (None, Some(default)) => format!("default `{default}`"),
        (None, None) if one.required => "required".to_owned(),
        (None, None) => "optional".to_owned(),
    });
    facts.join(", ")
}

/// A loop, all about it.
pub(crate) fn looping(one: &RegisteredLoop) -> String {
    let declaration = one.declaration();
    let mut text = format!("**{}** (loop)\n\n{}\n", declaration.name, declaration.doc);
    if let Some(origin) = one.origin() {
        let _ = writeln!(text, "\nFrom the plugin `{}`.", origin.display());
    }
    if let Some(knowledge) = &declaration.knowledge {
        let _ = writeln!(text, "\nWorks on the knowledge `{knowledge}`.");
    }
    list(&mut text, "Properties", declaration.properties.iter().map(|one| one.name.as_str()));
    list(&mut text, "Senses", declaration.senses.iter().map(String::as_str));
    list(&mut text, "Effects", declaration.effects.iter().map(String::as_str));
    list(&mut text, "Adds", declaration.entries.iter().map(|one| one.name.as_str()));
    list(&mut text, "Publishes", declaration.publishes.iter().map(|one| one.name.as_str()));
    list(&mut text, "Subscribes to", declaration.subscribes.iter().map(|one| one.name.as_str()));
    text
}

/// The meaning of a diagnostic's code in Markdown, with the rule of SCA that it is about.
pub(super) fn code(one: &Code, rule: Option<&str>) -> String {
    let rule = rule.map_or_else(String::new, |rule| format!(" SCA Assembly: {rule}."));
    format!("**{} {}**: {}{rule}", one.id, one.name, one.meaning)
}

/// A topic, as a class or a loop declares it.
pub(crate) fn topic(one: &ClassTopic) -> String {
    format!("**{}**: a topic of `{}` ({})", one.name, one.message, one.kind.name())
}

/// An element: what it is for, what it has and holds.
pub(crate) fn element(kind: &Kind) -> String {
    let mut text = format!("**{}**\n\n{}\n", kind.name, kind.doc);
    list(&mut text, "Attributes", kind.attributes.iter().map(|known| known.name));
    list(&mut text, "Holds", children(kind));
    text
}

/// An attribute.
pub(crate) fn attribute(known: &Known) -> String {
    let required = if known.required { " (required)" } else { "" };
    format!("**{}**{required}\n\n{}", known.name, known.doc)
}

fn list<'n>(text: &mut String, title: &str, names: impl Iterator<Item = &'n str>) {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    if !names.is_empty() {
        let _ = writeln!(text, "\n{title}: {}", names.join(", "));
    }
}
