//! Hover texts for the part under the cursor.

use std::ops::Range;

use saoms_lang::diagnostic::codes;
use saoms_lang::load::vocabulary::{Holds, other, own_attributes};
use saoms_lang::syntax::{Element, ElementId};

use super::complete::language;
use super::complete::names::declared;
use super::complete::table;
use super::describe;
use super::scene::Scene;
use super::scene::outline::{Component, Implementation, Side};
use super::scene::symbol::{Symbol, at};
use super::scene::topics::RENAME;
use super::syntax::{Cursor, Places, local, trimmed};

/// The description of the thing at a byte, in Markdown, and the range of its name.
pub fn hover(scene: &Scene, byte: usize) -> Option<(String, Range<usize>)> {
    let file = scene.file();
    if let Some(found) = at(scene, byte)
        && let Some(text) = named(scene, &found.symbol, found.at.start)
    {
        return Some((text, found.at.start..found.at.end));
    }
    if file.is_beside {
        return table::hover(scene, byte);
    }
    match file.cursor(byte) {
        Cursor::ElementName { element: Some(element), name, .. } | Cursor::EndTag { element: Some(element), name } => {
            let text = match file.kind(element.id()) {
                Some(kind) => describe::element(kind),
                None => other(element.local_name())?.to_owned(),
            };
            Some((text, name))
        }
        Cursor::AttributeName { element, name } => {
            let (kind, written) = (file.kind(element.id())?, &file.text[name.clone()]);
            let of_sca = kind.attributes.iter().find(|known| known.name == written);
            let own = || own_attributes(kind).find(|known| written.contains(':') && known.name == local(written));
            Some((describe::attribute(of_sca.or_else(own)?), name))
        }
        Cursor::AttributeValue { element, attribute, value } => value_of(scene, element, attribute.name(), value, byte),
        Cursor::Text { parent: Some(element) } => {
            let inside = element.text_place()?;
            let is_value = element.local_name() == "value";
            let property = if is_value { element.parent()? } else { element };
            let touches = inside.start <= byte && byte <= inside.end;
            touches.then(|| value_of_property(scene, property, inside, byte)).flatten()
        }
        _ => None,
    }
}

/// The meaning of a name.
fn named(scene: &Scene, symbol: &Symbol, start: usize) -> Option<String> {
    match symbol {
        Symbol::Component { file, name } => {
            let (of, one) = scene.component(*file, name)?;
            Some(component(scene, of, one))
        }
        Symbol::Parameter { file, name } => {
            let outline = &scene.files[*file].outline;
            let one = outline.properties.iter().find(|one| one.text == *name)?;
            let value = scene.value_of(*file, one.element);
            let value = value.map_or_else(String::new, |value| format!(": `{value}`"));
            Some(format!("**{name}**, a property of the composite `{}`{value}", composite_name(scene, *file)))
        }
        Symbol::Promoted { file, side, name } => {
            let what = if *side == Side::Service { "service" } else { "reference" };
            Some(format!("**{name}**, a {what} of the composite `{}`", composite_name(scene, *file)))
        }
        Symbol::Part { file, component, side, name } => {
            let of = scene.component(*file, component)?;
            let one = scene.contract(of, *side, name)?;
            let (class, interface) = (scene.class(of.1)?.name(), &one.interface?.name);
            Some(match one.multiplicity {
                None => format!("**{name}**, a service of `{class}` with the interface `{interface}`"),
                Some(multiplicity) => {
                    format!("**{name}**, a reference of `{class}`, `{multiplicity}`, for the interface `{interface}`")
                }
            })
        }
        Symbol::Composite { file } => {
            let one = &scene.files[*file];
            let count = match one.outline.components.len() {
                1 => "1 component".to_owned(),
                count => format!("{count} components"),
            };
            let namespace = &one.outline.namespace;
            let name = composite_name(scene, *file);
            let path = one.path.display();
            Some(format!("**{name}**, a composite of `{namespace}`\n\n{count}, in `{path}`"))
        }
        Symbol::Loop { .. } => {
            let component = scene.component_around(scene.file().document.innermost(start as u32 + 1)?.id())?;
            let one = component.loops.iter().find(|one| one.name.at.start <= start && start <= one.name.at.end)?;
            let class = scene.class_of_loop((0, component), one)?;
            Some(describe::looping(scene.registry.get_loop(&class)?))
        }
        Symbol::Topic { name } => scene.about_topic(name),
        Symbol::Index { component, .. } => Some(format!("**index**, the number of each replica of `{component}`")),
        Symbol::Class { name } => match (scene.registry.get(name), scene.registry.get_loop(name)) {
            (Some(class), _) => Some(describe::class(class)),
            (None, one) => Some(describe::looping(one?)),
        },
    }
}

