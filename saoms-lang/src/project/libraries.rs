//! The libraries that composites name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::LibraryResolver;
use crate::model::{Contribution, ImplementationKind, LibraryLink, Origin};
use crate::registry::Registry;
use crate::source::Sources;

/// Opens the libraries that implementations name with `library`, and reads the classes that they name in Python. What
/// is wrong with them is for the checker to say.
pub(super) fn open_named(
    contribution: &mut Contribution,
    libraries: &dyn LibraryResolver,
    sources: &Sources,
    registry: &mut Registry,
) {
    let mut named: Vec<(Origin, PathBuf, String)> = Vec::new();
    let mut in_python: Vec<(Origin, (PathBuf, String, String))> = Vec::new();
    for composite in contribution.composites() {
        let folder = Path::new(sources.get(composite.file()).path()).parent().unwrap_or(Path::new(""));
        for implementation in composite.components.iter().filter_map(|one| one.implementation.as_ref()) {
            match &implementation.kind {
                ImplementationKind::Rust { library: Some(library), .. } => {
                    named.push((implementation.origin, folder.to_owned(), library.as_str().trim().to_owned()));
                }
                ImplementationKind::Python(python) => {
                    let Some((module, class)) = python.module.as_ref().zip(python.class.as_ref()) else { continue };
                    let (module, class) = (module.as_str().to_owned(), class.as_str().to_owned());
                    in_python.push((implementation.origin, (folder.to_owned(), module, class)));
                }
                _ => {}
            }
        }
    }
    for (origin, folder, name) in named {
        let link = libraries.open(&folder, &name, &|path| sources.open().outside(path), registry);
        contribution.set_library(origin, link);
    }
    // Many components are of one class.
    let mut declared: HashMap<(PathBuf, String, String), LibraryLink> = HashMap::new();
    for (origin, named) in in_python {
        let link = match declared.get(&named) {
            Some(link) => link.clone(),
            None => {
                let (folder, module, class) = &named;
                let link = libraries.declare(folder, "python", (module, class), registry);
                declared.insert(named, link.clone());
                link
            }
        };
        contribution.set_library(origin, link);
    }
}
