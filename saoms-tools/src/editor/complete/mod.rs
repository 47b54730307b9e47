//! Completion: the texts that can be written at a place.

mod attributes;
mod completion;
mod elements;
mod ends;
pub(super) mod language;
pub(super) mod names;
mod paths;
mod sources;
pub(super) mod table;
#[cfg(test)]
mod tests;
pub(super) mod topics;
mod types;
mod values;

use std::ops::Range;

use saoms_lang::diagnostic::SeverityLevel;
use saoms_lang::load::vocabulary::{
    BINDING_SCA, COMPONENT, COMPONENT_PROPERTY, COMPOSITE, COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE,
    Holds, own_attributes,
};
use saoms_lang::model::{Hangup, Multiplicity};
use saoms_lang::syntax::{Element, ElementId};

use super::scene::Scene;
use super::scene::expressions::template_before;
use super::scene::outline::{Component, Side};
use super::syntax::{Cursor, Places, bytes, is_declaration, local, trimmed};
pub use completion::{Insert, Proposal, ProposalKind};

/// The completions at a byte of the file.
pub fn complete(scene: &Scene, at: usize) -> Vec<Proposal> {
    let file = scene.file();
    if file.is_beside {
        return beside(scene, at);
    }
    if let Some(entities) = entities(scene, at) {
        return entities;
    }
    match file.cursor(at) {
        Cursor::ElementName { parent, element, name } => elements::in_tag(scene, parent, element, &name),
        Cursor::EndTag { element, name } => elements::end(scene, element, &name, at),
        Cursor::AttributeName { element, name } => attributes::complete(scene, element, &name),
        Cursor::AttributeValue { element, attribute, value } => {
            // What is behind the cursor stays where the value has no end yet.
            let value = value.start..if attribute.is_closed() { value.end } else { at };
            value_of(scene, element.id(), attribute.name(), value, at)
        }
        Cursor::Text { parent } => in_text(scene, parent, at),
        Cursor::Opaque => Vec::new(),
    }
}

/// Proposals behind a `&`: the characters that must be escaped in some places (XML 1.0, 4.6). `None` where there is
/// none.
fn entities(scene: &Scene, at: usize) -> Option<Vec<Proposal>> {
    const ENTITIES: [(&str, &str); 5] =
        [("&amp;", "&"), ("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'")];
    let text = &scene.file().text;
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '#';
    let start = text[..at].trim_end_matches(is_part).strip_suffix('&')?.len();
    let can_be = matches!(scene.file().cursor(at), Cursor::Text { parent: Some(_) } | Cursor::AttributeValue { .. });
    let behind = text[at..].len() - text[at..].trim_start_matches(is_part).len();
    let end = at + behind + usize::from(text[at + behind..].starts_with(';'));
    let one = |(name, meant): (&str, &str)| Proposal::new(name, ProposalKind::Constant, &(start..end)).detail(meant);
    can_be.then(|| ENTITIES.map(one).into())
}

/// Proposals in a file that holds values.
fn beside(scene: &Scene, at: usize) -> Vec<Proposal> {
    if let Some(of) = table::owner(scene) {
        return table::complete(scene, of, at);
    }
    let whole = 0..scene.file().text.len();
    let mut owners = scene.owners().iter();
    let found = owners.find_map(|&file| {
        let of = &scene.files[file];
        let of_components = of.outline.components.iter().find_map(|one| {
            let property = one.files.iter().find(|name| scene.is_first(file, name))?;
            if let Some(inside) = one.is_replicated.then(|| template(scene, file, one, &whole, at)).flatten() {
                return Some(inside);
            }
            let language = language::of_property(scene, file, property.element)?;
            Some(language::complete(&language, scene, whole.clone(), at))
        });
        of_components.or_else(|| {
            let mut properties = of.outline.properties.iter().filter(|one| {
                let mut named = of.outline.beside_of(one.element);
                named.any(|name| scene.is_first(file, name))
            });
            let language = properties.find_map(|one| language::of_parameter(scene, file, &one.text))?;
            Some(language::complete(&language, scene, whole.clone(), at))
        })
    });
    found.unwrap_or_default()
}