fn composite_name(scene: &Scene, file: usize) -> &str {
    scene.files[file].outline.name.as_ref().map_or("", |name| &name.text)
}

fn component(scene: &Scene, file: usize, one: &Component) -> String {
    let name = &one.name.text;
    let shown = scene.files[file].path.file_name().unwrap_or_default().to_string_lossy();
    let of = if file == 0 { String::new() } else { format!(", in `{shown}`") };
    match &one.implementation {
        Some(Implementation::Composite(inner)) => {
            format!("**{name}**, a component that the composite `{}` implements{of}", inner.text)
        }
        Some(Implementation::Class(class)) => {
            let about = scene.class(one).map_or("", |class| class.declaration().doc.as_str());
            format!("**{name}**, a component of the class `{}`{of}\n\n{about}", class.text)
        }
        None => format!("**{name}**, a component without an implementation{of}"),
    }
}

fn value_of(
    scene: &Scene,
    element: Element<'_>,
    name: &str,
    value: Range<usize>,
    byte: usize,
) -> Option<(String, Range<usize>)> {
    let file = scene.file();
    let kind = file.kind(element.id())?;
    let of_sca = kind.attributes.iter().find(|known| known.name == name);
    let own = || own_attributes(kind).find(|known| name.contains(':') && known.name == local(name));
    let known = of_sca.or_else(own)?;
    let at = trimmed(&file.text, value);
    if known.holds == Holds::Value
        && let Some(found) = value_of_property(scene, element, at.clone(), byte.clamp(at.start, at.end))
    {
        return Some(found);
    }
    let more = match known.holds {
        Holds::PropertyName => property(scene, element.parent()?.id(), &file.text[at.clone()]),
        Holds::Code => {
            let of_rules = scene.registry.rules().iter().map(|rule| rule.code());
            let mut all = codes::ALL.iter().copied().chain(of_rules);
            let found = all.find(|code| code.id == &file.text[at.clone()]);
            found.map(|code| describe::code(code, code.rule))
        }
        _ => None,
    };
    // Of what nothing more is known, at least what it is for.
    Some((more.unwrap_or_else(|| describe::attribute(known)), at))
}

fn property(scene: &Scene, parent: ElementId, name: &str) -> Option<String> {
    let (one, preset) = declared(scene, parent).into_iter().find(|(one, _)| one.name == name)?;
    Some(describe::property(one, preset))
}

/// The value of a property: what it has to be, or of `topicRename` the topic.
fn value_of_property(
    scene: &Scene,
    element: Element<'_>,
    value: Range<usize>,
    byte: usize,
) -> Option<(String, Range<usize>)> {
    let file = scene.file();
    let name = &file.text[element.value("name")?];
    if name == RENAME
        && let Some(component) = scene.component_around(element.id())
    {
        let is_part = |c: char| c != ',' && c != ':' && !c.is_whitespace();
        let before = file.text[value.start..byte].trim_end_matches(is_part).len();
        let behind = &file.text[byte..value.end];
        let at = value.start + before..byte + behind.len() - behind.trim_start_matches(is_part).len();
        let topics = scene.topics((0, component));
        if let Some(topic) = topics.iter().find(|one| one.declaration.name == file.text[at.clone()]) {
            return Some((describe::topic(topic.declaration), at));
        }
    }
    if let Some(language) = language::of_property(scene, 0, element.id())
        && let Some(found) = language::explain(&language, scene, value.clone(), byte)
    {
        return Some(found);
    }
    Some((property(scene, element.parent()?.id(), name)?, value))
}
