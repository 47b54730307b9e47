//! The parts of a file, for outlines and for going to one by name.

use std::ops::Range;
use std::sync::Arc;

use super::scene::file::File;
use super::scene::outline::{Component, Implementation, Named};
use super::syntax::Places;

/// A named part of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentSymbol {
    /// Its name, which may be empty while it is typed.
    pub name: String,
    /// A short text beside the name, as the class of a component; may be empty.
    pub detail: String,
    /// The kind of part.
    pub kind: SymbolKind,
    /// The bytes of the whole element.
    pub range: Range<usize>,
    /// The bytes of the name.
    pub name_range: Range<usize>,
    /// The parts inside, in the order of the file.
    pub children: Vec<DocumentSymbol>,
}

/// The kind of a named part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    /// A composite, or the name of one that is included.
    Composite,
    /// A component.
    Component,
    /// A property.
    Property,
    /// A service.
    Service,
    /// A reference.
    Reference,
    /// A loop of a component.
    Loop,
}

/// A composite or a component that was found by its name.
#[derive(Clone, Copy, Debug)]
pub struct WorkspaceSymbol<'f> {
    /// The file that it is in.
    pub file: &'f File,
    /// Its name.
    pub name: &'f str,
    /// The bytes of the name.
    pub start: usize,
    /// The byte behind the name.
    pub end: usize,
    /// The kind of part.
    pub kind: SymbolKind,
    /// The composite around a component, or the namespace of a composite; may be empty.
    pub container: &'f str,
}

/// The parts of a composite as a tree.
pub fn document_symbols(file: &File) -> Vec<DocumentSymbol> {
    let outline = &file.outline;
    let named = |names: &[Named], kind, what: &str| -> Vec<DocumentSymbol> {
        names.iter().map(|name| symbol(file, name, kind, what, Vec::new())).collect()
    };
    let mut parts = named(&outline.includes, SymbolKind::Composite, "include");
    parts.extend(named(&outline.properties, SymbolKind::Property, "property"));
    parts.extend(named(&outline.services, SymbolKind::Service, "service"));
    parts.extend(named(&outline.references, SymbolKind::Reference, "reference"));
    parts.extend(outline.components.iter().map(|one| component(file, one)));
    // In the order of the file.
    parts.sort_by_key(|one| one.range.start);
    match &outline.name {
        Some(name) => vec![symbol(file, name, SymbolKind::Composite, &outline.namespace, parts)],
        None => parts,
    }
}

/// The composites of files and their components whose names hold the letters of a query in their order.
pub fn workspace_symbols<'f>(files: &'f [Arc<File>], query: &str) -> Vec<WorkspaceSymbol<'f>> {
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
        let own = name.map(|name| found(file, name, SymbolKind::Composite, &file.outline.namespace));
        let components = file.outline.components.iter();
        let inside = components.map(|one| found(file, &one.name, SymbolKind::Component, composite));
        let fitting = own.into_iter().chain(inside).filter(|one| !one.name.is_empty() && fits(one.name));
        all.extend(fitting);
    }
    all
}

fn found<'f>(file: &'f File, name: &'f Named, kind: SymbolKind, container: &'f str) -> WorkspaceSymbol<'f> {
    let (start, end) = (name.at.start, name.at.end);
    WorkspaceSymbol { file, name: &name.text, start, end, kind, container }
}

fn component(file: &File, component: &Component) -> DocumentSymbol {
    let named = |names: &[Named], kind, what: &str| -> Vec<DocumentSymbol> {
        names.iter().map(|name| symbol(file, name, kind, what, Vec::new())).collect()
    };
    let property = |one: &Named| {
        let value = value(file, one).unwrap_or_default();
        symbol(file, one, SymbolKind::Property, &value, Vec::new())
    };
    let mut parts: Vec<DocumentSymbol> = component.properties.iter().map(property).collect();
    parts.extend(named(&component.services, SymbolKind::Service, "service"));
    parts.extend(named(&component.references, SymbolKind::Reference, "reference"));
    let loops: Vec<Named> = component.loops.iter().map(|one| one.name.clone()).collect();
    parts.extend(named(&loops, SymbolKind::Loop, "loop"));
    parts.sort_by_key(|one| one.range.start);
    let class = match &component.implementation {
        Some(Implementation::Class(name) | Implementation::Composite(name)) => name.text.as_str(),
        None => "",
    };
    symbol(file, &component.name, SymbolKind::Component, class, parts)
}

/// The value of a property, short.
fn value(file: &File, property: &Named) -> Option<String> {
    let element = file.element(property.element);
    let given = element.value("value").or_else(|| element.text_place());
    let source = element.value("source");
    let value = &file.text[given.or(source)?];
    Some(value.lines().next().unwrap_or_default().chars().take(40).collect())
}

fn symbol(file: &File, name: &Named, kind: SymbolKind, detail: &str, children: Vec<DocumentSymbol>) -> DocumentSymbol {
    DocumentSymbol {
        name: name.text.clone(),
        detail: detail.to_owned(),
        kind,
        range: file.element(name.element).whole(),
        name_range: name.at.clone(),
        children,
    }
}
