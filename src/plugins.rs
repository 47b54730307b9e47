//! The classes that composites can name: those linked in, and those of plugins.

use std::env;
use std::path::{Path, PathBuf};

use saoms_api::host::one_line;
use saoms_core::plugin::Search;
use saoms_lang::project::{ClassPath, Classes, PluginFault};
use saoms_lang::registry::Registry;

use crate::Exit;
use crate::arguments::PluginArguments;
use crate::output::eprint;

/// The variable with folders of plugins, separated by colons.
const SEARCH_PATH: &str = "SAOMS_PLUGIN_PATH";

/// The classes of a command. Plugins are looked for where the command line says, in the folders of `SAOMS_PLUGIN_PATH`,
/// beside each composite, and in a folder `plugins` beside it or in the current folder; of those that the command line
/// and the variable do not name, the declarations are read and no code runs.
pub(crate) struct CommandClasses<'a> {
    arguments: &'a PluginArguments,
    linked: Registry,
}

impl<'a> CommandClasses<'a> {
    /// The classes linked in, with plugins as the arguments say.
    ///
    /// # Errors
    /// The linked classes contradict each other, which is a fault of this build and not of the user: it was reported.
    pub(crate) fn new(arguments: &'a PluginArguments) -> Result<Self, Exit> {
        match Registry::linked() {
            Ok(linked) => Ok(Self { arguments, linked }),
            Err(error) => {
                eprint(&format!("error: {error}\n"));
                Err(Exit::Failed)
            }
        }
    }
}

impl ClassPath for CommandClasses<'_> {
    fn classes(&self, files: &[PathBuf]) -> Classes {
        let mut classes = search(self.arguments, files).classes(self.linked.clone());
        let unasked = classes.registry.rules().iter().filter(|rule| rule.is_only_read());
        let mut unasked: Vec<&Path> = unasked.filter_map(|rule| rule.origin()).collect();
        unasked.dedup();
        let told = unasked.into_iter().map(|path| {
            let path = path.display();
            let text = format!(
                "plugin `{path}` was found, but no option names it: its rules do not check the fleet; add `--plugin \
                {path}` to run its code"
            );
            PluginFault { is_error: false, text }
        });
        classes.problems.extend(told);
        classes
    }
}

/// The files of plugins that a command without composites reads.
pub(crate) fn files_read(arguments: &PluginArguments) -> Vec<PathBuf> {
    search(arguments, &[]).files()
}

/// The registry of a command without composites.
///
/// # Errors
/// A plugin cannot be used, which was reported.
pub(crate) fn registry(arguments: &PluginArguments) -> Result<Registry, Exit> {
    let CommandClasses { linked, .. } = CommandClasses::new(arguments)?;
    let Classes { registry, problems, .. } = search(arguments, &[]).classes(linked);
    usable(&problems)?;
    Ok(registry)
}

/// Tells what is wrong with plugins.
///
/// # Errors
/// One of them cannot be used.
pub(crate) fn usable(problems: &[PluginFault]) -> Result<(), Exit> {
    for PluginFault { is_error, text } in problems {
        eprint(&format!("{}: {}\n", if *is_error { "error" } else { "warning" }, one_line(text)));
    }
    if problems.iter().any(|one| one.is_error) { Err(Exit::WrongInput) } else { Ok(()) }
}

/// The places where plugins are looked for.
pub(crate) fn search(arguments: &PluginArguments, files: &[PathBuf]) -> Search {
    let path = env::var_os(SEARCH_PATH).unwrap_or_default();
    let folders: Vec<PathBuf> = env::split_paths(&path).filter(|path| !path.as_os_str().is_empty()).collect();
    let mut around = Vec::new();
    for file in files {
        let beside =
            file.parent().map(|parent| if parent.as_os_str().is_empty() { ".".into() } else { parent.to_owned() });
        around.extend(beside.into_iter().flat_map(|beside| [beside.join("plugins"), beside]));
    }
    around.push("plugins".into());
    if !arguments.plugins.is_empty() || !path.is_empty() {
        crate::guard::install();
    }
    Search { named: arguments.plugins.clone(), folders, around, runs_all: false }
}
