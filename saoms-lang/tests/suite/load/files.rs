//! Composites that other people wrote: a few in this repository, and all of a larger collection where there is one.

use std::fs;
use std::path::Path;

use super::collection::collection;

/// A composite and the name it is known by.
#[derive(Debug)]
pub(crate) struct Sample {
    pub(crate) name: String,
    pub(crate) text: String,
}

/// The files in this repository.
pub(crate) fn shipped() -> Vec<Sample> {
    let found = below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../saoms-lang/tests/data/corpus"));
    assert!(found.len() >= 6, "the files that come with the repository");
    found
}

/// All there are.
pub(crate) fn all() -> Vec<Sample> {
    let mut all = shipped();
    all.extend(collection().iter().flat_map(|folder| below(&folder.join("files"))));
    all
}

/// Every composite in a folder and those inside it, in order of their paths.
fn below(folder: &Path) -> Vec<Sample> {
    let (mut folders, mut samples) = (vec![folder.to_owned()], Vec::new());
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "composite") {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                samples.push(Sample { name, text: fs::read_to_string(&path).unwrap() });
            }
        }
    }
    samples.sort_by(|a, b| a.name.cmp(&b.name));
    samples
}
