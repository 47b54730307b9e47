//! Registries are made again when libraries change, and not before.

use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use saoms_lang::project::{ClassPath, Classes, LibraryResolver, PluginFault};
use saoms_lang::registry::Registry;

use super::NoPlugins;
use crate::editor::check::{ClassCache, PluginSearch};

/// A search in one folder, where each library is faulty.
#[derive(Debug)]
struct Faulty(PathBuf);

impl PluginSearch for Faulty {
    fn places(&self, _: &Path) -> Vec<PathBuf> {
        vec![self.0.clone()]
    }

    fn find(&self, _: &Path, name: &str) -> Option<PathBuf> {
        Some(self.0.join(name)).filter(|path| path.exists())
    }

    fn libraries(&self, _: &Path) -> Rc<dyn LibraryResolver> {
        Rc::new(NoPlugins)
    }

    fn classes(&self, _: &Path) -> Classes {
        let problems = vec![PluginFault { is_error: false, text: "it is faulty".to_owned() }];
        Classes { problems, ..Registry::new().into() }
    }
}

#[test]
fn classes_are_those_of_the_libraries_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let library = folder.path().join("a.so");
    fs::write(&library, "first").unwrap();
    let cache = ClassCache::new(Faulty(folder.path().to_owned()));
    let file = folder.path().join("fleet.composite");
    let first = cache.of(&file, &[]);
    fs::write(folder.path().join("notes.txt"), "").unwrap();
    assert!(Arc::ptr_eq(&first, &cache.of(&file, &[])), "nothing changed");
    fs::write(&library, "the second one").unwrap();
    let second = cache.of(&file, &[]);
    assert!(!Arc::ptr_eq(&first, &second), "it was built anew");
    // A composite that names a library has classes of its own, and the others keep theirs.
    let named = cache.of(&file, &["a.so".to_owned()]);
    assert!(!Arc::ptr_eq(&second, &named));
    assert!(Arc::ptr_eq(&named, &cache.of(&file, &["a.so".to_owned(), "none.so".to_owned()])));
    assert!(Arc::ptr_eq(&second, &cache.of(&file, &[])));
    fs::remove_file(&library).unwrap();
    assert!(!Arc::ptr_eq(&second, &cache.of(&file, &[])), "it is gone");
}

#[test]
fn a_fault_of_a_plugin_is_told_once_and_apart_from_checks() {
    let folder = tempfile::tempdir().unwrap();
    let cache = ClassCache::new(Faulty(folder.path().to_owned()));
    let found = cache.classes(&[folder.path().join("fleet.composite")]);
    assert!(found.problems.is_empty());
    assert_eq!(cache.new_problems().len(), 1);
    fs::write(folder.path().join("b.so"), "").unwrap();
    cache.of(&folder.path().join("fleet.composite"), &[]);
    assert!(cache.new_problems().is_empty(), "it is known");
}
