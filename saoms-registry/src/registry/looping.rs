//! Declarations of loops and of their knowledge, read from text (see [`saoms_api::host::declaration`]).

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use saoms_api::Failure;
use saoms_api::host::{DynLoop, LoopRegistration, PropertyValue};
use serde::Deserialize;
use serde_json::Value;
use smol_str::SmolStr;

use super::{ClassTopic, PropertyDeclaration, ReferenceDeclaration, simple};

/// All that a loop declares.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct LoopDeclaration {
    /// The name that composite files use.
    #[serde(rename = "loop")]
    pub name: String,
    /// The purpose of the loop.
    #[serde(default)]
    pub doc: String,
    /// The name of the knowledge that it works on; `None` for any that has its entries.
    pub knowledge: Option<String>,
    /// True if it works on the struct of the knowledge, and not entry by entry: it has to be built together with the
    /// component.
    #[serde(default)]
    pub direct: bool,
    /// Its properties in order.
    #[serde(default)]
    pub properties: Vec<PropertyDeclaration>,
    /// The entries it reads.
    #[serde(default)]
    pub senses: Vec<String>,
    /// The entries it changes, beside its own.
    #[serde(default)]
    pub effects: Vec<String>,
    /// The entries that it adds to the knowledge.
    #[serde(default)]
    pub entries: Vec<DeclaredEntry>,
    /// The topics it publishes.
    #[serde(default)]
    pub publishes: Vec<ClassTopic>,
    /// The topics it subscribes to.
    #[serde(default)]
    pub subscribes: Vec<ClassTopic>,
    /// The references it can call through.
    #[serde(default)]
    pub references: Vec<ReferenceDeclaration>,
}

impl LoopDeclaration {
    /// The name within a component unless the composite gives another one: the text behind the last dot.
    pub fn short_name(&self) -> &str {
        simple(&self.name)
    }
}

/// The knowledge that the loops of a class share.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct KnowledgeDeclaration {
    /// The name by which loops say that they work on it.
    pub name: String,
    /// The type of the knowledge in words.
    #[serde(default)]
    pub doc: String,
    /// Its entries in order.
    #[serde(default)]
    pub entries: Vec<DeclaredEntry>,
}

/// An entry of a knowledge.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct DeclaredEntry {
    /// Its name.
    pub name: String,
    /// Its type, as in the schema of a message.
    #[serde(rename = "type")]
    pub of: Value,
    /// The kind of single value that it is; `None` for a compound one.
    pub value: Option<String>,
    /// The meaning.
    #[serde(default)]
    pub doc: String,
    /// Its unit, where it has one.
    pub unit: Option<String>,
    /// True if only one of the loops of a component may change it.
    #[serde(default)]
    pub effector: bool,
    /// True if its changes are not written to the journal.
    #[serde(default)]
    pub quiet: bool,
}

/// The loops that components of a class have unless a composite says otherwise.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct DefaultLoops {
    /// The names of the loops in order, where there is one list.
    #[serde(default)]
    pub default: Vec<String>,
    /// The property whose value chooses a list, where there are several.
    pub property: Option<String>,
    /// The lists by these values.
    #[serde(default)]
    pub lists: BTreeMap<String, Vec<String>>,
}

impl DefaultLoops {
    /// The names of the loops where the property that chooses has this value.
    pub fn of(&self, value: Option<&str>) -> &[String] {
        match (&self.property, value) {
            (Some(_), Some(value)) => self.lists.get(value).map_or(&[], Vec::as_slice),
            (Some(_), None) => &[],
            (None, _) => &self.default,
        }
    }

    /// Each list, with the value that chooses it; the only one without a value.
    pub fn all(&self) -> impl Iterator<Item = (Option<&str>, &[String])> {
        let only = self.property.is_none().then_some((None, self.default.as_slice()));
        only.into_iter().chain(self.lists.iter().map(|(value, list)| (Some(value.as_str()), list.as_slice())))
    }
}

/// A loop that composites can name: what it declares, and how to construct it.
#[derive(Clone, Debug)]
pub struct RegisteredLoop {
    pub(super) declaration: LoopDeclaration,
    pub(super) text: Arc<str>,
    pub(super) provider: Arc<dyn LoopProvider>,
}

impl RegisteredLoop {
    /// The name it is registered under.
    pub fn name(&self) -> &str {
        &self.declaration.name
    }

    /// The declaration.
    pub fn declaration(&self) -> &LoopDeclaration {
        &self.declaration
    }

    /// The declaration as its author's build wrote it: a JSON object in the shape of [`saoms_api::host::declaration`].
    pub fn declaration_json(&self) -> &str {
        &self.text
    }

    /// The first property that has to be given.
    pub(super) fn required(&self) -> Option<&str> {
        let properties = &self.declaration.properties;
        properties.iter().find(|property| property.required).map(|property| property.name.as_str())
    }

    /// The library that the loop comes from; `None` for one that is linked into the program.
    pub fn origin(&self) -> Option<&Path> {
        self.provider.origin()
    }

    /// True if its library was found and not named: it is known by its declaration alone, and none of its code runs.
    pub fn is_only_read(&self) -> bool {
        self.provider.is_only_read()
    }

    /// Constructs a loop; values that are absent take their defaults.
    ///
    /// # Errors
    /// A value is missing or wrong, or the values do not fit together.
    pub fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
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

/// The source of the code of a loop.
pub trait LoopProvider: fmt::Debug + Send + Sync {
    /// As [`RegisteredLoop::construct`].
    ///
    /// # Errors
    /// As there.
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure>;

    /// As [`RegisteredLoop::load`].
    ///
    /// # Errors
    /// As there.
    fn load(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// As [`RegisteredLoop::origin`].
    fn origin(&self) -> Option<&Path>;

    /// As [`RegisteredLoop::is_only_read`].
    fn is_only_read(&self) -> bool {
        false
    }
}

impl LoopProvider for LoopRegistration {
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        LoopRegistration::construct(self, values)
    }

    fn origin(&self) -> Option<&Path> {
        None
    }
}
