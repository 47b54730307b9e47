//! Classes in other languages, which composites name by module and class, and a library reads and runs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use saoms_api::Failure;
use saoms_api::host::{DynComponent, PropertyValue};
use saoms_lang::model::{ClassFault, LibraryLink};
use saoms_lang::registry::{Provider, Registry};
use saoms_lang::source::identity;
use serde::Deserialize;
use serde_json::value::RawValue;
use smol_str::SmolStr;

use super::search::{beside_the_program, libraries};
use super::{CodeUse, Plugin, PluginError, Search};

/// What a library says of a class.
#[derive(Deserialize)]
struct Answer {
    declaration: Option<Box<RawValue>>,
    #[serde(default)]
    file: PathBuf,
    #[serde(default)]
    installed: bool,
    #[serde(default)]
    findings: Vec<Finding>,
}

#[derive(Deserialize)]
struct Finding {
    part: String,
    message: String,
    #[serde(default)]
    help: Vec<String>,
    #[serde(default)]
    instead: Vec<String>,
}

/// A class in another language.
#[derive(Debug)]
struct ForeignClass {
    plugin: Arc<Plugin>,
    kind: String,
    request: String,
    file: PathBuf,
    is_only_read: bool,
}

impl Provider for ForeignClass {
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        let implementation = self.plugin.code()?.implementation;
        implementation.ok_or("the library runs no classes in other languages")?.construct(&self.request, values)
    }

    fn load(&self) -> Result<(), Failure> {
        self.plugin.code().map(drop)
    }

    fn origin(&self) -> Option<&Path> {
        Some(&self.file)
    }

    fn language(&self) -> Option<&str> {
        Some(&self.kind)
    }

    fn is_only_read(&self) -> bool {
        self.is_only_read
    }
}

impl Search {
    /// Registers a class in another language.
    pub(super) fn declare_class(
        &self,
        folder: &Path,
        kind: &str,
        (module, class): (&str, &str),
        registry: &mut Registry,
    ) -> LibraryLink {
        let plugin = match self.runner(kind) {
            Ok(Some(plugin)) => plugin,
            Ok(None) => return LibraryLink::Missing(Vec::new()),
            Err(message) => return LibraryLink::Faulty(message),
        };
        let folder = std::path::absolute(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        let folder = folder.unwrap_or_default();
        let named = self.named.iter().chain(&self.folders).filter(|place| place.is_dir());
        let named = named.filter_map(|place| std::path::absolute(place).ok());
        let folders: Vec<PathBuf> = std::iter::once(folder).chain(named).collect();
        let request = serde_json::json!({"kind": kind, "module": module, "class": class, "folders": folders});
        let request = request.to_string();
        let answer = plugin.code().and_then(|code| {
            let implementation = code.implementation.ok_or("its table has no functions for classes")?;
            implementation.declare(&request)
        });
        let answer = answer.and_then(|answer| {
            serde_json::from_slice::<Answer>(&answer)
                .map_err(|error| Failure::new(format!("its answer about a class cannot be read: {error}")))
        });
        let Answer { declaration, file, installed, findings } = match answer {
            Ok(answer) => answer,
            Err(failure) => return LibraryLink::Faulty(failure.message().to_owned()),
        };
        let Some(declaration) = declaration else {
            let fault = |Finding { part, message, help, instead }| ClassFault { part, message, help, instead };
            return LibraryLink::Undeclared(findings.into_iter().map(fault).collect());
        };
        let name = format!("{module}.{class}");
        let is_known = registry
            .get(&name)
            .is_some_and(|known| known.origin() == Some(&file) && known.declaration_json() == declaration.get());
        if !is_known {
            let is_only_read = !(installed || self.runs_all || self.names_module(&file));
            let provider = ForeignClass { plugin, kind: kind.to_owned(), request, file: file.clone(), is_only_read };
            if let Err(error) = registry.add_provided(declaration.get(), Arc::new(provider)) {
                return LibraryLink::Faulty(error.to_string());
            }
        }
        LibraryLink::To(file)
    }

    /// True if the user named a module, or a folder in which its package is.
    fn names_module(&self, file: &Path) -> bool {
        let file = identity(file);
        let mut places = self.named.iter().chain(&self.folders);
        places
            .any(|place| file.starts_with(identity(if place.as_os_str().is_empty() { Path::new(".") } else { place })))
    }

    /// The library that runs classes of a language: one that is named, or one beside the program. `None`: there is
    /// none.
    ///
    /// # Errors
    /// It is there, and cannot be used.
    fn runner(&self, kind: &str) -> Result<Option<Arc<Plugin>>, String> {
        let own = beside_the_program().into_iter().flat_map(|folder| libraries(&folder));
        let named = self.files().into_iter().filter(|path| self.runs_all || self.is_named(path));
        let mut fault = None;
        for path in named.chain(own) {
            match Plugin::read(&path, CodeUse::Load) {
                Ok(plugin) if plugin.metadata.implementations.iter().any(|one| one == kind) => return Ok(Some(plugin)),
                // Another version of the boundary: whether it is this library, its metadata cannot say.
                Err(error @ PluginError::Version { .. }) => _ = fault.get_or_insert(error),
                _ => {}
            }
        }
        fault.map_or(Ok(None), |error| Err(error.to_string()))
    }
}
