//! The libraries that composites name.

use std::path::{Path, PathBuf};

use super::LibraryResolver;
use crate::model::{Contribution, ImplementationKind, Origin};
use crate::registry::Registry;
use crate::source::Sources;

/// Opens the libraries that implementations name with `library`. What is wrong with them is for the checker to say.
pub(super) fn open_named(
    contribution: &mut Contribution,
    libraries: &dyn LibraryResolver,
    sources: &Sources,
    registry: &mut Registry,
) {
    let mut named: Vec<(Origin, PathBuf, String)> = Vec::new();
    for composite in contribution.composites() {
        let folder = Path::new(sources.get(composite.file()).path()).parent().unwrap_or(Path::new(""));
        for implementation in composite.components.iter().filter_map(|one| one.implementation.as_ref()) {
            if let ImplementationKind::Rust { library: Some(library), .. } = &implementation.kind {
                named.push((implementation.origin, folder.to_owned(), library.as_str().trim().to_owned()));
            }
        }
    }
    for (origin, folder, name) in named {
        let link = libraries.open(&folder, &name, &|path| sources.open().outside(path), registry);
        contribution.set_library(origin, link);
    }
}
