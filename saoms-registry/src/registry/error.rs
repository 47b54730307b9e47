//! Errors of a registry.

use std::fmt;
use std::path::{Path, PathBuf};

/// The reason why a class cannot be registered. The fault is the program's or the plugin's, not that of a composite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RegistryError {
    /// The declaration is no JSON of the right shape, or contradicts itself.
    Malformed {
        /// The class, or the start of the declaration where it has no readable name.
        class: String,
        /// The fault.
        message: String,
    },
    /// The declaration of a loop is no JSON of the right shape, or contradicts itself.
    MalformedLoop {
        /// The loop, or the start of the declaration where it has no readable name.
        name: String,
        /// The fault.
        message: String,
    },
    /// The declaration is of another version of the contract.
    Contract {
        /// The class, or the loop.
        class: String,
        /// The version of the declaration.
        found: u32,
    },
    /// A name, or the code of a rule, is taken already.
    NameTaken {
        /// The name.
        name: String,
        /// The holder of the name.
        first: Holder,
        /// The one that was to get it.
        second: Holder,
    },
}

/// The holder of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// As "class `a.Eye`".
    pub what: String,
    /// The library that it comes from; `None` for what is linked into the program.
    pub origin: Option<PathBuf>,
}

impl Holder {
    pub(super) fn new(kind: &str, name: &str, origin: Option<&Path>) -> Holder {
        Holder { what: format!("{kind} `{name}`"), origin: origin.map(Path::to_owned) }
    }

    fn place(&self) -> String {
        match &self.origin {
            Some(path) => format!("in plugin `{}`", path.display()),
            None => "in this program".to_owned(),
        }
    }
}

/// The version of the contract that this registry reads.
pub(super) const CONTRACT: u32 = 1;

impl fmt::Display for RegistryError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed { class, message } => {
                write!(out, "the declaration of class `{class}` is malformed: {message}")
            }
            Self::MalformedLoop { name, message } => {
                write!(out, "the declaration of loop `{name}` is malformed: {message}")
            }
            Self::Contract { class, found } => write!(
                out,
                "class `{class}` was built for contract {found}, this program has contract {CONTRACT}: build both from one version"
            ),
            Self::NameTaken { name, first, second } => {
                let what = match (&first.what, &second.what) {
                    (first, second) if first == second => format!("{first} is registered twice"),
                    (first, second) => format!("the name `{name}` is used by {first} and by {second}"),
                };
                match (&first.origin, &second.origin) {
                    (None, None) => out.write_str(&what),
                    _ => {
                        write!(out, "{what}: {} and {}; use one, or rename one", first.place(), second.place())
                    }
                }
            }
        }
    }
}

impl std::error::Error for RegistryError {}
