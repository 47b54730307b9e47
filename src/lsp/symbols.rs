//! The parts of a file, for outlines and for going to one by name.

use std::sync::Arc;

use lsp_types::{DocumentSymbol, SymbolKind};

use super::file::File;
use super::outline::{Component, Implementation, Named};

/// The parts of a composite as a tree.
pub(super) fn symbols(file: &File) -> Vec<DocumentSymbol> {
    let outline = &file.outline;
    let named = |names: &[Named], kind, what: &str| -> Vec<DocumentSymbol> {
        names.iter().map(|name| symbol(file, name, kind, what, Vec::new())).collect()
    };
    let mut parts = named(&outline.includes, SymbolKind::MODULE, "include");
    parts.extend(named(&outline.properties, SymbolKind::PROPERTY, "property"));
    parts.extend(named(&outline.services, SymbolKind::INTERFACE, "service"));
    parts.extend(named(&outline.references, SymbolKind::EVENT, "reference"));
    parts.extend(outline.components.iter().map(|one| component(file, one)));
    // In the order of the file.
    parts.sort_by_key(|one| (one.range.start.line, one.range.start.character));
    match &outline.name {
        Some(name) => vec![symbol(file, name, SymbolKind::MODULE, &outline.namespace, parts)],
        None => parts,
    }
}

/// The composites of files and their components whose names hold the letters of a query, in their order: each with its file, its kind and the composite that it is in.
pub(super) fn matching<'f>(
    files: &'f [Arc<File>],
    query: &str,
) -> Vec<(&'f File, &'f Named, SymbolKind, &'f str)> {
    let query = query.to_lowercase();
    let fits = |name: &str| {
        let name = name.to_lowercase();
        let mut letters = name.chars();
        query.chars().all(|wanted| letters.any(|known| known == wanted))
    };
    let mut all = Vec::new();
    for file in files {
        let name = file.outline.name.as_ref();
        let composite = name.map_or("", |name| name.text.as_str());
        let own = name.map(|name| (&**file, name, SymbolKind::MODULE, file.outline.namespace.as_str()));
        let components = file.outline.components.iter();
        let inside = components.map(|one| (&**file, &one.name, SymbolKind::CLASS, composite));
        all.extend(
            own.into_iter().chain(inside).filter(|(_, name, ..)| !name.text.is_empty() && fits(&name.text)),
        );
    }
    all
}

fn component(file: &File, component: &Component) -> DocumentSymbol {
    let named = |names: &[Named], kind, what: &str| -> Vec<DocumentSymbol> {
        names.iter().map(|name| symbol(file, name, kind, what, Vec::new())).collect()
    };
    let mut parts = named(&component.properties, SymbolKind::PROPERTY, "");
    for one in &mut parts {
        one.detail = value(file, &component.properties, &one.name);
    }
    parts.extend(named(&component.services, SymbolKind::INTERFACE, "service"));
    parts.extend(named(&component.references, SymbolKind::EVENT, "reference"));
    let loops: Vec<Named> = component.loops.iter().map(|one| one.name.clone()).collect();
    parts.extend(named(&loops, SymbolKind::FUNCTION, "loop"));
    parts.sort_by_key(|one| (one.range.start.line, one.range.start.character));
    let class = match &component.implementation {
        Some(Implementation::Class(name) | Implementation::Composite(name)) => name.text.as_str(),
        None => "",
    };
    symbol(file, &component.name, SymbolKind::CLASS, class, parts)
}

/// The value of a property, short.
fn value(file: &File, properties: &[Named], name: &str) -> Option<String> {
    let one = properties.iter().find(|one| one.text == name)?;
    let tree = &file.tree;
    let source = tree.value(&file.text, one.element, "source");
    let given = tree.value(&file.text, one.element, "value").or_else(|| tree.text(&file.text, one.element));
    let value = &file.text[given.or(source)?];
    Some(value.lines().next().unwrap_or_default().chars().take(40).collect())
}

#[expect(deprecated, reason = "the field has to be given, and nothing is deprecated here")]
fn symbol(
    file: &File,
    name: &Named,
    kind: SymbolKind,
    detail: &str,
    children: Vec<DocumentSymbol>,
) -> DocumentSymbol {
    let element = &file.tree.elements[name.element];
    let range = file.lines.range(&file.text, element.tag.start..element.end.max(element.tag.end));
    DocumentSymbol {
        // A name must not be empty.
        name: if name.text.is_empty() { "?".to_owned() } else { name.text.clone() },
        detail: (!detail.is_empty()).then(|| detail.to_owned()),
        kind,
        tags: None,
        deprecated: None,
        range,
        selection_range: file.lines.range(&file.text, name.at.clone()),
        children: (!children.is_empty()).then_some(children),
    }
}
