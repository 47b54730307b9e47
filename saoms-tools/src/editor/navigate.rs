//! Navigation from a name to its definition, and to all other names of the same symbol.

use std::path::PathBuf;

use super::scene::Scene;
use super::scene::symbol::{FileRange, Occurrence, Symbol, at, places};
use super::syntax::Cursor;

/// The target of a jump.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DefinitionTarget {
    /// A range of a file of the scene.
    Range(FileRange),
    /// A whole file, which need not be of the scene.
    File(PathBuf),
}

/// The definitions of the name at a byte of the file.
pub fn definition(scene: &Scene, byte: usize) -> Vec<DefinitionTarget> {
    let Some(found) = at(scene, byte) else { return side_file(scene, byte).into_iter().collect() };
    let mut defined = defined(scene, &found.symbol);
    if defined.is_empty() {
        // A service of a class is where its component is.
        if let Symbol::Part { file, component, .. }
        | Symbol::Loop { file, component, .. }
        | Symbol::Index { file, component } = &found.symbol
        {
            let owner = Symbol::Component { file: *file, name: component.clone() };
            defined = self::defined(scene, &owner);
        }
        if let Symbol::Composite { file } = found.symbol {
            return vec![DefinitionTarget::Range(FileRange { file, start: 0, end: 0 })];
        }
    }
    defined.into_iter().map(|one| DefinitionTarget::Range(one.at)).collect()
}

fn defined(scene: &Scene, symbol: &Symbol) -> Vec<Occurrence> {
    places(scene, symbol).into_iter().filter(|one| one.is_definition).collect()
}

/// A file beside the composite that an attribute names.
fn side_file(scene: &Scene, byte: usize) -> Option<DefinitionTarget> {
    let file = scene.file();
    let Cursor::AttributeValue { attribute, value, .. } = file.cursor(byte) else { return None };
    let name = attribute.name();
    let is_file = matches!(name, "file" | "uri" | "library") || name.ends_with(":overrides");
    let path = file.path.parent()?.join(file.text[value].trim());
    (is_file && path.is_file()).then_some(DefinitionTarget::File(path))
}

/// The places that name the same as the name at a byte of the file.
pub fn references(scene: &Scene, byte: usize, with_definition: bool) -> Vec<FileRange> {
    let Some(found) = at(scene, byte) else { return Vec::new() };
    let all = places(scene, &found.symbol).into_iter();
    all.filter(|one| with_definition || !one.is_definition).map(|one| one.at).collect()
}
