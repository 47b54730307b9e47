//! What tests of the language server and a fuzzer share: text with a cursor in, answers out.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use saoms_lang::registry::Registry;

use super::complete::complete;
use super::file::File;
use super::hover::hover;
use super::laws;
use super::links::links;
use super::navigate::{definition, references};
use super::rename::rename;
use super::scene::Scene;
use super::shape::{self, folds};
use super::symbols::symbols;
use super::workspace::Around;

static REGISTRY: LazyLock<Arc<Registry>> = LazyLock::new(|| Arc::new(Registry::linked().unwrap()));

/// The scene of a text with the cursor `|` in it and of other files, each a name and a text; and the byte of the cursor.
pub(super) fn scene(marked: &str, others: &[(&str, &str)]) -> (Scene, usize) {
    scene_in("fleet.composite", marked, others)
}

/// The same of a file of another name.
pub(super) fn scene_in(name: &str, marked: &str, others: &[(&str, &str)]) -> (Scene, usize) {
    let at = marked.find('|').unwrap();
    (scene_named(name, &marked.replacen('|', "", 1), others), at)
}

/// The scene of a text without a cursor. Other files that are no composites hold values.
pub(super) fn scene_of(text: &str, others: &[(&str, &str)]) -> Scene {
    scene_named("fleet.composite", text, others)
}

fn scene_named(name: &str, text: &str, others: &[(&str, &str)]) -> Scene {
    let all = [(name, text)].into_iter().chain(others.iter().copied());
    let files = all.map(|(name, text)| {
        let is_xml = [".composite", ".xml"].iter().any(|ending| name.ends_with(ending));
        let make = if is_xml { File::new } else { File::beside };
        Arc::new(make(PathBuf::from("/fleet").join(name), text.into()))
    });
    made(files.collect())
}

/// The scene of a text that is in a file on disk, or would be.
pub(super) fn scene_at(path: &Path, text: &str) -> Scene {
    made(vec![Arc::new(File::new(path.to_owned(), text.into()))])
}

fn made(files: Vec<Arc<File>>) -> Scene {
    Scene::new(Around { own: files.len(), known: files.len(), files }, Arc::clone(&REGISTRY))
}

/// A composite of 1.1 with this inside.
pub(super) fn composite(inside: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" name=\"fleet\" targetNamespace=\"urn:f\">\n{inside}\n</composite>"
    )
}

/// Asks everything at a byte of a text beside other files. What is answered is in the texts.
pub(crate) fn ask_everything(text: &str, at: usize, others: &[(&str, &str)]) {
    ask_everything_in("fleet.composite", text, at, others);
}

/// The same of a file of another name.
pub(super) fn ask_everything_in(name: &str, text: &str, at: usize, others: &[(&str, &str)]) {
    let scene = scene_named(name, text, others);
    let file = scene.file();
    for one in complete(&scene, at) {
        assert!(one.range.start <= at && at <= one.range.end, "{:?} is not around {at}", one.range);
        assert!(text.get(one.range.clone()).is_some());
        let _ = one.into_item(file, true);
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
    symbols(file);
    links(&scene);
    assert!(folds(file).iter().all(|one| one.start_line < one.end_line));
    let around = shape::around(file, at);
    assert!(around.iter().all(|range| text.get(range.clone()).is_some()));
    assert!(
        around.is_sorted_by(|one, wider| wider.start <= one.start && one.end <= wider.end && one != wider)
    );
    let near = file.lines.offset(text, file.lines.position(text, at));
    assert_eq!(file.lines.offset(text, file.lines.position(text, near)), near);
}

/// Holds a text beside other files to what editors and the command have to agree on.
pub(crate) fn hold_laws(text: &str, at: usize, others: &[(&str, &str)]) {
    laws::hold(&scene_of(text, others), at);
}
