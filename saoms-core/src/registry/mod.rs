//! The classes that composites can name.
//!
//! A [`Registry`] is a value. [`Registry::linked`] has the classes that are linked into the program, tests fill their own.
//! It is built from the text of declarations alone, so that it can know classes whose code it has not run.

mod class;
mod declaration;
mod error;
#[cfg(test)]
mod tests;
mod validate;

use std::collections::BTreeMap;
use std::sync::Arc;

use saoms_api::Registration;

pub use class::{Class, Provider};
pub use declaration::{
    Alias, ClassDeclaration, ClassKind, InterfaceDeclaration, PropertyDeclaration, ReferenceDeclaration,
    ServiceDeclaration, TopicDeclaration,
};
pub use error::RegistryError;

use crate::diagnostic::nearest_few;

/// How many names are offered in place of an unknown one.
const OFFERED: usize = 3;

/// Classes by name.
///
/// ```
/// use saoms_api::{Class, Component, Failure, Registration};
/// use saoms_core::registry::Registry;
///
/// /// Stands around.
/// #[derive(Class)]
/// #[class(name = "example.Lamp", passive)]
/// struct Lamp;
///
/// impl Component for Lamp {
///     type Properties = ();
///
///     fn new(_: ()) -> Result<Self, Failure> {
///         Ok(Lamp)
///     }
/// }
///
/// let mut registry = Registry::new();
/// registry.add(Registration::of::<Lamp>())?;
/// assert_eq!(registry.get("example.Lamp").unwrap().declaration().doc, "Stands around.");
/// assert_eq!(registry.nearest("example.Lmap"), ["example.Lamp"]);
/// assert!(registry.add(Registration::of::<Lamp>()).is_err(), "the name is taken");
/// # Ok::<(), saoms_core::registry::RegistryError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Registry {
    classes: BTreeMap<String, Arc<Class>>,
}

impl Registry {
    /// No classes.
    pub fn new() -> Self {
        Self::default()
    }

    /// The classes that are linked into this program.
    ///
    /// # Errors
    /// As [`Registry::add`].
    pub fn linked() -> Result<Self, RegistryError> {
        let mut all: Vec<&Registration> = Registration::linked().collect();
        // The linker's order would decide which of two faults is reported.
        all.sort_unstable_by_key(|registration| registration.declaration());
        let mut registry = Self::new();
        all.into_iter().try_for_each(|registration| registry.add(*registration))?;
        Ok(registry)
    }

    /// Adds a class under all its names. After an error the registry is as it was before.
    ///
    /// # Errors
    /// The declaration is malformed or of another version of the contract, or one of its names is taken.
    pub fn add(&mut self, registration: Registration) -> Result<(), RegistryError> {
        self.add_provided(registration.declaration(), Arc::new(registration))
    }

    /// Adds a class by its declaration and where its code comes from, under all its names. After an error the registry is as it was before.
    ///
    /// # Errors
    /// As [`Registry::add`].
    pub fn add_provided(
        &mut self,
        declaration: &str,
        provider: Arc<dyn Provider>,
    ) -> Result<(), RegistryError> {
        let classes = read(declaration, &provider)?;
        for (place, class) in classes.iter().enumerate() {
            let taken = self.classes.get(&class.name).map(|other| &other.declaration.name);
            let again = classes[..place].iter().find(|other| other.name == class.name);
            if let Some(first) = taken.or(again.map(|other| &other.declaration.name)) {
                return Err(RegistryError::NameTaken {
                    name: class.name.clone(),
                    first: first.clone(),
                    second: class.declaration.name.clone(),
                });
            }
        }
        self.classes.extend(classes.into_iter().map(|class| (class.name.clone(), Arc::new(class))));
        Ok(())
    }

    /// The class of this name.
    pub fn get(&self, name: &str) -> Option<&Arc<Class>> {
        self.classes.get(name)
    }

    /// All classes under all their names, sorted by name.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Arc<Class>> {
        self.classes.values()
    }

    /// How many names there are.
    pub fn len(&self) -> usize {
        self.classes.len()
    }

    /// Whether there is no class.
    pub fn is_empty(&self) -> bool {
        self.classes.is_empty()
    }

    /// Up to three names that are like `name`, the likeliest first: by spelling, or by what follows the last dot when
    /// nothing is spelt alike.
    pub fn nearest(&self, name: &str) -> Vec<&str> {
        let names = || self.classes.keys().map(String::as_str);
        let alike = nearest_few(name, names(), OFFERED);
        if !alike.is_empty() {
            return alike;
        }
        let last = simple(name);
        names()
            .filter(|known| !last.is_empty() && simple(known).eq_ignore_ascii_case(last))
            .take(OFFERED)
            .collect()
    }
}

/// What follows the last dot: the class without its package.
fn simple(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

/// What every version of a declaration has.
#[derive(serde::Deserialize)]
struct Head {
    contract: u32,
    class: String,
}

/// A class under each of its names, the declared one first.
fn read(text: &str, provider: &Arc<dyn Provider>) -> Result<Vec<Class>, RegistryError> {
    let declaration = Arc::new(read_text(text)?);
    let text: Arc<str> = text.into();
    let class = |name: &str, presets| Class {
        name: name.to_owned(),
        declaration: Arc::clone(&declaration),
        presets,
        text: Arc::clone(&text),
        provider: Arc::clone(provider),
    };
    let also = declaration.also.iter().map(|alias| {
        let presets = alias.preset.iter().map(|(name, value)| (name.clone(), value.as_str().into()));
        class(&alias.name, presets.collect())
    });
    Ok(std::iter::once(class(&declaration.name, Vec::new())).chain(also).collect())
}

fn read_text(text: &str) -> Result<ClassDeclaration, RegistryError> {
    let malformed =
        |class: &str, message: String| RegistryError::Malformed { class: class.to_owned(), message };
    let start: String = text.chars().take(40).collect();
    // First of all the version: another one may have another shape.
    let head: Head = serde_json::from_str(text).map_err(|error| malformed(&start, error.to_string()))?;
    if head.contract != error::CONTRACT {
        return Err(RegistryError::Contract { class: head.class, found: head.contract });
    }
    let declaration: ClassDeclaration =
        serde_json::from_str(text).map_err(|error| malformed(&head.class, error.to_string()))?;
    validate::validate(&declaration).map_err(|message| malformed(&head.class, message))?;
    Ok(declaration)
}
