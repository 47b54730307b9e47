//! A class under one of its names.

use std::sync::Arc;

use std::fmt;
use std::path::Path;

use saoms_api::Failure;
use saoms_api::host::{DynComponent, PropertyValue, Registration};
use smol_str::SmolStr;

use super::ClassDeclaration;

/// A class under one of its names: what it declares, and how to construct components of it.
#[derive(Clone, Debug)]
pub struct RegisteredClass {
    pub(super) name: String,
    pub(super) declaration: Arc<ClassDeclaration>,
    pub(super) presets: Vec<(SmolStr, PropertyValue)>,
    pub(super) text: Arc<str>,
    pub(super) extended: Arc<[Arc<str>]>,
    pub(super) provider: Arc<dyn Provider>,
}

impl RegisteredClass {
    /// The name it is registered under: that of the declaration, or a further one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// True if the name is a further one, not that of the declaration.
    pub fn is_alias(&self) -> bool {
        self.name != self.declaration.name
    }

    /// The declaration.
    pub fn declaration(&self) -> &Arc<ClassDeclaration> {
        &self.declaration
    }

    /// The declaration as its author's build wrote it: a JSON object in the shape of [`saoms_api::host::declaration`].
    pub fn declaration_json(&self) -> &str {
        &self.text
    }

    /// The same of the classes that it extends, the nearest first.
    pub fn extended_json(&self) -> impl Iterator<Item = &str> {
        self.extended.iter().map(AsRef::as_ref)
    }

    /// The values that this name presets, for properties that a composite does not give.
    pub fn presets(&self) -> &[(SmolStr, PropertyValue)] {
        &self.presets
    }

    /// The library that the class comes from; `None` for one that is linked into the program.
    pub fn origin(&self) -> Option<&Path> {
        self.provider.origin()
    }

    /// True if its library was found and not named: it is known by its declaration alone, and none of its code runs.
    pub fn is_only_read(&self) -> bool {
        self.provider.is_only_read()
    }

    /// The language of its code where a library runs it in another one, such as `python`: its name is then that of its
    /// module, a dot, and that of the class in it.
    pub fn language(&self) -> Option<&str> {
        self.provider.language()
    }

    /// Constructs a component. `values` are all values, those preset by the name included; absent ones take their
    /// defaults.
    ///
    /// # Errors
    /// A value is missing or wrong, or the values do not fit together.
    pub fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        self.provider.construct(values)
    }

    /// Loads its code, if that is not there yet.
    ///
    /// # Errors
    /// Its library cannot be loaded.
    pub fn load(&self) -> Result<(), Failure> {
        self.provider.load()
    }
}

/// The source of the code of a class.
pub trait Provider: fmt::Debug + Send + Sync {
    /// As [`RegisteredClass::construct`].
    ///
    /// # Errors
    /// As there.
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure>;

    /// As [`RegisteredClass::load`].
    ///
    /// # Errors
    /// As there.
    fn load(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// As [`RegisteredClass::origin`].
    fn origin(&self) -> Option<&Path>;

    /// As [`RegisteredClass::language`].
    fn language(&self) -> Option<&str> {
        None
    }

    /// As [`RegisteredClass::is_only_read`].
    fn is_only_read(&self) -> bool {
        false
    }
}

impl Provider for Registration {
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        Registration::construct(self, values)
    }

    fn origin(&self) -> Option<&Path> {
        None
    }
}
