//! The classes that composites of a folder can name, plugins included, as `saoms check` finds them.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use saoms_core::plugin::{Plugin, Search};
use saoms_lang::project::{ClassPath, Classes, PluginFault};
use saoms_lang::registry::Registry;

use crate::arguments::PluginArguments;
use crate::plugins::search;

/// The registries by the places where plugins are searched. Both threads of the server ask for them.
#[derive(Debug)]
pub(super) struct Registries {
    arguments: PluginArguments,
    known: Mutex<ClassCache>,
}

#[derive(Debug, Default)]
struct ClassCache {
    by_places: HashMap<Places, (Libraries, Arc<Registry>)>,
    reported: HashSet<String>,
    problems: Vec<PluginFault>,
}

/// The files and folders that the user names, the folders that are searched, and the libraries that a composite names.
type Places = [Vec<PathBuf>; 3];

/// The libraries that were there, each with what shows a change.
type Libraries = BTreeMap<PathBuf, (Option<SystemTime>, u64)>;

impl Registries {
    pub(super) fn new(arguments: PluginArguments) -> Self {
        Self { arguments, known: Mutex::default() }
    }

    /// The search for plugins of a composite.
    fn search(&self, file: &Path) -> Search {
        search(&self.arguments, &[file.to_owned()])
    }

    /// The classes for a composite, those of libraries that it names itself included. Plugins that were built anew
    /// since the last time are read anew.
    pub(super) fn of(&self, file: &Path, named: &[String]) -> Arc<Registry> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let search = self.search(file);
        let named: Vec<PathBuf> = named.iter().filter_map(|name| search.find(folder, name).ok()).collect();
        let mut libraries = Libraries::new();
        named.iter().for_each(|path| note(path, &mut libraries));
        for path in search.named.iter().chain(&search.folders) {
            note(path, &mut libraries);
            let inside = fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
            inside.filter(|path| path.extension().is_some_and(|ending| ending == "so")).for_each(|path| {
                note(&path, &mut libraries);
            });
        }
        let key = [search.named.clone(), search.folders.clone(), named];
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((before, registry)) = known.by_places.get(&key)
            && *before == libraries
        {
            return Arc::clone(registry);
        }
        let Classes { mut registry, problems, .. } = match Registry::linked() {
            Ok(linked) => search.classes(linked),
            Err(error) => {
                let problem = PluginFault { is_error: true, text: error.to_string() };
                Classes { problems: vec![problem], ..Registry::new().into() }
            }
        };
        for problem in problems {
            if known.reported.insert(problem.text.clone()) {
                known.problems.push(problem);
            }
        }
        for path in &key[2] {
            // What is wrong with it, and whether it is known already, the checker says.
            let _ = Plugin::open(path).map(|plugin| plugin.register(&mut registry));
        }
        let registry = Arc::new(registry);
        known.by_places.insert(key, (libraries, Arc::clone(&registry)));
        registry
    }

    /// Faults of plugins since the last call.
    pub(super) fn new_problems(&self) -> Vec<PluginFault> {
        std::mem::take(&mut self.known.lock().unwrap_or_else(PoisonError::into_inner).problems)
    }
}

/// Faults of plugins are reported apart from the diagnostics of a check, see [`Registries::new_problems`].
impl ClassPath for Registries {
    fn classes(&self, files: &[PathBuf]) -> Classes {
        let first = files.first().map_or(Path::new(""), PathBuf::as_path);
        let registry = Registry::clone(&self.of(first, &[]));
        Classes { registry, libraries: Some(Rc::new(self.search(first))), problems: Vec::new() }
    }
}

fn note(path: &Path, libraries: &mut Libraries) {
    if let Ok(about) = fs::metadata(path)
        && about.is_file()
    {
        libraries.insert(path.to_owned(), (about.modified().ok(), about.len()));
    }
}
