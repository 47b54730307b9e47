//! Helpers of the tests and of a fuzzer: text with a cursor in, answers out.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

#[cfg(test)]
mod composite;
mod laws;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

#[cfg(test)]
use saoms_components as _;
use saoms_lang::registry::Registry;

use super::folding::folds;
use super::scene::workspace::{Bounds, Surroundings, Workspace};
use super::{
    File, Scene, complete, definition, document_symbols, hover, linked_tags, links, references, rename, selections,
};
#[cfg(test)]
pub(crate) use composite::composite;
pub(super) use laws::hold;

static REGISTRY: LazyLock<Arc<Registry>> = LazyLock::new(|| Arc::new(Registry::linked().unwrap()));

/// The scene of a text with the cursor `|` in it and of other files, each a name and a text; and the byte of the
/// cursor.
pub(crate) fn scene(marked: &str, others: &[(&str, &str)]) -> (Scene, usize) {
    scene_in("fleet.composite", marked, others)
}

/// The same of a file of another name.
pub(crate) fn scene_in(name: &str, marked: &str, others: &[(&str, &str)]) -> (Scene, usize) {
    let at = marked.find('|').unwrap();
    (scene_named(name, &marked.replacen('|', "", 1), others), at)
}

/// The scene of a text without a cursor. Other files that are no composites hold values.
pub(crate) fn scene_of(text: &str, others: &[(&str, &str)]) -> Scene {
    scene_named("fleet.composite", text, others)
}

fn scene_named(name: &str, text: &str, others: &[(&str, &str)]) -> Scene {
    let all = [(name, text)].into_iter().chain(others.iter().copied());
    let files = all.map(|(name, text)| {
        let is_xml = [".composite", ".xml"].iter().any(|ending| name.ends_with(ending));
        let make = if is_xml { File::new } else { File::beside };
        Arc::new(make(PathBuf::from("/fleet").join(name), text.to_owned().into()))
    });
    made(files.collect())
}

/// The scene of a text that is in a file on disk, or would be.
pub(crate) fn scene_at(path: &Path, text: &str) -> Scene {
    made(vec![Arc::new(File::new(path.to_owned(), text.to_owned().into()))])
}

fn made(files: Vec<Arc<File>>) -> Scene {
    Scene::new(
        Surroundings {
            own: files.len(),
            known: files.len(),
            files,
            identities: HashMap::new(),
            bounds: Bounds::default(),
        },
        Arc::clone(&REGISTRY),
    )
}

/// The scene of a file on disk with those around it that may be read.
pub(crate) fn scene_around(path: &Path, workspace: &mut Workspace) -> Scene {
    Scene::new(workspace.around(path), Arc::clone(&REGISTRY))
}

/// Asks everything at a byte of a text beside other files. What is answered is in the texts.
pub fn ask_everything(text: &str, at: usize, others: &[(&str, &str)]) {
    ask_everything_in("fleet.composite", text, at, others);
}

/// The same of a file of another name.
pub(crate) fn ask_everything_in(name: &str, text: &str, at: usize, others: &[(&str, &str)]) {
    let scene = scene_named(name, text, others);
    let file = scene.file();
    for one in complete(&scene, at) {
        assert!(one.range.start <= at && at <= one.range.end, "{:?} is not around {at}", one.range);
        assert!(text.get(one.range.clone()).is_some());
    }
    if let Some((_, range)) = hover(&scene, at) {
        assert!(text.get(range).is_some());
    }
    definition(&scene, at);
    references(&scene, at, true);
    for (place, _) in rename(&scene, at, "new").unwrap_or_default() {
        assert!(scene.files[place.file].text.get(place.start..place.end).is_some());
    }
    scene.fleets();
    document_symbols(file);
    linked_tags(file, at);
    links(&scene);
    assert!(folds(file).iter().all(|one| one.start < one.end));
    let around = selections(file, at);
    assert!(around.iter().all(|range| text.get(range.clone()).is_some()));
    assert!(around.is_sorted_by(|one, wider| wider.start <= one.start && one.end <= wider.end && one != wider));
}

/// Holds a text beside other files to the laws of editors.
pub fn hold_laws(text: &str, at: usize, others: &[(&str, &str)]) {
    hold(&scene_of(text, others), at);
}
