//! The classes that composites of a folder can name, plugins included, kept until a library changes.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt::Debug;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use saoms_lang::project::{ClassPath, Classes, LibraryResolver, PluginFault};
use saoms_lang::registry::Registry;

/// The search for plugins around a composite.
pub trait PluginSearch: Debug + Send + Sync {
    /// The files and folders in which plugins for a composite are looked for.
    fn places(&self, file: &Path) -> Vec<PathBuf>;

    /// The library that a composite names.
    fn find(&self, file: &Path, name: &str) -> Option<PathBuf>;

    /// The resolver of the libraries that a composite names.
    fn libraries(&self, file: &Path) -> Rc<dyn LibraryResolver>;

    /// The classes for a composite, as the libraries in all places have them now.
    fn classes(&self, file: &Path) -> Classes;
}

/// The registries of classes by the places where plugins are searched; threads share it.
#[derive(Debug)]
pub struct ClassCache {
    search: Box<dyn PluginSearch>,
    known: Mutex<KnownClasses>,
}

#[derive(Debug, Default)]
struct KnownClasses {
    by_places: HashMap<Places, (Libraries, Arc<Registry>)>,
    reported: HashSet<String>,
    problems: Vec<PluginFault>,
}

/// The files and folders that are searched, and the libraries that a composite names.
type Places = [Vec<PathBuf>; 2];

/// The libraries that were there, each with what shows a change.
type Libraries = BTreeMap<PathBuf, (Option<SystemTime>, u64)>;

impl ClassCache {
    /// A cache that has asked for nothing yet.
    pub fn new(search: impl PluginSearch + 'static) -> Self {
        Self { search: Box::new(search), known: Mutex::default() }
    }

    /// The classes for a composite, those of libraries that it names itself included. Plugins that were built anew
    /// since the last time are read anew.
    pub fn of(&self, file: &Path, named: &[String]) -> Arc<Registry> {
        let places = self.search.places(file);
        let found: Vec<(&String, PathBuf)> =
            named.iter().filter_map(|name| Some((name, self.search.find(file, name)?))).collect();
        let mut libraries = Libraries::new();
        found.iter().for_each(|(_, path)| note(path, &mut libraries));
        for path in &places {
            note(path, &mut libraries);
            let inside = fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
            let inside = inside.filter(|path| path.extension().is_some_and(|ending| ending == "so"));
            inside.for_each(|path| note(&path, &mut libraries));
        }
        let key = [places, found.iter().map(|(_, path)| path.clone()).collect()];
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((before, registry)) = known.by_places.get(&key)
            && *before == libraries
        {
            return Arc::clone(registry);
        }
        let Classes { mut registry, libraries: resolver, problems } = self.search.classes(file);
        for problem in problems {
            if known.reported.insert(problem.text.clone()) {
                known.problems.push(problem);
            }
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        for (name, _) in &found {
            // What is wrong with it, and whether it is known already or must not be read, the checker says.
            let _ = resolver.as_ref().map(|resolver| resolver.open(folder, name, &|_| None, &mut registry));
        }
        let registry = Arc::new(registry);
        known.by_places.insert(key, (libraries, Arc::clone(&registry)));
        registry
    }

    /// Faults of plugins since the last call, each once.
    pub fn new_problems(&self) -> Vec<PluginFault> {
        std::mem::take(&mut self.known.lock().unwrap_or_else(PoisonError::into_inner).problems)
    }
}

/// Faults of plugins are reported apart from the diagnostics of a check, see [`ClassCache::new_problems`].
impl ClassPath for ClassCache {
    fn classes(&self, files: &[PathBuf]) -> Classes {
        let first = files.first().map_or(Path::new(""), PathBuf::as_path);
        let registry = Registry::clone(&self.of(first, &[]));
        Classes { registry, libraries: Some(self.search.libraries(first)), problems: Vec::new() }
    }
}

fn note(path: &Path, libraries: &mut Libraries) {
    if let Ok(about) = fs::metadata(path)
        && about.is_file()
    {
        libraries.insert(path.to_owned(), (about.modified().ok(), about.len()));
    }
}
