//! Values of properties.

use std::ops::Range;

use saoms_api::extension::DURATION_UNITS;
use saoms_api::host::declaration::PropertyKind;
use saoms_lang::registry::PropertyDeclaration;
use saoms_lang::syntax::{Element, ElementId};

use super::{Proposal, language, names, topics, value};
use crate::editor::describe;
use crate::editor::scene::Scene;
use crate::editor::scene::symbol::Symbol;
use crate::editor::scene::topics::RENAME;
use crate::editor::syntax::{Places, local};

/// The values that a property of a component, or of a loop, can have.
pub(super) fn complete(scene: &Scene, property: ElementId, range: Range<usize>, at: usize) -> Vec<Proposal> {
    let file = scene.file();
    let element = file.element(property);
    let Some(parent) = element.parent().map(Element::id) else { return Vec::new() };
    let Some(name) = element.value("name") else { return Vec::new() };
    let name = &file.text[name];
    if name == RENAME {
        return topics::complete(scene, property, range, at);
    }
    if let Some(language) = language::of_property(scene, 0, property) {
        return language::complete(&language, scene, range, at);
    }
    let declared = names::declared(scene, parent);
    let Some((one, preset)) = declared.into_iter().find(|(one, _)| one.name == name) else {
        let component = scene.component_around(parent);
        let inner = component.and_then(|one| scene.inner(0, one));
        return inner.map_or_else(Vec::new, |inner| as_used(scene, inner, name, &range, at));
    };
    let mut all = explained(one, preset, &file.text[range.start..at], &range);
    if name == "ID"
        && let Some(component) = scene.component_around(property)
    {
        all.push(value(&component.name.text, &range).detail("the name of the component"));
    }
    all
}

/// The values of a declared property, behind what is typed, each with what there is to say about it.
pub(super) fn explained(
    one: &PropertyDeclaration,
    preset: Option<&str>,
    typed: &str,
    range: &Range<usize>,
) -> Vec<Proposal> {
    let (doc, expected) = (describe::property(one, preset), one.expected());
    let all = of_declared(one, typed, range).into_iter();
    all.map(|item| if item.detail.is_empty() { item.detail(&expected) } else { item }.doc(&doc)).collect()
}

/// The values that a property of the composite can have.
pub(super) fn of_parameter(scene: &Scene, property: ElementId, range: Range<usize>, at: usize) -> Vec<Proposal> {
    let file = scene.file();
    let Some(name) = file.element(property).value("name") else { return Vec::new() };
    let name = &file.text[name];
    match language::of_parameter(scene, 0, name) {
        Some(language) => language::complete(&language, scene, range, at),
        None => as_used(scene, 0, name, &range, at),
    }
}

/// The values of a property of a composite: those of its type, or else those of the first property that takes its value
/// from it.
pub(super) fn as_used(scene: &Scene, file: usize, name: &str, range: &Range<usize>, at: usize) -> Vec<Proposal> {
    let Symbol::Parameter { file, name } = scene.parameter(file, name) else { return Vec::new() };
    let of = &scene.files[file];
    let declared = scene.property(file, &name);
    let r#type = declared.and_then(|one| of.element(one.element).value("type"));
    if r#type.is_some_and(|at| local(&of.text[at]) == "boolean") {
        return names::words(&["true", "false"], range);
    }
    let mut takers = scene.unit_of(file).iter().flat_map(|&place| {
        let sources = scene.files[place].outline.sources.iter().filter(|source| source.text == name);
        sources.filter_map(move |source| taker(scene, place, source.element))
    });
    let Some(one) = takers.next() else { return Vec::new() };
    explained(one, None, &scene.file().text[range.start..at], range)
}

/// The declaration of a property of a component of a file.
fn taker(scene: &Scene, file: usize, property: ElementId) -> Option<&PropertyDeclaration> {
    let of = &scene.files[file];
    let property = of.element(property);
    let name = &of.text[property.value("name")?];
    let declared = names::declared_in(scene, file, property.parent()?.id());
    declared.into_iter().map(|(one, _)| one).find(|one| one.name == name)
}

/// Proposals from the declaration, behind the typed text.
fn of_declared(one: &PropertyDeclaration, typed: &str, range: &Range<usize>) -> Vec<Proposal> {
    let is_default = |text: &str| one.default.as_deref() == Some(text);
    let mut all: Vec<Proposal> = match one.kind {
        PropertyKind::Boolean => ["true", "false"].map(|word| value(word, range)).into(),
        PropertyKind::Duration => {
            let number = typed.trim_end_matches(|c: char| c.is_ascii_alphabetic()).trim();
            let units = DURATION_UNITS.iter().zip(1..);
            match number.parse::<f64>() {
                Ok(_) => units
                    .map(|((unit, what), rank)| value(format!("{number}{unit}"), range).detail(*what).rank(rank))
                    .filter(|item| one.check(&item.label).is_ok())
                    .collect(),
                Err(_) => Vec::new(),
            }
        }
        _ => one.allowed.iter().map(|word| value(word, range)).collect(),
    };
    // The ends of the range, where they are values.
    let ends = [(&one.min, "the least"), (&one.max, "the greatest")];
    for (end, what) in ends {
        if let Some(end) = end.as_ref().filter(|end| !all.iter().any(|item| item.label == **end)) {
            all.push(value(end, range).detail(format!("{what}: {}", one.expected())).rank(7));
        }
    }
    if let Some(default) = one.default.as_deref().filter(|default| !default.is_empty())
        && !all.iter().any(|item| item.label == default)
    {
        all.push(value(default, range));
    }
    all.into_iter().map(|item| if is_default(&item.label) { item.detail("default").rank(0) } else { item }).collect()
}
