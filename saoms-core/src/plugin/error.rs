use std::fmt;
use std::path::PathBuf;

use saoms_abi::{SECTION, VERSION};
use saoms_api::boundary::API;

/// A fault of a library that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each field is named in the message of its variant")]
pub enum PluginError {
    /// The file cannot be read.
    Unreadable { path: PathBuf, message: String },
    /// It is no shared library.
    NoLibrary { path: PathBuf },
    /// It is cut off, or damaged.
    Broken { path: PathBuf, message: String },
    /// It was built for another machine.
    Machine { path: PathBuf, found: String },
    /// It has no metadata.
    NoMetadata { path: PathBuf },
    /// Its metadata are not what they should be.
    Metadata { path: PathBuf, message: String },
    /// It was built for another version of the boundary.
    Version { path: PathBuf, found: u32, api: String },
    /// Its panics would end the program.
    Aborts { path: PathBuf, package: String },
    /// The system cannot load it, or its code is not what its metadata say.
    Unloadable { path: PathBuf, package: String, message: String },
}

impl fmt::Display for PluginError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PluginError::Unreadable { path, message } => {
                write!(out, "plugin `{}` cannot be read: {message}", path.display())
            }
            PluginError::NoLibrary { path } => write!(
                out,
                "plugin `{}` is not a shared library: expected the ELF file that `cargo build` makes from a crate \
                with `crate-type = [\"cdylib\"]`",
                path.display()
            ),
            PluginError::Broken { path, message } => {
                write!(out, "plugin `{}` is damaged or cut off ({message}): build or copy it again", path.display())
            }
            PluginError::Machine { path, found } => write!(
                out,
                "plugin `{}` was built for {found}, this program runs on {}: build it with `cargo build --target \
                 {}-unknown-linux-gnu`",
                path.display(),
                std::env::consts::ARCH,
                std::env::consts::ARCH
            ),
            PluginError::NoMetadata { path } => write!(
                out,
                "plugin `{}` has no section `{SECTION}`: add `saoms_api::plugin! {{ classes: [...] }}` to its crate, \
                and build it again",
                path.display()
            ),
            PluginError::Metadata { path, message } => {
                write!(out, "plugin `{}` has metadata that cannot be read: {message}", path.display())
            }
            PluginError::Version { path, found, api } => {
                let older = if *found < VERSION { "older" } else { "newer" };
                let api = if api.is_empty() { String::new() } else { format!(" (saoms-api {api})") };
                write!(
                    out,
                    "plugin `{}` was built for the {older} version {found} of the boundary{api}, this program has \
                     version {VERSION} (saoms-api {API}): build the plugin with saoms-api {API}, by `cargo update -p \
                     saoms-api && cargo build --release` in its folder",
                    path.display()
                )
            }
            PluginError::Aborts { path, package } => write!(
                out,
                "plugin `{}` was built with `panic = \"abort\"`: a panic in it would end the whole program; remove \
                that from the profile in the Cargo.toml of `{package}`, and build it again",
                path.display()
            ),
            PluginError::Unloadable { path, package, message } => {
                write!(out, "plugin `{}` ({package}) cannot be loaded: {message}", path.display())
            }
        }
    }
}

impl std::error::Error for PluginError {}
