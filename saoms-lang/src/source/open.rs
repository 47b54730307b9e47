//! Texts that editors hold and have not saved, and the files that are read beside them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Texts that count in place of what their files hold on disk. Clones share what they hold until one of them changes.
#[derive(Clone, Debug, Default)]
pub struct OpenTexts {
    texts: Arc<BTreeMap<PathBuf, Arc<String>>>,
    /// The files that were read from disk, of all clones together.
    read: Arc<Mutex<BTreeSet<PathBuf>>>,
    /// The files and folders that may be read, of all clones together; `None` where all may.
    inside: Option<Arc<Mutex<BTreeSet<PathBuf>>>>,
}

impl OpenTexts {
    /// Gives the file at `path`, which need not exist, another text.
    pub fn insert(&mut self, path: &Path, text: impl Into<Arc<String>>) {
        Arc::make_mut(&mut self.texts).insert(identity(path), text.into());
    }

    /// Lets the file at `path`, one of [`OpenTexts::paths`], have its own text again.
    pub fn remove(&mut self, path: &Path) {
        Arc::make_mut(&mut self.texts).remove(path);
    }

    /// The text for the file at `path`, however the path is written.
    pub fn get(&self, path: &Path) -> Option<&Arc<String>> {
        // As a rule there are none, or the path is the usual one, and then the file system need not be asked.
        if self.texts.is_empty() { None } else { self.texts.get(path).or_else(|| self.texts.get(&identity(path))) }
    }

    /// The files that have such a text, each by one path, see [`identity`].
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.texts.keys().map(PathBuf::as_path)
    }

    /// The same, with nothing to be read but what is [`permit`](Self::permit)ted, or with all files.
    #[must_use]
    pub(crate) fn confined(self, is_confined: bool) -> Self {
        Self { inside: is_confined.then(Arc::default), ..self }
    }

    /// Lets a file be read, or all in a folder and below.
    pub(crate) fn permit(&self, path: &Path) {
        let Some(inside) = &self.inside else { return };
        inside.lock().unwrap_or_else(PoisonError::into_inner).insert(real(path));
    }

    /// The path, without links, of a file that must not be read; `None` for one that may be.
    pub(crate) fn outside(&self, path: &Path) -> Option<PathBuf> {
        let inside = self.inside.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner);
        let real = real(path);
        let is_inside = real.ancestors().any(|above| inside.contains(above));
        (!is_inside).then_some(real)
    }

    /// Opens a file on disk to read it, and keeps that in mind.
    pub(crate) fn read(&self, path: &Path) -> io::Result<File> {
        let file = File::open(path)?;
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
        Ok(file)
    }

    /// The files on disk that were read, also in part, beside this and all its clones: nobody may write over them.
    pub fn files_read(&self) -> Vec<PathBuf> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    /// The files in this folder that have such a text.
    pub fn inside<'a>(&'a self, folder: &Path) -> impl Iterator<Item = &'a Path> + use<'a> {
        let folder = if self.texts.is_empty() { PathBuf::new() } else { identity(folder) };
        // In the order of paths those of a folder and below follow it.
        let below = self.texts.range(folder.clone()..).map(|(path, _)| path.as_path());
        let inside = |path: &Path, folder: &Path| path.parent() == Some(folder);
        below.map_while(move |path| path.starts_with(&folder).then(|| inside(path, &folder).then_some(path))).flatten()
    }
}

/// The absolute path without links and `..`, also of a file that does not exist.
fn real(path: &Path) -> PathBuf {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let known = absolute.ancestors().find_map(|above| Some((above, above.canonicalize().ok()?)));
    let Some((above, mut real)) = known else { return absolute };
    for part in absolute.strip_prefix(above).unwrap_or(Path::new("")).components() {
        match part {
            Component::ParentDir => _ = real.pop(),
            part => real.push(part),
        }
    }
    real
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
