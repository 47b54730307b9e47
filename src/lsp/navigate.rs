//! From a name to what it stands for, and to everything else that means the same.

use std::path::PathBuf;

use super::scene::Scene;
use super::symbol::{Occurrence, Place, Symbol, at, places};
use super::syntax::Cursor;

/// Where something is: a file, and bytes of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Goal {
    /// In a file of the scene.
    Place(Place),
    /// A file of another kind.
    File(PathBuf),
}

/// Where the thing at a byte of the file is defined.
pub(super) fn definition(scene: &Scene, byte: usize) -> Vec<Goal> {
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
            return vec![Goal::Place(Place { file, start: 0, end: 0 })];
        }
    }
    defined.into_iter().map(|one| Goal::Place(one.at)).collect()
}

fn defined(scene: &Scene, symbol: &Symbol) -> Vec<Occurrence> {
    places(scene, symbol).into_iter().filter(|one| one.is_definition).collect()
}

/// A file beside the composite that an attribute names.
fn side_file(scene: &Scene, byte: usize) -> Option<Goal> {
    let file = scene.file();
    let Cursor::AttributeValue { element, attribute, value } = file.tree.cursor(&file.text, byte) else {
        return None;
    };
    let name = &file.text[file.tree.elements[element].attributes[attribute].name.clone()];
    let is_file = matches!(name, "file" | "uri" | "library") || name.ends_with(":overrides");
    let path = file.path.parent()?.join(file.text[value].trim());
    (is_file && path.is_file()).then_some(Goal::File(path))
}

/// Everything that means the same as what is at a byte of the file.
pub(super) fn references(scene: &Scene, byte: usize, with_definition: bool) -> Vec<Place> {
    let Some(found) = at(scene, byte) else { return Vec::new() };
    let all = places(scene, &found.symbol).into_iter();
    all.filter(|one| with_definition || !one.is_definition).map(|one| one.at).collect()
}
