//! Plugins: libraries with classes, loops and rules over whole fleets.
//!
//! A [`Plugin`] is known by its metadata, which lie in a section of the file and are read before anything in it runs
//! (see [`saoms_abi`]). Its code is loaded when the first component of its classes is constructed, from a private copy
//! of the file, and stays until the program ends.

mod boundary;
mod copy;
mod declared_names;
mod error;
mod file;
mod implementation;
mod library;
mod metadata;
mod named;
mod search;
mod tables;

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use saoms_abi::SECTION;
use saoms_api::host::{DynComponent, DynLoop, PropertyValue};
use saoms_api::rule::FleetView;
use saoms_api::{Failure, Finding};
use smol_str::SmolStr;

use boundary::Implementation;
pub use boundary::{ImportedClass, ImportedLoopClass, ImportedRule};
pub use error::PluginError;
pub(crate) use file::read_section;
pub(crate) use library::load_table;
pub use metadata::Metadata;
pub use search::{FoundLibraries, Search};
pub(crate) use search::{beside_the_program, libraries};

use saoms_lang::registry::{LoopProvider, Provider, Registry, RegistryError, RuleProvider};

/// The tables of a loaded library, in the order of its metadata.
#[derive(Debug)]
struct Code {
    classes: Vec<ImportedClass>,
    loops: Vec<ImportedLoopClass>,
    rules: Vec<ImportedRule>,
    implementation: Option<Implementation>,
}

/// The use that may be made of the code of a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CodeUse {
    Load,
    /// Nobody named the library: none of its code may run.
    Nothing,
}

/// A library with classes, loops and rules.
#[derive(Debug)]
pub struct Plugin {
    path: PathBuf,
    text: String,
    metadata: Metadata,
    /// What may become of its code.
    use_of_code: CodeUse,
    /// Its code, once it is loaded.
    code: OnceLock<Result<Code, PluginError>>,
}

impl Plugin {
    /// Reads the metadata of a library. No code of it runs.
    ///
    /// # Errors
    /// It is no library for this machine, has no metadata, or was built for another version of the boundary.
    pub fn open(path: &Path) -> Result<Arc<Plugin>, PluginError> {
        Plugin::read(path, CodeUse::Load)
    }

    fn read(path: &Path, use_of_code: CodeUse) -> Result<Arc<Plugin>, PluginError> {
        let text = file::read_section(path, SECTION)?;
        let metadata = metadata::read(path, &text)?;
        Ok(Arc::new(Plugin { path: path.to_owned(), text, metadata, use_of_code, code: OnceLock::new() }))
    }

    /// Path of the library.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// True if none of its code runs, because nobody named it.
    pub fn is_only_read(&self) -> bool {
        self.use_of_code == CodeUse::Nothing
    }

    /// Metadata of the library.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// Adds its loops, classes and rules to a registry, all of them or, after an error, none.
    ///
    /// # Errors
    /// As [`Registry::add_loop`], [`Registry::add`] and [`Registry::add_rule`].
    pub fn register(self: &Arc<Plugin>, registry: &mut Registry) -> Result<(), RegistryError> {
        // All or nothing.
        let mut all = registry.clone();
        for (place, declaration) in self.metadata.loops.iter().enumerate() {
            let provider = Part { plugin: Arc::clone(self), place };
            all.add_loop_provided(declaration.get(), Arc::new(provider))?;
        }
        for (place, declaration) in self.metadata.classes.iter().enumerate() {
            let provider = Part { plugin: Arc::clone(self), place };
            all.add_provided(declaration.get(), Arc::new(provider))?;
        }
        for (place, rule) in self.metadata.rules.iter().enumerate() {
            let provider = Part { plugin: Arc::clone(self), place };
            all.add_rule_provided(rule.code, rule.judges_parts, rule.prevents_start, Arc::new(provider))?;
        }
        *registry = all;
        Ok(())
    }

    /// Loads its code, at the first call.
    fn code(&self) -> Result<&Code, Failure> {
        if self.use_of_code == CodeUse::Nothing {
            let path = self.path.display();
            return Err(Failure::new(format!("no option names this library: add `--plugin {path}` to run its code")));
        }
        let code = self.code.get_or_init(|| library::load(&self.path, &self.metadata, &self.text));
        code.as_ref().map_err(|error| Failure::new(error.to_string()))
    }
}

/// A class, a loop or a rule of a plugin, by its index in the metadata.
#[derive(Debug)]
struct Part {
    plugin: Arc<Plugin>,
    place: usize,
}

impl Provider for Part {
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        // The loader checked that each of the metadata has its table.
        self.plugin.code()?.classes.get(self.place).ok_or("the library has no such class")?.construct(values)
    }

    fn load(&self) -> Result<(), Failure> {
        self.plugin.code().map(drop)
    }

    fn origin(&self) -> Option<&Path> {
        Some(self.plugin.path())
    }

    fn is_only_read(&self) -> bool {
        self.plugin.is_only_read()
    }
}

impl LoopProvider for Part {
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        // The loader checked that each of the metadata has its table.
        self.plugin.code()?.loops.get(self.place).ok_or("the library has no such loop")?.construct(values)
    }

    fn load(&self) -> Result<(), Failure> {
        self.plugin.code().map(drop)
    }

    fn origin(&self) -> Option<&Path> {
        Some(self.plugin.path())
    }

    fn is_only_read(&self) -> bool {
        self.plugin.is_only_read()
    }
}

impl RuleProvider for Part {
    fn check(&self, fleet: &FleetView<'_>) -> Result<Vec<Finding>, Failure> {
        // The loader checked that each of the metadata has its table.
        self.plugin.code()?.rules.get(self.place).ok_or("the library has no such rule")?.check(fleet)
    }

    fn origin(&self) -> Option<&Path> {
        Some(self.plugin.path())
    }

    fn is_only_read(&self) -> bool {
        self.plugin.is_only_read()
    }
}
