//! Components: of a class, with its properties and references, or of another composite.

use std::fmt::Write as _;

use saoms_api::host::declaration::PropertyKind;
use saoms_lang::assembly::TaskProperties;
use saoms_lang::load::vocabulary::{COMPONENT, LOOP};
use saoms_lang::registry::{PropertyDeclaration, RegisteredClass};

use super::{Writer, values};

/// The components of a composite: their names, and the classes that they may have; the first of these is the likeliest.
pub(super) const COMPONENTS: &[(&str, &[&str])] = &[
    ("W", &["saoms.World", "resources.robotEnvironment.Robot"]),
    ("R1", &["robot.Robot001", "saoms.Robot"]),
    ("E", &["saoms.Environment", "launch.Environment"]),
    ("R2", &["saoms.Robot", "resources.robotEnvironment.Navigator"]),
    ("M", &["saoms.MasterRobot", "saoms.MasterEnvironment"]),
    ("B", &["saoms.MessageBroker", "resources.robotEnvironment.GPS"]),
    ("R1", &["saoms.Robot"]),
    ("ä.b", &["robot.Robot002"]),
];

/// Writes one of them.
pub(super) fn component(writer: &mut Writer<'_, '_>, place: usize) {
    let (name, classes) = COMPONENTS[place];
    writer.is_replicated = writer.choices.once_in(5);
    let _ = write!(writer.text, "<component name=\"{name}");
    if writer.is_replicated {
        writer.text.push_str(writer.choices.of(&["${index}", "-${index:03}", "${index * 2}", ""]));
        writer.text.push('"');
        let count = if writer.choices.once_in(8) {
            super::expression::number(writer.choices, 2)
        } else {
            writer.choices.below(4).to_string()
        };
        writer.text.push_str(" s:count=\"");
        writer.put(&count);
    }
    writer.text.push('"');
    if writer.is_replicated && writer.choices.once_in(3) {
        writer.text.push_str(" s:overrides=\"table.csv\"");
    }
    if writer.choices.once_in(6) {
        writer.attributes(&COMPONENT, &["name", "count", "overrides"]);
    }
    writer.text.push_str(">\n");
    match writer.choices.below(8) {
        0..6 => of_class(writer, place, classes),
        6 => of_composite(writer),
        _ => writer.child(&COMPONENT),
    }
    for _ in 0..writer.choices.below(3) {
        if writer.choices.once_in(4) { writer.element(&LOOP) } else { writer.child(&COMPONENT) }
    }
    writer.text.push_str("</component>\n");
    writer.is_replicated = false;
}

fn of_composite(writer: &mut Writer<'_, '_>) {
    let name = writer.choices.of(&["t:a", "t:b", "b", "o:b", "t:fleet", "a"]);
    let _ = writeln!(writer.text, "<implementation.composite name=\"{name}\"/>");
}

fn of_class(writer: &mut Writer<'_, '_>, place: usize, classes: &[&str]) {
    let registry = writer.registry;
    let any = if writer.choices.once_in(8) {
        registry.iter().nth(writer.choices.below(registry.len())).map(AsRef::as_ref)
    } else {
        registry.get(classes[writer.choices.below(classes.len())]).map(AsRef::as_ref)
    };
    let Some(class) = any else { return };
    let language = writer.choices.of(&["java", "s:rust"]);
    let tag = language
        .strip_prefix("s:")
        .map_or_else(|| format!("implementation.{language}"), |own| format!("s:implementation.{own}"));
    let _ = writeln!(writer.text, "<{tag} class=\"{}\"/>", class.name());
    let declaration = class.declaration();
    let task = if declaration.is_periodic() { TaskProperties::declarations() } else { &[] };
    for property in declaration.properties.iter().chain(task) {
        let is_given = match property.required {
            true => !writer.choices.once_in(32),
            false => writer.choices.once_in(8),
        };
        if is_given {
            self::property(writer, property, place);
        }
    }
    references(writer, class);
}

fn property(writer: &mut Writer<'_, '_>, declared: &PropertyDeclaration, place: usize) {
    let name = &declared.name;
    let _ = write!(writer.text, "<property name=\"{name}\"");
    if writer.choices.once_in(16) {
        let from = writer
            .choices
            .of(&["source=\"$p\"", "source=\"$q/a\"", "source=\"$site\"", "file=\"value.txt\"", "many=\"true\""]);
        let _ = writeln!(writer.text, " {from}/>");
        return;
    }
    let mut value = values::of(writer.choices, declared, place);
    if writer.is_replicated && (declared.unique.is_some() || writer.choices.once_in(8)) {
        value.push_str(writer.choices.of(&["${index}", "${index:02}", "${q}", "$${", "${(index - 1) % 2 * 3}"]));
    }
    match writer.choices.below(4) {
        _ if declared.kind == PropertyKind::Complex => {
            writer.text.push('>');
            writer.text.push_str(&value);
            writer.text.push_str("</property>\n");
        }
        3 => {
            writer.text.push_str(" value=\"");
            writer.put(&value);
            writer.text.push_str("\"/>\n");
        }
        2 => {
            writer.text.push_str("><value>");
            writer.put(&value);
            writer.text.push_str("</value></property>\n");
        }
        _ => {
            writer.text.push('>');
            writer.put(&value);
            writer.text.push_str("</property>\n");
        }
    }
}

fn references(writer: &mut Writer<'_, '_>, class: &RegisteredClass) {
    for reference in &class.declaration().references {
        if writer.choices.once_in(6) {
            continue;
        }
        let target = writer.choices.of(&["W", "W", "W", "W/Hardware", "R1", "R1*", "W R1", "E/TaskInterface", "Q"]);
        let _ = writeln!(writer.text, "<reference name=\"{}\" target=\"{target}\"/>", reference.name);
    }
}
