//! The classes that composites can name: those linked in, and those of plugins.

use std::env;
use std::path::PathBuf;

use saoms_core::model::Contribution;
use saoms_core::plugin::{Search, open_named};
use saoms_core::registry::{Registry, RegistryError};
use saoms_core::source::Sources;

use crate::Exit;
use crate::arguments::PluginArguments;
use crate::output::eprint;

/// The variable with folders of plugins, separated by colons.
const SEARCH_PATH: &str = "SAOMS_PLUGIN_PATH";

/// The registry of a command over these composites. Plugins are looked for where the command line says, in the folders of
/// `SAOMS_PLUGIN_PATH`, beside each composite, and in a folder `plugins` beside it or in the current folder.
///
/// What is wrong is told here; then the exit code is that for wrong input.
pub(crate) fn registry(arguments: &PluginArguments, files: &[PathBuf]) -> Result<Registry, Exit> {
    let mut registry = Registry::linked().map_err(|error| {
        // A fault of this build, not of the user: no composite could be checked.
        eprint(&format!("error: {error}\n"));
        Exit::Failed
    })?;
    let found = search(arguments, files).run();
    for error in &found.left_out {
        eprint(&format!("warning: {error}\n"));
    }
    let mut failed = !found.errors.is_empty();
    for error in &found.errors {
        eprint(&format!("error: {error}\n"));
    }
    for plugin in &found.plugins {
        if let Err(error) = plugin.register(&mut registry) {
            eprint(&match error {
                RegistryError::NameTaken { .. } => format!("error: {error}\n"),
                _ => format!("error: plugin `{}`: {error}\n", plugin.path().display()),
            });
            failed = true;
        }
    }
    if failed { Err(Exit::WrongInput) } else { Ok(registry) }
}

/// Adds the classes of the libraries that composites name themselves. What is wrong with these the checker says.
pub(crate) fn open_libraries(
    arguments: &PluginArguments,
    files: &[PathBuf],
    contribution: &mut Contribution,
    sources: &Sources,
    registry: &mut Registry,
) {
    open_named(contribution, &search(arguments, files), sources, registry);
}

fn search(arguments: &PluginArguments, files: &[PathBuf]) -> Search {
    let path = env::var_os(SEARCH_PATH).unwrap_or_default();
    let mut folders: Vec<PathBuf> =
        env::split_paths(&path).filter(|path| !path.as_os_str().is_empty()).collect();
    for file in files {
        let beside = file
            .parent()
            .map(|parent| if parent.as_os_str().is_empty() { ".".into() } else { parent.to_owned() });
        folders.extend(beside.into_iter().flat_map(|beside| [beside.join("plugins"), beside]));
    }
    folders.push("plugins".into());
    Search { named: arguments.plugins.clone(), folders }
}
