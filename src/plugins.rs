//! The classes that composites can name: those linked in, and those of plugins.

use std::env;
use std::path::PathBuf;

use saoms_core::plugin::Search;
use saoms_lang::registry::{Registry, RegistryError};

use crate::Exit;
use crate::arguments::PluginArguments;
use crate::output::eprint;

/// The variable with folders of plugins, separated by colons.
const SEARCH_PATH: &str = "SAOMS_PLUGIN_PATH";

/// Something that is wrong with a plugin.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    /// Whether somebody named the plugin, or it contradicts another one; others are only left out.
    pub(crate) is_error: bool,
    pub(crate) text: String,
}

/// The registry of a command over these composites. Plugins are looked for where the command line says, in the folders of
/// `SAOMS_PLUGIN_PATH`, beside each composite, and in a folder `plugins` beside it or in the current folder.
///
/// What is wrong is told here; then the exit code is that for wrong input.
pub(crate) fn registry(arguments: &PluginArguments, files: &[PathBuf]) -> Result<Registry, Exit> {
    let (registry, problems) = collect(&search(arguments, files)).map_err(|error| {
        // A fault of this build, not of the user: no composite could be checked.
        eprint(&format!("error: {error}\n"));
        Exit::Failed
    })?;
    for Problem { is_error, text } in &problems {
        eprint(&format!("{}: {text}\n", if *is_error { "error" } else { "warning" }));
    }
    if problems.iter().any(|one| one.is_error) { Err(Exit::WrongInput) } else { Ok(registry) }
}

/// Where plugins are looked for.
pub(crate) fn search(arguments: &PluginArguments, files: &[PathBuf]) -> Search {
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
    Search { named: arguments.plugins.clone(), folders, copies: arguments.copies }
}

/// The classes linked in and those of the plugins that a search finds, with all that is wrong.
///
/// # Errors
/// What is linked in does not fit together.
pub(crate) fn collect(search: &Search) -> Result<(Registry, Vec<Problem>), RegistryError> {
    let mut registry = Registry::linked()?;
    let found = search.run();
    let left_out = found.left_out.iter().map(|error| Problem { is_error: false, text: error.to_string() });
    let mut problems: Vec<Problem> = left_out.collect();
    problems.extend(found.errors.iter().map(|error| Problem { is_error: true, text: error.to_string() }));
    for plugin in &found.plugins {
        if let Err(error) = plugin.register(&mut registry) {
            let text = match error {
                RegistryError::NameTaken { .. } => error.to_string(),
                _ => format!("plugin `{}`: {error}", plugin.path().display()),
            };
            problems.push(Problem { is_error: true, text });
        }
    }
    Ok((registry, problems))
}
