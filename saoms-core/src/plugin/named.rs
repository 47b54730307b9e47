//! Libraries that composites name.

use std::fs;
use std::path::{Path, PathBuf};

use super::Search;
use saoms_lang::model::LibraryLink;
use saoms_lang::project::LibraryResolver;
use saoms_lang::registry::Registry;
use saoms_lang::source::identity;

/// A name is a path relative to the folder of its composite, or to a place of the search; `lib` before the name and
/// `.so` behind it may be left out.
impl LibraryResolver for Search {
    fn open(
        &self,
        folder: &Path,
        name: &str,
        outside: &dyn Fn(&Path) -> Option<PathBuf>,
        registry: &mut Registry,
    ) -> LibraryLink {
        let mut refused = None;
        let mut is_allowed = |path: &Path| {
            let outside = outside(path).filter(|_| !self.is_in_a_place(path));
            let is_allowed = outside.is_none();
            refused = refused.take().or(outside);
            is_allowed
        };
        match self.find_allowed(folder, name, &mut is_allowed) {
            // Whether there is one outside is not revealed.
            Err(looked) => refused.map_or(LibraryLink::Missing(looked), LibraryLink::Outside),
            Ok(path) => match registered(&path, self, registry) {
                Ok(path) => LibraryLink::To(path),
                Err(message) => LibraryLink::Faulty(message),
            },
        }
    }

    fn declare(&self, folder: &Path, kind: &str, named: (&str, &str), registry: &mut Registry) -> LibraryLink {
        self.declare_class(folder, kind, named, registry)
    }
}

/// The path by which a library is registered, which is done now unless it is already.
fn registered(path: &Path, search: &Search, registry: &mut Registry) -> Result<PathBuf, String> {
    let same = identity(path);
    if let Some(known) = registry.origins().find(|known| identity(known) == same) {
        return Ok(known.to_owned());
    }
    let plugin = search.plugin(path).map_err(|error| error.to_string())?;
    plugin.register(registry).map_err(|error| error.to_string())?;
    Ok(path.to_owned())
}

impl Search {
    /// The library of this name: relative to the folder, or to a place of the search.
    ///
    /// # Errors
    /// The files that it would have been, where none is there.
    pub fn find(&self, folder: &Path, name: &str) -> Result<PathBuf, Vec<PathBuf>> {
        self.find_allowed(folder, name, &mut |_| true)
    }

    /// As [`find`](Self::find), without looking at files that must not be read.
    fn find_allowed(
        &self,
        folder: &Path,
        name: &str,
        is_allowed: &mut dyn FnMut(&Path) -> bool,
    ) -> Result<PathBuf, Vec<PathBuf>> {
        let names = files(name);
        let mut looked = Vec::new();
        let beside = names.iter().map(|name| folder.join(name));
        let named = self.named.iter().flat_map(|place| {
            // A library that was named itself has the name, or has not.
            let is_meant = |name: &PathBuf| place.file_name() == name.file_name();
            match place.is_dir() {
                true => names.iter().map(|name| place.join(name)).collect(),
                false if names.iter().any(is_meant) => vec![place.clone()],
                false => Vec::new(),
            }
        });
        let folders =
            self.folders.iter().chain(&self.around).flat_map(|folder| names.iter().map(|name| folder.join(name)));
        for path in beside.chain(named).chain(folders) {
            if is_allowed(&path) && fs::metadata(&path).is_ok_and(|found| found.is_file()) {
                return Ok(path);
            }
            if !looked.contains(&path) {
                looked.push(path);
            }
        }
        Err(looked)
    }
}

/// The files that a name can mean, the likeliest first.
fn files(name: &str) -> Vec<PathBuf> {
    let path = Path::new(name);
    let Some(last) = path.file_name().and_then(|last| last.to_str()) else { return Vec::new() };
    let stem = last.strip_suffix(".so").unwrap_or(last);
    let mut all = vec![path.with_file_name(format!("{stem}.so"))];
    if !stem.starts_with("lib") {
        // A package `my-robot` is built as `libmy_robot.so`.
        all.insert(
            usize::from(last.ends_with(".so")),
            path.with_file_name(format!("lib{}.so", stem.replace('-', "_"))),
        );
    }
    all
}
