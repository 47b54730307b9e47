//! What tests of the language server share: text with a cursor in, answers out.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use saoms_core::registry::Registry;

use super::file::File;
use super::scene::Scene;

static REGISTRY: LazyLock<Arc<Registry>> = LazyLock::new(|| Arc::new(Registry::linked().unwrap()));

/// The scene of a text with the cursor `|` in it and of other files, each a name and a text; and the byte of the cursor.
pub(super) fn scene(marked: &str, others: &[(&str, &str)]) -> (Scene, usize) {
    let at = marked.find('|').unwrap();
    let text = marked.replacen('|', "", 1);
    (scene_of(&text, others), at)
}

/// The scene of a text without a cursor. Other files that are no composites hold values.
pub(super) fn scene_of(text: &str, others: &[(&str, &str)]) -> Scene {
    let all = [("fleet.composite", text)].into_iter().chain(others.iter().copied());
    let files = all.map(|(name, text)| {
        let make = if [".composite", ".xml"].iter().any(|ending| name.ends_with(ending)) {
            File::new
        } else {
            File::beside
        };
        Arc::new(make(PathBuf::from("/fleet").join(name), text.into()))
    });
    Scene::new(files.collect(), Arc::clone(&REGISTRY))
}

/// The scene of a text that is in a file on disk, or would be.
pub(super) fn scene_at(path: &Path, text: &str) -> Scene {
    Scene::new(vec![Arc::new(File::new(path.to_owned(), text.into()))], Arc::clone(&REGISTRY))
}

/// A composite of 1.1 with this inside.
pub(super) fn composite(inside: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" name=\"fleet\" targetNamespace=\"urn:f\">\n{inside}\n</composite>"
    )
}
