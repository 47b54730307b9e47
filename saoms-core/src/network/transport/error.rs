use std::fmt;
use std::path::PathBuf;

use crate::plugin::PluginError;

/// The transports that ship: their packages, with the schemes for which people look for them. Where a scheme is none of
/// these, the first one is what is likely meant.
const SHIPPED: [(&str, &[&str]); 5] = [
    ("saoms-zenoh", &["", "tls"]),
    ("saoms-mqtt", &["mqtt", "mqtts"]),
    ("saoms-stomp", &["stomp", "stomp+ssl"]),
    ("saoms-ros2", &["ros2"]),
    ("saoms-rosbridge", &["rosbridge"]),
];

/// A scheme as people write it.
pub(super) fn shown(scheme: &str) -> String {
    if scheme.is_empty() { "`host:port`".to_owned() } else { format!("`{scheme}://`") }
}

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
    /// It carries the topics of programs that do not speak our language.
    Topics { scheme: String },
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
                let meant = SHIPPED.iter().find(|(_, serves)| serves.contains(&scheme.as_str()));
                let (package, serves) = meant.unwrap_or(&SHIPPED[0]);
                let serves: Vec<String> = serves.iter().map(|scheme| shown(scheme)).collect();
                let folders: Vec<String> = searched.iter().map(|path| format!("`{}`", path.display())).collect();
                write!(
                    out,
                    ": `cargo build --release -p {package}` makes the one for {}, `lib{}.so`, in \
                     `target/release`",
                    serves.join(" and "),
                    package.replace('-', "_")
                )?;
                if let Some(installed) = installed {
                    write!(out, "; copy it to `{}`, or name it with `--plugin`", installed.display())?;
                }
                write!(out, "; searched in {}", folders.join(", "))
            }
            TransportError::Library(error) => error.fmt(out),
            TransportError::Topics { scheme } => {
                write!(out, "urls with `{scheme}://` lead to topics of other programs, which know no operators")
            }
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
