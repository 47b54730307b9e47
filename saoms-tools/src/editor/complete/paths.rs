//! Files beside composites.

use std::collections::BTreeSet;
use std::fs;
use std::ops::Range;
use std::path::Path;

use saoms_lang::syntax::ElementId;

use super::ProposalKind;

use super::Proposal;
use crate::editor::scene::Scene;
use crate::editor::scene::outline::{Component, Implementation};

/// So many entries of a folder are looked at.
const MOST: usize = 2_000;

/// The files that a value can name, folder by folder: those for which `fits` says so.
pub(super) fn complete(scene: &Scene, value: &Range<usize>, at: usize, fits: fn(&Path) -> bool) -> Vec<Proposal> {
    let file = scene.file();
    let typed = &file.text[value.start..at];
    let inner = typed.rfind('/').map_or(0, |slash| slash + 1);
    let range = value.start + inner..value.end;
    let folder = file.path.parent().unwrap_or(Path::new("")).join(&typed[..inner]);
    if !scene.bounds.hold(&folder) {
        return Vec::new();
    }
    let entries = fs::read_dir(folder).into_iter().flatten().take(MOST).flatten();
    entries
        .filter_map(|entry| {
            let (path, name) = (entry.path(), entry.file_name().into_string().ok()?);
            // A name that would need character references is not proposed.
            if name.starts_with('.') || name.contains(['&', '<', '"', '\'']) {
                return None;
            }
            match path.is_dir() {
                true => Some(Proposal::new(format!("{name}/"), ProposalKind::Folder, &range).rank(7)),
                false => fits(&path).then(|| Proposal::new(name, ProposalKind::File, &range)),
            }
        })
        .collect()
}

/// True if a file can hold a value.
pub(super) fn is_value(path: &Path) -> bool {
    !has_ending(path, &["composite", "so"])
}

/// True if a file can be a table.
pub(super) fn is_table(path: &Path) -> bool {
    has_ending(path, &["csv"])
}

fn is_library(path: &Path) -> bool {
    has_ending(path, &["so"])
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known))
}

/// The libraries that are known by the classes that they bring, that of the component's class first, and those in the
/// folder.
pub(super) fn libraries(scene: &Scene, element: ElementId, value: &Range<usize>, at: usize) -> Vec<Proposal> {
    let class = scene.component_around(element).and_then(|one: &Component| match &one.implementation {
        Some(Implementation::Class(name)) => scene.registry.get(&name.text)?.origin(),
        _ => None,
    });
    let known: BTreeSet<&Path> = scene.registry.iter().filter_map(|one| one.origin()).collect();
    let mut all: Vec<Proposal> = known
        .into_iter()
        .filter_map(|path| {
            let stem = path.file_stem()?.to_str()?;
            let one = Proposal::new(stem.strip_prefix("lib").unwrap_or(stem), ProposalKind::Module, value);
            Some(one.detail(path.display().to_string()).rank(if class == Some(path) { 0 } else { 4 }))
        })
        .collect();
    all.extend(complete(scene, value, at, is_library));
    all
}
