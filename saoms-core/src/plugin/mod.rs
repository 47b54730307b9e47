//! Libraries that bring classes.
//!
//! A [`Plugin`] is known by its metadata, which lie in a section of the file and are read before anything in it runs (see
//! [`saoms_api::abi`]). Its code is loaded when the first component of its classes is constructed, and stays until the program ends.

mod error;
mod file;
mod library;
mod metadata;
mod search;

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use saoms_api::abi::ImportedClass;
use saoms_api::{DynComponent, Failure, PropertyValue};

pub use error::PluginError;
pub use metadata::Metadata;
pub use search::{Found, Search};

use crate::registry::{Provider, Registry, RegistryError};

/// A library that brings classes.
#[derive(Debug)]
pub struct Plugin {
    path: PathBuf,
    text: String,
    metadata: Metadata,
    /// The tables of its classes, once its code is loaded.
    classes: OnceLock<Result<Vec<ImportedClass>, PluginError>>,
}

impl Plugin {
    /// Reads what a library offers. Nothing in it runs.
    ///
    /// # Errors
    /// It is no library for this machine, has no metadata, or was built for another version of the boundary.
    pub fn open(path: &Path) -> Result<Arc<Plugin>, PluginError> {
        let text = file::read_section(path)?;
        let metadata = metadata::read(path, &text)?;
        Ok(Arc::new(Plugin { path: path.to_owned(), text, metadata, classes: OnceLock::new() }))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it says about itself.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// Adds its classes to a registry.
    ///
    /// # Errors
    /// As [`Registry::add`].
    pub fn register(self: &Arc<Plugin>, registry: &mut Registry) -> Result<(), RegistryError> {
        for (place, declaration) in self.metadata.classes.iter().enumerate() {
            let provider = ClassOf { plugin: Arc::clone(self), place };
            registry.add_provided(declaration.get(), Arc::new(provider))?;
        }
        Ok(())
    }

    /// Loads its code, at the first call.
    ///
    /// # Errors
    /// The system cannot load it, or its tables are not what its metadata say.
    pub fn load(&self) -> Result<&[ImportedClass], PluginError> {
        let classes = self.classes.get_or_init(|| library::load(&self.path, &self.metadata, &self.text));
        classes.as_deref().map_err(Clone::clone)
    }
}

/// A class of a plugin.
#[derive(Debug)]
struct ClassOf {
    plugin: Arc<Plugin>,
    place: usize,
}

impl Provider for ClassOf {
    fn construct(&self, values: &[(String, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        let classes = self.plugin.load().map_err(|error| Failure::new(error.to_string()))?;
        // `load` gives one for each class of the metadata.
        let class = classes.get(self.place).ok_or("the library has no such class")?;
        class.construct(values)
    }

    fn origin(&self) -> Option<&Path> {
        Some(self.plugin.path())
    }
}
