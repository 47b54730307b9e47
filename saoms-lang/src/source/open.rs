//! Texts that editors hold and have not saved.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Texts that count in place of what their files hold on disk.
#[derive(Clone, Debug, Default)]
pub struct OpenTexts(HashMap<PathBuf, Arc<String>>);

impl OpenTexts {
    /// Gives the file at `path`, which need not exist, another text.
    pub fn insert(&mut self, path: &Path, text: impl Into<Arc<String>>) {
        self.0.insert(identity(path), text.into());
    }

    /// The text for the file at `path`, however the path is written.
    pub fn get(&self, path: &Path) -> Option<&Arc<String>> {
        // As a rule there are none, and then nobody has to ask the file system.
        if self.0.is_empty() { None } else { self.0.get(&identity(path)) }
    }

    /// The files in this folder that have such a text.
    pub fn inside<'a>(&'a self, folder: &Path) -> impl Iterator<Item = &'a Path> + use<'a> {
        let folder = (!self.0.is_empty()).then(|| identity(folder));
        self.0.keys().map(PathBuf::as_path).filter(move |path| path.parent() == folder.as_deref())
    }
}

/// One path for one file, however it is written.
pub fn identity(path: &Path) -> PathBuf {
    if let Ok(known) = path.canonicalize() {
        return known;
    }
    // A file that does not exist yet is in a folder that does.
    let here = || std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    match (path.parent(), path.file_name()) {
        (Some(parent), Some(name)) => {
            let parent = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
            parent.canonicalize().map_or_else(|_| here(), |parent| parent.join(name))
        }
        _ => here(),
    }
}
