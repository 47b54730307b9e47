//! Places that name files: those that hold values, tables, libraries, and composites.

use std::ops::Range;
use std::path::PathBuf;

use super::scene::Scene;
use super::scene::outline::{Implementation, Named};

/// Each place of the file that names another file, and that file.
pub fn links(scene: &Scene) -> Vec<(Range<usize>, PathBuf)> {
    let file = scene.file();
    let outline = &file.outline;
    let beside = outline.beside.iter().filter_map(|name| {
        let path = match scene.beside(0, name) {
            Some(known) => scene.files[known].path.clone(),
            None => file.path.parent()?.join(&name.text),
        };
        path.is_file().then(|| (name.at.clone(), path))
    });
    let implementations = outline.components.iter().filter_map(|one| match &one.implementation {
        Some(Implementation::Composite(name)) => Some(name),
        _ => None,
    });
    let composite = |name: &Named| {
        let found = scene.composite(0, name).filter(|found| *found > 0)?;
        Some((name.at.clone(), scene.files[found].path.clone()))
    };
    let composites = outline.includes.iter().chain(&outline.deployables).chain(implementations);
    let mut all: Vec<_> = beside.chain(composites.filter_map(composite)).collect();
    all.sort_by_key(|(at, _)| at.start);
    all
}