/// The values of an attribute.
fn value_of(scene: &Scene, element: ElementId, name: &str, value: Range<usize>, at: usize) -> Vec<Proposal> {
    let file = scene.file();
    let Some(kind) = file.kind(element) else { return Vec::new() };
    if is_declaration(name) {
        return attributes::namespaces(&value);
    }
    let of_sca = kind.attributes.iter().find(|known| known.name == name);
    let own = || own_attributes(kind).find(|known| name.contains(':') && known.name == local(name));
    let Some(known) = of_sca.or_else(own) else { return Vec::new() };
    let is_of = |other| std::ptr::eq(kind, other);
    let is_name = is_of(&COMPONENT) && name == "name";
    if let Some(inside) = in_template(scene, element, is_name, &value, at) {
        return inside;
    }
    match known.holds {
        Holds::Boolean => names::words(&["true", "false"], &value),
        Holds::Hangup => names::words(&Hangup::ALL.map(Hangup::name), &value),
        Holds::Level => names::words(&SeverityLevel::ALL.map(SeverityLevel::name), &value),
        Holds::Code => names::codes(scene, &value),
        Holds::Multiplicity => names::words(&Multiplicity::ALL.map(Multiplicity::name), &value),
        Holds::PropertyName => names::properties(scene, element, &value),
        Holds::ServiceName => names::parts(scene, element, Side::Service, &value),
        Holds::ReferenceName => names::parts(scene, element, Side::Reference, &value),
        Holds::Class => names::classes(scene, &value),
        Holds::Interface => names::interfaces(scene, element, &value),
        Holds::LoopName => names::loops(scene, element, name, &value),
        Holds::LoopClass => names::loop_classes(scene, element, &value),
        Holds::Composite => names::composites(scene, element, &value),
        Holds::End | Holds::Ends => ends::complete(scene, element, name, value, at),
        Holds::Source => sources::complete(scene, value, at),
        Holds::Value if is_of(&COMPONENT_PROPERTY) => values::complete(scene, element, value, at),
        Holds::Value => values::of_parameter(scene, element, value, at),
        // The expressions are over properties of the composite.
        Holds::Number => names::parameters(scene, None, &names::word_at(&file.text, value, at)),
        Holds::Condition => {
            let replicated = scene.component_around(element).filter(|one| one.is_replicated);
            names::parameters(scene, replicated, &names::word_at(&file.text, value, at))
        }
        Holds::Type => types::complete(scene, element, &value),
        Holds::Element => types::elements(scene, element, &value),
        Holds::Variable => types::variables(scene, element, &value),
        Holds::File => paths::complete(scene, &value, at, paths::is_value),
        Holds::Table => paths::complete(scene, &value, at, paths::is_table),
        Holds::Library => paths::libraries(scene, element, &value, at),
        Holds::Namespace => names::namespaces(scene, &value),
        // What the binding of a reference leads to is a target.
        Holds::Uri if is_of(&BINDING_SCA) && in_reference(scene, element) => {
            ends::complete(scene, element, "target", value, at)
        }
        Holds::Name if is_of(&COMPOSITE) => names::of_file(scene, &value),
        Holds::Name if is_of(&COMPOSITE_SERVICE) || is_of(&COMPOSITE_REFERENCE) => {
            names::promoted(scene, element, &value)
        }
        Holds::Name | Holds::Uri | Holds::Names | Holds::Duration | Holds::Text => Vec::new(),
    }
}

/// The names in the `${...}` that a byte is in; `None` where it is in none.
fn in_template(
    scene: &Scene,
    element: ElementId,
    is_name: bool,
    range: &Range<usize>,
    at: usize,
) -> Option<Vec<Proposal>> {
    // The name is typed before it is said how many there are.
    let component = scene.component_around(element).filter(|one| one.is_replicated || is_name)?;
    template(scene, 0, component, range, at)
}

/// The same in a text of a replicated component of a file.
fn template(
    scene: &Scene,
    file: usize,
    component: &Component,
    range: &Range<usize>,
    at: usize,
) -> Option<Vec<Proposal>> {
    let text = &scene.file().text;
    let expression = template_before(text, range.clone(), at)?;
    let end = text[at..range.end].find(['}', '\n']).map_or(range.end, |found| at + found);
    let word = names::word_at(text, expression.start..end, at);
    Some(names::parameters_of(scene, file, Some(component), &word))
}

fn in_reference(scene: &Scene, element: ElementId) -> bool {
    let parent = scene.file().element(element).parent();
    parent.is_some_and(|parent| parent.local_name() == "reference")
}

/// Proposals in the content of an element.
fn in_text(scene: &Scene, parent: Option<Element<'_>>, at: usize) -> Vec<Proposal> {
    let file = scene.file();
    let Some(element) = parent else { return elements::in_content(scene, None, at) };
    let is_property = |one: &Element<'_>| {
        let kinds = [&COMPONENT_PROPERTY, &COMPOSITE_PROPERTY];
        file.kind(one.id()).is_some_and(|kind| kinds.iter().any(|known| std::ptr::eq(kind, *known)))
    };
    let property = match (file.kind(element.id()), element.parent()) {
        (Some(_), _) => Some(element).filter(is_property),
        // A `<value>` of a property.
        (None, outer) if element.local_name() == "value" => outer.filter(is_property),
        _ => None,
    };
    let Some(property) = property.map(Element::id) else { return elements::in_content(scene, parent, at) };
    if element.children().next().is_some() {
        return elements::in_content(scene, parent, at);
    }
    let end_tag = element.end_tag_span().map(bytes);
    let end = end_tag.as_ref().map_or(at, |tag| tag.start).max(at);
    let inside = trimmed(&file.text, element.tag().end..end);
    let element = element.id();
    // An empty text is where the cursor is; one that is there already is replaced.
    let range = match (inside.is_empty(), &end_tag) {
        (true, _) => at..at,
        (false, Some(_)) => inside.start.min(at)..inside.end.max(at),
        (false, None) => inside.start.min(at)..at,
    };
    // What is replaced is within a line, as the protocol asks.
    let line_start = file.text[..at].rfind(['\n', '\r']).map_or(0, |found| found + 1);
    let line_end = file.text[at..].find(['\n', '\r']).map_or(file.text.len(), |found| at + found);
    let range = range.start.max(line_start)..range.end.min(line_end);
    if let Some(inside) = in_template(scene, element, false, &range, at) {
        return inside;
    }
    match file.kind(property) {
        Some(kind) if std::ptr::eq(kind, &COMPOSITE_PROPERTY) => values::of_parameter(scene, property, range, at),
        _ => values::complete(scene, property, range, at),
    }
}

/// A proposal of a value.
fn value(label: impl Into<String>, range: &Range<usize>) -> Proposal {
    Proposal::new(label, ProposalKind::Value, range)
}
