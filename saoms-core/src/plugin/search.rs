use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use saoms_abi::TRANSPORT_SECTION;
use saoms_lang::project::{Classes, PluginFault};
use saoms_lang::registry::{Registry, RegistryError};
use saoms_lang::source::identity;

use super::file::read_section;
use super::{CodeUse, Plugin, PluginError};

/// Places in which libraries are searched.
#[derive(Clone, Debug, Default)]
pub struct Search {
    /// Files and folders named by the user: a fault in one of them is an error.
    pub named: Vec<PathBuf>,
    /// Folders named by the user that are searched if they exist; files in them without metadata are ignored.
    pub folders: Vec<PathBuf>,
    /// The same of folders that nobody named, around composites: none of the code in them runs.
    pub around: Vec<PathBuf>,
    /// True if the code of libraries that nobody named runs, too: for tests, whose composites are their own.
    pub runs_all: bool,
}

/// Result of a search.
#[derive(Debug, Default)]
pub struct FoundLibraries {
    /// The plugins, in the order of the places and by name within a folder; each file once.
    pub plugins: Vec<Arc<Plugin>>,
    /// Faults of the libraries that the user named.
    pub errors: Vec<PluginError>,
    /// Faults of other libraries, which are left out.
    pub left_out: Vec<PluginError>,
}

impl Search {
    /// Reads the metadata of one library.
    pub(super) fn plugin(&self, path: &Path) -> Result<Arc<Plugin>, PluginError> {
        let is_used = self.runs_all || self.is_named(path);
        let use_of_code = if is_used { CodeUse::Load } else { CodeUse::Nothing };
        Plugin::read(path, use_of_code)
    }

    /// True if the user named a library, or the folder that it is in.
    pub(super) fn is_named(&self, path: &Path) -> bool {
        is_among(path, self.named.iter().chain(&self.folders))
    }

    /// True if a library is one that was named, or in one of the folders that are searched.
    pub(super) fn is_in_a_place(&self, path: &Path) -> bool {
        self.is_named(path) || is_among(path, self.around.iter())
    }

    /// The classes of a registry together with those of all libraries that are found, and what is wrong with these.
    pub fn classes(&self, mut registry: Registry) -> Classes {
        let found = self.run();
        let left_out = found.left_out.iter().map(|error| PluginFault { is_error: false, text: error.to_string() });
        let mut problems: Vec<PluginFault> = left_out.collect();
        problems.extend(found.errors.iter().map(|error| PluginFault { is_error: true, text: error.to_string() }));
        for plugin in &found.plugins {
            if let Err(error) = plugin.register(&mut registry) {
                let text = match error {
                    RegistryError::NameTaken { .. } => error.to_string(),
                    _ => format!("plugin `{}`: {error}", plugin.path().display()),
                };
                problems.push(PluginFault { is_error: true, text });
            }
        }
        Classes { registry, libraries: Some(Rc::new(self.clone())), problems }
    }

    /// The libraries in all places, each of which [`run`](Search::run) reads.
    pub fn files(&self) -> Vec<PathBuf> {
        let named = self.named.iter().flat_map(|path| if path.is_dir() { libraries(path) } else { vec![path.clone()] });
        named.chain(self.folders.iter().chain(&self.around).flat_map(|folder| libraries(folder))).collect()
    }

    /// Reads the metadata of all libraries. No code of them runs.
    pub fn run(&self) -> FoundLibraries {
        let mut found = FoundLibraries::default();
        let mut seen = BTreeSet::new();
        let mut look = |path: &Path, named: bool, found: &mut FoundLibraries| {
            // The same file by another way is no second plugin.
            if !seen.insert(fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())) {
                return;
            }
            match self.plugin(path) {
                Ok(plugin) => found.plugins.push(plugin),
                // It is named to be used by a network.
                Err(PluginError::NoMetadata { .. }) if read_section(path, TRANSPORT_SECTION).is_ok() => {}
                Err(error) if named => found.errors.push(error),
                Err(PluginError::NoMetadata { .. } | PluginError::NoLibrary { .. }) => {}
                Err(error) => found.left_out.push(error),
            }
        };
        let mut unreadable = BTreeSet::new();
        for path in &self.named {
            if !path.is_dir() {
                // A module names itself: what runs it is another library.
                if path.extension().is_none_or(|ending| ending != MODULE) || !path.is_file() {
                    look(path, true, &mut found);
                }
                continue;
            }
            let libraries = libraries(path);
            for library in &libraries {
                look(library, false, &mut found);
            }
            if libraries.is_empty() && !has_modules(path) {
                // It may lie beside a composite, too.
                unreadable.insert(identity(path));
                let message = match fs::read_dir(path) {
                    Ok(_) => "there is no library (`*.so`) in this folder".to_owned(),
                    Err(error) => error.to_string(),
                };
                found.errors.push(PluginError::Unreadable { path: path.clone(), message });
            }
        }
        for folder in self.folders.iter().chain(&self.around) {
            match fs::read_dir(folder) {
                Err(error) if !matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                    // As `plugins` and `./plugins`.
                    if !unreadable.insert(identity(folder)) {
                        continue;
                    }
                    found.errors.push(PluginError::Unreadable { path: folder.clone(), message: error.to_string() });
                }
                _ => libraries(folder).iter().for_each(|library| look(library, false, &mut found)),
            }
        }
        found
    }
}

/// The ending of modules in Python.
const MODULE: &str = "py";

/// True if a folder has modules in Python, or packages of such.
fn has_modules(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else { return false };
    entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .any(|path| path.extension().is_some_and(|ending| ending == MODULE) || path.join("__init__.py").is_file())
}

/// The folder of the program, and that of libraries beside it as packages have them: `bin` and `lib/saoms`.
pub(crate) fn beside_the_program() -> Vec<PathBuf> {
    let Some(folder) = env::current_exe().ok().and_then(|program| Some(program.parent()?.to_owned())) else {
        return Vec::new();
    };
    let installed = folder.parent().map(|above| above.join("lib/saoms"));
    std::iter::once(folder).chain(installed).collect()
}

/// True if a file is one of these places, or in one of them.
fn is_among<'a>(path: &Path, mut places: impl Iterator<Item = &'a PathBuf>) -> bool {
    let here = |folder: &Path| identity(if folder.as_os_str().is_empty() { ".".as_ref() } else { folder });
    let (folder, file) = (path.parent().map(here), identity(path));
    places.any(|place| {
        let place = here(place);
        place == file || folder.as_ref() == Some(&place)
    })
}

/// The libraries of a folder, by name; none where it does not exist.
pub(crate) fn libraries(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut found: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "so") && path.is_file())
        .collect();
    found.sort();
    found
}
