//! Sources of the classes that composites can name.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::model::LibraryLink;
use crate::registry::Registry;

/// The source of the classes of a fleet: a registry, or one with the plugins around the composites.
pub trait ClassPath {
    /// The classes for a fleet in these files. Texts in memory are not among them.
    fn classes(&self, files: &[PathBuf]) -> Classes;
}

/// The classes that the composites of a fleet can name.
#[derive(Clone)]
pub struct Classes {
    /// The classes, loops and rules.
    pub registry: Registry,
    /// The resolver of libraries that composites name themselves; `None` where they are not looked for.
    pub libraries: Option<Rc<dyn LibraryResolver>>,
    /// Faults of plugins, which have no place in a composite.
    pub problems: Vec<PluginFault>,
}

/// A fault of a plugin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PluginFault {
    /// True if somebody named the plugin, or if it contradicts another one; others are only left out.
    pub is_error: bool,
    /// The fault.
    pub text: String,
}

/// A resolver of the libraries that composites name with `library`.
pub trait LibraryResolver {
    /// Looks for the library that a composite in a folder names, and adds what it offers to the registry. Nothing in it
    /// runs. `outside` is the path without links of a file that must not be read, unless the user named its folder.
    fn open(
        &self,
        folder: &Path,
        name: &str,
        outside: &dyn Fn(&Path) -> Option<PathBuf>,
        registry: &mut Registry,
    ) -> LibraryLink;

    /// Looks for a class in another language that a composite in a folder names, and adds what it declares to the
    /// registry, as `MODULE.CLASS`. None of its code runs. The `kind` is that of the implementation, such as `python`;
    /// module and class are what it is named by.
    fn declare(&self, folder: &Path, kind: &str, named: (&str, &str), registry: &mut Registry) -> LibraryLink;
}

impl ClassPath for Registry {
    fn classes(&self, _: &[PathBuf]) -> Classes {
        self.clone().into()
    }
}

impl From<Registry> for Classes {
    fn from(registry: Registry) -> Self {
        Self { registry, libraries: None, problems: Vec::new() }
    }
}
