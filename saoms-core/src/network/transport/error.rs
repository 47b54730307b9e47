use std::fmt;
use std::path::PathBuf;

use crate::plugin::PluginError;

/// A reason why there is no transport for a url.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each field is named in the message of its variant")]
pub enum TransportError {
    /// No library serves urls of this scheme.
    Missing { scheme: String, searched: Vec<PathBuf>, known: Vec<String>, installed: Option<PathBuf> },
    /// The library cannot be read or loaded.
    Library(PluginError),
    /// Its metadata are not what they should be.
    Metadata { path: PathBuf, message: String },
    /// It was built for another version of the boundary.
    Version { path: PathBuf, found: u32, expected: u32 },
}

impl fmt::Display for TransportError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TransportError::Missing { scheme, searched, known, installed } => {
                match scheme.as_str() {
                    "" => out.write_str("there is no transport for urls such as `host:port`")?,
                    scheme => write!(out, "there is no transport for urls with `{scheme}://`")?,
                }
                if !known.is_empty() {
                    write!(out, "; those that were found serve {}", known.join(", "))?;
                }
                let folders: Vec<String> = searched.iter().map(|path| format!("`{}`", path.display())).collect();
                out.write_str(
                    ": `cargo build --release -p saoms-zenoh` makes the one for `host:port` and `tls://`, \
                     `libsaoms_zenoh.so`, in `target/release`",
                )?;
                if let Some(installed) = installed {
                    write!(out, "; copy it to `{}`, or name it with `--plugin`", installed.display())?;
                }
                write!(out, "; searched in {}", folders.join(", "))
            }
            TransportError::Library(error) => error.fmt(out),
            TransportError::Metadata { path, message } => {
                write!(out, "transport `{}` has metadata that cannot be read: {message}", path.display())
            }
            TransportError::Version { path, found, expected } => write!(
                out,
                "transport `{}` was built for version {found} of the boundary, this program has version {expected}: \
                 build it again, with the saoms-abi of this program",
                path.display()
            ),
        }
    }
}

impl std::error::Error for TransportError {}
