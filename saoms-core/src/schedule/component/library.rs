use std::fmt::Display;

use saoms_api::host::one_line;
use saoms_lang::assembly::ComponentSpec;

/// What a component said when it failed, with the library of the code that failed.
pub(crate) fn with_library(spec: &ComponentSpec, failure: impl Display) -> String {
    let mut text = failure.to_string();
    if let Some(library) = library_of(spec, &text) {
        text.push_str(&in_library(&library));
    }
    text
}

/// The library of the code that failed so: that of the component, or of the loop that the failure names.
pub(crate) fn library_of(spec: &ComponentSpec, failure: &str) -> Option<String> {
    let named = spec.loops.iter().find(|one| failure.starts_with(&format!("loop `{}`: ", one.name)));
    let library = named.map_or_else(|| spec.class.origin(), |one| one.class.origin())?;
    Some(one_line(&library.display().to_string()).into_owned())
}

/// The end of a message about code of a library.
pub(crate) fn in_library(library: &str) -> String {
    format!(" (library `{library}`)")
}
