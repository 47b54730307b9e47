use std::path::Path;

use saoms_api::abi::VERSION;
use serde::Deserialize;
use serde_json::value::RawValue;

use super::PluginError;

/// What a library says about itself.
#[derive(Debug, Deserialize)]
pub struct Metadata {
    /// The version of `saoms-api` that it was built with; empty for one in another language.
    #[serde(default)]
    pub api: String,
    /// Its name.
    #[serde(default)]
    pub package: String,
    /// Its version.
    #[serde(default)]
    pub version: String,
    /// Whether its panics unwind or abort.
    #[serde(default)]
    pub(super) panic: String,
    /// The name of the function that gives its tables.
    pub(super) entry: String,
    /// The declarations of its classes.
    #[serde(default)]
    pub(super) classes: Vec<Box<RawValue>>,
    /// The declarations of its loops.
    #[serde(default)]
    pub(super) loops: Vec<Box<RawValue>>,
}

/// What every version has.
#[derive(Deserialize)]
struct Head {
    saoms: String,
    abi: u32,
    #[serde(default)]
    api: String,
}

/// Reads metadata.
pub(super) fn read(path: &Path, text: &str) -> Result<Metadata, PluginError> {
    let malformed = |message: String| PluginError::Metadata { path: path.to_owned(), message };
    // First of all the version: another one may have another shape.
    let head: Head = serde_json::from_str(text).map_err(|error| malformed(error.to_string()))?;
    if head.saoms != "plugin" {
        return Err(malformed(format!("found `{}` for `saoms`, expected `plugin`", head.saoms)));
    }
    if head.abi != VERSION {
        return Err(PluginError::Version { path: path.to_owned(), found: head.abi, api: head.api });
    }
    let metadata: Metadata = serde_json::from_str(text).map_err(|error| malformed(error.to_string()))?;
    if metadata.panic == "abort" {
        return Err(PluginError::Aborts { path: path.to_owned(), package: metadata.package });
    }
    Ok(metadata)
}
