use std::fmt::Display;

use saoms_api::host::{one_line, shown};
use saoms_lang::assembly::ComponentSpec;

/// What a component said when it failed, with the library of the code that failed.
pub(crate) fn with_library(spec: &ComponentSpec, failure: impl Display) -> String {
    let text = failure.to_string();
    match library_of(spec, &text) {
        Some(library) => text + &in_library(&library),
        // That of a library was shortened when it came.
        None => shown(text.as_bytes()).into_owned(),
    }
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
