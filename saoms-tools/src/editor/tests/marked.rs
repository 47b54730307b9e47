//! Text with a cursor in, places and texts out.

use crate::editor::navigate::{DefinitionTarget, definition, references};
use crate::editor::rename::{prepare, rename};
use crate::editor::scene::Scene;
use crate::editor::scene::symbol::FileRange;
use crate::editor::testing::scene;

/// A file as `name:line:column text`, the column from 1 in bytes.
fn shown(scene: &Scene, place: &FileRange) -> String {
    let file = &scene.files[place.file];
    let before = &file.text[..place.start];
    let line = before.matches('\n').count() + 1;
    let column = place.start - before.rfind('\n').map_or(0, |at| at + 1) + 1;
    let name = file.path.file_name().unwrap().to_str().unwrap();
    format!("{name}:{line}:{column} {}", &file.text[place.start..place.end])
}

/// The definition of the name at the cursor.
pub(super) fn defined(marked: &str, others: &[(&str, &str)]) -> Vec<String> {
    let (scene, at) = scene(marked, others);
    let all = definition(&scene, at).into_iter().map(|goal| match goal {
        DefinitionTarget::Range(place) => shown(&scene, &place),
        DefinitionTarget::File(path) => path.display().to_string(),
    });
    all.collect()
}

/// All files after the name at the cursor was changed, or why it cannot be.
pub(super) fn renamed(marked: &str, others: &[(&str, &str)], name: &str) -> Result<Vec<String>, String> {
    let (scene, at) = scene(marked, others);
    prepare(&scene, at)?;
    let mut edits = rename(&scene, at, name)?;
    edits.sort_by(|one, other| other.0.cmp(&one.0));
    let mut texts: Vec<String> = scene.files.iter().map(|file| file.text.to_string()).collect();
    for (place, new) in edits {
        texts[place.file].replace_range(place.start..place.end, &new);
    }
    Ok(texts)
}

/// Every place that means the same as the name at the cursor.
pub(super) fn found(marked: &str, others: &[(&str, &str)], with_definition: bool) -> Vec<String> {
    let (scene, at) = scene(marked, others);
    references(&scene, at, with_definition).iter().map(|place| shown(&scene, place)).collect()
}
