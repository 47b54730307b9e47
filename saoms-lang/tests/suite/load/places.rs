//! Every reported place is right.

use std::collections::HashSet;

use saoms_lang::diagnostic::codes;
use saoms_lang::model::{Composite, Contract, ImplementationKind, Part, Property, ReferenceElement, ServiceElement};
use saoms_lang::source::{Location, Span, Text};
use saoms_lang::syntax;
use saoms_tools::diagnostics::{human, json};

use crate::load::support::loaded;

/// Loads a text under a name and holds every place in model and diagnostics to the text. Gives errors and warnings as
/// `code [marked text]`.
pub(crate) fn checked(name: &str, text: &str) -> Vec<String> {
    let (composite, sources, diagnostics) = loaded(name, text);
    if let Some(composite) = &composite {
        for text in texts(composite) {
            let written = sources.snippet(text.location);
            let is_literal = !written.contains(['&', '<', '\n', '\r', '\t']);
            assert!(!is_literal || written == text.as_str(), "{name}: {text:?} is written as {written:?}");
        }
        for part in parts(composite) {
            let element = composite.document.innermost(part.span.start).unwrap();
            assert_eq!(element.name_location(), part, "{name}");
        }
    }
    let known = places(text);
    let found = diagnostics.into_sorted();
    for one in &found {
        let labels = one.labels.iter().map(|label| label.location);
        let edits = one.suggestions.iter().flat_map(|one| &one.edits).map(|edit| edit.location);
        for place in labels.chain(edits).chain([one.location]) {
            let Span { start, end } = place.span;
            assert!(start <= end && text.get(start as usize..end as usize).is_some(), "{name}: {one:?}");
        }
        let is_known = known.as_ref().is_none_or(|known| known.contains(&one.location.span));
        assert!(is_known || one.code == &codes::TOO_MANY, "{name}: no thing is at {one:?}");
    }
    // Whatever it is, it can be shown.
    human(&found, &sources, false);
    json(&found, &sources);
    let shown = |location: Location| sources.snippet(location).to_owned();
    found.iter().map(|one| format!("{} {} [{}]", one.severity.name(), one.code.id, shown(one.location))).collect()
}

/// The places of all names, attributes, values and texts of a well-formed text.
fn places(text: &str) -> Option<HashSet<Span>> {
    let parse = syntax::parse(saoms_lang::source::FileId(0), &std::sync::Arc::new(text.into()));
    let document = parse.well_formed().ok()?;
    let mut all = HashSet::new();
    for element in document.elements() {
        let slice = |span: Span| &text[span.start as usize..span.end as usize];
        assert_eq!(slice(element.name_span()), element.name());
        assert!(element.end_name_span().is_none_or(|end| slice(end) == element.name()));
        assert!(slice(element.start_tag_span()).starts_with('<') && slice(element.start_tag_span()).ends_with('>'));
        assert_eq!(document.innermost(element.span().start + 1).unwrap().id(), element.id());
        all.insert(element.name_span());
        all.extend(element.text_span());
        for attribute in element.attributes().chain(element.namespace_declarations()) {
            assert_eq!(slice(attribute.name_span()), attribute.name());
            assert!(slice(attribute.span()).ends_with(['"', '\'']));
            let trimmed = attribute.trimmed().location.span;
            all.extend([attribute.name_span(), attribute.span(), attribute.value_span(), trimmed]);
            // Of a list, the word that is wrong.
            all.extend(attribute.words().map(|word| word.location.span));
        }
    }
    Some(all)
}

/// Every text of the model that the file states.
fn texts(composite: &Composite) -> Vec<&Text> {
    let mut all = vec![&composite.name];
    all.extend(&composite.target_namespace);
    for include in &composite.includes {
        all.push(&include.name);
        all.extend(&include.uri);
    }
    for wire in &composite.wires {
        all.extend(wire.source.iter().chain(&wire.target));
    }
    composite.properties.iter().for_each(|one| property(one, &mut all));
    composite.services.iter().for_each(|one| service(one, &mut all));
    composite.references.iter().for_each(|one| reference(one, &mut all));
    for component in &composite.components {
        all.push(&component.name);
        if let Some(implementation) = &component.implementation {
            match &implementation.kind {
                ImplementationKind::Java { class } => all.extend(class),
                ImplementationKind::Composite { name } => all.extend(name),
                ImplementationKind::Rust { class, library } => {
                    all.extend(class);
                    all.extend(library.as_ref());
                }
                ImplementationKind::Python(python) => {
                    all.extend(&python.module);
                    all.extend(&python.class);
                }
                ImplementationKind::Other { .. } => {}
            }
        }
        component.properties.iter().for_each(|one| property(one, &mut all));
        component.services.iter().for_each(|one| service(one, &mut all));
        component.references.iter().for_each(|one| reference(one, &mut all));
    }
    all.retain(|text| !text.is_empty());
    all
}

fn property<'a>(property: &'a Property, all: &mut Vec<&'a Text>) {
    all.push(&property.name);
    all.extend(property.value.as_ref());
    // Text between markup is longer in the file than in the model.
    all.extend(property.text.as_ref().into_iter().filter(|_| property.content().is_empty()));
    all.extend([property.r#type(), property.element(), property.source(), property.file()].into_iter().flatten());
    all.extend(property.values().iter().filter(|one| one.content.is_empty()).map(|one| &one.text));
}

fn service<'a>(service: &'a ServiceElement, all: &mut Vec<&'a Text>) {
    all.push(&service.name);
    all.extend(service.promote.as_ref());
    contract(service.contract(), all);
}

fn reference<'a>(reference: &'a ReferenceElement, all: &mut Vec<&'a Text>) {
    all.push(&reference.name);
    all.extend(reference.targets.iter().chain(&reference.promote));
    contract(reference.contract(), all);
}

fn contract<'a>(contract: &'a Contract, all: &mut Vec<&'a Text>) {
    let Contract { interface, bindings, callback } = contract;
    if let Some(interface) = interface {
        all.extend(&interface.interface);
    }
    for binding in bindings.iter().chain(callback.iter().flat_map(|callback| &callback.bindings)) {
        all.extend(binding.name.as_ref());
        all.extend(&binding.uri);
    }
}

/// The tags of components and what they hold.
fn parts(composite: &Composite) -> Vec<Location> {
    let mut all = vec![composite.tag()];
    for component in &composite.components {
        all.push(component.tag());
        all.extend(component.implementation.iter().map(Part::tag));
        all.extend(component.properties.iter().map(Part::tag));
        all.extend(component.services.iter().map(Part::tag));
        all.extend(component.references.iter().map(Part::tag));
    }
    all
}
